"""Computes the audit of a log: metrics of clock, energy, force and stiffness, the stiffness limit of a device, the
diagnosis, and a list of the quantities that the log does not determine."""
import numpy as np
from hapbench_import.stroke import likely_unit

from .clock import clock_of, clock_warnings
from .contacts import contacts_of
from .device import device_limit
from .diagnosis import findings_of
from .energy import Port, contact_energy, energy_of, stored_at
from .force import force_of, peaks_of, spectrum_of
from .log import FASTEST
from .stiffness import FEWEST, contradicting, evidence_of, springs_of


def audit_log(log, device=None):
    """Returns (numbers for audit.json, the Contacts, the result of spectrum_of()). `device`: a device preset or the
    name of a device file. If `device` is None, no stiffness limit is computed."""
    contacts = contacts_of(log)
    clock, port = clock_of(log), Port(log, contacts)
    force, spectrum = force_of(log, contacts), spectrum_of(log, contacts)
    every = each_contact(log, contacts)
    main = with_springs(log, contacts, every)
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
        "device": device_limit(device, loop_interval(log), main) if device else None,
        "measured": measured_lag(log, contacts),
        "contacts": every,
    }
    audit["diagnosis"] = findings_of(log, contacts, audit)
    audit["missing"] = missing(log, audit, device)
    audit["warnings"] = log.notes + clock_warnings(clock) + doubts(log, audit)
    return audit, contacts, spectrum


def loop_interval(log):
    """Returns the period of the control loop [s]: the interval between rows, times the number of rows over which each
    position or each force is repeated (the larger of both numbers; 1 without repetition)."""
    return log.interval * max([1.0] + [one.rows for one in (log.held, log.held_force) if one])


def energy_by_contact(log, every):
    """Returns the created energy (see created()) per contact [J] and per second in contact [W], and the contact with
    the largest created energy, for the JSON. Contacts with unknown created energy are left out."""
    known = [one for one in every if one["created_J"] is not None]
    seconds = sum(one["rows"] for one in known) * log.interval
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
    for first, after in contacts.runs.tolist():
        rows = np.arange(first, after)
        last = min(after, len(log.time) - 1)
        found.append(
            {
                "start_s": float(log.time[first]),
                "end_s": float(log.time[last]),
                "rows": after - first,
                "is_complete": bool(first > 0 and after < len(log.time)),
                "force_max_N": float(np.linalg.norm(log.force[rows], axis=1).max()),
            }
        )
    return found


def with_springs(log, contacts, every):
    """Sets `spring` of each contact in `every`. Returns the spring of the whole log for the JSON, or None if the log
    does not determine a stiffness. If no contact determines a stiffness and contradicting() is 0, the spring of the log
    is fitted to all rows in contact of the longest sequence of contacts (Contacts.stretches)."""
    evidences = [
        evidence_of_run(log, contacts, np.arange(first, after)) if after - first >= FEWEST else None
        for first, after in contacts.runs.tolist()
    ]
    springs, main = springs_of(log, evidences)
    for one, spring in zip(every, springs):
        one["spring"] = spring
    is_known = main is not None or any(has_stiffness(one) for one in springs)
    if is_known or not contacts.stretches or contradicting(springs):
        return main
    first, after = max(
        contacts.stretches,
        key=lambda span: contacts.runs[span[1] - 1][1] - contacts.runs[span[0]][0],
    )
    rows = np.arange(contacts.runs[first][0], contacts.runs[after - 1][1])
    rows = rows[contacts.in_contact[rows]]
    return springs_of(log, [evidence_of_run(log, contacts, rows)])[1]


def evidence_of_run(log, contacts, rows):
    return evidence_of(log, rows, rows[contacts.settled[rows]])


def known_spring(spring):
    """Returns the spring if it has a stiffness, otherwise None."""
    return spring if has_stiffness(spring) else None


def has_stiffness(spring):
    return bool(spring) and "stiffness_N_per_m" in spring


def stiffness_range(every):
    """Returns the smallest and the largest stiffness [N/m] of the contacts that determine a stiffness, or None if no
    contact determines a stiffness."""
    values = [one["spring"]["stiffness_N_per_m"] for one in every if has_stiffness(one["spring"])]
    return [min(values), max(values)] if values else None


def measured_lag(log, contacts):
    """Compares the measured force with the commanded force. Returns the delay [s] at which their cross-correlation is
    largest, and the gain at this delay. Returns None without a measured force or without contact.
    """
    if log.measured is None or not contacts.in_contact.any():
        return None
    a, b = log.force - log.force.mean(axis=0), log.measured - log.measured.mean(axis=0)
    max_lag = min(200, len(a) // 4)
    products = [float(np.sum(a[: len(a) - lag] * b[lag:])) for lag in range(max_lag + 1)]
    lag = int(np.argmax(products))
    return {
        "delay_s": lag * log.interval,
        "gain": products[lag] / max(float(np.sum(a[: len(a) - lag] ** 2)), 1e-300),
    }


def doubts(log, audit):
    """Returns warnings about units and signs that are probably wrong, and about contacts with different stiffnesses."""
    found = []
    speeds = np.linalg.norm(np.diff(log.position, axis=0), axis=1) / np.diff(log.time)
    fast = float(np.percentile(speeds, 90))
    if fast > FASTEST:
        unit = likely_unit(log.interval, fast)
        found.append(
            f"the position moves at {fast:.3g} m/s: are the units s and m? (--scale position=0.001 is for millimetres, "
            f"--scale time={unit:g} for another clock)"
        )
    springs = [one["spring"] for one in audit["contacts"] if one["spring"]]
    known = [one for one in springs if has_stiffness(one)]
    growing = [
        one["apparent_stiffness_N_per_m"] for one in springs if "apparent_stiffness_N_per_m" in one
    ]
    if len(growing) > len(known):
        found.append(
            f"the force grows along its own direction ({growing[0]:.4g} N/m), unlike that of a "
            "surface on a tool: is it the force of the tool on the object? (--set force_by_tool=true); otherwise "
            "energy and stiffness have the wrong sign"
        )
    return found + disagreement(known)


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


def missing(log, audit, device):
    """Returns a text for each quantity that the log does not determine. The text names the column or the test that
    would determine the quantity."""
    found = [] if len(audit["contacts"]) else ["contact: no row has a force"]
    found += missing_of_spring(audit)
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
    if log.turn is not None:
        turned = float((log.turn[0].inv() * log.turn).magnitude().max())
        if turned > 0.01:
            found.append(
                f"energy of rotation: the tool rotates by up to {turned:.3g} rad, and the log has no torque"
            )
    if audit["metrics"]["force_mean_in_contact_N"] is None and audit["contacts"]:
        found.append("vibration: there is less than 1/30 s of contact after the landings")
    if audit["energy"]["net_created_J"] is None:
        found.append(
            "created energy: the log begins in contact, and without a stiffness the energy stored there is unknown; "
            "a log that begins without contact"
        )
    if audit["clock"]["rate_Hz"] <= 60.0:
        found.append("vibration above 30 Hz: a log of more than 60 Hz")
    return found


def missing_of_spring(audit):
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
        reasons = [one for one in springs if "why" in one]
        if reasons:
            why = max(reasons, key=lambda one: one.get("travel_m", 0.0))["why"]
        return [f"stiffness: {why}; tap, and press to several depths at several speeds"]
    if audit["stiffness"] and audit["stiffness"].get("why_no_damping"):
        return [
            f"damping: {audit['stiffness']['why_no_damping']}; taps and quick presses, more digits, or a column of "
            "velocities"
        ]
    if audit["stiffness"] and audit["stiffness"]["delay_s"] is None:
        return ["delay: the log does not separate it from damping; taps and quick presses"]
    return []
