"""Converts the samples of a recording to a stroke: times of a regular clock that starts at 0, and optional smoothing.
Reports the properties of the recording as JSON and as a printed table."""
import math

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from hapbench_command import MAX_FAULTS, Faults, fail

from .clock import (
    FASTEST_HZ,
    are_days,
    is_rounded,
    likely_unit,
    packet_rate,
    packet_text,
    usual_interval,
)
from .columns import scale_text
from .component_columns import add_usual_orientation
from .samples import DOWN, Samples, read_samples

STIFFNESS = 20000.0  # default of rendering.stiffness_N_per_m [N/m]
MAX_SAMPLES = 1e7
LONG_INTERVALS = 10.0  # duration in median intervals above which an interval is a gap
USUAL_RATES = (1.0, FASTEST_HZ)  # usual rates of recordings [Hz]
LONGEST, SHORTEST = 1.0, 1e-5  # largest and smallest plausible length of a hand's stroke [m]
FASTEST = 5.0  # largest plausible speed of a hand [m/s]
MAX_GAPS = 5  # largest number of gaps that are listed one by one
MAX_NOT_READ = 12  # largest number of unread columns that the table names


def import_stroke(recording, options):
    """Returns (Stroke that a scenario can replay, properties of the recording for the JSON)."""
    add_usual_orientation(recording, options)
    read = read_samples(recording, options)
    clock, is_regular = clock_of(read.samples.time)
    gaps = gaps_in(read, clock["interval_s"]["median"], options.max_gap)
    resampled = options.rate is not None or not is_regular
    rate = (
        options.rate
        if options.rate is not None
        else usual_rate(read.samples.time, read.samples.position, is_regular)
    )
    stroke = resample(read.samples, rate) if resampled else read.samples
    if not resampled:
        stroke.time = stroke.time - stroke.time[0]
    clock["first_time_s"] += read.origin
    smoothing = smooth(stroke, **options.smooth) if options.smooth else None
    speeds = sorted(
        (np.linalg.norm(np.diff(stroke.position, axis=0), axis=1) / np.diff(stroke.time)).tolist()
    ) or [0.0]
    resolution = [resolution_of(column) for column in read.coordinates.T]
    coarsest = max((step for step in resolution if step is not None), default=None)
    axes = stroke.turn.apply(DOWN)
    mean = axes.mean(axis=0)
    mean = mean / np.linalg.norm(mean) if np.linalg.norm(mean) > 1e-9 else axes[0]
    forces = None if stroke.force is None else np.linalg.norm(stroke.force, axis=1)
    found = {
        "rows_read": len(recording.rows),
        "rows_left_out": read.rows_left_out,
        "columns": read.columns,
        "columns_not_read": read.columns_not_read,
        "scales": read.scales,
        "rows_per_held_sample": 1.0 if read.held is None else read.held.rows,
        "samples": len(stroke.time),
        "rate_Hz": rate,
        "resampled": resampled,
        **clock,
        "gaps": len(gaps),
        "box_m": [stroke.position.min(axis=0).tolist(), stroke.position.max(axis=0).tolist()],
        "speed_p99_m_per_s": speeds[int(0.99 * (len(speeds) - 1))],
        "speed_max_m_per_s": speeds[-1],
        "has_roll": stroke.has_roll,
        "tip_direction": mean.tolist(),
        "tip_direction_spread_rad": float(np.arccos(np.clip(axes @ mean, -1.0, 1.0)).max()),
        "unit_deviation": read.unit_deviation,
        "quantum_m": resolution,
        "quantum_force_N": None if coarsest is None else STIFFNESS * coarsest,
        "force_min_N": None if forces is None else float(forces.min()),
        "force_max_N": None if forces is None else float(forces.max()),
        "smoothing": smoothing,
    }
    along = into_surface(stroke)
    warnings = _warnings(read, gaps, found)
    if along > 0.5:
        warnings.append(
            "the measured force points along the tip, into the surface; a surface pushes in the opposite direction: "
            + (
                "does the file have the forces on the tool? (omit force_by_tool=true)"
                if options.force_by_tool
                else "does the file have the forces of the tool on the object? (--set force_by_tool=true)"
            )
        )
    return stroke, found | {"warnings": warnings}


def clock_of(time):
    """Returns (statistics of the clock, True if the clock is regular). In a regular clock, every time differs from
    equidistant times by at most a thousandth of the mean interval."""
    first, duration, intervals = float(time[0]), float(time[-1] - time[0]), np.diff(time)
    even = duration / len(intervals)
    off = time - first - np.arange(len(time)) * even
    interval = {
        "min": float(intervals.min()),
        "median": float(np.sort(intervals)[len(intervals) // 2]),
        "max": float(intervals.max()),
    }
    return {"first_time_s": first, "duration_s": duration, "interval_s": interval}, bool(
        (np.abs(off) <= 1e-3 * even).all()
    )


def usual_rate(time, position, is_regular):
    """Returns the sampling rate of a recording [Hz]. For an irregular clock, returns the rate of the rounded clock, of
    the packets or of the usual_interval(), rounded to an integer if it is at least 10 Hz."""
    steps, mean = np.diff(time), (len(time) - 1) / float(time[-1] - time[0])
    if is_regular:
        return mean
    if is_rounded(steps, float(np.median(steps))):
        rate = mean
    else:
        rate = packet_rate(time, position) or 1.0 / usual_interval(steps)
    return rate if rate < 10.0 else float(math.floor(rate + 0.5))


def gaps_in(read, median, longest):
    """Returns (index of the sample before the gap, duration [s]) for each gap, which is an interval of at least
    LONG_INTERVALS times the `median` interval [s]. Refuses the recording if any interval is longer than `longest` [s].
    """
    intervals = np.diff(read.samples.time)
    faults = [
        (
            read.recording.location(read.kept[i]),
            f"a gap of {intervals[i]:.4g} s follows; allowed: {longest:g} s (--set max_gap=...)",
        )
        for i in np.flatnonzero(intervals > longest).tolist()
    ]
    if faults:
        raise Faults(faults[:MAX_FAULTS])
    return [
        (i, float(intervals[i]))
        for i in np.flatnonzero(intervals >= LONG_INTERVALS * median).tolist()
    ]


def resolution_of(values):
    """Returns the resolution of a coordinate: the largest length of which all differences between its values are
    multiples, such as 1e-5 m for a log with five decimals. Returns None if no such length is above 2e-10 and above 2e-9
    of the largest value (the coordinate has full precision), or if all values are equal."""
    values = np.sort(values).tolist()
    # Differences are multiples only up to the rounding of doubles, which Euclid's algorithm amplifies.
    rounding = max(1e-10, 1e-9 * max(abs(values[0]), abs(values[-1])))
    step = 0.0
    for before, value in zip(values, values[1:]):
        # Computes the greatest common divisor by Euclid's algorithm. Rounding can turn a remainder of zero into a small
        # positive number, or into a number slightly below the divisor.
        rest = value - before
        if rest <= rounding:
            continue
        while rest > rounding:
            step, rest = rest, abs(math.remainder(step, rest))
        if step <= 2.0 * rounding:
            return None
        # The whole span of the values is a multiple of the step, too. Dividing the span by its rounded number of steps
        # removes the amplified error.
        span = value - values[0]
        step = span / math.floor(span / step + 0.5)
    return step if step > 0.0 else None


def resample(samples, rate):
    """Returns the samples at a regular rate [Hz] from the first sample on, with times that start at 0. Positions and
    forces are interpolated linearly, and orientations along the great arc."""
    time, duration = samples.time, samples.time[-1] - samples.time[0]
    if not (rate > 0.0 and math.isfinite(rate) and duration * rate < MAX_SAMPLES):
        fail(
            f"rate: got {rate:g} Hz for {duration:.6g} s; allowed: above 0, and up to {MAX_SAMPLES:g} samples"
        )
    # The tolerance keeps a last sample that misses the regular times only by rounding.
    grid = np.arange(math.floor(duration * rate * (1.0 + 1e-12)) + 1) / rate
    recorded = time[0] + grid
    after = np.clip(np.searchsorted(time, recorded, side="right"), 1, len(time) - 1)
    before = after - 1
    part = np.clip((recorded - time[before]) / (time[after] - time[before]), 0.0, 1.0)

    def between(values):
        return values[before] + part[:, None] * (values[after] - values[before])

    turn = Slerp(time, samples.turn)(np.minimum(recorded, time[-1]))
    return Samples(
        grid,
        between(samples.position),
        turn,
        None if samples.force is None else between(samples.force),
        samples.has_roll,
    )


def smooth(stroke, window, order):
    """Smooths the positions and the components of the quaternions in `stroke` by least-squares polynomials over windows
    of neighbouring samples (Savitzky and Golay 1964). A sample gets the value of the polynomial in the middle of its
    window. The samples before the middle of the first window and after the middle of the last window get values of the
    polynomial of this window. The quaternions are normalised again. Forces are measurements and are not smoothed.
    Returns statistics of the changes for the JSON."""
    n = len(stroke.time)
    if window < 3 or window % 2 == 0 or window > 10001 or window > n:
        fail(f"smooth: got a window of {window} samples; allowed: odd, 3 ... {min(n, 10001)}")
    if order >= window or order > 20:
        fail(f"smooth: got order {order}; allowed: 0 ... {min(window - 1, 20)}")
    half = window // 2
    # Orthogonal polynomials keep high orders accurate. scipy.signal.savgol_filter uses powers, which are less accurate.
    basis, _ = np.linalg.qr(
        np.polynomial.chebyshev.chebvander(np.arange(-half, half + 1) / half, order)
    )
    before = np.column_stack([stroke.position, of_one_sign(stroke.turn.as_quat())])
    after = np.column_stack(
        [np.convolve(column, (basis @ basis[half])[::-1], "valid") for column in before.T]
    )
    after = np.concatenate(
        [
            basis[:half] @ (basis.T @ before[:window]),
            after,
            basis[half + 1 :] @ (basis.T @ before[n - window :]),
        ]
    )
    # Over a window that spans more than half a turn, the mean quaternion may be nearly zero. The affected samples keep
    # their orientations.
    is_turn = np.linalg.norm(after[:, 3:], axis=1, keepdims=True) > 0.1
    turn = Rotation.from_quat(np.where(is_turn, after[:, 3:], before[:, 3:]))
    moved, turned = (
        np.linalg.norm(after[:, :3] - stroke.position, axis=1),
        (turn.inv() * stroke.turn).magnitude(),
    )
    stroke.position, stroke.turn = after[:, :3], turn
    return {
        "position_largest_m": float(moved.max()),
        "position_rms_m": float(np.sqrt(np.mean(moved**2))),
        "angle_largest_rad": float(turned.max()),
        "angle_rms_rad": float(np.sqrt(np.mean(turned**2))),
    }


def of_one_sign(quaternions):
    """Returns the quaternions with signs for which no dot product of consecutive quaternions is negative. q and -q are
    the same orientation. With these signs, interpolation follows the shorter arc."""
    same = np.einsum("ij,ij->i", quaternions[1:], quaternions[:-1]) >= 0.0
    return quaternions * np.cumprod(np.where(np.concatenate([[True], same]), 1.0, -1.0))[:, None]


def stroke_text(stroke):
    """Returns the contents of the stroke's file. Its columns are time_s,px_m,py_m,pz_m, then qw,qx,qy,qz or
    axis_x,axis_y,axis_z, and with a measured force mfx_N,mfy_N,mfz_N."""
    if stroke.has_roll:
        names, pose = "qw,qx,qy,qz", np.roll(of_one_sign(stroke.turn.as_quat()), 1, axis=1)
    else:
        names, pose = "axis_x,axis_y,axis_z", stroke.turn.apply(DOWN)
    names = f"time_s,px_m,py_m,pz_m,{names}{'' if stroke.force is None else ',mfx_N,mfy_N,mfz_N'}"
    columns = [stroke.time, stroke.position, pose] + (
        [] if stroke.force is None else [stroke.force]
    )
    return "\n".join(
        [names, *(",".join(map(number_text, row)) for row in np.column_stack(columns).tolist()), ""]
    )


def number_text(value):
    """Returns the shortest decimal text that is read back as the same number. Scientific notation is used only if it is
    shorter."""
    text = repr(value)
    if "e" not in text and abs(value) >= 1e-3 and not text.endswith(".0"):
        return text
    fixed, scientific = np.format_float_positional(value, trim="-"), np.format_float_scientific(
        value, trim="-", exp_digits=2
    )
    return fixed if len(fixed) <= len(scientific) else scientific


def table_of(found):
    """Returns the rows (label, text) of the printed table about the result of import_stroke()."""
    smallest, largest = found["force_min_N"], found["force_max_N"]
    return [
        ("columns", columns_text(found["columns"], found["columns_not_read"], found["scales"])),
        *recording_rows(found),
        *motion_rows(found),
        *resolution_rows(found),
        (
            "force",
            "not measured" if smallest is None else f"measured, {smallest:.4g} ... {largest:.4g} N",
        ),
    ]


def recording_rows(found):
    """Returns the rows of table_of() about rows, clock and gaps of the recording."""
    interval, bad = found["interval_s"], found["rows_left_out"]
    rows = [
        (
            "rows",
            f"{found['rows_read']} read, " + (f"{bad} bad rows skipped" if bad else "all used"),
        ),
        (
            "clock",
            f"starts at {found['first_time_s']:.9g} s; intervals: median {1e3 * interval['median']:.4g} ms, range "
            f"{1e3 * interval['min']:.4g} ... {1e3 * interval['max']:.4g} ms",
        ),
        (
            "stroke",
            f"{found['duration_s']:.6g} s in {found['samples']} samples, {found['rate_Hz']:.6g} Hz"
            + (", resampled" if found["resampled"] else ""),
        ),
        (
            "gaps",
            f"{found['gaps']}, bridged by straight lines"
            if found["gaps"]
            else "none (of at least ten median intervals)",
        ),
    ]
    if found["rows_per_held_sample"] > 1.0:
        rows.insert(
            1,
            (
                "held",
                f"{found['rows_per_held_sample']:.4g} rows per pose; the first row of each pose is used",
            ),
        )
    return rows


def motion_rows(found):
    """Returns the rows of table_of() about positions, speeds and orientations."""
    low, high = found["box_m"]
    return [
        (
            "tip",
            ", ".join(
                f"{axis} {1e3 * a:.4g} ... {1e3 * b:.4g}" for axis, a, b in zip("xyz", low, high)
            )
            + " mm",
        ),
        (
            "speed",
            f"{found['speed_max_m_per_s']:.4g} m/s at most; 99 % of the steps below "
            f"{found['speed_p99_m_per_s']:.4g} m/s",
        ),
        (
            "pose",
            f"quaternions, with norms within {found['unit_deviation']:.1e} of 1"
            if found["has_roll"]
            else "direction of the axis only; the roll is unknown",
        ),
        (
            "tip direction",
            f"[{', '.join(f'{part + 0.0:.3g}' for part in found['tip_direction'])}] in the mean; all "
            f"directions within {math.degrees(found['tip_direction_spread_rad']):.3g} degrees of it",
        ),
    ]


def resolution_rows(found):
    """Returns the rows of table_of() about the resolution of the positions and about smoothing."""
    smoothing = found["smoothing"]
    rows = [
        (
            "resolution",
            ", ".join(
                f"{axis} {'none' if step is None else f'{1e6 * step:.4g} um'}"
                for axis, step in zip("xyz", found["quantum_m"])
            ),
        ),
    ]
    if found["quantum_force_N"] is not None:
        rows.append(
            (
                "",
                f"this resolution q alone causes force steps of K q = "
                f"{found['quantum_force_N']:.4g} N at the default K = {STIFFNESS:g} N/m",
            )
        )
    if smoothing:
        moved, moved_rms, turned, turned_rms = smoothing.values()
        rows.append(
            (
                "smoothing",
                f"moves the tip by at most {1e6 * moved:.4g} um ({1e6 * moved_rms:.4g} um rms) and rotates the "
                f"tool by at most {1e3 * turned:.4g} mrad ({1e3 * turned_rms:.4g} mrad rms)",
            )
        )
    return rows


def columns_text(columns, not_read, scales):
    """Returns a text with the columns of each quantity, by number and name: "time: column 1 t; position x, y, z:
    columns 2 px, 3 py, 4 pz". `not_read`: columns that were not read. `scales`: factors to SI units.
    """
    texts = []
    for quantity, parts in columns.items():
        titles = ", ".join(f"{part['column']} {part['name']}".rstrip() for part in parts)
        of = "angle" if quantity == "orientation" else quantity
        titles += scale_text(of, scales.get(of, 1.0))
        if len(parts) > 1:
            order = ", ".join(part["component"] for part in parts)
            texts.append(f"{quantity} {order}: columns {titles}")
        else:
            texts.append(f"{quantity}: column {titles}" if parts else f"{quantity}: none")
    if not_read:
        more = f" and {len(not_read) - MAX_NOT_READ} more" if len(not_read) > MAX_NOT_READ else ""
        texts.append(f"not read: {', '.join(not_read[:MAX_NOT_READ])}{more}")
    return "; ".join(texts)


def into_surface(stroke):
    """Returns the mean cosine of the angle between the measured force and the direction out of the tip, over the
    samples with more than a fifth of the largest force. A positive mean indicates that the force has the wrong sign,
    because a surface pushes against the tip. Returns 0 without forces, with fewer than 10 of these samples, or if the
    cosine is positive in at most 95 % of these samples."""
    if stroke.force is None:
        return 0.0
    sizes = np.linalg.norm(stroke.force, axis=1)
    touching = sizes > 0.2 * sizes.max(initial=0.0)
    if np.count_nonzero(touching) < 10:
        return 0.0
    along = np.einsum("ij,ij->i", stroke.force, stroke.turn.apply(DOWN))[touching] / sizes[touching]
    return float(along.mean()) if np.mean(along > 0.0) > 0.95 else 0.0


def _warnings(read, gaps, found):
    warnings = list(read.notes)
    if read.left_out:
        warnings.append(f"{read.rows_left_out} bad rows were skipped")
    warnings += [f"{location}: {problem}" for location, problem in read.left_out[:20]]
    warnings += [
        f"a gap of {duration:.4g} s after {read.recording.row_word} "
        f"{read.recording.row_numbers[read.kept[i]]} is bridged by a straight line"
        for i, duration in gaps[:MAX_GAPS]
    ]
    if len(gaps) > MAX_GAPS:
        warnings.append(f"{len(gaps)} gaps in all")
    extent = float(np.ptp(found["box_m"], axis=0).max())
    if not SHORTEST <= extent <= LONGEST:
        warnings.append(
            f"the tip's positions span {extent:.4g} m, which is unusual for a hand: is the scale right? "
            "(--scale position=0.001 is for millimetres, position=0.01 for centimetres)"
        )
    packets = packet_rate(read.samples.time, read.samples.position)
    if packets:
        warnings.append(packet_text(packets))
    warnings += _clock_warnings(found)
    if found["tip_direction"][2] > 0.5:
        warnings.append(
            "the tip points upwards in the mean: are --orientation (the order of a quaternion), "
            "tip_axis and --frame right?"
        )
    return warnings


def _clock_warnings(found):
    """Returns a list with a warning if the sampling rate or the speed is unusual, otherwise an empty list. If the times
    are probably in another unit, the warning names the scale of time that would make the rate usual.
    """
    rate, speed = found["rate_Hz"], found["speed_p99_m_per_s"]
    scale = found["scales"].get("time", 1.0)
    what = f"{rate:.4g} samples per second and a speed of {speed:.3g} m/s"
    if are_days(rate, found["first_time_s"]):
        return [
            f"{what} are unusual: are the times in days, as in spreadsheets and MATLAB? (with --scale time=86400 "
            f"the rate is {rate / 86400:.4g} Hz)"
        ]
    if rate < USUAL_RATES[0] or (rate < 20.0 and 0.0 < speed < 2e-3):
        factor = likely_unit(1.0 / rate, speed)
    elif rate > USUAL_RATES[1] or speed > FASTEST:
        factor = 1e3 if rate < 1e7 else 1e6
        if rate <= USUAL_RATES[1]:
            return [f"{what} are unusual: are the scales of time and position right?"]
    else:
        return []
    return [
        f"{what} are unusual: is the scale of time right? (with --scale time={scale * factor:g} the rate is "
        f"{rate / factor:.4g} Hz; time=0.001 is for milliseconds)"
    ]
