"""Known answers for the tables of `converge` and for the errors of `compare`. The known values come from recurrences
for the motion of a mass on one spring, and from the limits of these values for small time steps."""
import math

import numpy as np
from scipy import linalg

from answers import EXACT, Table, Within, norms, scene
from physics import PLAIN, SPRING, UP, Phases, nearest_rank, step_matrix


@scene
def sampled_finer(bench):
    """Checks the estimates of `compare` for two errors of laws on a plane: the error due to the time step, and the
    error due to the point spacing. The known values come from single runs with a half and a quarter of the time step or
    of the spacing. Their metrics use the same times as the run with the full time step."""
    laws, by, scene_name = (
        ["summation", "proxy", "shaped_stiffness", "highest_depth"],
        ["force_step_p99_N", "force_max_N"],
        "plane_wiped_round",
    )
    spaced = lambda part: ["--set", f"environment.spacing_m={0.0004 / part}"]
    printed = bench.json(
        "compare",
        scene_name,
        *spaced(1),
        "--algorithms",
        ",".join(laws),
        "--by",
        ",".join(by),
        "--errors",
        "--out",
        "errors",
    )["errors"]

    def measured(law, spacing, step):
        run = bench.run(
            scene_name,
            *spaced(spacing),
            "--set",
            f"time.step_s={1 / 2048 / step}",
            "--set",
            f"time.steps={2048 * step}",
            "--set",
            f"rendering.algorithm={law}",
            "--set",
            "expect={}",
            out=f"{law}_{spacing}_{step}",
        )
        rows = run.table()
        f, touching = rows.vectors("fx_N", "fy_N", "fz_N")[::step], rows["colliding"][::step] > 0
        steps = norms(np.diff(f, axis=0, prepend=f[:1]))[Phases(touching, 1 / 2048).settled]
        return [nearest_rank(steps, 0.99), norms(f).max()]

    unrefined = {law: measured(law, 1, 1) for law in laws}
    finer = {
        law: {
            "spacing": [measured(law, part, 1) for part in (2, 4)],
            "step": [measured(law, 1, part) for part in (2, 4)],
        }
        for law in laws
    }
    for m, row in enumerate(printed):
        for part in ("spacing", "step"):
            # The error is at least the difference between the runs. If the order of convergence is known, the error is
            # 1.25 |f - f*| instead, with the extrapolated value f*. Histogram bins of p99 are 1.6 % wide.
            far = [
                max(abs(unrefined[law][m] - runs[m]) for runs in finer[law][part]) for law in laws
            ]
            is_bound = [
                n[f"error_of_{part}"] is None
                or n[f"error_of_{part}"] > 0.9 * f - 0.02 * unrefined[law][m]
                for n, f, law in zip(row["numbers"], far, laws)
            ]
            bench.add(
                f"compare --json: error_of_{part}",
                is_bound,
                [True] * 4,
                "no less than single runs are apart",
                EXACT,
                ("less", [False] * 4),
            )
        values = {n["algorithm"]: (n["value"], n["error_estimate"]) for n in row["numbers"]}
        is_distinct = lambda a, b: values[b][0] - values[a][0] > values[a][1] + values[b][1]
        rank = {law: i for i, group in enumerate(row["order"]) for law in group}
        pairs = [(a, b) for a in rank for b in rank if a != b]
        bench.add(
            "compare --json: order",
            [rank[a] < rank[b] for a, b in pairs],
            [is_distinct(a, b) for a, b in pairs],
            "by the numbers and errors beside it",
            EXACT,
            ("the other way round", [rank[a] >= rank[b] for a, b in pairs]),
        )
        order = " < ".join(" ~ ".join(group) for group in row["order"])
        bench.add(
            "compare --json: says",
            order in row["says"]
            and row["says"].startswith("no significant order") == ("<" not in order),
            True,
            "the same in words",
            EXACT,
            ("another", False),
        )
    springs = bench.scenario(
        "springs",
        time={"step_s": 0.001, "steps": 300},
        environment=UP,
        initial={"position_m": [1e-4, -1e-3, 0]},
        rendering={"algorithm": "mean", **PLAIN, "damping_ratio": 0.1},
    )
    printed = bench.json(
        "compare", springs, "--algorithms", "mean,summation", "--errors", "--out", "springs"
    )["errors"]
    bench.add(
        "compare --json: error_of_spacing",
        [n["error_of_spacing"] for row in printed for n in row["numbers"]],
        [None] * (2 * len(printed)),
        "springs have no points",
        EXACT,
        ("none", [0.0] * (2 * len(printed))),
    )


def verdict_on(f):
    """Returns the observed order, Richardson's extrapolated value, and the error of each result with Roache's factor
    1.25. `f`: results at steps that are halved each time; the last three results determine the order.
    """
    p = math.log2((f[-3] - f[-2]) / (f[-2] - f[-1]))
    limit = f[-1] + (f[-1] - f[-2]) / (2**p - 1)
    return p, limit, 1.25 * np.abs(f - limit)


@scene
def convergence_in_thirds(bench):
    """Checks `converge` for leapfrog on one damped spring. The time step is divided by r = 3 from level to level. With
    the differences d_1 and d_2 of successive results f, the order is p = log(d_1 / d_2) / log r. Richardson's
    value is f + (f - f_before) / (r^p - 1)."""
    K, M, dt, n, r = 1500.0, 0.1, 0.002, 40, 3
    B = 2 * 0.2 * math.sqrt(K * M)
    base = bench.scenario(
        "convergence_in_thirds",
        time={"step_s": dt, "steps": n},
        environment=SPRING,
        initial={"position_m": [1e-3, 0, 0]},
        rendering={
            **PLAIN,
            "algorithm": "summation",
            "stiffness_N_per_m": K,
            "damping_ratio": 0.2,
            "mass_kg": M,
        },
    )
    words = ("converge", base, "--metric", "final_position_m.x", "--levels", "4", "--ratio", r)
    printed = bench.json(*words, "--out", bench.folder / "thirds")
    f = np.array(
        [
            1e-3 * np.linalg.matrix_power(step_matrix(K, B, M, dt / r**i), (n - 1) * r**i)[0, 0]
            for i in range(4)
        ]
    )
    drop = (f[-3] - f[-2]) / (f[-2] - f[-1])
    p = math.log(drop) / math.log(r)
    near = Within(
        "positions of 1e-4 m known to 1e-18 m after 1080 steps, over differences of 1e-6 m",
        relative=1e-8,
    )
    how = "recurrence of leapfrog, formulas of Roache"
    bench.add(
        "converge --json: order", printed["order"], p, how, near, ("of halves", math.log2(drop))
    )
    bench.add(
        "converge.csv:extrapolated",
        printed["extrapolated"],
        f[-1] + (f[-1] - f[-2]) / (r**p - 1),
        how,
        near,
        ("of halves", f[-1] + (f[-1] - f[-2]) / (2**p - 1)),
    )


@scene
def convergence(bench):
    """Checks `converge` for leapfrog on one damped spring with five time steps. The results of all time steps are
    evaluated at the same time. Orders and extrapolated value follow from a recurrence."""
    K, M, dt, n = 1500.0, 0.1, 0.002, 40
    B = 2 * 0.2 * math.sqrt(K * M)
    base = bench.scenario(
        "convergence",
        time={"step_s": dt, "steps": n},
        environment=SPRING,
        initial={"position_m": [1e-3, 0, 0]},
        rendering={
            **PLAIN,
            "algorithm": "summation",
            "stiffness_N_per_m": K,
            "damping_ratio": 0.2,
            "mass_kg": M,
        },
    )
    metric, out = "final_position_m.x", bench.folder / "converged"
    printed = bench.json("converge", base, "--metric", metric, "--out", out)
    steps = dt / 2.0 ** np.arange(5)
    f = np.array(
        [
            1e-3 * np.linalg.matrix_power(step_matrix(K, B, M, h), (n - 1) * 2**i)[0, 0]
            for i, h in enumerate(steps)
        ]
    )
    p, limit, errors = verdict_on(f)
    orders = [math.nan] * 2 + [verdict_on(f[i - 2 : i + 1])[0] for i in range(2, 5)]
    ratio = (
        abs((f[-3] - f[-4]) / f[-3]) / abs((f[-2] - f[-3]) / f[-2]) / 2**p
    )  # 1 if the relative differences of the levels before the last decrease by 2^p
    near = Within(
        "positions of 1e-4 m known to 1e-18 m after 640 steps, over differences of 1e-6 m",
        relative=1e-9,
    )
    fine = Within("the same, of differences of differences", relative=1e-8)
    exact = linalg.expm(np.array([[0, 1], [-K / M, -B / M]]) * (n - 1) * dt)[0, 0] * 1e-3
    assert abs(limit - exact) < errors[-1], "the index does not hold the exact solution"
    table, levels = Table(out / "converge.csv"), Table(out / "converge_levels.csv")
    known = {
        "metric": (metric, EXACT, "another", "final_position_m.y"),
        "field": ("time.step_s", EXACT, "another", "time.steps"),
        "formal_order": (
            1.0,
            EXACT,
            "without damping the same integrator's of two steps before",
            2.0,
        ),
        "observed_order": (p, fine, "the formal one", 1.0),
        "reason": (None, EXACT, "some", "contacts switch"),
        "extrapolated": (limit, near, "the exact solution", exact),
        "gci": (
            errors[-1] / abs(f[-1]),
            fine,
            "without the factor of safety",
            errors[-1] / abs(f[-1]) / 1.25,
        ),
        "asymptotic": (
            abs(ratio - 1) <= 0.1,
            EXACT,
            "of the first differences",
            abs(ratio - 1) > 0.1,
        ),
        "low": (f[2:].min(), near, "of the first three", f[:3].min()),
        "high": (f[2:].max(), near, "of the first three", f[:3].max()),
    }
    for name, (value, within, naive, wrong) in known.items():
        cell = table.rows[0][name]
        cell = {"true": True, "false": False}.get(
            cell, float(cell) if isinstance(value, float) else cell or None
        )
        bench.add(
            f"converge.csv:{name}",
            cell,
            value,
            "recurrence of leapfrog, formulas of Roache",
            within,
            (naive, wrong),
        )
    bench.add(
        "converge --json: order",
        printed["order"],
        p,
        "recurrence of leapfrog, formulas of Roache",
        fine,
        ("the formal one", 1.0),
    )
    bench.add(
        "converge --json: band",
        printed["band"],
        [f[2:].min(), f[2:].max()],
        "of the last three levels",
        near,
        ("of all", [f.min(), f.max()]),
    )
    levels_of_convergence(bench, dt, errors, f, fine, levels, metric, near, orders, out, steps)
    error_of_step(bench, base, f, fine, metric, printed)


def error_of_step(bench, base, f, fine, metric, printed):
    """Checks the error due to the time step that `compare` states for a metric. It is the error of the result with the
    largest of three time steps."""
    error = verdict_on(f[:3])[2][0]
    (compared,) = bench.json(
        "compare",
        base,
        "--algorithms",
        "summation",
        "--by",
        metric,
        "--errors",
        "--out",
        bench.folder / "errors",
    )["errors"]
    number = compared["numbers"][0]
    assert (
        number["value"] == printed["levels"][0]["result"]
        and number["error_estimate"] == number["error_of_step"]
    )
    bench.add(
        "compare --json: error_of_step",
        number["error_of_step"],
        error,
        "three levels of the same recurrence",
        fine,
        ("from the finest of three", abs(f[0] - f[2])),
    )


def levels_of_convergence(bench, dt, errors, f, fine, levels, metric, near, orders, out, steps):
    """Checks converge_levels.csv: steps, results, observed orders and errors of each level."""
    for name, (value, within, naive, wrong) in {
        "value": (steps, EXACT, "the coarsest over 1, 2, 3 ...", dt / np.arange(1, 6)),
        "result": (f, near, "of the last row of each run", np.append(f[1:], f[0])),
        "observed_order": (orders, fine, "the formal one", [math.nan] * 2 + [1.0] * 3),
        "error_estimate": (errors, fine, "from the finest level", np.abs(f - f[-1])),
    }.items():
        bench.add(
            f"converge_levels.csv:{name}",
            levels[name],
            value,
            "recurrence of leapfrog, formulas of Roache",
            within,
            (naive, wrong),
        )
    for name, value, wrong in (("metric", metric, "x"), ("outcome", "completes", "diverges")):
        bench.add(
            f"converge_levels.csv:{name}",
            levels[name],
            [value] * 5,
            "as asked, and stable below 2 M / B",
            EXACT,
            ("another", [wrong] * 5),
        )
    times = Table(out / "converge_levels_timing.csv")
    bench.add(
        "converge_levels_timing.csv:value",
        times["value"],
        steps,
        "as of the levels",
        EXACT,
        ("of the finest first", steps[::-1]),
    )
    seconds = times["seconds"]
    bench.add(
        "converge_levels_timing.csv:seconds",
        bool(np.all((seconds > 1e-6) & (seconds < 0.1))),
        True,
        "640 steps take more than a microsecond, less than 0.1 s",
        EXACT,
        ("of a step", bool(np.all(seconds / 640 > 1e-6))),
    )
