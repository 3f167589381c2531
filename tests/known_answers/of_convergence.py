"""How far numbers are from converged: recurrences of one spring against their limits."""
import math

import numpy as np
from scipy import linalg

from answers import EXACT, Table, Within, scene
from physics import PLAIN, SPRING, step_matrix


def positions(K, B, M, dt, n, every=1):
    A, state, found = step_matrix(K, B, M, dt), np.array([1e-3, 0.0]), []
    for k in range(n):
        found += [state] if k % every == 0 else []
        state = A @ state
    return np.array(found)


def verdict_on(f):
    """Order, Richardson's value and its error of three results at steps that are halved, with Roache's factor."""
    p = math.log2((f[-3] - f[-2]) / (f[-2] - f[-1]))
    limit = f[-1] + (f[-1] - f[-2]) / (2**p - 1)
    return p, limit, 1.25 * np.abs(f - limit)


@scene
def convergence(bench):
    """Leapfrog on one damped spring at five steps, where it is after the same time: orders and limit by hand of a recurrence."""
    K, M, dt, n = 1500.0, 0.1, 0.002, 40
    B = 2 * 0.2 * math.sqrt(K * M)
    base = bench.scenario("convergence", time={"step_s": dt, "steps": n}, environment=SPRING, initial={"position_m": [1e-3, 0, 0]},
                          rendering={**PLAIN, "algorithm": "summation", "stiffness_N_per_m": K, "damping_ratio": 0.2, "mass_kg": M})
    metric, out = "final_position_m.x", bench.folder / "converged"
    printed = bench.json("converge", base, "--metric", metric, "--out", out)
    steps = dt / 2.0 ** np.arange(5)
    f = np.array([positions(K, B, M, h, n * 2**i, 2**i)[-1, 0] for i, h in enumerate(steps)])
    p, limit, errors = verdict_on(f)
    orders = [math.nan] * 2 + [verdict_on(f[i - 2:i + 1])[0] for i in range(2, 5)]
    ratio = abs((f[-3] - f[-4]) / f[-3]) / abs((f[-2] - f[-3]) / f[-2]) / 2**p  # of the three before the last, the more severe
    near = Within("positions of 1e-4 m known to 1e-18 m after 640 steps, over differences of 1e-6 m", relative=1e-9)
    fine = Within("the same, of differences of differences", relative=1e-8)
    exact = linalg.expm(np.array([[0, 1], [-K / M, -B / M]]) * (n - 1) * dt)[0, 0] * 1e-3
    assert abs(limit - exact) < errors[-1], "the index does not hold the exact solution"
    table, levels = Table(out / "converge.csv"), Table(out / "converge_levels.csv")
    known = {"metric": (metric, EXACT, "another", "final_position_m.y"), "field": ("time.step_s", EXACT, "another", "time.steps"),
             "formal_order": (1.0, EXACT, "without damping the same integrator's of two steps before", 2.0),
             "observed_order": (p, fine, "the formal one", 1.0), "reason": (None, EXACT, "some", "contacts switch"),
             "extrapolated": (limit, near, "the exact solution", exact), "gci": (errors[-1] / abs(f[-1]), fine, "without the factor of safety", errors[-1] / abs(f[-1]) / 1.25),
             "asymptotic": (abs(ratio - 1) <= 0.1, EXACT, "of the first differences", abs(ratio - 1) > 0.1),
             "low": (f[2:].min(), near, "of the first three", f[:3].min()), "high": (f[2:].max(), near, "of the first three", f[:3].max())}
    for name, (value, within, naive, wrong) in known.items():
        cell = table.rows[0][name]
        cell = {"true": True, "false": False}.get(cell, float(cell) if isinstance(value, float) else cell or None)
        bench.add(f"converge.csv:{name}", cell, value, "recurrence of leapfrog, formulas of Roache", within, (naive, wrong))
    bench.add("converge --json: order", printed["order"], p, "recurrence of leapfrog, formulas of Roache", fine, ("the formal one", 1.0))
    bench.add("converge --json: band", printed["band"], [f[2:].min(), f[2:].max()], "of the last three levels", near, ("of all", [f.min(), f.max()]))
    for name, (value, within, naive, wrong) in {
            "value": (steps, EXACT, "the coarsest over 1, 2, 3 ...", dt / np.arange(1, 6)), "result": (f, near, "of the last row of each run", np.append(f[1:], f[0])),
            "observed_order": (orders, fine, "the formal one", [math.nan] * 2 + [1.0] * 3), "error_estimate": (errors, fine, "from the finest level", np.abs(f - f[-1]))}.items():
        bench.add(f"converge_levels.csv:{name}", levels[name], value, "recurrence of leapfrog, formulas of Roache", within, (naive, wrong))
    for name, value, wrong in (("metric", metric, "x"), ("outcome", "completes", "diverges")):
        bench.add(f"converge_levels.csv:{name}", levels[name], [value] * 5, "as asked, and stable below 2 M / B", EXACT, ("another", [wrong] * 5))
    times = Table(out / "converge_levels_timing.csv")
    bench.add("converge_levels_timing.csv:value", times["value"], steps, "as of the levels", EXACT, ("of the finest first", steps[::-1]))
    seconds = times["seconds"]
    bench.add("converge_levels_timing.csv:seconds", bool(np.all((seconds > 1e-6) & (seconds < 0.1))), True, "640 steps take more than a microsecond, less than 0.1 s",
              EXACT, ("of a step", bool(np.all(seconds / 640 > 1e-6))))
    error = verdict_on(f[:3])[2][0]
    said, = bench.json("compare", base, "--algorithms", "summation", "--by", metric, "--errors", "--out", bench.folder / "errors")["errors"]
    number = said["numbers"][0]
    assert number["value"] == printed["levels"][0]["result"] and number["error_estimate"] == number["error_of_step"]
    bench.add("compare --json: error_of_step", number["error_of_step"], error, "three levels of the same recurrence", fine,
              ("from the finest of three", abs(f[0] - f[2])))
