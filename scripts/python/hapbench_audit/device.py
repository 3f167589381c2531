"""Compares the stiffness that a log shows with the linear limit of a device: the largest stable stiffness by linear
analysis. The program computes this limit."""
import json

import numpy as np
from hapbench_command import output_of_program

MAX_DELAYS = 5  # largest number of delays for which the limit is computed


def device_limit(device, interval, contact):
    """Returns the comparison of the stiffness of the spring `contact` with the linear limit of a device, for the JSON.
    The analysed control loop has the period `interval` [s], and the damping and the delay of this spring. Returns None
    if `contact` is None, which means that the log determines no stiffness.

    If the log does not determine damping or delay, `linear_limit_N_per_m` is None. `linear_limit_interval` is the range
    of the limit over the dampings and delays that the log allows, computed for at most MAX_DELAYS of these delays.
    """
    if not contact:
        return None
    stiffness, loops = contact["stiffness_N_per_m"], contact["loops"]
    delays = sorted({delay for delay, _ in loops})
    some = np.linspace(0, len(delays) - 1, min(len(delays), MAX_DELAYS)).round().astype(int)
    chosen = [delays[i] for i in some.tolist()]
    answers = [
        loop_of(device, interval, stiffness, damping, delay)
        for delay, damping in loops
        if delay in chosen
    ]
    limits = [
        float("inf") if one["linear_limit_N_per_m"] is None else one["linear_limit_N_per_m"]
        for one in answers
    ]
    ends = [min(limits), max(limits)]
    low, high = contact["stiffness_interval"]
    found = {
        "stiffness_N_per_m": stiffness,
        "rate_Hz": 1.0 / interval,
        "linear_limit_interval": [None if np.isinf(one) else one for one in ends],
        "ratio_interval": [
            low / ends[1] if ends[1] else None,
            high / ends[0] if ends[0] else None,
        ],
        "damping_N_s_per_m": contact["damping_N_s_per_m"],
        "log_delay_s": contact["delay_s"],
    }
    delay, damping = contact["delay_s"], contact["damping_N_s_per_m"]
    is_known = delay is not None and damping is not None
    if not is_known:
        unknown = (
            "linear_limit_N_per_m",
            "worst_hand_limit_N_per_m",
            "at_stiffness",
            "at_limit",
        )
        loop = answers[0] | dict.fromkeys((*unknown, "delay_samples"))
        return found | loop | {"ratio": None, "expected_frequency_Hz": None, "is_known": False}
    loop = loop_of(device, interval, stiffness, max(damping, 0.0), delay)
    limit, oscillation = loop["linear_limit_N_per_m"], loop["at_stiffness"] or {}
    grows = oscillation.get("growth_per_s", 0.0) > 0.0
    return (
        found
        | loop
        | {
            "damping_N_s_per_m": max(damping, 0.0),
            "ratio": stiffness / limit if limit else None,
            "expected_frequency_Hz": oscillation.get("frequency_Hz") if grows else None,
            "is_known": True,
        }
    )


def loop_of(device, interval, stiffness, damping, delay):
    """Returns the linear analysis of a device that renders a wall, computed by the program. Arguments: period
    `interval` [s], stiffness [N/m], damping [N s/m], and delay [s] in addition to the delay of the device.
    """
    answer = output_of_program(
        "knows devices and their linear limits",
        "audit",
        "--linear-loop",
        device,
        interval,
        stiffness,
        damping,
        delay,
    )
    return json.loads(answer)
