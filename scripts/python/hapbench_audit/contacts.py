"""Finds the contacts of a log, each from touch to release. Separates landings from settled contact by the rules of
`hapbench run`: a landing is the first 0.05 s after a touch that follows at least 0.05 s without contact."""
from dataclasses import dataclass

import numpy as np
from hapbench_command import fail

SETTLING = 0.05  # duration of a landing [s]; equals the default of metrics.settling_s of a scenario
# If at least this fraction of the rows has zero force, every row with a non-zero force counts as contact. With fewer
# such rows, this holds if all other forces have a component in one common direction, as in a single contact. Noise
# around zero has no such direction.
SOME_ZEROS = 0.01
# The release threshold is at least FAR times the rms noise. The touch threshold is higher than the release threshold by
# 2 FAR times the rms noise of one force component.
FAR = 3.0
# Threshold of release as a fraction of the 99th percentile of the force. It applies if not every non-zero force counts
# as contact.
TOUCH_SHARE = 0.05


@dataclass
class Contacts:
    in_contact: np.ndarray  # for each row, true if it is in contact
    runs: np.ndarray  # for each contact, the first row and the row after the last row
    # For each sequence of contacts separated by less than SETTLING: index in `runs` of its first contact, and index
    # after its last contact.
    stretches: list
    # First row of each contact that begins after at least SETTLING without contact.
    landings: np.ndarray
    landing: np.ndarray  # for each row, true if it is part of a landing
    settled: np.ndarray  # for each row, true if it is in contact and not part of a landing
    # Force above which a row is in contact [N]; 0 if any force counts as contact, or if a column of the log states the
    # number of contacts.
    touch_N: float
    rule: str  # how contact was detected, in words
    # For each interval between rows, true if a contact ends in it, because it is long or the position jumps in it.
    gap: np.ndarray
    # Number of times without contact for which missing rows leave open whether they last SETTLING.
    unclear: int

    @property
    def lost(self):
        """Number of losses of contact that last less than SETTLING."""
        return sum(after - first - 1 for first, after in self.stretches)

    def lost_after_landing(self, first, after):
        """Returns the number of losses of contact that last less than SETTLING and begin in the rows from `first` to
        before `after`, but not in a landing."""
        releases = [
            row for start, end in self.stretches for row in self.runs[start : end - 1, 1].tolist()
        ]
        return int(sum(first <= row < after and not self.landing[row] for row in releases))


def contacts_of(log):
    """Returns the Contacts of a log, by the rule of rows_in_contact(). Fails if no row is in contact or if all
    forces are 0."""
    size = np.linalg.norm(log.force, axis=1)
    in_contact, threshold, rule = rows_in_contact(log, size)
    if not in_contact.any() or not size.any():
        problem = "no row has a force" if in_contact.any() else "no row is in contact"
        fail(f"{problem}: {why_no_contact(log, size, threshold)}", log.file)
    gap = log.pauses | log.jumps
    runs = runs_of(in_contact, gap)
    landings, stretches, before, unclear = [int(runs[0, 0])], [[0, 1]], 0, 0
    for number, (first, after) in enumerate(runs.tolist()):
        if number:
            away = float(log.seconds[before:first].sum())
            new = first > before and away >= settling_s(log)
            # The time without contact is unknown across a gap. A gap therefore begins a new sequence.
            is_cut = bool(gap[before - 1 : first].any())
            hidden = 0.5 * log.interval * (log.missing[before - 1] + log.missing[first - 1])
            unclear += not is_cut and abs(away - settling_s(log)) < hidden
            if new or is_cut:
                stretches.append([number, number + 1])
            else:
                stretches[-1][1] = number + 1
            if new:
                landings.append(first)
        before = after
    landing = np.zeros(len(size), bool)
    for first in landings:
        landing[first : after_landing(log, first)] = True
    return Contacts(
        in_contact,
        runs,
        [tuple(one) for one in stretches],
        np.array(landings, int),
        landing,
        in_contact & ~landing,
        threshold,
        rule,
        gap,
        unclear,
    )


def settling_s(log):
    """Returns SETTLING as a limit for sums of times of rows [s]: SETTLING in whole rows, less half a row. Rounding
    errors of such a sum then do not matter."""
    return (round(SETTLING / log.interval) - 0.5) * log.interval


def after_landing(log, first):
    """Returns the first row that begins at least SETTLING after the start of row `first`."""
    return int(np.searchsorted(log.starts, log.starts[first] + settling_s(log)))


def rows_in_contact(log, size):
    """Returns (for each row, true if it is in contact; threshold of the force at a touch [N]; description of the rule).
    `size`: magnitude of the force of each row [N]."""
    if log.touch is not None:
        return size > log.touch, log.touch, f"force above {log.touch:g} N (touch_N)"
    if log.contacts is not None:
        return log.contacts > 0, 0.0, "the column of contacts is above 0"
    zeros = float(np.mean(size == 0.0))
    if (
        zeros >= SOME_ZEROS
        or not size.any()
        or (zeros and has_one_direction(log.force[size > 0.0]))
    ):
        return size > 0.0, 0.0, "any force"
    release = TOUCH_SHARE * float(np.percentile(size, 99))
    # Rows with a force below `release` contain only noise. The distance between both thresholds prevents noise from
    # beginning or ending a contact.
    noise = float(np.sqrt(np.mean(size[size < release] ** 2))) if (size < release).any() else 0.0
    release = max(release, FAR * noise)
    touch = release + 2.0 * FAR * noise / np.sqrt(log.axes)
    ends = f"until below {release:.3g} N, " if noise > 0.0 else ""
    without = f"only {100.0 * zeros:.2g} % of the rows are" if zeros else "no row is"
    return (
        between(size, release, touch),
        touch,
        f"force above {touch:.3g} N {ends}by 5 % of its 99th percentile and its noise, because {without} without force "
        "(--set touch_N=... sets it)",
    )


def has_one_direction(forces):
    """Returns True if every force has a positive component along the mean of the directions of all forces."""
    directions = forces / np.linalg.norm(forces, axis=1)[:, None]
    return bool(np.all(directions @ directions.mean(axis=0) > 0.0))


def why_no_contact(log, size, threshold):
    """Returns the reason why no row is in contact, and the option that may correct it."""
    largest = float(size.max())
    if not largest > 0.0 and log.measured is not None and log.measured.any():
        measured = log.columns["measured"][0]["name"]
        return f"every force is 0, but the log has measured forces: --columns force={measured} uses them"
    if not largest > 0.0:
        return (
            f"every force is 0, in {log.columns_text('force')}; allowed: a log with contact (--columns force=... "
            "reads other columns)"
        )
    if log.touch is not None:
        return (
            f"the largest force is {largest:.4g} N; allowed: a smaller touch_N, got {threshold:g}"
        )
    if log.contacts is not None:
        return (
            f"{log.columns_text('contacts')}, the number of contacts, is never above 0, but the largest force is "
            f"{largest:.4g} N: --set touch_N=0 uses the force instead, --columns contacts=... another column"
        )
    return (
        f"no force exceeds the threshold of {threshold:.4g} N, which the noise of the force requires; the largest "
        f"force is {largest:.4g} N: --set touch_N=... sets the threshold"
    )


def between(values, low, high):
    """Returns for each value whether it is part of a contact, with hysteresis: a contact begins above `high` and ends
    below `low`."""
    event = np.where((values > high) | (values < low), np.arange(len(values)), 0)
    return values[np.maximum.accumulate(event)] > high


def runs_of(flags, gap):
    """Returns the first row, and the row after the last row, of each sequence of consecutive True flags. A gap between
    two rows ends a sequence. `flags`: one boolean for each row. `gap`: one boolean for each interval between two rows.
    """
    edges = np.diff(np.concatenate([[False], flags, [False]]).astype(int))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    cuts = np.flatnonzero(gap & flags[1:] & flags[:-1]) + 1
    return np.column_stack(
        [np.sort(np.concatenate([starts, cuts])), np.sort(np.concatenate([ends, cuts]))]
    ).astype(int)
