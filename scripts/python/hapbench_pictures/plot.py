"""`hapbench plot`: writes a picture. The picture of runs has cross-sections of the scenes and quantities over time.
Sweeps, limits, tunings and convergence studies have other pictures."""
import math
from pathlib import Path

from hapbench.columns import is_number
from hapbench.errors import InputError
from hapbench_command import print_warning, write
from hapbench_style import DPI, SHEETS, picture

from .given import common_folder, given_alone, given_runs, given_sweep
from .legibility import with_legible_ticks
from .quantities import chosen
from .ranking_plot import draw_ranking, is_ranking
from .replay_plot import draw_logs, given_logs
from .run_plot import draw_runs
from .study_plot import PICTURES, draw_study, kind_of
from .sweep_plot import Sweep, draw_sweep, sensitivity_table

KINDS = (".svg", ".png", ".pdf")
MIN_DPI, MAX_DPI = 50, 1200


def plot(options):
    file = options.out or common_folder(options.runs) / "plot.svg"
    if file.suffix not in KINDS:
        raise InputError(f"--out {file}: got \"{file.suffix}\"; allowed: {', '.join(KINDS)}")
    write(file, picture(figure_of(options), file.suffix[1:], dpi=dpi_of(options, file)))
    if not options.quiet:
        print(f"picture in {file}")


def dpi_of(options, file):
    """Returns the resolution from --dpi [pixels per inch], or the default. Fails for an SVG, which has no pixels."""
    if options.dpi is None:
        return DPI
    if file.suffix == ".svg":
        raise InputError("--dpi: an .svg has no pixels; allowed for --out FILE.png, or .pdf")
    if not is_number(options.dpi) or not MIN_DPI <= float(options.dpi) <= MAX_DPI:
        raise InputError(f'--dpi: got "{options.dpi}"; allowed: {MIN_DPI} to {MAX_DPI}')
    return float(options.dpi)


def figure_of(options):
    """Returns the figure for the parsed options of `hapbench plot`."""
    return with_legible_ticks(drawn(options))


def drawn(options):
    """Returns the figure before its tick labels are adjusted."""
    window = window_of(options)  # checked first, because --to FILE is a likely mistake
    logs = given_logs(options.runs)
    if logs:
        refuse(
            options,
            ("--y", "--metric", "--where", "--from", "--to"),
            "is not for logs of a loop; allowed for them: --width, --dpi, --out",
        )
        return draw_logs(logs, SHEETS[options.width or "double"])
    sweep, study = given_sweep(options.runs), given_alone(options.runs, PICTURES, "holds a study")
    sheet = SHEETS[options.width or "double"]
    if study:
        refuse(
            options,
            ("--y", "--metric", "--where", "--from", "--to"),
            f"is not for {study}, {kind_of(study)}; allowed for it: --width, --dpi, --out",
        )
        return draw_study(study, sheet)
    if sweep:
        return of_sweep(sweep, options, sheet)
    return of_runs(options, sheet, window)


def refuse(options, names, why):
    """Fails if one of the options `names` is given, because it does not apply to the drawn results. `why`: text of the
    message."""
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


def window_of(options):
    """Returns the first and the last time to draw [s], from --from and --to."""
    for name, text in (("--from", options.start), ("--to", options.end)):
        if text is not None and not is_number(text):
            hint = ""
            if Path(text).suffix in KINDS:
                hint = f"; --out {text} names the file of the picture"
            raise InputError(f'{name}: got "{text}"; allowed: a time in seconds{hint}')
    window = float(options.start or -math.inf), float(options.end or math.inf)
    if not window[0] < window[1]:
        raise InputError(
            f"--from {options.start} --to {options.end}: is not a span of time; allowed: --from before --to"
        )
    return window


def of_runs(options, sheet, window):
    """Draws runs over time. With --metric, or if the folder has a ranking and none of --y, --from and --to is given,
    draws the metrics of a comparison, one group for each force law."""
    over_time = bool(options.y or options.start or options.end)
    if options.where:
        raise InputError("--where: is for a sweep's folder; allowed for runs: --y, --metric")
    if over_time and options.metric:
        raise InputError(
            "--metric: draws a metric by law; allowed without --y, --from and --to, which draw runs over time"
        )
    runs = given_runs(options.runs)
    if options.metric or is_ranking(options.runs) and not over_time:
        return draw_ranking(runs, options.metric, options.runs, sheet)
    quantities, with_path = chosen(options.y, runs)
    return draw_runs(runs, quantities, with_path, window, sheet)


def of_sweep(folder, options, sheet):
    refuse(
        options,
        ("--y", "--from", "--to"),
        f"{folder} is a sweep; allowed for it: --metric, --where",
    )
    if len(options.metric) > 1:
        raise InputError(
            f"--metric: got {','.join(options.metric)}; allowed for a sweep: one column of sweep.csv"
        )
    sweep = Sweep(folder, next(iter(options.metric), None), options.where)
    if sweep.gap:
        print_warning(sweep.gap)
    if not options.quiet:
        print("".join(f"{line}\n" for line in sensitivity_table(sweep)), end="")
    return draw_sweep(sweep, sheet)
