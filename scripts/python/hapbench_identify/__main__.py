"""python -m hapbench_identify NAME=VALUE…; the program calls it for `hapbench identify`.

The words are the options of the command, one for each value of a list. Writes the device's file and the picture of the
residual, or the signal of --design. Prints JSON: `table`, rows of text, and `json`; or `faults`, each a place and a problem;
or `io_error`, the number of a system error."""
import json
import math
import sys
from pathlib import Path

import numpy as np
from hapbench_command import write
from hapbench_import.faults import fail, run_asked
from hapbench_import.stroke import number_text

from .design import KINDS, design, travel_of
from .fit import fit
from .log import read_log
from .model import NAMES

UNITS = {"handle_mass_kg": "kg", "viscous_N_s_per_m": "N s/m", "coulomb_N": "N", "delay_samples": "samples", "encoder_step_m": "m",
         "position_noise_m": "m", "offset_N": "N"}
IN_DEVICE = ("handle_mass_kg", "viscous_N_s_per_m", "coulomb_N", "delay_samples", "encoder_step_m", "position_noise_m")


def identify(given):
    log = read_log(given)
    found = fit(log)
    told = dict(zip(NAMES, zip(found.values.tolist(), found.intervals.tolist())))
    delay, late = told.pop("delay_s")
    told["delay_samples"] = (delay / log.step, [end / log.step for end in late])
    step = log.encoder_step
    # Differences of positions are multiples of the step to 1e-9 of it (resolution_of).
    told["encoder_step_m"] = (step, [step * (1.0 - 1e-9), step * (1.0 + 1e-9)])
    count = np.isfinite(found.residual).sum() / found.memory
    beyond = found.rms**2 - step**2 / 12.0
    noise = math.sqrt(max(beyond, 0.0))
    spread = found.rms**2 * math.sqrt(2.0 / count) * 1.96
    told["position_noise_m"] = (noise, [math.sqrt(max(beyond - spread, 0.0)), math.sqrt(max(beyond + spread, 0.0))])
    told = {name: parameter(*told[name]) for name in UNITS}
    if told["handle_mass_kg"]["value"] is None:
        fail(f"the log cannot tell the mass: the simulated position misses by {found.rms:.3g} m. Is a hand or a spring on the handle, or is a "
             "sign or a unit wrong? hapbench identify --design makes a signal that tells", given["file"][0])
    warnings = log.warnings + warnings_of(told, found, log)
    out = Path(given["out"][0])
    device = {"type": "impedance"} | {name: float(f"{told[name]['value']:.6g}") for name in IN_DEVICE if told[name]["value"]}
    write(out, json.dumps(device, indent=2) + "\n")
    picture = out.with_suffix(".svg")
    draw(picture, log, found)
    table = [[f"{name} [{UNITS[name]}]", "cannot be told" if one["value"] is None else f"{one['value']:.4g}", *map(shown_end, one["interval"])] for name, one in told.items()]
    table.append(["residual [m]", f"{found.rms:.3g}", "", ""])
    return {"table": table, "json": told | {"step_s": log.step, "residual_m": found.rms, "samples": int(np.isfinite(log.position).sum()),
                                            "device": str(out), "picture": str(picture), "warnings": warnings}}


def parameter(value, interval):
    """No value where the interval is wider than it; the interval then still says what it is not."""
    low, high = interval
    return {"value": value if high - low <= abs(value) or low == high else None,
            "interval": [end if math.isfinite(end) else None for end in interval]}


def shown_end(end):
    return "any" if end is None else f"{end:.4g}"


def warnings_of(told, found, log):
    warnings = [f"{name}: the log cannot tell it from 0; 95 % interval {' ... '.join(map(shown_end, one['interval']))}"
                for name, one in told.items() if one["value"] is None and name not in ("offset_N", "position_noise_m")]
    if delay := told["delay_samples"]["value"]:
        warnings.append(f"delay_samples counts samples of this log, of {1e3 * log.step:.4g} ms: {1e3 * delay * log.step:.3g} ms. A scene takes it "
                        f"for time steps of its own: give it {delay * log.step:.4g} / time.step_s there, {2048 * delay * log.step:.4g} at 1/2048 s")
    if told["offset_N"]["value"] is not None:
        warnings.append(f"a constant force of {told['offset_N']['value']:.3g} N acts besides the commands (weight, a cable): no device file has it")
    if found.memory > 10.0 and found.rms > 2.0 * max(log.encoder_step, 1e-12) / math.sqrt(12.0):
        warnings.append(f"the residual, {found.rms:.3g} m, is no noise: {found.memory:.0f} samples of it count as one. The device has something that "
                        "this model has not (a hand on it, elasticity, friction that depends on the place): look at the picture; the intervals "
                        "allow for the correlation only")
    return warnings


def draw(file, log, found):
    from hapbench_style import AMBER, PETROL, SETTINGS, panels, picture, plt  # loads matplotlib, which --design does without
    plt.rcParams.update(SETTINGS)
    figure, ((above,), (below,)) = panels(2, 1, 4.0, sharex=True)
    time = log.time - log.time[0]
    above.plot(time, 1e3 * log.position, color=PETROL, label="measured")
    above.plot(time, 1e3 * (log.position - found.residual), color=AMBER, ls="--", label="device identified")
    above.set_ylabel("position [mm]")
    above.legend()
    unit, name = (log.encoder_step, "encoder steps") if log.encoder_step else (1e-6, "µm")
    below.plot(time, found.residual / unit, ".", ms=1.5, color=PETROL)
    below.set_ylabel(f"measured - simulated [{name}]")
    below.set_xlabel("time [s]")
    write(file, picture(figure, "svg"))


def play(given):
    kind = given["design"][0]
    numbers = {name: float(given[name][0]) for name in ("force", "travel", "rate", "duration", "mass")}
    for name, value in numbers.items():
        if not 0.0 < value < 1e9:
            fail(f"--{name}: got {value:g}; allowed: > 0")
    time, force = design(kind, **numbers)
    rows = "\n".join(f"{number_text(t)},{number_text(f)}" for t, f in zip(time.tolist(), force.tolist()))
    write(Path(given["out"][0]), f"time_s,force_N\n{rows}\n")
    travel = float(travel_of(time, force, numbers["mass"]))
    table = [["signal", KINDS[kind], "", ""], ["samples", str(len(time)), "", ""], ["largest force [N]", f"{np.abs(force).max():.3g}", "", ""],
             [f"way of {numbers['mass']:g} kg without friction [m]", f"{travel:.3g}", "", ""]]
    return {"table": table, "json": {"file": given["out"][0], "design": kind, "samples": len(time), "force_max_N": float(np.abs(force).max()),
                                     "travel_m": travel, "warnings": []}}


if __name__ == "__main__":
    sys.exit(run_asked(lambda given: play(given) if "design" in given else identify(given)))
