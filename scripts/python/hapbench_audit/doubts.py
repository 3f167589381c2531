"""Finds numbers of an audit that are probably false: wrong units and signs, faults of the tracking, forces with an
offset, and a column of contacts that counts other contacts. Each warning names the option or the log that corrects
them."""
import numpy as np
from hapbench_import.text_table import counted

from .clock import FASTEST_HZ, unit_text
from .contacts import SETTLING
from .log import FASTEST, MAX_JUMPS, NEAR
from .measured import MIN_CORRELATION
from .normal import main_direction
from .stiffness import has_stiffness

SMALL_FORCE = 0.01  # forces below this fraction of the largest force are hardly any contact
FEWEST_GROWTH = 5  # smallest number of rows of a contact whose force and position are compared


def doubts(log, contacts, audit, sequence, offset):
    """Returns the warnings. `audit`: the numbers of audit_log(). `sequence`: the spring of the longest sequence of
    contacts, or None. `offset`: result of offset_of()."""
    springs = [one["spring"] for one in audit["contacts"] if one["spring"]]
    known = [one for one in springs if has_stiffness(one)]
    return [
        *contacts_without_force(log, contacts),
        *unlikely_speed(log),
        *jump_text(log),
        *unclear_text(contacts),
        *wrong_sign(log, contacts, [*springs, sequence or {}], known),
        *other_sign(audit["measured"]),
        *disagreement(known),
        *offset_text(offset),
    ]


def contacts_without_force(log, contacts):
    """Returns a list with a warning if most rows that are in contact by the column of contacts have hardly any force.
    Otherwise returns an empty list."""
    if log.contacts is None or log.touch is not None:
        return []
    size = np.linalg.norm(log.force, axis=1)
    small = SMALL_FORCE * float(size.max())
    share = float(np.mean(size[contacts.in_contact] <= small))
    if share <= 0.5:
        return []
    touch = small if (size[contacts.in_contact] == 0.0).mean() <= 0.5 else 0.0
    return [
        f"in {100.0 * share:.3g} % of the rows in which {log.columns_text('contacts')} is above 0, the force is nearly "
        "0: does it also count contacts of other objects? Then the numbers of contacts, landings, settled force and "
        f"vibration are wrong: --set touch_N={touch:.2g} finds the contacts by the force"
    ]


def unlikely_speed(log):
    """Returns a list with a warning if the tool moves faster than a hand, otherwise an empty list."""
    moved = np.linalg.norm(log.position[NEAR:] - log.position[:-NEAR], axis=1)
    speeds = moved / (log.time[NEAR:] - log.time[:-NEAR])
    fast, rate = float(np.quantile(speeds, 1.0 - MAX_JUMPS)), 1.0 / log.interval
    if fast <= FASTEST:
        return []
    scale = 1e-3 * log.scales.get("position", 1.0)
    is_clock = rate > FASTEST_HZ
    question = f"is its unit m? (--scale position={scale:g} is for millimetres)"
    return [
        f"the position moves at {fast:.3g} m/s: {unit_text(log, rate) if is_clock else question}"
    ]


def jump_text(log):
    """Returns a list with a warning if the position jumps, otherwise an empty list."""
    jumps = np.flatnonzero(log.jumps)
    if not len(jumps):
        return []
    moved = np.linalg.norm(log.position[jumps[0] + 1] - log.position[jumps[0]])
    return [
        f"the position jumps {counted(len(jumps), 'time')}, first by {1e3 * moved:.3g} mm in the row at "
        f"{log.time[jumps[0] + 1]:.6g} s, faster than {FASTEST:g} m/s: a jump ends a contact, and no energy is counted "
        f"across it. If these rows are faults of the tracking, --skip-bad-rows --set max_speed={FASTEST:g} skips them"
    ]


def unclear_text(contacts):
    """Returns a list with a warning if the log does not show whether a time without contact lasts SETTLING."""
    if not contacts.unclear:
        return []
    return [
        f"missing rows leave open whether {counted(contacts.unclear, 'time')} without contact last {SETTLING:g} s: the "
        "numbers of landings and of lost contacts are uncertain by as many; a log without missing rows shows them"
    ]


def wrong_sign(log, contacts, springs, known):
    """Returns a list with a warning if the force grows along its own direction. `known`: springs that have a stiffness,
    of all `springs`."""
    growing = [
        one["apparent_stiffness_N_per_m"] for one in springs if "apparent_stiffness_N_per_m" in one
    ]
    if not known and not growing:
        growing = growth_of(log, contacts)
    if len(growing) <= len(known):
        return []
    return [
        f"the force grows along its own direction ({growing[0]:.4g} N/m), unlike that of a surface on a tool: is it "
        "the force of the tool on the object? (--set force_by_tool=true); otherwise energy and stiffness have the "
        "wrong sign"
    ]


def growth_of(log, contacts):
    """Returns a list with the slope of the force over the position [N/m] if the force grows along its own direction in
    all contacts together, also if each is too short for a fit. Otherwise returns an empty list."""
    normal, pairs = main_direction(log.force[contacts.in_contact]), []
    for first, after in contacts.runs.tolist():
        if after - first >= FEWEST_GROWTH:
            position, force = log.position[first:after] @ normal, log.force[first:after] @ normal
            pairs.append(np.column_stack([position - position.mean(), force - force.mean()]))
    if len(pairs) < 2:
        return []
    products = np.vstack(pairs)
    (size, both), (_, length) = products.T @ products
    return [both / size] if both > MIN_CORRELATION * np.sqrt(size * length) > 0.0 else []


def other_sign(measured):
    """Returns a list with a warning if the measured force is opposite to the commanded force."""
    if not measured or (measured["gain"] or 0.0) >= 0.0:
        return []
    return [
        f"the measured force has the other sign than the commanded force ({measured['gain']:.3g} times): does the "
        "sensor measure the force of the hand or of the tool on the object?"
    ]


def disagreement(springs):
    """Returns a list with a warning if the contacts have different stiffnesses: no stiffness is within the intervals of
    more than three quarters of the contacts. Otherwise returns an empty list. `springs`: springs of the contacts that
    determine a stiffness."""
    if len(springs) < 2:
        return []
    ends = np.array([one["stiffness_interval"] for one in springs])
    values = [one["stiffness_N_per_m"] for one in springs]
    # Relative differences of the stiffness up to `share` do not count: even without noise, a velocity that is known
    # only at the sampling times can cause such differences.
    share = 0.02
    common = max(
        np.sum((ends[:, 0] <= (1.0 + share) * x) & (x * (1.0 - share) <= ends[:, 1]))
        for x in ends[:, 0]
    )
    if common > 0.75 * len(springs):
        return []
    return [
        f"the contacts disagree by more than their intervals: {min(values):.4g} to {max(values):.4g} N/m. The "
        "stiffness is not linear, or the tool touches several surfaces; audit.json has each contact"
    ]


def offset_of(log):
    """Returns (force [N], fraction of the rows, travel [m], touch_N) if the force keeps its smallest value over a part
    of the rows in which the tool moves, as a force sensor with an offset does without contact. Otherwise returns None.
    `touch_N`: force above which a row would be in contact [N]."""
    if log.touch is not None or log.contacts is not None:
        return None
    size = np.linalg.norm(log.force, axis=1)
    smallest, largest = float(np.percentile(size, 2)), float(size.max())
    noise = 1.4826 * float(np.median(np.abs(np.diff(size, 2)))) / np.sqrt(6.0)
    band = max(6.0 * noise, 2.0 * float(log.quantum_N.max()), 0.02 * (largest - smallest))
    near = size <= smallest + band
    position = log.position @ main_direction(log.force)
    travel = float(np.ptp(position[near]))
    # A spring changes its force by `band` over the fraction band / (largest - smallest) of its travel.
    of_spring = band / max(largest - smallest, 1e-300)
    if (
        of_spring > 0.2
        or near.mean() < 0.1
        or travel < max(0.1, 3.0 * of_spring) * float(np.ptp(position))
        or smallest <= band
    ):
        return None
    return smallest, float(near.mean()), travel, smallest + 2.0 * band


def offset_text(offset):
    """Returns a list with a warning about the result of offset_of(); empty for None."""
    if offset is None:
        return []
    smallest, share, travel, touch = offset
    return [
        f"the force stays near {smallest:.3g} N in {100.0 * share:.3g} % of the rows, although the tool moves by "
        f"{1e3 * travel:.3g} mm in them: does the force sensor have an offset? Forces, contacts and energy then "
        f"contain it: subtract it from the forces, or begin a contact at a larger force (--set touch_N={touch:.2g})"
    ]
