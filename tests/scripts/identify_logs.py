"""Creates synthetic logs for tests of the identification, and checks the parameters that it reports. As a script, this
file runs the study of 200 logs whose table is in device_model/FIT_METHOD.md."""
import os
import sys

import numpy as np
from fixture import PROGRAM

from hapbench_identify.fit import Cost, fit
from hapbench_identify.log import log_of
from hapbench_identify.model import KINDS, NAMES, Simulator, design, positions
from hapbench_command import Faults

os.environ["HAPBENCH_PROGRAM"] = str(PROGRAM)  # this program simulates the logs
LOGS = 200
PARAMETERS = NAMES[:5]


def synthetic(seed):
    """Returns (log, true values in the order of NAMES, description of the log) for a seed."""
    random = np.random.default_rng(seed)
    kind = list(KINDS)[seed % 3]
    rate, duration = random.choice([500.0, 1000.0, 2000.0, 4000.0]), float(
        np.round(np.exp(random.uniform(np.log(2.0), np.log(60.0))), 1)
    )
    mass, force = np.exp(random.uniform(np.log(0.03), np.log(0.8))), random.uniform(0.5, 5.0)
    travel = random.uniform(0.05, 0.2)
    when, push = design(kind, force, travel, rate, duration, mass * random.uniform(0.5, 1.0))
    peak = np.abs(push).max()
    dry = peak * random.choice(
        [0.0, random.uniform(0.0, 0.2), random.uniform(0.2, 0.6)], p=[0.1, 0.5, 0.4]
    )
    truth = np.array(
        [
            mass,
            np.exp(random.uniform(np.log(0.02), np.log(3.0))),
            dry,
            random.uniform(0.0, 6.0) / rate,
            peak * random.choice([0.0, 0.02 * random.standard_normal()]),
            0.0,
        ]
    )
    encoder = np.exp(random.uniform(np.log(2e-6), np.log(1e-4)))
    trajectory = positions(when, push, truth) + encoder * random.choice(
        [0.0, 0.3, 1.0]
    ) * random.standard_normal(len(when))
    return (
        log_of(when, push, encoder * np.round(trajectory / encoder)),
        truth,
        (kind, rate, duration, dry / peak),
    )


def judged(seed):
    """Fits the log of a seed. Returns for each parameter True if its interval contains the true value, otherwise False;
    None if the fit does not report the parameter. Also returns the rms residual divided by the rms residual of the true
    parameters, and the processor time [s]."""
    log, truth, what = synthetic(seed)
    begun = sum(os.times()[:3])
    try:
        found = fit(log)
    except Faults as refused:
        return {
            "seed": seed,
            "what": what,
            "refused": str(refused),
            "holds": dict.fromkeys(PARAMETERS),
            "over": None,
            "seconds": 0.0,
        }
    seconds = sum(os.times()[:3]) - begun  # user time of this process and of its child processes
    with Simulator(log.time, log.force) as simulate:
        at_truth = Cost(simulate, log)(truth)
    holds = {
        name: None if name in found.undetermined else bool(low <= true <= high)
        for name, true, (low, high) in zip(PARAMETERS, truth, found.intervals)
    }
    return {
        "seed": seed,
        "what": what,
        "refused": "",
        "holds": holds,
        "over": found.rms / np.sqrt(np.mean(at_truth**2)),
        "seconds": seconds,
        "untold": found.undetermined,
    }


def table(ones):
    """Returns the lines of a Markdown table with a row for each kind of signal and a row for all logs. For each
    parameter, a row has the fraction of the reported intervals that contain the true value. `ones`: results of
    judged()."""
    rows = [
        "| logs | m | b | c | delay | offset | refused | not told | largest residual / at the "
        "truth | CPU, mean, largest |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for kind in (*KINDS, "all"):
        of_kind = [one for one in ones if kind in ("all", one["what"][0])]
        accepted = [one for one in of_kind if not one["refused"]]
        shares = [f"{100.0 * share(accepted, name):.0f} %" for name in PARAMETERS]
        undetermined = sum(holds is None for one in accepted for holds in one["holds"].values())
        seconds = [one["seconds"] for one in accepted]
        rows.append(
            f"| {len(of_kind)} {kind} | {' | '.join(shares)} | {len(of_kind) - len(accepted)} | {undetermined} | "
            f"{max(one['over'] for one in accepted):.4f} | {np.mean(seconds):.1f} s, {max(seconds):.1f} s |"
        )
    return rows


def share(ones, name):
    held = [one["holds"][name] for one in ones if one["holds"][name] is not None]
    return sum(held) / max(1, len(held))


def main():
    ones = [judged(seed) for seed in range(LOGS)]
    print("\n".join(table(ones)))
    wrong = [
        f"seed {one['seed']}: refused or not told: {one['refused'] or one['untold']}"
        for one in ones
        if one["refused"] or one["untold"]
    ]
    wrong += [
        f"seed {one['seed']}: residual {one['over']:.4f} of that at the truth"
        for one in ones
        if one["over"] and one["over"] > 1.002
    ]
    wrong += [
        f"{name}: {100.0 * share(ones, name):.1f} % of the intervals hold; allowed: 92 ... 98 %"
        for name in PARAMETERS
        if not 0.92 <= share(ones, name) <= 0.98
    ]
    print("\n".join(wrong))
    return len(wrong)


if __name__ == "__main__":
    sys.exit(main() != 0)
