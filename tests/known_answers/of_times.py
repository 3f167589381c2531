"""Known answers for the tables of run time: run times by `compare --time` and `sweep --time`, and run time against
error by `converge --over`."""
import math

import numpy as np

from answers import EXACT, ROUNDING, Table, Within, scene
from physics import PLAIN, SPRING

K, M, X, STEP, STEPS = 1000.0, 0.1, 1e-3, 1e-3, 64
DEADLINE = 0.5e-3
# Plausible bounds for the time of a step [s].
FASTEST, SLOWEST = 1e-8, 1e-3


def oscillator(bench, name):
    """Returns the scenario of a mass on one spring without damping, whose motion is x = X cos(omega t)."""
    return bench.scenario(
        name,
        time={"step_s": STEP, "steps": STEPS},
        initial={"position_m": [X, 0, 0]},
        environment=SPRING,
        rendering={
            **PLAIN,
            "algorithm": "summation",
            "stiffness_N_per_m": K,
            "mass_kg": M,
            "damping_ratio": 0,
        },
    )


def add_times(bench, table, times, steps, deadline=DEADLINE):
    """Adds the answers for the columns that all tables of run times have. `steps`: time steps [s]."""
    each, spread = times["seconds_per_step"], times["spread_s"]
    for name, found, wrong in (
        ("seconds_per_step", (each > FASTEST) & (each < SLOWEST), 640 * each < SLOWEST / 1e3),
        ("spread_s", (spread >= 0) & (spread < SLOWEST), spread > SLOWEST),
    ):
        bench.add(
            f"{table}:{name}",
            bool(np.all(found)),
            True,
            "a step takes more than 10 ns and less than 1 ms",
            EXACT,
            ("of a run", bool(np.all(wrong))),
        )
    for name, known, wrong in (
        ("seconds_per_simulated_second", each / steps, each / (2 * DEADLINE + steps)),
        ("deadline_share", each / deadline, each / (2 * deadline + steps)),
    ):
        bench.add(
            f"{table}:{name}",
            times[name],
            known,
            "seconds_per_step over a time",
            ROUNDING,
            ("of another time", wrong),
        )


@scene
def times_of_laws(bench):
    """Checks the run times of two laws on the same spring, in contact in every step."""
    base = oscillator(bench, "times_of_laws")
    bench.hapbench(
        "compare", base, "--algorithms", "summation,mean", "--time", "--out", "times", "--quiet"
    )
    times = Table(bench.folder / "times" / "comparison_timing.csv")
    add_times(bench, "comparison_timing.csv", times, STEP)
    fastest_first = times["seconds_per_step"].argsort()
    each, spread = times["seconds_per_step"], times["spread_s"]
    ranks = [1 + sum(each[i] - each[j] > spread[i] + spread[j] for j in range(2)) for i in range(2)]
    for name, known, naive, wrong in (
        ("scenario", ["times_of_laws"] * 2, "another", ["x"] * 2),
        ("algorithm", [sorted(times["algorithm"])[i] for i in (0, 1)], "in reverse", None),
        ("contacts_per_step", [1.0, 1.0], "of a run", [float(STEPS)] * 2),
        ("steps", [STEPS] * 2, "without the first", [STEPS - 1] * 2),
        (
            "rank",
            ranks,
            "of the slowest first",
            [3 - rank if max(ranks) > 1 else 2 for rank in ranks],
        ),
    ):
        found = times[name]
        if name == "algorithm":
            found, wrong = sorted(found), known[::-1]
        bench.add(
            f"comparison_timing.csv:{name}",
            found,
            known,
            "as asked; the spring is in contact in every step",
            EXACT,
            (naive, wrong),
        )
    assert list(fastest_first) == [0, 1]


@scene
def errors_of_settings(bench):
    """Checks the errors of velocity Verlet with several time steps h. With velocity Verlet the mass moves as X
    cos(omega' t) with cos(omega' h) = 1 - (omega h)^2 / 2, instead of X cos(omega t)."""
    base = oscillator(bench, "errors_of_settings")
    bench.hapbench(
        "converge",
        base,
        "--over",
        "integrator.type=velocity_verlet",
        "--to",
        "2e-6",
        "--out",
        "over",
        "--quiet",
    )
    errors = Table(bench.folder / "over" / "convergence.csv")
    times = Table(bench.folder / "over" / "convergence_timing.csv")
    h, omega, t = STEP / 2.0 ** np.arange(4), math.sqrt(K / M), STEP * np.arange(STEPS)
    of_verlet = np.arccos(1 - (omega * h) ** 2 / 2) / h
    shifted = X * (np.cos(np.outer(of_verlet, t)) - np.cos(omega * t))
    known = np.sqrt(np.mean(shifted**2, axis=1))
    # The reference is rk4 with a step h / 128. Its error grows by (omega h / 128)^4 / 120 of X per radian.
    fine = Within("error of the reference solution", absolute=1e-9 * X)
    for table, found in (("convergence.csv", errors), ("convergence_timing.csv", times)):
        for name, value, wrong in (
            ("problem", "summation", "velocity_verlet"),
            ("integrator", "velocity_verlet", "rk4"),
        ):
            bench.add(
                f"{table}:{name}",
                found[name],
                [value] * 4,
                "as asked",
                EXACT,
                ("another", [wrong] * 4),
            )
        bench.add(
            f"{table}:step_s", found["step_s"], h, "halved", ROUNDING, ("in reverse", h[::-1])
        )
    for name, value, wrong in (("outcome", "completes", "diverges"), ("expected", "true", "false")):
        bench.add(
            f"convergence.csv:{name}",
            errors[name],
            [value] * 4,
            "an oscillation that ends with the last step",
            EXACT,
            ("another", [wrong] * 4),
        )
    how = "closed form of velocity Verlet and of the oscillator"
    largest = np.abs(shifted).max(axis=1)
    bench.add(
        "convergence.csv:position_error_m",
        errors["position_error_m"],
        known,
        how,
        fine,
        ("the largest", largest),
    )
    bench.add(
        "convergence.csv:force_error_N",
        errors["force_error_N"],
        K * known,
        "K times the error of the position",
        Within("error of the reference solution", absolute=1e-9 * X * K),
        ("the largest", K * largest),
    )
    for name, unit in (("reference_position_error_m", X), ("reference_force_error_N", K * X)):
        found = errors[name]
        bench.add(
            f"convergence.csv:{name}",
            bool(np.all(found < 1e-9 * unit)),
            True,
            "rk4 with a step of h / 128",
            EXACT,
            ("of leapfrog", bool(np.all(known * unit / X < 1e-9 * unit))),
        )
    bench.add(
        "convergence.csv:resolved",
        errors["resolved"],
        ["true"] * 4,
        how,
        EXACT,
        ("none", ["false"] * 4),
    )
    bench.add(
        "convergence.csv:asked_error_m",
        errors["asked_error_m"],
        [2e-6] * 4,
        "--to",
        EXACT,
        ("default", [1e-6] * 4),
    )
    add_times(bench, "convergence_timing.csv", times, h, deadline=h)
    # The error decreases and the cost increases with each level. Therefore no setting is better than another setting in
    # both, and all settings are on the Pareto front. In logarithmic scales the front is straight, so it has no knee.
    cost = times["seconds_per_simulated_second"]
    front = [not np.any((cost < cost[i]) & (known < known[i])) for i in range(4)]
    texts = lambda values: ["true" if value else "false" for value in values]
    bench.add(
        "convergence_timing.csv:on_front",
        times["on_front"],
        texts(front),
        "no other setting is below it in both",
        EXACT,
        ("none", texts([False] * 4)),
    )
    bench.add(
        "convergence_timing.csv:knee",
        times["knee"],
        texts([False] * 4),
        "the error falls with the square of the cost: a straight front",
        EXACT,
        ("the cheapest", texts([True, False, False, False])),
    )


@scene
def times_of_a_sweep(bench):
    """Checks the run times of a sweep over three masses on the same spring."""
    base = oscillator(bench, "times_of_a_sweep")
    words = ("--vary", "rendering.mass_kg=0.1,0.2,0.3", "--time", "--out", "swept", "--quiet")
    bench.hapbench("sweep", base, *words)
    times = Table(bench.folder / "swept" / "sweep_timing.csv")
    add_times(bench, "sweep_timing.csv", times, STEP)
    for name, known, naive, wrong in (
        ("index", [0, 1, 2], "from one", [1, 2, 3]),
        ("steps", [STEPS] * 3, "without the first", [STEPS - 1] * 3),
    ):
        bench.add(f"sweep_timing.csv:{name}", times[name], known, "as asked", EXACT, (naive, wrong))
