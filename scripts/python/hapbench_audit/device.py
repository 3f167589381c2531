"""The rendered stiffness against the linear limit of a device, which the program computes."""
import json

from hapbench_command import asked_of_program


def device_limit(device, interval, contact):
    """Limit and frequency of the loop of the device [SI units] at the log's rate and delay with the contact's
    stiffness and damping; None if the contact has no stiffness."""
    stiffness = contact and contact.get("stiffness_N_per_m")
    if not stiffness or stiffness <= 0.0:
        return None
    damping = max(contact.get("damping_N_s_per_m") or 0.0, 0.0)
    answer = asked_of_program(
        "knows devices and their linear limits",
        "audit",
        "--linear-loop",
        device,
        interval,
        stiffness,
        damping,
        contact["delay_s"],
    )
    loop = json.loads(answer)
    limit, oscillation = loop["linear_limit_N_per_m"], loop["at_stiffness"] or {}
    grows = oscillation.get("growth_per_s", 0.0) > 0.0
    return loop | {
        "stiffness_N_per_m": stiffness,
        "damping_N_s_per_m": damping,
        "log_delay_s": contact["delay_s"],
        "ratio": stiffness / limit if limit else None,
        "expected_frequency_Hz": oscillation.get("frequency_Hz") if grows else None,
    }
