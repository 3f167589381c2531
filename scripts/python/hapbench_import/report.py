"""The report of an import, as JSON and, from that, as a table for people."""
import math

import numpy as np

from .samples import DOWN

USUAL_RATES = (1.0, 1e5)  # of recordings [Hz]
LONGEST, SHORTEST = 3.0, 1e-5  # of a hand's stroke, which is millimetres to decimetres long [m]
MOST_GAPS = 5  # that are told each


def json_of(report, stiffness):
    read, clock, stroke = report.read, report.clock, report.stroke
    axes = stroke.turn.apply(DOWN)
    mean = axes.mean(axis=0)
    mean = mean / np.linalg.norm(mean) if np.linalg.norm(mean) > 1e-9 else axes[0]
    coarsest = max((step for step in report.resolution if step is not None), default=None)
    forces = None if stroke.force is None else np.linalg.norm(stroke.force, axis=1)
    found = {
        "rows_read": len(read.recording.rows), "rows_left_out": len(read.left_out), "samples": len(stroke.time),
        "rate_Hz": report.rate, "resampled": report.resampled, "first_time_s": clock.first, "duration_s": clock.duration,
        "interval_s": {"min": clock.interval_min, "median": clock.interval_median, "max": clock.interval_max},
        "gaps": len(report.gaps), "box_m": [stroke.position.min(axis=0).tolist(), stroke.position.max(axis=0).tolist()],
        "speed_p99_m_per_s": report.speed_p99, "speed_max_m_per_s": report.speed_max, "has_roll": stroke.has_roll,
        "tip_direction": mean.tolist(), "tip_direction_spread_rad": float(np.arccos(np.clip(axes @ mean, -1.0, 1.0)).max()),
        "unit_deviation": read.unit_deviation, "quantum_m": report.resolution,
        "quantum_force_N": None if coarsest is None else stiffness * coarsest,
        "force_min_N": None if forces is None else float(forces.min()), "force_max_N": None if forces is None else float(forces.max()),
        "smoothing": report.smoothing}
    return found | {"warnings": _warnings(report, found)}


def table_of(found, stiffness):
    """Rows of a label and a text, of what json_of made."""
    interval, (low, high) = found["interval_s"], found["box_m"]
    bad, smoothing = found["rows_left_out"], found["smoothing"]
    rows = [
        ("rows", f"{found['rows_read']} read, " + (f"{bad} bad ones left out" if bad else "all used")),
        ("clock", f"began at {found['first_time_s']:.9g} s; intervals {1e3 * interval['median']:.4g} ms in the median, "
                  f"{1e3 * interval['min']:.4g} ... {1e3 * interval['max']:.4g} ms"),
        ("stroke", f"{found['duration_s']:.6g} s in {found['samples']} samples, {found['rate_Hz']:.6g} Hz" + (", resampled" if found["resampled"] else "")),
        ("gaps", f"{found['gaps']}, bridged" if found["gaps"] else "none (of ten median intervals and more)"),
        ("tip", ", ".join(f"{axis} {1e3 * a:.4g} ... {1e3 * b:.4g}" for axis, a, b in zip("xyz", low, high)) + " mm"),
        ("speed", f"{found['speed_max_m_per_s']:.4g} m/s at most, 99 % below {found['speed_p99_m_per_s']:.4g} m/s"),
        ("pose", f"quaternions; norms were within {found['unit_deviation']:.1e} of 1" if found["has_roll"] else "the axis alone; the roll is unknown"),
        ("tip points", f"along [{', '.join(f'{part + 0.0:.3g}' for part in found['tip_direction'])}] in the mean, within "
                       f"{math.degrees(found['tip_direction_spread_rad']):.3g} degrees of it"),
        ("resolution", ", ".join(f"{axis} {'none' if step is None else f'{1e6 * step:.4g} um'}" for axis, step in zip("xyz", found["quantum_m"])))]
    if found["quantum_force_N"] is not None:
        rows.append(("", f"alone makes steps of K q = {found['quantum_force_N']:.4g} N at the default K = {stiffness:g} N/m"))
    if smoothing:
        moved, moved_rms, turned, turned_rms = smoothing.values()
        rows.append(("smoothing", f"moved the tip by {1e6 * moved:.4g} um at most, {1e6 * moved_rms:.4g} um rms; turned it by "
                                  f"{1e3 * turned:.4g} mrad, {1e3 * turned_rms:.4g} rms"))
    least, most = found["force_min_N"], found["force_max_N"]
    return [*rows, ("force", "not measured" if least is None else f"measured, {least:.4g} ... {most:.4g} N")]


def _warnings(report, found):
    read = report.read
    warnings = list(read.notes)
    if read.left_out:
        warnings.append(f"{len(read.left_out)} bad rows were left out")
    warnings += [f"{place}: {problem}" for place, problem in read.left_out[:20]]
    warnings += [f"a gap of {duration:.4g} s behind {read.recording.row_word} {read.recording.places[read.kept[i]]} is bridged by a straight line"
                 for i, duration in report.gaps[:MOST_GAPS]]
    if len(report.gaps) > MOST_GAPS:
        warnings.append(f"{len(report.gaps)} gaps in all")
    extent = float(np.ptp(found["box_m"], axis=0).max())
    if not SHORTEST <= extent <= LONGEST:
        warnings.append(f"the tip's places are within {extent:.4g} m, which is not a stroke of a hand: is the scale right? "
                        "(--scale position=0.001 is for millimetres)")
    if not USUAL_RATES[0] <= report.rate <= USUAL_RATES[1]:
        warnings.append(f"{report.rate:.4g} samples a second is an unusual rate: is the scale of time right? (--scale time=1e-3 is for "
                        "milliseconds)")
    if found["tip_direction"][2] > 0.5:
        warnings.append("the tip points upwards in the mean: are --orientation (the order of a quaternion), tip_axis and --frame right?")
    return warnings
