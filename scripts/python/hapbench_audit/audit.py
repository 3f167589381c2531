"""Computes the audit of a log: metrics of clock, energy, force and stiffness, the stiffness limit of a device, the
diagnosis, and a list of the quantities that the log does not determine."""
import numpy as np

from .clock import clock_of, clock_warnings
from .contacts import contacts_of
from .curvature import radius_of
from .device import device_limit
from .diagnosis import findings_of
from .doubts import doubts, offset_of
from .energy import Port, contact_energy, energy_of, stored_at
from .force import force_of, peaks_of, spectrum_of
from .measured import measured_lag
from .stiffness import FEWEST, contradicting, evidence_of, has_stiffness, springs_of


def audit_log(log, device=None):
    """Returns (numbers for audit.json, the Contacts, the result of spectrum_of()). `device`: a device preset or the
    name of a device file. If `device` is None, no stiffness limit is computed."""
    contacts = contacts_of(log)
    clock, port = clock_of(log), Port(log, contacts)
    force, spectrum = force_of(log, contacts), spectrum_of(log, contacts)
    every = each_contact(log, contacts)
    radius = radius_of(log, contacts)
    main, sequence = with_springs(log, contacts, every, radius)
    offset = offset_of(log)
    for one, (first, after) in zip(every, contacts.runs.tolist()):
        stored = stored_at(log, contacts, first, known_spring(one["spring"]) or main)
        one |= contact_energy(port, first, after, stored)
    audit = {
        "clock": clock,
        "contact_rule": contacts.rule,
        "metrics": force,
        "energy": energy_of(log, port, stored_at(log, contacts, 0, main))
        | energy_by_contact(log, every),
        "buzz": peaks_of(log, contacts, spectrum, force["force_mean_in_contact_N"]),
        "stiffness": main,
        "stiffness_range": stiffness_range(every),
        "surface_radius_m": radius,
        "device": device_limit(device, loop_interval(log), main) if device else None,
        "measured": measured_lag(log, contacts),
        "contacts": every,
    }
    audit["diagnosis"] = findings_of(log, contacts, audit)
    audit["missing"] = missing(log, audit, device, sequence, offset)
    audit["warnings"] = log.notes + clock_warnings(log, clock)
    audit["warnings"] += doubts(log, contacts, audit, sequence, offset)
    return audit, contacts, spectrum


def loop_interval(log):
    """Returns the period of the control loop [s]: the interval between rows, times the number of rows over which each
    position or each force is repeated (the larger of both numbers; 1 without repetition)."""
    return log.interval * max([1.0] + [one.rows for one in (log.held, log.held_force) if one])


def energy_by_contact(log, every):
    """Returns the created energy (see created()) per contact [J] and per second in contact [W], and the contact with
    the largest created energy, for the JSON. Contacts with unknown created energy are left out."""
    known = [one for one in every if one["created_J"] is not None]
    seconds = max(sum(one["end_s"] - one["start_s"] for one in known), log.interval)
    created = sum(one["created_J"] for one in known)
    worst = max(known, key=lambda one: one["created_J"], default=None)
    return {
        "created_per_contact_J": created / len(known) if known else None,
        "created_per_s_in_contact_W": created / seconds if known else None,
        "worst_contact": worst
        and {name: worst[name] for name in ("start_s", "end_s", "created_J", "error_J")},
    }


def each_contact(log, contacts):
    """Returns for each contact its start and end [s], its number of rows, its largest force [N], and whether the log
    contains both its touch and its release."""
    found = []

    def is_seen(row):
        """Returns True if the log contains the interval before `row` and it is no gap."""
        return bool(0 < row < len(log.time) and not contacts.gap[row - 1])

    for first, after in contacts.runs.tolist():
        rows = np.arange(first, after)
        last = min(after, len(log.time) - 1)
        if contacts.gap[last - 1]:
            last = after - 1  # the contact ends at a gap
        found.append(
            {
                "start_s": float(log.time[first]),
                "end_s": float(log.time[last]),
                "rows": after - first,
                "is_complete": is_seen(first) and is_seen(after),
                "force_max_N": float(np.linalg.norm(log.force[rows], axis=1).max()),
            }
        )
    return found


def with_springs(log, contacts, every, radius):
    """Sets `spring` of each contact in `every`. Returns (spring of the whole log for the JSON, or None if the log does
    not determine a stiffness; spring of the longest sequence of contacts, or None if it is not fitted). If no contact
    determines a stiffness and contradicting() is 0, the spring of the log is fitted to all rows in contact of the
    longest sequence of contacts (Contacts.stretches). On a curved surface, no spring is fitted. `radius`: radius of
    curvature of the surface [m], or None for a flat surface."""
    if radius is not None:
        for one in every:
            one["spring"] = {"why": curved_text(radius)}
        return None, None
    evidences = [
        evidence_of_run(log, contacts, np.arange(first, after)) if after - first >= FEWEST else None
        for first, after in contacts.runs.tolist()
    ]
    springs, main = springs_of(log, evidences)
    for one, spring in zip(every, springs):
        one["spring"] = spring
    is_known = main is not None or any(has_stiffness(one) for one in springs)
    if is_known or not contacts.stretches or contradicting(springs):
        return main, None
    first, after = max(
        contacts.stretches,
        key=lambda span: contacts.runs[span[1] - 1][1] - contacts.runs[span[0]][0],
    )
    rows = np.arange(contacts.runs[first][0], contacts.runs[after - 1][1])
    rows = rows[contacts.in_contact[rows]]
    (sequence,), main = springs_of(log, [evidence_of_run(log, contacts, rows)])
    return main, sequence


def curved_text(radius):
    return f"the surface is curved, with a radius of about {1e3 * radius:.2g} mm, and the audit fits flat surfaces only"


def evidence_of_run(log, contacts, rows):
    return evidence_of(log, rows, rows[contacts.settled[rows]])


def known_spring(spring):
    """Returns the spring if it has a stiffness, otherwise None."""
    return spring if has_stiffness(spring) else None


def stiffness_range(every):
    """Returns the smallest and the largest stiffness [N/m] of the contacts that determine a stiffness, or None if no
    contact determines a stiffness."""
    values = [one["spring"]["stiffness_N_per_m"] for one in every if has_stiffness(one["spring"])]
    return [min(values), max(values)] if values else None


def missing(log, audit, device, sequence, offset):
    """Returns a text for each quantity that the log does not determine. The text names the column or the test that
    would determine the quantity. `sequence`: see with_springs(). `offset`: result of offset_of().
    """
    found = [] if len(audit["contacts"]) else ["contact: no row has a force"]
    found += missing_of_spring(audit, sequence, offset)
    if device is None:
        found.append("whether the device can render this stiffness: --device FILE.json or a preset")
    elif audit["device"] is None:
        found.append("the limit of the device: it needs the stiffness of a contact")
    if log.contacts is None:
        found.append(
            "whether force steps are changes of contacts: a column with the number of contacts"
        )
    if log.measured is None:
        found.append(
            "whether the device renders the force: a column of the measured force (measured=...)"
        )
    elif audit["measured"] and "why" in audit["measured"]:
        found.append(f"delay and gain of the device: {audit['measured']['why']}")
    if log.turn is not None:
        turned = float((log.turn[0].inv() * log.turn).magnitude().max())
        if turned > 0.01:
            found.append(
                f"energy of rotation: the tool rotates by up to {turned:.3g} rad, and the log has no torque"
            )
    if audit["metrics"]["force_mean_in_contact_N"] is None and audit["contacts"]:
        found.append("vibration: there is less than 1/30 s of contact after the landings")
    if audit["energy"]["net_created_J"] is None and not offset:
        found.append(
            "created energy: the log begins in contact, and without a stiffness the energy stored there is unknown; "
            "a log that begins without contact"
        )
    if audit["clock"]["rate_Hz"] <= 60.0:
        found.append("vibration above 30 Hz: a log of more than 60 Hz")
    return found


def missing_of_spring(audit, sequence, offset):
    """Returns a list with one text about the first of stiffness, damping and delay that the log does not determine. The
    text names the test that would determine the quantity. The list is empty if the log determines all three.
    """
    if audit["stiffness"] is None and audit["contacts"]:
        # Reports the reason of the contact with the longest travel, because this contact is the closest to determining
        # a stiffness.
        springs = [one["spring"] for one in audit["contacts"] if one["spring"]]
        known = [one["stiffness_interval"] for one in springs if has_stiffness(one)]
        why = f"no contact has {FEWEST} rows"
        if known:
            low, high = min(one[0] for one in known), max(one[1] for one in known)
            why = f"the contacts give {low:.4g} to {high:.4g} N/m, an interval of more than +- 25 %"
        reasons = [one for one in [*springs, sequence or {}] if "why" in one]
        if reasons:
            why = max(reasons, key=lambda one: one.get("travel_m", 0.0))["why"]
        if audit["surface_radius_m"] is not None:
            return [f"stiffness: {why}; presses at one position, without motion along the surface"]
        if offset:
            return [f"stiffness: {why}; forces without the offset that the warning names"]
        return [f"stiffness: {why}; tap, and press to several depths at several speeds"]
    if audit["stiffness"] and audit["stiffness"].get("why_no_damping"):
        return [
            f"damping: {audit['stiffness']['why_no_damping']}; taps and quick presses, more digits, or a column of "
            "velocities"
        ]
    if audit["stiffness"] and audit["stiffness"]["delay_s"] is None:
        return ["delay: the log does not separate it from damping; taps and quick presses"]
    return []
