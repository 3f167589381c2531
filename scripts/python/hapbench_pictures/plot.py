"""`hapbench plot`: a file with quantities over time under each other and the tip's way beside them; or the picture of a sweep
or a study."""
import math
from collections import Counter
from pathlib import Path

from hapbench_command import write
from hapbench_report.json_input import InputError, at
from hapbench_report.recording import tool_profile
from hapbench_style import SETTINGS, picture, plt

from .given import common_folder, given_runs, given_sweep, named
from .map_plot import given_study, study_figures
from .panels import AXIS_COLUMNS, PATH_COLUMNS, draw_over_time, draw_path, draw_tool, looks, projections
from .quantities import Samples, chosen
from .replay import surface_of
from .sweep_plot import Sweep, draw_sweep, sensitivity_table

KINDS = (".svg", ".png", ".pdf")
PANEL_HEIGHT, WIDTH, PATH_WIDTH = 1.35, 7.0, 2.6  # [inch]
LEGEND_COLUMNS = 4
LETTER = 0.068  # width of a letter of the legend [inch]
LONGEST_NAME = 90  # letters
SURFACE_SAID = ("dots: section of the surface through", "the middle of the way")
TOOL_SAID = "outlines: tool on its way"


def plot(options):
    sweep = given_sweep(options.runs)
    study = given_study(options.runs)
    if study:
        refuse(options, ("--y", "--metric", "--where", "--from", "--to"), f"{study} holds limits; allowed for it: --out")
    folder = study.parent if study and study.is_file() else common_folder(options.runs)
    file = options.out or folder / "plot.svg"
    if file.suffix not in KINDS:
        raise InputError(f"--out {file}: got \"{file.suffix}\"; allowed: {', '.join(KINDS)}")
    if study:
        write_all(study_figures(study), file, options.quiet)
        return
    if sweep:
        figure = of_sweep(sweep, options)
    elif options.metric or options.where:
        raise InputError(f"{'--metric' if options.metric else '--where'}: is for a sweep's folder; allowed for runs: --y")
    else:
        figure = of_runs(options)
    write_all([("", figure)], file, options.quiet)


def refuse(options, names, why):
    """Options that what is drawn has no use for."""
    given = {"--y": options.y, "--metric": options.metric, "--where": options.where, "--from": options.start, "--to": options.end}
    unused = next((name for name in names if given[name]), None)
    if unused:
        raise InputError(f"{unused}: {why}")


def write_all(figures, file, quiet):
    """Several of them beside each other, told apart by their names."""
    for name, figure in figures:
        to = file.with_stem(f"{file.stem}_{name}") if len(figures) > 1 else file
        write(to, picture(figure, to.suffix[1:]))
        if not quiet:
            print(f"picture in {to}")


def window_of(options):
    """The times to draw [s]."""
    window = (time_of("--from", options.start, -math.inf), time_of("--to", options.end, math.inf))
    if not window[0] < window[1]:
        raise InputError(f"--from {options.start} --to {options.end}: is no span of time; allowed: --from before --to")
    return window


def time_of(name, text, default):
    if text is None:
        return default
    try:
        time = float(text)
    except ValueError:
        time = math.nan
    if not math.isfinite(time):
        raise InputError(f"{name}: got \"{text}\"; allowed: a time in seconds")
    return time


def of_runs(options):
    runs = given_runs(options.runs)
    quantities, with_path = chosen(options.y, runs)
    samples, shown = samples_of(runs, quantities, with_path, window_of(options)), looks(runs, *named(runs))
    return draw(runs, shown, quantities, with_path, samples, surface_of(runs) if with_path else None)


def of_sweep(folder, options):
    refuse(options, ("--y", "--from", "--to"), f"{folder} is a sweep; allowed for it: --metric, --where")
    sweep = Sweep(folder, options.metric, options.where)
    if not options.quiet:
        print("".join(f"{line}\n" for line in sensitivity_table(sweep)), end="")
    return draw_sweep(sweep)


def samples_of(runs, quantities, with_path, window):
    return [Samples(run, quantities, (*PATH_COLUMNS, *AXIS_COLUMNS) if with_path else (), window) for run in runs]


def draw(runs, shown, quantities, with_path, samples, surface=None):
    """The figure: a title with the runs' names, below it quantities on the left and ways on the right."""
    with plt.rc_context(SETTINGS):
        ways, entries = projections(samples) if with_path else (), legend_of(shown)
        widths = [WIDTH, PATH_WIDTH] if quantities and ways else [WIDTH]
        body = PANEL_HEIGHT * max(len(quantities), len(ways) if quantities else 2 * len(ways))
        columns = legend_columns(entries, sum(widths))
        head = 0.3 + (0.19 * math.ceil(len(entries) / columns) if len(runs) > 1 else 0)
        figure = plt.figure(figsize=(sum(widths), head + body + 0.3))
        top, bottom = figure.subfigures(2, 1, height_ratios=[head, body + 0.3])
        parts = bottom.subfigures(1, len(widths), width_ratios=widths, squeeze=False)[0]
        write_title(top, head, runs, entries, columns)
        if quantities:
            axes = parts[0].subplots(len(quantities), 1, sharex=True, squeeze=False)[:, 0]
            for ax, quantity in zip(axes, quantities):
                draw_over_time(ax, quantity, samples, shown)
            axes[-1].set_xlabel("time [s]   (triangles and dotted lines: first touch)")
        if ways:
            axes, profile, outlined = parts[-1].subplots(len(ways), 1, squeeze=False)[:, 0], profile_of(runs[0]), False
            for ax, plane in zip(axes, ways):
                draw_path(ax, plane, samples, shown, surface)
                outlined |= profile is not None and draw_tool(ax, plane, samples[0], profile, shown[0].colour)
            said = [*(SURFACE_SAID if surface is not None else ()), *([TOOL_SAID + ", first run" * (len(runs) > 1)] if outlined else ())]
            axes[-1].set_xlabel("\n".join([axes[-1].get_xlabel(), *said]))
        return figure


def profile_of(run):
    """Profile of the tool; None for springs, which have no tool."""
    return None if at(run.scenario, "/environment/type") == "springs" else tool_profile(run.scenario, run.summary)


def legend_of(shown):
    """Label -> look: the first run of each group stands for all of it."""
    counts = Counter(one.group or one.label for one in shown)
    entries = {}
    for one in shown:
        name = one.group or one.label
        entries.setdefault(name if counts[name] == 1 else f"{name} ({counts[name]} seeds)", one)
    return {shortened(name): one for name, one in entries.items()} if len(set(map(shortened, entries))) == len(entries) else entries


def shortened(name):
    return name if len(name) <= LONGEST_NAME else f"{name[:LONGEST_NAME // 2 - 1]}…{name[-LONGEST_NAME // 2:]}"


def legend_columns(entries, width):
    """The number of columns that fit into so many inches."""
    return max(1, min(LEGEND_COLUMNS, int((width - 0.2) / (0.55 + LETTER * max(map(len, entries))))))


def write_title(top, head, runs, entries, columns):
    scenes = ", ".join(dict.fromkeys(run.name for run in runs))
    name = next(iter(entries)) if len(runs) == 1 else scenes if len(scenes) <= LONGEST_NAME else f"{len(runs)} runs"
    top.text(0.01, 1 - 0.06 / head, name, ha="left", va="top", fontsize=9, weight="bold")
    if len(runs) > 1:
        handles = [plt.Line2D([], [], color=one.colour, ls=one.line) for one in entries.values()]
        top.legend(handles, list(entries), loc="lower left", ncol=columns)
