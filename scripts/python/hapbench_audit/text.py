"""Formats an audit as rows of a table (subject, quantity, text), and the lines below the table."""
from hapbench_import.text_table import counted
from hapbench_report.markup import rounded_up


HAMMERS = 1.0  # number of contact losses per second above which the tool hammers
# Smallest number of contact losses after landings of a tool that hammers. Fewer losses do not show a repetition.
MIN_LOSSES = 3


def number(value, digits=3, none="-"):
    return none if value is None else f"{value:.{digits}g}"


def millijoules(value, error=None):
    if value is None:
        return "unknown"
    if error is not None and 0.0 <= value < error:
        return f"<= {rounded_up(1e3 * (value + error)):.1g} mJ"  # a bound, as in the tables of hapbench
    text = f"{1e3 * value:.3g}"
    return f"{text} mJ" if error is None else f"{text} +- {1e3 * error:.1g} mJ"


def rows_of(audit):
    """Returns (subject, quantity, text) of each row of the table."""
    return [
        (subject, quantity, text)
        for subject, rows in (
            ("clock", clock_rows(audit["clock"])),
            ("contact", contact_rows(audit)),
            ("energy", energy_rows(audit["energy"])),
            ("force", force_rows(audit["metrics"])),
            ("vibration", vibration_rows(audit)),
            ("stiffness", stiffness_rows(audit)),
            ("device", device_rows(audit)),
            ("measured", measured_rows(audit["measured"])),
        )
        for quantity, text in rows
    ]


def clock_rows(clock):
    interval, jitter = clock["interval_s"], clock["jitter_s"]
    # Jitter below the rounding of the times is printed as none.
    shown = "none" if jitter < 1e-6 * interval else f"{1e6 * jitter:.3g} us rms"
    rows = [
        ("rate", f"{clock['rate_Hz']:.6g} Hz, {clock['rows']} rows in {clock['duration_s']:.4g} s"),
        ("jitter", f"{shown}; intervals {interval_text(1e3, clock)} ms"),
        ("missing", f"{counted(clock['rows_missing'], 'row')}"),
    ]
    for what in ("position", "force"):
        if clock[f"rows_per_{what}"] > 1.0:
            rows.append((f"held {what}", f"each in {clock[f'rows_per_{what}']:.4g} rows"))
    position, force = clock["position_resolution_m"], clock["force_resolution_N"]
    shown = [f"{1e6 * position:.3g} um" if position else "position to all digits"]
    shown.append(f"{force:.3g} N" if force else "force to all digits")
    return [*rows, ("resolution", ", ".join(shown))]


def interval_text(factor, clock):
    low, high = factor * clock["interval_min_s"], factor * clock["interval_max_s"]
    return f"{low:.4g} to {high:.4g}"


def contact_rows(audit):
    metrics = audit["metrics"]
    return [
        (
            "contacts",
            f"{metrics['contacts']} in {counted(metrics['landings'], 'landing')}, "
            f"{100.0 * metrics['contact_share']:.3g} % of the time",
        ),
        ("in contact", audit["contact_rule"]),
        ("lost", f"{number(metrics['contacts_lost_per_s'])} per second of contact"),
    ]


def energy_rows(energy):
    giver = "the engine gave it to the hand"
    if energy["work_J"] < 0.0:
        giver = "the hand gave it to the engine"
    elif energy["work_J"] == 0.0:
        giver = "none"
    if abs(energy["work_J"]) < energy["work_error_J"]:
        giver = "its sign is not known"
    rows = [
        ("net created", millijoules(energy["net_created_J"], energy["net_created_error_J"])),
        ("without holding", f"{millijoules(energy['net_created_path_J'])} created along the path"),
        ("work on tool", f"{millijoules(energy['work_J'], energy['work_error_J'])}: {giver}"),
    ]
    if energy["stored_at_start_J"]:
        rows.append(
            (
                "stored",
                f"{millijoules(energy['stored_at_start_J'])} where the log begins, in contact",
            )
        )
    worst = energy["worst_contact"]
    if worst is None:
        return rows
    # If the largest created energy is below its error, the mean over the contacts is not known.
    if worst["created_J"] < worst["error_J"]:
        return rows
    return [
        *rows,
        (
            "created",
            f"{millijoules(energy['created_per_contact_J'])} per contact, "
            f"{1e3 * energy['created_per_s_in_contact_W']:.3g} mJ per second of contact",
        ),
        (
            "worst contact",
            f"{millijoules(worst['created_J'], worst['error_J'])} created from {worst['start_s']:.6g} to "
            f"{worst['end_s']:.6g} s",
        ),
    ]


def force_rows(metrics):
    return [
        ("mean", f"{number(metrics['force_mean_in_contact_N'])} N in settled contact"),
        ("largest", f"{number(metrics['force_max_N'])} N"),
        (
            "largest step",
            f"{number(metrics['settled_force_step_max_N'])} N in settled contact, at "
            f"{metrics['time_of_largest_step_s']:.6g} s; {number(metrics['force_step_max_N'])} N with landings",
        ),
        (
            "large steps",
            f"{number(metrics['steps_above_share_per_s'])} per second above 10 % of the mean",
        ),
        ("reversals", f"{number(metrics['force_reversals_per_s'])} per second"),
    ]


def vibration_rows(audit):
    peaks = ", ".join(
        f"{one['amplitude_N']:.3g} N at {one['frequency_Hz']:.4g} Hz" for one in audit["buzz"]
    )
    return [
        ("above 30 Hz", f"{number(audit['metrics']['force_rms_above_30Hz_N'])} N rms"),
        ("amplitudes", peaks or "no dominant frequency"),
    ]


def stiffness_rows(audit):
    spring = audit["stiffness"]
    if spring is None:
        return [("K", "not identifiable; see below")]
    x, y, z = (component + 0.0 for component in spring["direction"])
    rows = [
        (
            "K",
            f"{spring['stiffness_N_per_m']:.4g} N/m, 95 % {ends_text(spring['stiffness_interval'])}"
            f"{few_text(spring['contacts'], len(audit['contacts']))}",
        ),
        ("B", damping_text(spring)),
    ]
    if spring["dry_friction_N"]:
        rows.append(("dry friction", f"{spring['dry_friction_N']:.3g} N"))
    rows += [
        ("delay", delay_text(spring)),
        (
            "along",
            f"{'' if spring['direction_is_known'] else 'about '}({x:.2g}, {y:.2g}, {z:.2g}); explains "
            f"{100.0 * spring['explained']:.4g} % of the variance",
        ),
    ]
    if spring["linearity"] is not None:
        rows.append(
            (
                "linearity",
                f"the deeper half is {spring['linearity']:.3g} times as stiff as the other",
            )
        )
    span = audit["stiffness_range"]
    if span and span[1] > 1.05 * span[0]:
        rows.append(("contacts", f"have {span[0]:.4g} to {span[1]:.4g} N/m"))
    return rows


def few_text(known, count):
    """If the number `known` of contacts that determine the stiffness is positive and less than half of the number
    `count` of all contacts, returns a text with both numbers. Otherwise returns an empty text."""
    return f", from {known} of {counted(count, 'contact')}" if 1 <= 2 * known < count else ""


def damping_text(spring):
    if spring["damping_N_s_per_m"] is not None:
        return f"{spring['damping_N_s_per_m']:.3g} N s/m, 95 % {ends_text(spring['damping_interval'], 3)}"
    text = f"not identifiable, {ends_text(spring['damping_interval'], 3)} N s/m"
    if spring["delay_s"] is not None:
        return text
    return f"{text}; B less K times the delay is {ends_text(spring['slow_damping_interval'], 3)}"


def delay_text(spring):
    if spring["delay_s"] is None:
        first, last = (1e3 * one for one in spring["delay_interval_s"])
        return f"not identifiable, {first:.3g} to {last:.3g} ms: it acts like less damping"
    if not spring["delay_rows"]:
        return "none from position to force"
    return f"force {counted(spring['delay_rows'], 'row')} ({1e3 * spring['delay_s']:.3g} ms) behind the position"


def ends_text(interval, digits=4):
    """Returns both ends of an interval, with more digits if the ends would otherwise look equal."""
    low, high = interval
    while digits < 7 and f"{low:.{digits}g}" == f"{high:.{digits}g}":
        digits += 1
    return f"{low:.{digits}g} to {high:.{digits}g}"


def device_rows(audit):
    device = audit["device"]
    if device is None:
        return []
    if not device["is_known"]:
        return range_rows(audit)
    limit, ratio = device["linear_limit_N_per_m"], device["ratio"]
    if limit is None:
        return [(device["device"], "every stiffness is stable in the linear theory")]
    if ratio is None:
        return [
            (
                device["device"],
                "no stiffness is stable in the linear theory, at this damping and delay",
            )
        ]
    rows = [
        (
            "linear limit",
            f"{limit:.4g} N/m ({limits_text(device)}) for {device['device']} without a hand, at "
            f"{device['rate_Hz']:.4g} Hz, {device['delay_samples']:.3g} samples of delay, B = "
            f"{device['damping_N_s_per_m']:.3g} N s/m",
        ),
        ("K", f"{ratio:.3g} times the limit, {ratios_text(device)}"),
    ]
    if device["worst_hand_limit_N_per_m"] is not None:
        rows.append(
            (
                "with a hand",
                f"{device['worst_hand_limit_N_per_m']:.4g} N/m, smallest of typical hands",
            )
        )
    if device["expected_frequency_Hz"] is not None:
        rows.append(("buzz", expected_text(audit)))
    return rows


def range_rows(audit):
    """Returns the rows for a log that does not determine damping or delay."""
    device = audit["device"]
    return [
        (
            "linear limit",
            f"{limits_text(device)} N/m for {device['device']} without a hand, at {device['rate_Hz']:.4g} Hz, over the "
            "dampings and delays that the log allows",
        ),
        ("K", f"{ratios_text(device)} times the limit"),
    ]


def limits_text(device):
    low, high = device["linear_limit_interval"]
    if high is None:
        return "no limit" if low is None else f"{low:.4g} or more"
    return ends_text((low, high))


def ratios_text(device):
    low, high = device["ratio_interval"]
    if high is None:
        return f"{low:.3g} or more" if low is not None else "infinitely many"
    return ends_text((low, high), 3)


def expected_text(audit):
    """Returns a text with the frequency of the oscillation that the linear analysis predicts and the frequency in the
    log."""
    buzz, lost = audit["buzz"], audit["metrics"]["contacts_lost_in_spectrum"]
    text = f"expect a buzz near {audit['device']['expected_frequency_Hz']:.0f} Hz; the log "
    if not buzz:
        return text + "shows no buzz"
    slower = buzz[0]["frequency_Hz"] < 0.95 * audit["device"]["expected_frequency_Hz"]
    text += f"buzzes at {buzz[0]['frequency_Hz']:.0f} Hz"
    return text + (", slower because it loses contact" if slower and lost >= MIN_LOSSES else "")


def hammers(metrics):
    """Returns True if the tool loses contact repeatedly, not only while it lands."""
    return (
        metrics["contacts_lost_after_landing"] >= MIN_LOSSES
        and (metrics["contacts_lost_per_s"] or 0.0) > HAMMERS
    )


def measured_rows(measured):
    if measured is None:
        return []
    if measured["delay_s"] is None:
        return [("force", f"not identifiable: {measured['why']}")]
    return [
        (
            "force",
            f"{1e3 * measured['delay_s']:.3g} ms late, {measured['gain']:.3g} times the commanded",
        )
    ]


def table_rows(audit):
    """Returns the rows of rows_of(), where each subject is printed only once."""
    shown, last = [], None
    for subject, *rest in rows_of(audit):
        shown.append(["" if subject == last else subject, *rest])
        last = subject
    return shown


def below_table(audit):
    """Returns the lines below the table: diagnosis, and quantities that the log does not determine."""
    lines = ["diagnosis" if audit["diagnosis"] else "diagnosis: no rule exceeds its threshold"]
    for one in audit["diagnosis"]:
        lines += [f"  {one['rule']}: {one['says']}", f"    try: {one['try']}"]
    if audit["missing"]:
        lines += ["", "to say more, the log lacks"] + [f"  {one}" for one in audit["missing"]]
    return lines
