"""Command line of `hapbench import device`, which runs python -m hapbench_identify WORDS…. It fits a device to its log,
or creates the force signal to play."""
import json
import math
import sys
from pathlib import Path

from hapbench_command import (
    SCHEMA,
    CommandLine,
    answer,
    exit_status,
    fail,
    file_word,
    finite_number,
    is_stream,
    leave,
    refuse_source,
    require_name,
    shell_line,
    stop_on_ctrl_c,
    table_text,
    write,
    write_all,
)

if __name__ == "__main__":
    stop_on_ctrl_c("import device")

import numpy as np
from hapbench_import.options import DECIMALS
from hapbench_import.stroke import columns_text, number_text, resolution_of

from .fit import MASS, fit
from .log import read_log
from .model import IDENTIFIABLE_FRICTION, KINDS, NAMES, design, range_of, required_force
from .units import (
    LONGEST_STEP,
    is_likely,
    is_usual,
    likely_units,
    may_be_exchanged,
    scale_option,
    turned_round,
)

NOTES = [
    "Log: a CSV file of one axis while no hand holds the handle: time, commanded force and "
    "position, named time_s, force_N and position_m, or as --columns and --scale say. The force of "
    "a row is the one commanded at its time, positive in the direction of the position.",
    'Units in column names, such as "position [mm]", are applied; --scale overrides them. '
    "--scale force=-1 changes the sign of the forces.",
    "Result: mass, viscous and dry friction, delay, encoder step and noise, each with an interval. It "
    "is a 95 % interval unless a warning says that the residual is not noise. "
    "A parameter that the log cannot determine is not written; a warning gives the "
    "reason. A constant offset force is printed, but is not part of the device.",
    "Design: force (largest, default 1 N), travel (of the handle, default 0.05 m), mass (smallest "
    "possible, default 0.05 kg), rate (default 1000 Hz), duration (default 5 s).",
    "Files: LOG_device.json, for --device of limit, tune and audit, and a picture of the residual "
    "next to it; or the signal, signal_KIND.csv. They replace earlier files. A log that cannot be "
    "used gives exit status 2.",
]
EXAMPLES = [
    "hapbench import device --design multisine,force=2,travel=0.08 --out signal.csv",
    "hapbench import device log.csv --columns time=t,force=3 --scale time=1e-6",
    "hapbench limit tap_wall --device log_device.json",
]
UNITS = {
    "handle_mass_kg": "kg",
    "viscous_N_s_per_m": "N s/m",
    "coulomb_N": "N",
    "delay_s": "s",
    "delay_samples": "samples",
    "encoder_step_m": "m",
    "position_noise_m": "m",
    "offset_N": "N",
}
UNTRUSTED = "The true values can lie outside of the intervals: do not read them as 95 % intervals"
EXCHANGED = "Are the columns of force and position exchanged (--columns force=NAME,position=NAME)?"
OUTLIER = 15.0  # smallest residual of an outlier, in units of the median; 10 standard deviations of white noise
NEGLIGIBLE = 1e-3  # largest offset that counts as zero, as a fraction of the largest force
# Largest number of samples in the picture, which limits the size of the picture of a long log.
MAX_DRAWN = 6000
IN_DEVICE = (
    "handle_mass_kg",
    "viscous_N_s_per_m",
    "coulomb_N",
    "delay_s",
    "encoder_step_m",
    "position_noise_m",
)


def command_line():
    line = CommandLine(
        "import device",
        "Identify the mass, friction, delay and encoder of a device from a log, and write its device file.",
        NOTES,
        EXAMPLES,
        'device_model/README.md, section "The numbers of your own device"',
    )
    line.text("log", "<log.csv>", "log of one axis: time, commanded force, position", nargs="?")
    line.texts(
        "--columns",
        "<name=column,...>",
        "columns of time, force and position, by name or number from 1",
    )
    line.texts(
        "--scale",
        "<name=factor,...>",
        "units of the log: seconds per unit of time, and so on for force [N] and position [m]",
    )
    line.one_of(
        DECIMALS,
        "--decimal",
        "<sign>",
        "decimal sign: comma, point or auto (default: auto; found from the numbers)",
    )
    line.flag("--skip-bad-rows", "skip invalid rows and list them, instead of rejecting the log")
    line.texts(
        "--design",
        "<kind,name=n,...>",
        "instead of reading a log, write a signal to command: chirp, steps or multisine, "
        "with numbers (see below)",
    )
    line.text(
        "--out",
        "<file>",
        "device to write (default: LOG_device.json), or signal (default: signal_KIND.csv)",
    )
    line.add_output_options()
    return line


def run(options):
    if bool(options.design) == bool(options.log):
        fail(
            "import device takes either a LOG or --design, which makes the signal to play and to log"
        )
    kind, numbers = design_of(options.design) if options.design else ("", {})
    out = options.out or (f"signal_{kind}.csv" if kind else f"{Path(options.log).stem}_device.json")
    if options.log:
        refuse_source(out, options.log, "log")
    table, data = play(kind, numbers, out) if kind else identify(options, out)
    sure = kind or data["confidence"]
    headings = ["signal", "value"]
    if not kind:
        headings = ["identified device", "value", "95 % from" if sure else "interval from", "to"]
    next_line = (
        "play these forces on the device, log time_s,force_N,position_m, then "
        f"{shell_line('hapbench', 'import', 'device', 'LOG.csv')}"
        if options.design
        else shell_line("hapbench", "limit", "tap_wall", "--device", file_word(out))
    )
    read = "" if kind else f"{log_text(data)}\n"
    answer(
        options,
        f"{out}\n{read}{table_text(headings, table, options.wide, numbers=True)}\nnext: {next_line}",
        data | {"next": next_line},
    )


def not_in_log():
    """Returns the names of the fields of an impedance device that no fit sets: the fields in the schema, except the
    fitted fields."""
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    devices = [of["properties"] for of in schema["else"]["properties"]["device"]["oneOf"]]
    (fields,) = [of for of in devices if of.get("type") == {"const": "impedance"}]
    return [name for name in fields if name not in (*IN_DEVICE, "type", "preset", "delay_samples")]


def log_text(data):
    """Returns a text about the columns that were read, the clock of the log, and the fields that the log does not
    determine."""
    return (
        f"not in the log: {', '.join(data['not_in_log'])}; add them to {data['device']} if your device has them "
        "(hapbench describe device)\n"
        f"{columns_text(data['columns'], data['columns_not_read'], data['scales'])}\n"
        f"clock: {data['samples']} samples in {data['duration_s']:.4g} s, {1.0 / data['step_s']:.4g} Hz"
    )


def identify(options, out):
    log = read_log(options)
    if log.step > LONGEST_STEP and "time" not in given_scales(options):
        refuse_units(options, log, f"the log has a mean interval of {log.step:.4g} s")
    found = fit(log)
    require_right_sign(options, log, found)
    parameters = parameters_of(log, found)
    if not options.scale and not is_likely(found.values[MASS], log.encoder_step):
        handle = f"a handle of {found.values[MASS]:.3g} kg and an encoder step of {log.encoder_step:.3g} m"
        refuse_units(options, log, f"the fit gives {handle}", found)
    if parameters["handle_mass_kg"]["value"] is None:
        notes = f" {'; '.join(log.warnings)}." if log.warnings else ""
        exchanged = f" {EXCHANGED}" if may_be_exchanged(log) else ""
        fail(
            f"the mass cannot be identified from this log: the simulated position is off by {found.rms:.3g} m "
            f"(rms).{exchanged}{notes} Is a hand or a spring on the handle, or is a sign or a unit wrong? "
            '"hapbench import device --design" makes a suitable signal',
            options.log,
        )
    warnings = log.warnings + warnings_of(parameters, found, log)
    if not found.misfit and not is_usual(log, found.values[MASS]):
        warnings.append(
            f"a handle of {found.values[MASS]:.3g} kg, a travel of "
            f"{np.ptp(log.position[np.isfinite(log.position)]):.3g} m "
            f"and forces of up to {np.abs(log.force).max():.3g} N are unusual. "
            f"{units_text(options, log, found)}".rstrip()
        )
    device = {"type": "impedance"} | {
        name: float(f"{parameters[name]['value']:.6g}")
        for name in IN_DEVICE
        if parameters[name]["value"]
    }
    missing = not_in_log()
    files = {Path(out): json.dumps(device, indent=2) + "\n"}
    # A pipe or a device, such as /dev/stdout, is in no folder of results.
    picture = None if is_stream(Path(out)) else Path(out).with_suffix(".svg")
    if picture:
        files[picture] = drawn(log, found)
    write_all(files)
    table = [
        [
            f"{name} [{UNITS[name]}]",
            value_text(name, one, np.abs(log.force).max()),
            *map(shown_end, one["interval"]),
        ]
        for name, one in parameters.items()
    ]
    table.append(["residual [m rms]", f"{found.rms:.3g}", "", ""])
    return table, parameters | {
        "confidence": 0.95 if found.trusted else None,
        "step_s": log.step,
        "residual_m": found.rms,
        "samples": int(np.isfinite(log.position).sum()),
        "duration_s": float(log.time[-1] - log.time[0]),
        "columns": log.columns,
        "columns_not_read": log.columns_not_read,
        "scales": log.scales,
        "device": out,
        "not_in_log": missing,
        "picture": picture and str(picture),
        "warnings": warnings,
    }


def parameters_of(log, found):
    """Returns the value and the interval of each parameter by name, in the order of UNITS. The value is None if the log
    does not determine the parameter. An infinite end of an interval is None."""
    parameters = {
        name: {"value": None if name in found.undetermined else value, "interval": ends}
        for name, value, ends in zip(NAMES, found.values.tolist(), found.intervals.tolist())
    }
    delay = parameters["delay_s"]
    parameters["delay_samples"] = {
        "value": delay["value"] if delay["value"] is None else delay["value"] / log.step,
        "interval": [end / log.step for end in delay["interval"]],
    }
    step = log.encoder_step
    parameters["encoder_step_m"] = {
        # Without a step, the positions are not rounded, or the log rounds them too coarsely to see the step.
        "value": step
        if step or not resolution_of(log.position[np.isfinite(log.position)])
        else None,
        "interval": log.encoder_interval,
    }
    count = np.isfinite(found.residual).sum() / found.memory
    beyond = found.rms**2 - step**2 / 12.0
    spread = found.rms**2 * math.sqrt(2.0 / count) * 1.96
    low, high = (math.sqrt(max(beyond + sign * spread, 0.0)) for sign in (-1.0, 1.0))
    # If the model does not explain the residual, the residual is only an upper limit of the noise.
    parameters["position_noise_m"] = unless_wide(
        math.sqrt(max(beyond, 0.0)), [0.0 if found.misfit else low, high]
    )
    if parameters["offset_N"]["value"] is not None:
        parameters["offset_N"] = unless_wide(*parameters["offset_N"].values())
    return {
        name: parameters[name]
        | {
            "interval": [
                end if math.isfinite(end) else None for end in parameters[name]["interval"]
            ]
        }
        for name in UNITS
    }


def value_text(name, one, largest_force):
    """Formats a parameter for the printed table. If the offset has no value and its interval is within +- NEGLIGIBLE
    times the largest force, the offset is printed as zero, with the larger end of the interval as error.
    """
    if one["value"] is not None:
        return f"{one['value']:.4g}"
    if name == "offset_N" and None not in one["interval"]:
        size = max(map(abs, one["interval"]))
        if size <= NEGLIGIBLE * largest_force:
            return f"zero within {size:.4g}"
    return "not identifiable"


def unless_wide(value, interval):
    """Returns value and interval of a parameter as a dict. If the interval is wider than the value, the value is None.
    The interval is kept, because it excludes some values."""
    low, high = interval
    return {
        "value": value if high - low <= abs(value) or low == high else None,
        "interval": interval,
    }


def require_right_sign(options, log, found):
    """Fails if a force of the opposite sign explains the log, and the logged force does not."""
    other = turned_round(log, found)
    if other is None:
        return
    fail(
        "the handle accelerates against the force: the sign of force or position is wrong. With the other "
        f"sign the residual is {other.rms:.3g} m instead of {found.rms:.3g} m, and the fit gives a handle of "
        f"{other.values[MASS]:.3g} kg: {scale_option({'force': -1.0}, given_scales(options))}",
        options.log,
    )


def refuse_units(options, log, problem, found=None):
    """Fails with the likely units of a log whose units are probably not s, N and m. A log in milliseconds and
    millimetres fits equally well, but gives a handle mass of tons."""
    advice = units_text(options, log, found)
    if not advice and found is not None and found.misfit:
        fail(
            f"{problem}, but the residual of {found.rms:.3g} m (rms) is more than noise, and other units do not "
            "explain the log. Is a hand or a spring on the handle, or is the clock wrong? If the units s, N and m are "
            "right, --scale time=1 writes the device file anyway",
            options.log,
        )
    advice = advice or "No usual units explain the log."
    fail(
        f"{problem}: are the units s, N and m? {advice} If the units are right, confirm them with "
        "--scale time=1",
        options.log,
    )


def units_text(options, log, found):
    """Returns a text about the likely units of a log, or about columns that are exchanged; empty if neither explains
    the log."""
    given = given_scales(options)
    text = " or ".join(
        f"{text}: {scale_option(factors, given)}"
        for text, factors in likely_units(log, found)
        if factors
    )
    if not text and may_be_exchanged(log):
        return EXCHANGED
    return f"{text[0].upper()}{text[1:]}." if text else ""


def given_scales(options):
    """Returns a dict from quantity to its factor in --scale."""
    pairs = (word.partition("=") for word in options.scale)
    return {name: float(value) for name, _, value in pairs}


def shown_end(end):
    return "any" if end is None else f"{end:.4g}"


def warnings_of(parameters, found, log):
    warnings = [
        f"{name} cannot be identified from this log: {why}; "
        f"{'95 % interval' if found.trusted else 'estimated interval'} "
        f"{' ... '.join(map(shown_end, parameters[name]['interval']))}"
        for name, why in found.undetermined.items()
        if name in IN_DEVICE
    ]
    if parameters["offset_N"]["value"] is not None:
        warnings.append(
            f"a constant force of {parameters['offset_N']['value']:.3g} N acts in addition to the commanded "
            "force (such as weight or a cable); device files cannot represent it"
        )
    warnings += outliers_in(found, log)
    if found.misfit:
        causes = [] if log.knows_forces else ["the unknown forces of the missing samples"]
        causes += [] if log.is_even else ["times that differ from the sampling times"]
        causes += [
            "a property of the device that the model lacks, such as a hand on the handle, elasticity or friction that "
            "depends on the position"
        ]
        warnings.append(
            f"the residual of {found.rms:.3g} m is larger than noise. Possible causes: {'; '.join(causes)}; see the "
            "picture. The parameters are therefore fitted to pieces of "
            "0.2 s, and their intervals come from fits that each omit one twelfth of the log. "
            f"{UNTRUSTED}"
        )
    elif not found.trusted:
        warnings.append(
            f"the residual of {found.rms:.3g} m is not white: its slow part is larger than noise and encoder explain, "
            "as with friction that depends on the speed, or with times that differ from the sampling times. "
            f"{UNTRUSTED}"
        )
    return warnings


def outliers_in(found, log):
    """Returns a list with a warning if single positions are far from the simulation: by more than OUTLIER times the
    median deviation, which noise and rounding never reach. Such positions increase the noise and may move the values.
    """
    size = np.abs(np.where(np.isfinite(found.residual), found.residual, 0.0))
    usual = max(np.median(size[size > 0.0]) if size.any() else 0.0, log.encoder_step)
    far = np.flatnonzero(size > OUTLIER * usual) if usual else np.zeros(0, int)
    if not 0 < len(far) <= 0.01 * len(size):
        return []
    return [
        f"{len(far)} positions are far from the simulation, by up to {size.max():.3g} m, the first at "
        f"{log.time[far[0]]:.9g} s: are they errors of the log? They increase position_noise_m; without these rows, "
        "the noise and the intervals are smaller"
    ]


def drawn(log, found):
    """Returns the picture of a fit as SVG: the positions of log and simulation, and the residual."""
    from hapbench_style import (
        AMBER,
        PETROL,
        SETTINGS,
        panels,
        picture,
        plt,
    )  # Imported here, because it loads matplotlib, which --design does not need.

    plt.rcParams.update(SETTINGS)
    figure, ((above,), (below,)) = panels(2, 1, 4.0, sharex=True)
    every = max(1, len(log.time) // MAX_DRAWN)
    time, position, residual = (
        log.time[::every] - log.time[0],
        log.position[::every],
        found.residual[::every],
    )
    above.plot(
        time,
        1e3 * position,
        color=PETROL,
        label="measured" if every == 1 else f"measured, one sample in {every}",
    )
    above.plot(
        time,
        1e3 * (position - residual),
        color=AMBER,
        ls="--",
        label="simulated with the identified device",
    )
    above.set_ylabel("position [mm]")
    above.legend(loc="lower left", bbox_to_anchor=(0, 1), ncol=2)
    unit, name = (log.encoder_step, "encoder steps") if log.encoder_step else (1e-6, "µm")
    below.plot(time, residual / unit, ".", ms=1.5, color=PETROL)
    below.set_ylabel(f"residual [{name}]")
    below.set_xlabel("time [s]")
    return picture(figure, "svg")


def design_of(words):
    """Returns (kind of the signal, numbers by name) from words such as chirp and force=2. Missing numbers have
    defaults."""
    kind, *given = words
    require_name("--design: got", kind, list(KINDS))
    numbers = {"force": 1.0, "travel": 0.05, "rate": 1000.0, "duration": 5.0, "mass": 0.05}
    for word in given:
        name, _, text = word.partition("=")
        require_name("--design: got", name, list(numbers))
        numbers[name] = finite_number(text.encode())
        if not 0.0 < numbers[name] < 1e9:
            fail(f'--design: {name}: got "{text}"; allowed: a number > 0')
    return kind, numbers


def play(kind, numbers, out):
    time, force = design(kind, **numbers)
    rows = "\n".join(
        f"{number_text(t)},{number_text(f)}" for t, f in zip(time.tolist(), force.tolist())
    )
    write(Path(out), f"time_s,force_N\n{rows}\n")
    peak = float(np.abs(force).max())
    low, high = map(float, range_of(time, force, numbers["mass"]))
    table = [
        ["signal", KINDS[kind]],
        ["samples", str(len(time))],
        ["largest force [N]", f"{peak:.3g}"],
        ["largest identifiable dry friction [N]", f"{IDENTIFIABLE_FRICTION * peak:.3g}"],
        [f"travel of {numbers['mass']:g} kg or more [m]", f"{high - low:.3g}"],
        ["positions from the start [m]", f"{low:.3g} ... {high:.3g}"],
    ]
    return table, {
        "file": out,
        "design": kind,
        "samples": len(time),
        "force_max_N": peak,
        "travel_m": high - low,
        "range_m": [low, high],
        "warnings": limited_by_travel(kind, numbers, peak),
    }


def limited_by_travel(kind, numbers, peak):
    force = numbers["force"]
    if peak > 0.99 * force:
        return []
    text = (
        f"the signal has at most {peak:.3g} N, not {force:g} N: it begins at a low frequency, where a larger force "
        f"moves the handle further than the travel of {numbers['travel']:g} m. That is enough for dry friction of up "
        f"to {IDENTIFIABLE_FRICTION * peak:.3g} N. "
    )
    required = required_force(kind, numbers)
    return [
        text
        + (
            f"For more, ask for force={required:.3g} so that the signal begins at a higher frequency and reaches "
            f"{force:g} N, enough for {IDENTIFIABLE_FRICTION * force:.3g} N"
            if required
            else "A device with more dry friction needs more travel, or mass= above "
            f"{numbers['mass']:g} if its mass is known to be larger"
        )
    ]


if __name__ == "__main__":
    requested = command_line().parse(sys.argv[1:])
    doing = "" if requested.quiet else "designing" if requested.design else "identifying"
    leave(exit_status("import device", doing, lambda: run(requested)))
