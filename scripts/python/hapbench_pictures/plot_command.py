"""`hapbench plot`: a sketch in the terminal and a file."""
import io
import math
from pathlib import Path

from hapbench_command import Arguments
from hapbench_report.json_input import InputError

from .files import write
from .given import common_folder, given_runs, given_sweep, named
from .map_plot import given_study, study_figures
from .terminal import this_terminal

KINDS = (".svg", ".png", ".pdf")


def arguments(words):
    parser = Arguments(prog="hapbench plot", description="Draws runs over time, or a sweep.")
    parser.add_argument("runs", nargs="+", metavar="RUN")
    parser.add_argument("--y", type=lambda text: [name.strip() for name in text.split(",") if name.strip()], default=[])
    parser.add_argument("--metric")
    parser.add_argument("--from", dest="start", metavar="T")
    parser.add_argument("--to", dest="end", metavar="T")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--no-sketch", action="store_true")
    parser.add_argument("--quiet", action="store_true")
    return parser.parse_args(words)


def plot(words):
    options = arguments(words)
    sweep = given_sweep(options.runs)
    study = given_study(options.runs)
    if study:
        refuse(options, ("--y", "--metric", "--from", "--to"), f"{study} holds stability maps or limits; allowed for it: --out")
    folder = study.parent if study and study.is_file() else common_folder(options.runs)
    file = options.out or folder / "plot.svg"
    if file.suffix not in KINDS:
        raise InputError(f"--out {file}: got \"{file.suffix}\"; allowed: {', '.join(KINDS)}")
    if study:
        write_all(study_figures(study), file, options.quiet)
        return
    if sweep:
        figure, lines = of_sweep(sweep, options)
    elif options.metric:
        raise InputError("--metric: is for a sweep's folder; allowed for runs: --y")
    else:
        figure, lines = of_runs(options)
    for line in lines:
        print(line)
    write_all([("", figure)], file, options.quiet)


def refuse(options, names, why):
    """Options that what is drawn has no use for."""
    given = {"--y": options.y, "--metric": options.metric, "--from": options.start, "--to": options.end}
    unused = next((name for name in names if given[name]), None)
    if unused:
        raise InputError(f"{unused}: {why}")


def write_all(figures, file, quiet):
    """Several of them beside each other, told apart by their names."""
    import matplotlib
    from hapbench_figures.style import fix_layout

    for name, figure in figures:
        to = file.with_stem(f"{file.stem}_{name}") if len(figures) > 1 else file
        picture = io.BytesIO()
        fix_layout(figure)
        # Same runs, same bytes.
        with matplotlib.rc_context({"svg.hashsalt": "hapbench", "svg.fonttype": "none"}):
            figure.savefig(picture, format=to.suffix[1:], dpi=150, metadata=undated(to.suffix))
        write(to, picture.getvalue())
        if not quiet:
            print(f"picture in {to}")


def undated(suffix):
    return {".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".png": {"Software": None}}[suffix]


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
    from .looks import looks
    from .plot import draw, samples_of
    from .quantities import chosen
    from .replay import surface_of
    from .sketch import sketch

    runs = given_runs(options.runs)
    quantities, with_path = chosen(options.y, runs)
    samples, shown = samples_of(runs, quantities, with_path, window_of(options)), looks(runs, *named(runs))
    figure = draw(runs, shown, quantities, with_path, samples, surface_of(runs) if with_path else None)
    if options.no_sketch or options.quiet:
        return figure, []
    if not quantities:
        return figure, ["path: is in the picture only"]
    return figure, sketch(quantities, samples, shown, this_terminal())


def of_sweep(folder, options):
    from .sweep_plot import Sweep, draw_sweep, sketch_sweep

    refuse(options, ("--y", "--from", "--to"), f"{folder} is a sweep; allowed for it: --metric")
    sweep = Sweep(folder, options.metric)
    return draw_sweep(sweep), [] if options.no_sketch or options.quiet else sketch_sweep(sweep, this_terminal())
