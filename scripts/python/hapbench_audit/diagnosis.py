"""Diagnoses a log with the rules by which `hapbench run` diagnoses a run: the same texts and thresholds, but advice
that applies to any engine."""
import json
import math
from functools import lru_cache

import numpy as np
from hapbench_command import output_of_program

from .contacts import runs_of
from .force import CUTOFF, reversals, seen_rows
from .normal import main_direction
from .text import expected_text, hammers

# Smallest force that can be saturated, as a fraction of the largest force of the log.
AT_LIMIT = 0.999
# If at least this fraction of the rows in contact is saturated, the force counts as constant and not as limited.
CONSTANT = 0.9
FLAT = 20  # smallest number of saturated rows for which the largest force counts as a limit
# If the rms vibration exceeds this fraction of the mean force, the force counts as vibrating. Equals kMaxBuzz of the
# program.
HAS_BUZZ = 0.1
GAIN_MARGIN = 2.0  # the advice recommends the linear limit of the stiffness divided by this number
# The forces before and after a reversal must exceed this many standard deviations of the noise. On average, one of
# 16 000 normally distributed errors is larger.
NOISE = 4.0


@lru_cache
def rules():
    """Returns the rules of the program by name. Each rule has a unit, a threshold, and a sentence `says` in which {}
    stands for the measured value."""
    answer = output_of_program("has the rules of the diagnosis", "describe", "diagnosis", "--json")
    return {rule["rule"]: rule for rule in json.loads(answer)}


class Findings:
    """The rules whose measured value exceeds the threshold, in the order of rules()."""

    def __init__(self):
        self._found = {}

    def add(self, name, value, attempt, more=""):
        """Adds the rule `name` if its measured value `value` exceeds the threshold. `value` is None if the log does not
        determine the value. `attempt`: advice. `more`: text that is appended to the sentence of the rule.
        """
        rule = rules()[name]
        if value is None or not value > rule["threshold"]:
            return
        self._found[name] = {
            "rule": name,
            "value": float(value),
            "unit": rule["unit"],
            "threshold": rule["threshold"],
            "says": rule["says"].replace("{}", f"{value:.3g}") + more,
            "try": attempt,
        }

    def list(self):
        return [self._found[name] for name in rules() if name in self._found]


def share(value, of):
    return None if value is None or not of else value / of


def findings_of(log, contacts, audit):
    """Returns the findings as a list for the JSON. `audit`: the numbers of audit_log() that the rules use."""
    found, force = Findings(), audit["metrics"]
    mean, device = force["force_mean_in_contact_N"], audit["device"]
    vibration = share(force["force_rms_above_30Hz_N"], mean)
    vibrates = (vibration or 0.0) > HAS_BUZZ or hammers(force)
    ratio = device["ratio"] if device and vibrates else None
    if ratio is not None:
        found.add("edge", ratio, ratio_to_limit(device), limit_text(audit))
    found.add("buzz", vibration, against_buzz(audit, ratio), buzz_text(audit["buzz"]))
    found.add(
        "pop",
        share(force["settled_force_step_max_N"], mean),
        against_pop(log, contacts, audit),
        f", at {force['time_of_largest_step_s']:.6g} s",
    )
    reversals = reversals_per_s(log, contacts, audit)
    pop = share(force["settled_force_step_max_N"], mean) or 0.0
    if vibrates or max(pop, vibration or 0.0) > HAS_BUZZ or reversals:
        found.add("encoder", encoder_share(audit, mean), against_encoder(audit))
    found.add(
        "saturated",
        saturated_share(log, contacts, audit["stiffness"]),
        "a smaller stiffness, or a larger force limit in engine or device",
    )
    # The first landing is no rebound.
    landings = max(force["landings"] - 1, 0) / max(audit["clock"]["duration_s"], 1e-9)
    found.add("bounces", landings, "more damping or a smaller stiffness")
    found.add("chatter", reversals, against_chatter(vibration))
    energy = audit["energy"]
    created, error = energy["net_created_J"], energy["net_created_error_J"]
    if created is not None and created > error:
        found.add("energy", created, against_energy(audit), energy_text(audit))
    return found.list()


def energy_text(audit):
    energy = audit["energy"]
    causes = "resolution and missing rows" if audit["clock"]["rows_missing"] else "resolution"
    return (
        f" until {energy['time_of_max_s']:.6g} s (at most {energy['net_created_error_J']:.2g} J of it are the {causes} "
        "of the log)"
    )


def buzz_text(buzz):
    """Returns frequency and amplitude of the strongest oscillation above CUTOFF as a text; empty if no oscillation is
    above CUTOFF."""
    fast = [one for one in buzz if one["frequency_Hz"] > CUTOFF]
    return (
        f", at {fast[0]['frequency_Hz']:.0f} Hz with {fast[0]['amplitude_N']:.3g} N" if fast else ""
    )


def limit_text(audit):
    device = audit["device"]
    text = (
        f" of {device['device']} ({device['linear_limit_N_per_m']:.4g} N/m at {device['delay_samples']:.3g} samples of "
        "delay)"
    )
    return text if device["expected_frequency_Hz"] is None else f"{text}: {expected_text(audit)}"


def ratio_to_limit(device):
    good = device["linear_limit_N_per_m"] / GAIN_MARGIN
    text = f"a stiffness of {good:.3g} N/m (half the limit), a higher rate"
    return (
        text
        + (", a shorter delay" if device["delay_samples"] > 0.0 else "")
        + ", or some damping of the contact"
    )


def against_buzz(audit, ratio):
    stiffness, buzz = audit["stiffness"], audit["buzz"]
    half_rate = 0.5 * audit["clock"]["rate_Hz"]
    if buzz and buzz[0]["frequency_Hz"] > 0.9 * half_rate:
        return (
            "a shorter time step, or an implicit contact: the force alternates from row to row, as under an "
            "integrator at its stability limit"
        )
    if ratio is not None and ratio > rules()["edge"]["threshold"]:
        return 'the advice of the rule "edge"'
    if stiffness and stiffness["delay_interval_s"][0] > 0.0:
        lost = stiffness["stiffness_N_per_m"] * stiffness["delay_interval_s"][0]
        return f"a shorter delay: {lag_text(stiffness)}, which acts like a damping of {-lost:.3g} N s/m"
    encoder = encoder_share(audit, audit["metrics"]["force_mean_in_contact_N"])
    if (encoder or 0.0) > rules()["encoder"]["threshold"]:
        return 'the advice of the rule "encoder"'
    if hammers(audit["metrics"]):
        text = (
            "a smaller stiffness, less restitution or more damping: the tool hammers and loses contact "
            f"{audit['metrics']['contacts_lost_per_s']:.3g} times per second"
        )
        return text + ("; --device FILE.json shows the limit" if audit["device"] is None else "")
    if audit["device"] is None:
        return (
            "a smaller stiffness or a shorter time step; --device FILE.json compares the stiffness with the limit of "
            "the device"
        )
    return (
        "a smoother geometry, or forces that do not depend on which contacts are found: the stiffness is below the "
        "limit"
    )


def against_pop(log, contacts, audit):
    force, k = audit["metrics"], int(
        np.searchsorted(log.time, audit["metrics"]["time_of_largest_step_s"])
    )
    moved, caused = motion_at(log, audit["stiffness"], k)
    if caused is not None and caused > 0.5 * (force["settled_force_step_max_N"] or math.inf):
        return (
            f"a higher rate, slower motion or a smaller stiffness: the tool moves by {1e3 * moved:.3g} mm in one row, "
            f"which changes the force by {caused:.3g} N through the stiffness"
        )
    if k > 0 and contacts.in_contact[k] and not contacts.in_contact[k - 1]:
        return (
            "a compliant contact, such as a spring or a time constant of several rows: the largest step is a touch, "
            "and the engine stops the tool within a row, as rigid contacts and impulses do"
        )
    part = travel_share(log, contacts, k)
    if part > 0.5 * share_of_largest(log, k):
        return (
            f"a higher rate or slower motion: the tool moves by {1e3 * moved:.3g} mm in one row, {100.0 * part:.0f} % "
            "of its travel in contact"
        )
    if log.contacts is not None:
        step = np.linalg.norm(np.diff(log.force, axis=0), axis=1)
        large = contacts.settled[1:] & (step > 0.5 * (force["force_mean_in_contact_N"] or 0.0))
        changed = np.diff(log.contacts) != 0.0
        if large.any():
            part = float(changed[large].mean())
            sentence = f"the number of contacts changes in {100.0 * part:.0f} % of these steps"
            return sentence + (
                ": forces that fade in and out with depth, or contacts that are kept from step to step"
                if part > 0.5
                else f": check the normals and depths of the contacts there (the tool moves by {1e3 * moved:.3g} mm "
                "in the row of the largest step)"
            )
    if hammers(force):
        return (
            f"contact is lost {force['contacts_lost_per_s']:.3g} times per second: a smaller stiffness, less "
            "restitution or more damping, and a force that starts at zero at touch"
        )
    return (
        f"check the contacts at that time, when the tool moves by {1e3 * moved:.3g} mm in one row; a log with the "
        "number of contacts shows whether the contacts change at that time"
    )


def travel_share(log, contacts, row):
    """Returns the displacement from the row before `row` to `row`, as a fraction of the travel of all rows in contact.
    Displacement and travel are along main_direction() of the contact forces."""
    rows = np.flatnonzero(contacts.in_contact)
    position = log.position @ main_direction(log.force[rows])
    travel = float(np.ptp(position[rows]))
    return (
        abs(float(position[row] - position[row - 1])) / travel if row > 0 and travel > 0.0 else 0.0
    )


def share_of_largest(log, row):
    """Returns the force step from the row before `row` to `row`, as a fraction of the largest force of the log."""
    size = float(np.linalg.norm(log.force, axis=1).max())
    return float(np.linalg.norm(log.force[row] - log.force[row - 1])) / size


def motion_at(log, stiffness, row):
    """Returns the motion that can cause the force step at `row`: (largest displacement between successive rows [m],
    largest change of the spring force by a displacement between successive rows [N]). The rows end at `row` and cover
    the longest delay that the log allows, plus the duration of one held position. The change of the spring force is
    None if `stiffness` is None."""
    delay = 0 if not stiffness else round(stiffness["delay_interval_s"][1] / log.interval)
    held = 1 if log.held is None else round(log.held.rows)
    first = max(row - delay - held, 0)
    # A step across missing rows is no displacement between successive rows.
    steps = np.diff(log.position[first : row + 1], axis=0)[log.missing[first:row] == 0]
    if not len(steps):
        return 0.0, None
    moved = float(np.linalg.norm(steps, axis=1).max())
    if not stiffness:
        return moved, None
    along = float(np.abs(steps @ np.array(stiffness["direction"])).max())
    return moved, stiffness["stiffness_N_per_m"] * along


def reversals_per_s(log, contacts, audit):
    """Returns the number of force reversals() per second of settled contact. A reversal counts only if the forces
    before and after it exceed NOISE times the noise. The noise is the median of `noise_N` over the contacts (see
    evidence_of_rows())."""
    if audit["metrics"]["force_reversals_per_s"] is None:
        return None
    seen = seen_rows(log, contacts)
    noises = [
        one["spring"]["noise_N"] for one in audit["contacts"] if "noise_N" in (one["spring"] or {})
    ]
    size = np.linalg.norm(log.force, axis=1)
    is_large = size > (NOISE * float(np.median(noises)) if noises else 0.0)
    counted = reversals(log)[1:] & is_large[1:] & is_large[:-1] & seen[1:]
    return float(counted.sum() / (seen.sum() * log.interval))


def encoder_share(audit, mean):
    """Returns the force that one resolution step of the position causes through the damping, divided by the mean force.
    Returns None if the damping is unknown or not positive, or if the position has no resolution step (full
    precision)."""
    stiffness, step = audit["stiffness"], audit["clock"]["position_resolution_m"]
    damping = stiffness and stiffness.get("damping_N_s_per_m")
    if not damping or damping <= 0.0 or not step:
        return None
    return share(damping * step / audit["clock"]["interval_s"], mean)


def against_encoder(audit):
    step = audit["clock"]["position_resolution_m"]
    return (
        f"a low-pass on the velocity, less damping, or a finer position than {1e6 * step:.3g} um (if that is only the "
        "resolution of the log, more digits in the log)"
    )


def saturated_share(log, contacts, stiffness):
    """Returns the fraction of the time in contact that is saturated: the force stays at its largest value in
    consecutive rows, although the tool moves. Returns None for fewer than FLAT saturated rows, because the largest
    force is then no limit. Returns None if the fraction is CONSTANT or more, because the force is then
    constant.
    """
    size = np.linalg.norm(log.force, axis=1)
    rows = np.flatnonzero(contacts.in_contact)
    if not len(rows):
        return None
    normal = np.array(stiffness["direction"]) if stiffness else main_direction(log.force[rows])
    position, resolution = log.position @ normal, float(np.abs(normal) @ log.quantum_m)
    # Smallest travel [m] of saturated rows. Over a shorter travel, the force of a spring changes by less than the
    # fraction 1 - AT_LIMIT of its range, or position or force change by at most two steps of their resolutions.
    travel, steps = float(np.ptp(position[rows])), 2.0 * float(np.abs(normal) @ log.quantum_N)
    slope = (
        stiffness["stiffness_N_per_m"] if stiffness else np.ptp(size[rows]) / max(travel, 1e-300)
    )
    threshold = max((1.0 - AT_LIMIT) * travel, 2.0 * resolution, steps / max(slope, 1e-300))
    at = contacts.in_contact & (size >= AT_LIMIT * size.max())
    # A limit cuts off the peaks of the force, so that consecutive rows have the same force.
    flat = at[1:] & at[:-1] & (np.abs(np.diff(size)) <= 1e-6 * size.max())
    count, saturated_s = 0, 0.0
    for first, after in runs_of(flat, np.zeros(len(flat) - 1, bool)).tolist():
        if np.ptp(position[first : after + 1]) > threshold:
            count += after - first + 1
            saturated_s += float(log.seconds[first : after + 1].sum())
    part = share(saturated_s, float(log.seconds[rows].sum()))
    return part if count >= FLAT and part < CONSTANT else None


def against_chatter(vibration):
    if (vibration or 0.0) > HAS_BUZZ:
        return 'the advice of the rule "buzz": the vibration is larger than the force'
    return "friction without a jump at zero speed, and contact normals that do not flip"


def lag_text(stiffness):
    first, last = (1e3 * one for one in stiffness["delay_interval_s"])
    if first == last:
        return f"the force lags the position by {first:.3g} ms"
    return f"the force lags the position by {first:.3g} to {last:.3g} ms"


def half_hold(stiffness, interval):
    """Returns K T / 2 [N s/m] for the stiffness K and the interval T [s]. This damping dissipates the energy that is
    created by holding the force of a spring over an interval."""
    return 0.5 * stiffness["stiffness_N_per_m"] * interval


def against_energy(audit):
    energy, stiffness, interval = audit["energy"], audit["stiffness"], audit["clock"]["interval_s"]
    if stiffness and stiffness["delay_interval_s"][0] > 0.0:
        # Damping that the same loop computes has the same delay, so no amount of it is certain to help.
        return f"a shorter delay or a smaller stiffness: {lag_text(stiffness)}"
    is_of_hold = energy["net_created_path_J"] < 0.1 * energy["net_created_J"]
    if is_of_hold:
        enough = half_hold(stiffness, interval) if stiffness else math.inf
        has_enough = ((stiffness or {}).get("damping_N_s_per_m") or 0.0) > enough
        more = (
            f", or damping of more than K T / 2 = {enough:.3g} N s/m against slow motion"
            if stiffness
            else ""
        )
        return (
            f"a higher rate{'' if has_enough else more}: the contact is passive along the path, and holding each force "
            "until the next row creates the energy"
        )
    if stiffness and (stiffness.get("damping_N_s_per_m") or 0.0) < 0.0:
        return "the contact has negative damping: check its velocity for a filter or a delay"
    if stiffness and stiffness["delay_interval_s"][1] == 0.0:
        return (
            "a passivity controller, or contacts whose force follows from the position alone: the energy appears along "
            "the path too, so that contacts, weights or an internal state changed the force while the tool moved"
        )
    allowed = (
        f" (the log allows up to {1e3 * stiffness['delay_interval_s'][1]:.3g} ms)"
        if stiffness
        else ""
    )
    return (
        f"the energy appears along the path too: a delay of the force{allowed} creates it, or contacts, weights or an "
        "internal state that change the force while the tool moves; a log with taps and quick presses shows the cause"
    )
