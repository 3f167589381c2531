"""Scenes behind the tables of compare and sweep, recomputed from the summaries of single runs, and
of converge: recurrences of one spring against their limits."""
import math
from itertools import product

import numpy as np
from scipy import linalg

from answers import EXACT, ROUNDING, Run, Table, Within, norms, scene
from physics import PLAIN, SPRING, Phases, nearest_rank, step_matrix

UP = {"type": "springs", "groups": [{"direction": [0, 1, 0], "count": 2}]}
LAWS = ["mean", "virtual_coupling", "summation", "shaped_stiffness"]
BY = ["force_step_p99_N", "velocity_total_variation_m_per_s", "contact_share"]
SEEDS = 14


@scene
def league(bench):
    """A mass on two parallel springs, soft, and so stiff that leapfrog amplifies every step: some
    starts leave the bounds in time. The league by the book: means over common seeds, and ranks."""
    start = {"position_m": [1e-4, -1e-3, 0]}
    bench.scenario(
        "held",
        time={"step_s": 0.001, "steps": 500},
        environment=UP,
        initial=start,
        rendering={"algorithm": "mean", **PLAIN, "damping_ratio": 0.05},
    )
    bench.scenario(
        "thrown",
        time={"step_s": 0.001, "steps": 460},
        environment=UP,
        initial=start,
        bounds={"position_m": 300},
        rendering={"algorithm": "mean", **PLAIN, "stiffness_N_per_m": 400050.0},
    )
    scenes = ["held", "thrown"]
    out = bench.folder / "league"
    printed = bench.json(
        "compare",
        "held.json",
        "thrown.json",
        "--algorithms",
        ",".join(LAWS),
        "--seeds",
        SEEDS,
        "--jitter",
        "9e-4",
        "--by",
        ",".join(BY),
        "--out",
        out,
        statuses=(0, 3),
    )
    runs = {
        (s, law, k): Run(out / s / law / f"seed_{k}")
        for s in scenes
        for law in LAWS
        for k in range(SEEDS)
    }
    table = Table(out / "league.csv")
    known, naive, ranks = [], [], {law: [] for law in LAWS}
    number = lambda x: math.nan if x is None else float(x)
    outcomes = {
        (s, law): [runs[s, law, k].summary["outcome"] for k in range(SEEDS)]
        for s in scenes
        for law in LAWS
    }
    for s, law, metric in product(scenes, LAWS, BY):
        bad = {name: SEEDS - outcomes[s, name].count("completes") for name in LAWS}
        some = [name for name in LAWS if bad[name] < SEEDS]
        common = [
            k for k in range(SEEDS) if all(outcomes[s, name][k] == "completes" for name in some)
        ]
        values = {name: [runs[s, name, k].metric(metric) for k in common] for name in some}
        means = {name: np.mean(v) for name, v in values.items() if None not in v}
        sure = [name for name in means if bad[name] == 0]
        ranked = metric != "contact_share"
        alike = lambda a, b: abs(means[a] - means[b]) <= 1e-3 * max(abs(means[a]), abs(means[b]))
        order = sorted(sure, key=means.get)
        leader, rank = {}, {}
        for i, name in enumerate(order):
            leader[i] = leader[i - 1] if i and alike(order[leader[i - 1]], name) else i
            rank[name] = 1 + leader[i]
        rank.update(
            {name: 1 + sum(bad[other] < bad[name] for other in LAWS) for name in LAWS if bad[name]}
        )
        of_law = outcomes[s, law]
        counts = [f"{name} {of_law.count(name)}" for name in dict.fromkeys(of_law)]
        known.append(
            {
                "scenario": s,
                "algorithm": law,
                "metric": metric,
                "seeds": SEEDS,
                "failed": bad[law],
                "common_seeds": len(common),
                "outcome": of_law[0] if len(counts) == 1 else "; ".join(counts),
                "mean": number(means.get(law)),
                "better": "less" if ranked else "",
                "spread": number(np.std(values[law], ddof=1) if law in means else None),
                "rank": number(rank.get(law) if ranked else None),
            }
        )
        own = [
            math.nan if runs[s, law, k].metric(metric) is None else runs[s, law, k].metric(metric)
            for k in range(SEEDS)
        ]
        naive.append(
            {
                "failed": 0,
                "mean": float(np.nanmean([*own, 0.0])),
                "spread": number(np.std(values[law]) if law in means else None),
                "rank": 1 + LAWS.index(law),
                "common_seeds": SEEDS - bad[law],
                "seeds": SEEDS - bad[law],
            }
        )
        if ranked:
            ranks[law].append(rank[law])
    says = {
        "failed": "of runs that diverge",
        "mean": "over all seeds",
        "spread": "with n in place of n - 1",
        "rank": "in the order asked",
        "common_seeds": "seeds without failure",
        "seeds": "seeds without failure",
    }
    how = "from the runs' summaries, by the book"
    for name in table.names:
        column = [row[name] for row in known]
        wrong = (
            (says[name], [row[name] for row in naive])
            if name in says
            else ("in another order", column[::-1])
        )
        bench.add(
            f"league.csv:{name}",
            table[name],
            column,
            how,
            ROUNDING if name in ("mean", "spread") else EXACT,
            wrong,
        )
    order = [law["algorithm"] for law in printed["laws"]]
    # The other laws are stiffer than 4 M / dt^2 = 4e5 N/m, of which virtual coupling has two
    # thirds.
    for key, values, wrong in (
        ("mean_rank", [np.mean(ranks[law]) for law in order], ("place in the order", [1, 2, 3, 4])),
        (
            "fails",
            ["" if law == "virtual_coupling" else "thrown" for law in order],
            ("none", [""] * len(order)),
        ),
    ):
        found = [
            ", ".join(law[key]) if isinstance(law[key], list) else law[key]
            for law in printed["laws"]
        ]
        bench.add(
            f"compare --json: {key}",
            found,
            values,
            "from the ranks of both scenes",
            ROUNDING,
            wrong,
        )


@scene
def swept(bench):
    """A sweep is its single runs."""
    base = bench.scenario(
        "swept",
        time={"step_s": 0.001, "steps": 300},
        environment=UP,
        initial={"position_m": [1e-3, -1e-3, 0]},
        hand={"type": "force", "y_N": -0.5},
        rendering={"algorithm": "mean", **PLAIN, "damping_ratio": 0.1},
        expect={"outcome": "completes"},
    )
    field, values = "rendering.stiffness_N_per_m", [500.0, 1000.0, 2000.0, 4e6]
    told = bench.json(
        "sweep", base, "--vary", f"{field}=500,1000,2000,4e6", "--out", "sweep", statuses=(0, 3)
    )
    table = Table(bench.folder / "sweep" / "sweep.csv")
    runs = [
        bench.run(base, "--set", f"{field}={value}", out=f"run_{i}", statuses=(0, 3))
        for i, value in enumerate(values)
    ]
    of = lambda key: [run.summary[key] for run in runs]
    bench.columns(
        table, [("index", [0.0, 1, 2, 3], "order of the values", EXACT, "from 1", [1.0, 2, 3, 4])]
    )
    for key, known, naive in (
        ("outcome", of("outcome"), ("of the first", [of("outcome")[0]] * 4)),
        ("expected", [str(x).lower() for x in of("expected")], ("all", ["true"] * 4)),
        ("steps", of("steps"), ("asked", [300] * 4)),
        ("state_hash", of("state_hash"), ("of the first", [of("state_hash")[0]] * 4)),
    ):
        bench.add(f"sweep.csv:{key}", table[key], known, "single runs with --set", EXACT, naive)
    # 4e6 N/m is ten times 4 M / dt^2.
    for key, known, naive in (
        ("unexpected", 1, 0),
        ("completes", 3, 4),
        ("diverges", 1, 0),
        ("file", "sweep/sweep.csv", "sweep.csv"),
    ):
        bench.add(
            f"sweep --json: {key}",
            told.get(key, told["outcomes"].get(key)),
            known,
            "one of four is unstable",
            EXACT,
            ("those that complete, or all", naive),
        )
    bench.add(
        f"sweep --json: {field}",
        [row[field] for row in told["rows"]],
        values,
        "as asked",
        EXACT,
        ("of the scenario", [1000.0] * 4),
    )
    bench.add(
        "sweep --json: definition",
        told["definition"]
        != bench.json("sweep", base, "--vary", f"{field}=500,1001", "--out", "other")["definition"],
        True,
        "another sweep has another",
        EXACT,
        ("of the scenario alone", False),
    )
    shared = [name for name in table.names if name in runs[0].summary["metrics"]]
    bench.add(
        "sweep.csv:metrics",
        [table[name][1] for name in shared],
        [math.nan if runs[1].metric(name) is None else runs[1].metric(name) for name in shared],
        "a single run, the same digits",
        EXACT,
        (
            "the run before",
            [math.nan if runs[0].metric(name) is None else runs[0].metric(name) for name in shared],
        ),
    )
    may_err = [name for name in table.names if name.startswith("tolerances.")]
    known = [
        [run.summary["tolerances"].get(name.split(".", 1)[1], math.nan) for name in may_err]
        for run in runs
    ]
    bench.add(
        "sweep.csv:tolerances",
        [table[name][1] for name in may_err],
        known[1],
        "a single run, the same digits",
        EXACT,
        ("the run before", known[0]),
    )


@scene
def compared(bench):
    """comparison.csv is the runs' summaries, one of each law; a shell is what the file of a point
    shell says."""
    base = bench.scenario(
        "compared",
        time={"step_s": 0.001, "steps": 400},
        environment=UP,
        initial={"position_m": [1e-4, -1e-3, 0]},
        rendering={"algorithm": "mean", **PLAIN, "damping_ratio": 0.02},
    )
    laws = ["mean", "summation", "virtual_coupling"]
    printed = bench.json("compare", base, "--algorithms", ",".join(laws), "--out", "c")
    table, runs = Table(bench.folder / "c" / "comparison.csv"), [
        Run(bench.folder / "c" / law) for law in laws
    ]
    bench.add(
        "comparison.csv:algorithm",
        table["algorithm"],
        laws,
        "as asked",
        EXACT,
        ("by name", sorted(laws, reverse=True)),
    )
    for key, wrong in (("outcome", ["diverges"] * 3), ("steps", [399] * 3)):
        bench.add(
            f"comparison.csv:{key}",
            table[key],
            [run.summary[key] for run in runs],
            "of the summary",
            EXACT,
            ("another", wrong),
        )
    shared = [name for name in table.names if name in runs[0].summary["metrics"]]
    values = [
        [math.nan if run.metric(name) is None else float(run.metric(name)) for name in shared]
        for run in runs
    ]
    bench.add(
        "comparison.csv:metrics",
        [[table[name][i] for name in shared] for i in range(3)],
        values,
        "of the summaries, the same digits",
        EXACT,
        ("of the next law", values[1:] + values[:1]),
    )
    assert len(printed) == 3
    points = np.array(
        [[1e-3, 2e-3, 3e-3, 0, 0, 1], [-4e-3, 5e-3, 0, 0.6, 0, 0.8], [7e-3, -8e-3, 9e-3, 0, -1, 0]]
    )
    bench.write("points.csv", "x_m,y_m,z_m,nx,ny,nz", points)
    shell = bench.scenario(
        "shell",
        time={"step_s": 0.001, "steps": 1},
        environment={"type": "point_shell", "file": "points.csv"},
        rendering={"algorithm": "mean", **PLAIN},
    )
    bench.hapbench("validate", shell, "--points", "shell.csv")
    table = Table(bench.folder / "shell.csv")
    order = np.lexsort(points.T)
    found = np.lexsort(table.vectors(*table.names).T)
    for i, name in enumerate(("x_m", "y_m", "z_m", "nx", "ny", "nz")):
        bench.add(
            f"shell.csv:{name}",
            table[name][found],
            points[order, i],
            "of the file, in some order",
            EXACT,
            ("of another column", points[order, (i + 1) % 6]),
        )


@scene
def sampled_finer(bench):
    """Laws on a plane at half and a quarter of the step and of the distance of its points: single
    runs, measured at the same times."""
    laws, by, scene_name = (
        ["summation", "proxy", "shaped_stiffness", "highest_depth"],
        ["force_step_p99_N", "force_max_N"],
        "plane_wiped_round",
    )
    spaced = lambda part: ["--set", f"environment.spacing_m={0.0004 / part}"]
    said = bench.json(
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

    own = {law: measured(law, 1, 1) for law in laws}
    finer = {
        law: {
            "spacing": [measured(law, part, 1) for part in (2, 4)],
            "step": [measured(law, 1, part) for part in (2, 4)],
        }
        for law in laws
    }
    for m, row in enumerate(said):
        for part in ("spacing", "step"):
            # No less than the runs are apart; where an order is seen, 1.25 |f - f*| takes its
            # place. Bins of p99 are 1.6 % wide.
            far = [max(abs(own[law][m] - runs[m]) for runs in finer[law][part]) for law in laws]
            least = [
                n[f"error_of_{part}"] is None
                or n[f"error_of_{part}"] > 0.9 * f - 0.02 * own[law][m]
                for n, f, law in zip(row["numbers"], far, laws)
            ]
            bench.add(
                f"compare --json: error_of_{part}",
                least,
                [True] * 4,
                "no less than single runs are apart",
                EXACT,
                ("less", [False] * 4),
            )
        values = {n["algorithm"]: (n["value"], n["error_estimate"]) for n in row["numbers"]}
        apart = lambda a, b: values[b][0] - values[a][0] > values[a][1] + values[b][1]
        place = {law: i for i, group in enumerate(row["order"]) for law in group}
        pairs = [(a, b) for a in place for b in place if a != b]
        bench.add(
            "compare --json: order",
            [place[a] < place[b] for a, b in pairs],
            [apart(a, b) for a, b in pairs],
            "by the numbers and errors beside it",
            EXACT,
            ("the other way round", [place[a] >= place[b] for a, b in pairs]),
        )
        order = " < ".join(" ~ ".join(group) for group in row["order"])
        bench.add(
            "compare --json: says",
            order in row["says"] and row["says"].startswith("no significant order") == ("<" not in order),
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
    said = bench.json(
        "compare", springs, "--algorithms", "mean,summation", "--errors", "--out", "springs"
    )["errors"]
    bench.add(
        "compare --json: error_of_spacing",
        [n["error_of_spacing"] for row in said for n in row["numbers"]],
        [None] * (2 * len(said)),
        "springs have no points",
        EXACT,
        ("none", [0.0] * (2 * len(said))),
    )


def verdict_on(f):
    """Order, Richardson's value and its error of three results at steps that are halved, with
    Roache's factor."""
    p = math.log2((f[-3] - f[-2]) / (f[-2] - f[-1]))
    limit = f[-1] + (f[-1] - f[-2]) / (2**p - 1)
    return p, limit, 1.25 * np.abs(f - limit)


@scene
def convergence_in_thirds(bench):
    """Leapfrog on one damped spring at steps that are divided by r = 3: with the differences d of
    successive levels the order is p = log(d_1 / d_2) / log r, and Richardson's value is
    f + (f - f_before) / (r^p - 1)."""
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
    ask = ("converge", base, "--metric", "final_position_m.x", "--levels", "4", "--ratio", r)
    printed = bench.json(*ask, "--out", bench.folder / "thirds")
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
    """Leapfrog on one damped spring at five steps, where it is after the same time: orders and
    limit by hand of a recurrence."""
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
    )  # of the three before the last, the more severe
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
    """The error that compare gives a number: that of the coarsest of three levels."""
    error = verdict_on(f[:3])[2][0]
    (said,) = bench.json(
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
    number = said["numbers"][0]
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
    """converge_levels.csv: steps, results, orders and errors of each level."""
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
