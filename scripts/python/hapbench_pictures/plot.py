"""`hapbench plot`: a file with the scene in a section and quantities over time below it; or the
picture of a sweep, of limits, of a tuning or of a convergence."""
import math
from collections import Counter

from hapbench.columns import is_number
from hapbench.errors import InputError
from hapbench.results import Files, MissingResult, at
from hapbench_command import write
from hapbench_report.recording import tool_profile
from hapbench_report.replay import surface_of
from hapbench_style import LINE, SETTINGS, picture, plt

from .given import common_folder, given_alone, given_runs, given_sweep, named
from .over_axes import PICTURES
from .panels import AXIS_COLUMNS, PATH_COLUMNS, draw_over_time, draw_section, looks
from .quantities import Samples, chosen
from .sweep_plot import Sweep, draw_sweep, sensitivity_table

KINDS = (".svg", ".png", ".pdf")
WIDTH, LARGE, SMALL = (
    7.6,
    2.6,
    1.25,
)  # of the page, the scene and the first quantity, and of the others [inch]
LEGEND_COLUMNS = 4
LETTER = 0.068  # width of a letter of the legend [inch]
LONGEST_NAME = 90  # letters
SAID = "circle: start; triangle: first touch"
SOLID_SAID, TOOL_SAID = (
    "filled: section of the solid through the middle of the path",
    "outlines: the tool at four times",
)


def plot(options):
    sweep, study = given_sweep(options.runs), given_alone(options.runs, PICTURES, "holds limits")
    if study:
        refuse(
            options,
            ("--y", "--metric", "--where", "--from", "--to"),
            f"{study} holds limits; allowed for it: --out",
        )
    file = options.out or common_folder(options.runs) / "plot.svg"
    if file.suffix not in KINDS:
        raise InputError(f"--out {file}: got \"{file.suffix}\"; allowed: {', '.join(KINDS)}")
    if not sweep and not study and (options.metric or options.where):
        raise InputError(
            f"{'--metric' if options.metric else '--where'}: is for a sweep's folder; allowed for runs: --y"
        )
    figure = of_study(study) if study else of_sweep(sweep, options) if sweep else of_runs(options)
    write(file, picture(figure, file.suffix[1:]))
    if not options.quiet:
        print(f"picture in {file}")


def refuse(options, names, why):
    """Options that what is drawn has no use for."""
    given = {
        "--y": options.y,
        "--metric": options.metric,
        "--where": options.where,
        "--from": options.start,
        "--to": options.end,
    }
    unused = next((name for name in names if given[name]), None)
    if unused:
        raise InputError(f"{unused}: {why}")


def of_study(path):
    draw = next(draw for name, draw in PICTURES.items() if (path / name).is_file())
    try:
        with plt.rc_context(SETTINGS):
            return draw(Files(path))
    except MissingResult as error:
        raise InputError(str(error)) from error
    except (KeyError, ValueError, IndexError) as error:
        raise InputError(f"{path}: is not a table that hapbench wrote: {error}") from error


def window_of(options):
    """The times to draw [s]."""
    for name, text in (("--from", options.start), ("--to", options.end)):
        if text is not None and not is_number(text):
            raise InputError(f'{name}: got "{text}"; allowed: a time in seconds')
    window = float(options.start or -math.inf), float(options.end or math.inf)
    if not window[0] < window[1]:
        raise InputError(
            f"--from {options.start} --to {options.end}: is not a span of time; allowed: --from before --to"
        )
    return window


def of_runs(options):
    runs = given_runs(options.runs)
    quantities, with_path = chosen(options.y, runs)
    further = (*PATH_COLUMNS, *AXIS_COLUMNS) if with_path else ()
    samples = [Samples(run, quantities, further, window_of(options)) for run in runs]
    return draw(
        runs,
        looks(runs, *named(runs)),
        quantities,
        with_path,
        samples,
        surface_of(runs) if with_path else None,
    )


def of_sweep(folder, options):
    refuse(
        options,
        ("--y", "--from", "--to"),
        f"{folder} is a sweep; allowed for it: --metric, --where",
    )
    sweep = Sweep(folder, options.metric, options.where)
    if not options.quiet:
        print("".join(f"{line}\n" for line in sensitivity_table(sweep)), end="")
    return draw_sweep(sweep)


def draw(runs, shown, quantities, with_path, samples, surface=None):
    """The figure: a title with the runs' names, below it the scene and the first quantity in the
    same room, side by side where no solid fills the width of the scene, and the others."""
    with plt.rc_context(SETTINGS):
        entries = legend_of(shown)
        columns = legend_columns(entries, WIDTH)
        head = 0.3 + (LINE * math.ceil(len(entries) / columns) if len(runs) > 1 else 0)
        beside = with_path and bool(quantities) and surface is None
        heights = [LARGE] * (with_path + bool(quantities) - beside) + [SMALL] * (
            len(quantities) - 1
        )
        figure = plt.figure(figsize=(WIDTH, head + sum(heights) + 0.35))
        top, bottom = figure.subfigures(2, 1, height_ratios=[head, sum(heights) + 0.35])
        write_title(top, head, runs, entries, columns)
        grid = bottom.add_gridspec(len(heights), 2, height_ratios=heights, width_ratios=(1, 1.5))
        rows = [grid[i, :] for i in range(len(heights))]
        scene, *over_time = map(
            bottom.add_subplot, [grid[0, 0], grid[0, 1], *rows[1:]] if beside else rows
        )
        if with_path:
            profile = profile_of(runs[0])
            draw_section(scene, samples, shown, profile, surface)
            tool = TOOL_SAID + (", first run" if len(runs) > 1 else "")
            said = [
                SAID,
                *([SOLID_SAID] if surface is not None else []),
                *([tool] if profile else []),
            ]
            separator = ";\n" if beside else "; "
            scene.set_xlabel(f"{scene.get_xlabel()}\n{separator.join(said)}")
        else:
            over_time = [scene, *over_time]
        for ax, quantity in zip(over_time, quantities):
            draw_over_time(ax, quantity, samples, shown)
            ax.sharex(over_time[0])
            ax.tick_params(labelbottom=ax is over_time[-1] or beside and ax is over_time[0])
            if beside:
                over_time[0].set_xlabel("time [s]")
        if over_time:
            over_time[-1].set_xlabel("time [s]   (triangles and dotted lines: first touch)")
        bottom.align_ylabels()
        return figure


def profile_of(run):
    """Profile of the tool; None for springs, which have no tool."""
    return (
        None
        if at(run.scenario, "/environment/type") == "springs"
        else tool_profile(run.scenario, run.summary)
    )


def legend_of(shown):
    """Label -> look: the first run of each group stands for all of it."""
    counts = Counter(one.group or one.label for one in shown)
    entries = {}
    for one in shown:
        name = one.group or one.label
        entries.setdefault(name if counts[name] == 1 else f"{name} ({counts[name]} seeds)", one)
    return (
        {shortened(name): one for name, one in entries.items()}
        if len(set(map(shortened, entries))) == len(entries)
        else entries
    )


def shortened(name):
    return (
        name
        if len(name) <= LONGEST_NAME
        else f"{name[:LONGEST_NAME // 2 - 1]}…{name[-LONGEST_NAME // 2:]}"
    )


def legend_columns(entries, width):
    """The number of columns that fit into so many inches."""
    return max(
        1, min(LEGEND_COLUMNS, int((width - 0.2) / (0.55 + LETTER * max(map(len, entries)))))
    )


def write_title(top, head, runs, entries, columns):
    scenes = ", ".join(dict.fromkeys(run.name for run in runs))
    name = (
        next(iter(entries))
        if len(runs) == 1
        else scenes
        if len(scenes) <= LONGEST_NAME
        else f"{len(runs)} runs"
    )
    top.text(0.01, 1 - 0.06 / head, name, ha="left", va="top", fontsize=9, weight="bold")
    if len(runs) > 1:
        handles = [plt.Line2D([], [], color=one.colour, ls=one.line) for one in entries.values()]
        top.legend(handles, list(entries), loc="lower left", ncol=columns)
