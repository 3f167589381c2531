"""Known answers for the comparison of laws with a reference force by `converge --over`."""
import math

import numpy as np

from answers import EXACT, ROUNDING, Table, scene
from physics import PLAIN, SPRING

K, PRESSED, DEADLINE = 1000.0, 1e-3, 0.5e-3


@scene
def laws_against_a_force(bench):
    """Checks the errors of two laws for a tool that presses two parallel springs by x. The law `summation` gives the
    force 2 K x, and `mean` gives K x. The constant reference force is tilted by 0.1 rad."""
    reference = (-1.5, 0.15, 0.0)
    base = bench.scenario(
        "model",
        time={"step_s": 1e-3, "steps": 40},
        environment={**SPRING, "groups": [{"direction": [1, 0, 0], "count": 2}]},
        rendering={**PLAIN, "algorithm": "summation", "stiffness_N_per_m": K},
        motion={"position": {"type": "prescribed", "x_m": PRESSED, "y_m": 0, "z_m": 0}},
        reference_force={f"{axis}_N": value for axis, value in zip("xyz", reference)},
    )
    words = ("converge", base, "--over", "rendering.algorithm=summation,mean", "--out", "over")
    bench.hapbench(*words, "--quiet")
    model = Table(bench.folder / "over" / "convergence_model.csv")
    times = Table(bench.folder / "over" / "convergence_model_timing.csv")
    errors = [math.dist((-n * K * PRESSED, 0, 0), reference) for n in (2, 1)]
    size, how = math.hypot(*reference), "springs and a constant reference force"
    laws = ["summation", "mean"]
    for name, known, naive, wrong in (
        ("problem", laws, "in reverse", laws[::-1]),
        ("outcome", ["completes"] * 2, "another", ["diverges"] * 2),
        ("expected", ["true"] * 2, "the opposite", ["false"] * 2),
        ("force_direction_error_rad", [math.atan(0.1)] * 2, "of the x components", [0.0] * 2),
        ("force_error_rms_N", errors, "of the x components", [0.5, 0.5]),
        ("force_error_relative", [e / size for e in errors], "of the force", errors),
        ("reference_error_N", [0.0] * 2, "the error of the law", errors),
        ("shares_reference", ["false"] * 2, "of the proxy", ["true"] * 2),
    ):
        within = EXACT if isinstance(known[0], str) else ROUNDING
        bench.add(f"convergence_model.csv:{name}", model[name], known, how, within, (naive, wrong))
    median, p99_9 = times["step_median_s"], times["step_p99_9_s"]
    for name, found, known, naive, wrong in (
        ("problem", times["problem"], laws, "in reverse", laws[::-1]),
        (
            "step_median_s",
            bool(np.all((median > 1e-9) & (median < 1e-3))),
            True,
            "of a run",
            bool(np.all(40e3 * median < 1e-3)),
        ),
        (
            "step_p99_9_s",
            bool(np.all(p99_9 >= median)),
            True,
            "below the median",
            bool(np.all(p99_9 < median)),
        ),
        ("deadline_s", times["deadline_s"], [DEADLINE] * 2, "the time step", [1e-3] * 2),
        (
            "deadline_share",
            times["deadline_share"],
            p99_9 / DEADLINE,
            "of the time step",
            p99_9 / 1e-3,
        ),
    ):
        within = ROUNDING if name.startswith("deadline") else EXACT
        how = "times of steps between a nanosecond and a millisecond"
        bench.add(f"convergence_model_timing.csv:{name}", found, known, how, within, (naive, wrong))
