"""The report of an import, as a table for people and as JSON."""
import math

import numpy as np

from .samples import DOWN

USUAL_RATES = (1.0, 1e5)  # of recordings [Hz]


def table_of(report, stiffness):
    """Rows of a label and a text."""
    read, clock, stroke = report.read, report.clock, report.stroke
    count, bad = len(read.recording.rows), len(read.left_out)
    low, high = _box(stroke)
    coarsest = _coarsest(report)
    rows = [
        ("rows", f"{count} read, " + (f"{bad} bad ones left out" if bad else "all used")),
        ("clock", f"began at {clock.first:.9g} s; intervals {1e3 * clock.interval_median:.4g} ms in the median, "
                  f"{1e3 * clock.interval_min:.4g} ... {1e3 * clock.interval_max:.4g} ms"),
        ("stroke", f"{clock.duration:.6g} s in {len(stroke.time)} samples, {report.rate:.6g} Hz"
                   + (", resampled" if report.resampled else "")),
        ("gaps", f"{len(report.gaps)}, bridged" if report.gaps else "none (of ten median intervals and more)"),
        ("tip", f"{_size_text(low, high)} ({_place_text(low, high)})"),
        ("speed", f"{report.speed_max:.4g} m/s at most, 99 % below {report.speed_p99:.4g} m/s"),
        ("pose", f"quaternions; norms were within {read.unit_deviation:.1e} of 1" if stroke.has_roll
         else "the axis alone; the roll is unknown"),
        ("tip points", f"along [{', '.join(f'{part + 0.0:.3g}' for part in _direction(stroke)[0])}] in the mean, within "
                       f"{math.degrees(_direction(stroke)[1]):.3g} degrees of it"),
        ("resolution", ", ".join(f"{axis} {'none' if step is None else f'{1e6 * step:.4g} um'}"
                                 for axis, step in zip("xyz", report.resolution)))]
    if coarsest is not None:
        rows.append(("", f"alone makes steps of K q = {stiffness * coarsest:.4g} N at the default K = {stiffness:g} N/m"))
    if report.smoothing:
        moved, moved_rms, turned, turned_rms = report.smoothing.values()
        rows.append(("smoothing", f"moved the tip by {1e6 * moved:.4g} um at most, {1e6 * moved_rms:.4g} um rms; turned it by "
                                  f"{1e3 * turned:.4g} mrad, {1e3 * turned_rms:.4g} rms"))
    forces = _force_range(stroke)
    rows.append(("force", f"measured, {forces[0]:.4g} ... {forces[1]:.4g} N" if forces[0] is not None else "not measured"))
    return rows


def json_of(report, stiffness):
    read, clock = report.read, report.clock
    coarsest = _coarsest(report)
    least, most = _force_range(report.stroke)
    return {
        "rows_read": len(read.recording.rows), "rows_left_out": len(read.left_out), "samples": len(report.stroke.time),
        "rate_Hz": report.rate, "resampled": report.resampled, "first_time_s": clock.first, "duration_s": clock.duration,
        "interval_s": {"min": clock.interval_min, "median": clock.interval_median, "max": clock.interval_max},
        "gaps": len(report.gaps), "box_m": [end.tolist() for end in _box(report.stroke)],
        "speed_p99_m_per_s": report.speed_p99, "speed_max_m_per_s": report.speed_max, "has_roll": report.stroke.has_roll,
        "tip_direction": _direction(report.stroke)[0].tolist(), "tip_direction_spread_rad": _direction(report.stroke)[1],
        "unit_deviation": read.unit_deviation, "quantum_m": report.resolution,
        "quantum_force_N": None if coarsest is None else stiffness * coarsest, "force_min_N": least, "force_max_N": most,
        "smoothing": report.smoothing, "warnings": _warnings(report)}


def _warnings(report):
    read, most_gaps = report.read, 5
    word = read.recording.row_word
    warnings = list(read.notes)
    if read.left_out:
        warnings.append(f"{len(read.left_out)} bad rows were left out")
    warnings += [f"{place}: {problem}" for place, problem in read.left_out[:20]]
    warnings += [f"a gap of {duration:.4g} s behind {word} {read.recording.places[read.kept[i]]} is bridged by a straight line"
                 for i, duration in report.gaps[:most_gaps]]
    if len(report.gaps) > most_gaps:
        warnings.append(f"{len(report.gaps)} gaps in all")
    low, high = _box(report.stroke)
    longest = (high - low).max()
    # A hand's stroke is millimetres to decimetres long.
    if longest > 3.0 or longest < 1e-5:
        warnings.append(f"the tip's places are within {longest:.4g} m, which is no stroke of a hand: is the scale right? "
                        "(--scale position=0.001 is for millimetres)")
    if not USUAL_RATES[0] <= report.rate <= USUAL_RATES[1]:
        warnings.append(f"{report.rate:.4g} samples a second are no usual rate: is the scale of time right? (--scale time=1e-3 is for "
                        "milliseconds)")
    if _direction(report.stroke)[0][2] > 0.5:
        warnings.append("the tip points upwards in the mean: are --orientation (the order of a quaternion), tip_axis and --frame right?")
    return warnings


def _direction(stroke):
    """The mean direction out of the tip, and the largest angle to it [rad]."""
    axes = stroke.turn.apply(DOWN)
    mean = axes.mean(axis=0)
    length = np.linalg.norm(mean)
    mean = mean / length if length > 1e-9 else axes[0]
    return mean, float(np.arccos(np.clip(axes @ mean, -1.0, 1.0)).max())


def _box(stroke):
    return stroke.position.min(axis=0), stroke.position.max(axis=0)


def _coarsest(report):
    return max((step for step in report.resolution if step is not None), default=None)


def _force_range(stroke):
    if stroke.force is None:
        return None, None
    norms = np.linalg.norm(stroke.force, axis=1)
    return float(norms.min()), float(norms.max())


def _unit_for(metres):
    if metres >= 1.0 or metres == 0.0:
        return 1.0, "m"
    return (1e3, "mm") if metres >= 1e-4 else (1e6, "um")


def _size_text(low, high):
    factor, unit = _unit_for((high - low).max())
    return f"{' x '.join(f'{factor * length:.3g}' for length in high - low)} {unit}"


def _place_text(low, high):
    factor, unit = _unit_for(max(np.abs(low).max(), np.abs(high).max()))
    return ", ".join(f"{axis} {factor * a:.3g} ... {factor * b:.3g}" for axis, a, b in zip("xyz", low, high)) + f" {unit}"
