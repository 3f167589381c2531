"""Picture of one or two logs of a haptic loop. The picture shows over time what the loop sends to the device (the
rendered force or the set position), the late calls, and the difference of two logs. A haptic loop or
`hapbench run --replay` writes a log."""
import json
from contextlib import suppress
from io import BytesIO
from pathlib import Path

import numpy as np

from hapbench.columns import CUT_LINE, ENCODING, is_finite_number, read_bytes, readable, text_of
from hapbench.errors import InputError
from hapbench.results import number_or_none
from hapbench_command import print_warning
from hapbench_looks import SERIES
from hapbench_style import GREY, SETTINGS, curve, legend_height, plt

from .given import LOG_HEADER
from .legibility import legend_of_names_above
from .log_faults import log_faults
from .panels import SPANS

REPLAY, COMPARISON = "replay.csv", "replay_comparison.csv"
# A call of the loop is late if the time since the previous call exceeds LATE times the period of the loop.
LATE = 1.5
MODES = {  # columns, title and factor of the quantity that the loop sends to the device, by mode
    "impedance": (("fx_N", "fy_N", "fz_N"), "force [N]", 1.0),
    "admittance": (("set_x_m", "set_y_m", "set_z_m"), "set position [mm]", 1e3),
}


def given_logs(words):
    """Returns the log file of each argument, which is a log file or a folder of `hapbench run --replay`. Returns None
    if no argument has a log. Fails if only some arguments have a log, or for more than two logs."""
    files = [log_of(Path(word)) for word in words]
    if not any(files):
        return None
    if not all(files) or len(files) > 2:
        raise InputError(
            f"{', '.join(words)}: allowed: one log of a loop or folder of a replay, or two of them for their difference"
        )
    return files


def log_of(path):
    file = path / REPLAY if path.is_dir() else path
    if (path / COMPARISON).is_file():
        raise InputError(
            f"{path / COMPARISON}: is a table of numbers of each law, without a force over time; allowed: a folder of "
            '"hapbench run --replay", one for each law'
        )
    if not file.is_file():
        return None
    with readable(file), file.open(encoding=ENCODING, errors="replace") as lines:
        is_log = lines.readline().startswith(LOG_HEADER)
    if path.is_dir() and not is_log:
        raise InputError(
            f'{file}: line 1: does not begin with "{LOG_HEADER}"; allowed: a log of a loop'
        )
    return file if is_log else None


class Log:
    """A log of a haptic loop: number of each call, its time [ns], its time since the first call [s], and the quantity
    that the loop sends to the device. `period`: period of the loop [s]. `faults`: texts about faults of the file.
    """

    def __init__(self, file):
        about, names, text = log_text(file)
        self.columns, self.title, factor = MODES[about["mode"]]
        rows = log_numbers(file, names, text, ("call", "time_ns", *self.columns))
        if not len(rows):
            raise InputError(f"{file}: holds no call")
        self.name = f"{about['scenario']}, {'replay' if file.name == REPLAY else file.stem}"
        self.call, self.time_ns = rows[:, 0].astype(int), rows[:, 1]
        self.time = 1e-9 * (self.time_ns - self.time_ns[0])
        self.faults = log_faults(file, about, names, text, self.call, self.time)
        self.applied, self.period = factor * rows[:, 2:], about["period_s"]
        self.is_replay = file.name == REPLAY
        steps = np.diff(self.time)[np.diff(self.call) == 1]
        if self.is_replay and steps.size:
            # The first line of a replay has the time step of the scenario that rendered the log again, which may differ
            # from the period of the loop.
            self.period = float(np.median(steps))

    @property
    def late(self):
        """Returns an array that is True for each call that is late or whose previous call is missing."""
        return np.append(
            False, (np.diff(self.time) > LATE * self.period) | (np.diff(self.call) > 1)
        )


def log_text(file):
    """Returns (object of the first line, names of the columns, bytes of the rows) of a log."""
    data = read_bytes(file)
    first, _, rest = data.partition(b"\n")
    second, _, rows = rest.partition(b"\n")
    try:
        about = json.loads(text_of(first, file).removeprefix(LOG_HEADER))
    except ValueError as error:
        raise InputError(f"{file}: line 1: not JSON: {error}") from error
    if not isinstance(about, dict) or about.get("mode") not in MODES:
        raise InputError(f"{file}: line 1: no mode; allowed: {', '.join(MODES)}")
    period = number_or_none(about.get("period_s"))
    if not isinstance(about.get("scenario"), str) or period is None:
        raise InputError(f"{file}: line 1: no scenario or no period_s; allowed: a log of a loop")
    if rows and not rows.endswith(b"\n"):
        raise InputError(f"{file}: line {rows.count(10) + 3}: {CUT_LINE}")
    return about, text_of(second, file, 2).strip().split(","), rows


def log_numbers(file, names, rows, wanted):
    """Returns the columns `wanted` of a log, one row for each line that is not empty. Raises InputError for a missing
    column, for a line with a wrong number of fields, and for a field that is not a finite number.
    """
    absent = [name for name in wanted if name not in names]
    if absent:
        raise InputError(f"{file}: line 2: no column {absent[0]}; allowed: a log of a loop")
    if not rows.strip():
        raise InputError(f"{file}: holds no call")
    columns = [names.index(name) for name in wanted]
    lines = [(line, row) for line, row in enumerate(rows.splitlines(), 3) if row.strip()]
    for line, row in lines:
        # With a field too many, such as after a decimal comma, columns would contain numbers of other columns.
        if row.count(b",") != len(names) - 1:
            got = row.count(b",") + 1
            raise InputError(f"{file}: line {line}: got {got} fields; allowed: {len(names)}")
    with suppress(ValueError):
        found = np.loadtxt(
            BytesIO(rows), delimiter=",", usecols=columns, ndmin=2, comments=None, encoding="utf-8"
        )
        if np.isfinite(found).all():
            return found
    for line, row in lines:
        fields = text_of(row, file, line).split(",")
        for name, column in zip(wanted, columns):
            if not is_finite_number(fields[column]):
                got = fields[column][:40] or "an empty field"
                raise InputError(
                    f"{file}: line {line}: {name}: got {got}; allowed: a finite number"
                )
    raise InputError(f"{file}: is not a log that hapbench wrote")


def draw_logs(files, sheet):
    """Returns the figure of one or two logs: the quantity that the loop sends to the device over time. For two logs,
    also draws their difference at each call that both logs contain."""
    logs = [read_log(file) for file in files]
    share_period(logs)
    for text in (text for log in logs for text in log.faults):
        print_warning(text)
    if len({log.title for log in logs}) > 1:
        raise InputError(f"{files[0]}, {files[1]}: one log has forces, the other one positions")
    return figure_of(logs, sheet)


def share_period(logs):
    """Gives a replay the period of the recorded log, if the other log is the log that was replayed."""
    for replay, recorded in (logs, logs[::-1]) if len(logs) == 2 else ():
        _, first, second = np.intersect1d(replay.call, recorded.call, return_indices=True)
        has_equal_times = np.array_equal(replay.time_ns[first], recorded.time_ns[second])
        if replay.is_replay and not recorded.is_replay and has_equal_times:
            replay.period = recorded.period


def read_log(file):
    try:
        return Log(file)
    except (KeyError, ValueError) as error:
        raise InputError(f"{file}: is not a log that hapbench wrote: {error}") from error


def figure_of(logs, sheet):
    title, is_force = logs[0].title, logs[0].columns == MODES["impedance"][0]
    names = [log.name for log in logs]
    count = len(logs)
    with plt.rc_context(SETTINGS):
        height = 0.4 + sheet.panel(2.0) * count + legend_height([*names, ""], sheet.width)
        figure, axes = sheet.panels(count, 1, height, sharex=True)
        above = axes[0, 0]
        entries = []
        for log, series in zip(logs, SERIES):
            shown = log.applied if is_force else log.applied - log.applied[0]
            norm = np.linalg.norm(shown, axis=1)
            (line,) = above.plot(
                *curve(log.time, norm, norm, SPANS), color=series.colour, ls=series.line
            )
            entries.append((line, log.name))
        above.set_ylabel(f"|{title.replace(' [', '| [')}")
        late = np.unique(np.concatenate([log.time[log.late] for log in logs]))
        mark = {"marker": "v", "ms": 4, "ls": "none", "color": GREY, "clip_on": False}
        for ax in axes.flat if late.size else ():
            (marks,) = ax.plot(late, np.ones(late.size), transform=ax.get_xaxis_transform(), **mark)
            if ax is above:
                entries.append((marks, f"late or missing calls: {late.size}"))
        if count == 2:
            draw_difference(axes[1, 0], logs)
        axes[-1, 0].set_xlabel("time [s]")
        legend_of_names_above(figure, *zip(*entries))
    return figure


def draw_difference(ax, logs):
    """Draws the norm of the difference of two logs at the calls that both logs contain."""
    calls, first, second = np.intersect1d(logs[0].call, logs[1].call, return_indices=True)
    if not calls.size:
        raise InputError("the logs have no call in common")
    difference = np.linalg.norm(logs[0].applied[first] - logs[1].applied[second], axis=1)
    time = logs[0].time[first]
    ax.plot(*curve(time, difference, difference, SPANS), color=SERIES[0].colour)
    ax.set_ylabel(f"|difference| {logs[0].title[logs[0].title.index('['):]}")
    if not difference.any():
        ax.set_title(f"the {calls.size} calls that both logs have are equal", fontsize=7.5)
        ax.set_ylim(-0.05, 1.0)
