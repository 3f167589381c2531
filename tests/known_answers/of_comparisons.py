"""Known answers for the tables of compare, recomputed from the summaries of separate runs."""
import math
from itertools import product

import numpy as np

from answers import EXACT, ROUNDING, Run, Table, scene
from physics import PLAIN, UP

LAWS = ["mean", "virtual_coupling", "summation", "shaped_stiffness"]
BY = ["force_step_p99_N", "velocity_total_variation_m_per_s", "contact_share"]
SEEDS = 14


def ranks_of(means, bad):
    """Returns the rank of each law. Laws without failed runs are ranked by their means, and means within 0.1 % share a
    rank. Laws with failed runs follow, ranked by their number of failed runs `bad`. Returns an empty dictionary if all
    ranks would be equal."""
    alike = lambda a, b: abs(means[a] - means[b]) <= 1e-3 * max(abs(means[a]), abs(means[b]))
    order = sorted((name for name in means if bad[name] == 0), key=means.get)
    leader, rank = {}, {}
    for i, name in enumerate(order):
        leader[i] = leader[i - 1] if i and alike(order[leader[i - 1]], name) else i
        rank[name] = 1 + leader[i]
    rank.update(
        {name: 1 + sum(bad[other] < bad[name] for other in LAWS) for name in LAWS if bad[name]}
    )
    return rank if len(set(rank.values())) > 1 else {}


def rows_of_ranking(scenes, runs):
    """Returns the known rows of ranking.csv, the rows of a naive definition, and the ranks of each law over all scenes
    and metrics. `runs`: Run by (scene, law, seed)."""
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
        ranked = metric != "contact_share"
        rank = ranks_of(means, bad)
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
        valid = [
            math.nan if runs[s, law, k].metric(metric) is None else runs[s, law, k].metric(metric)
            for k in range(SEEDS)
        ]
        naive.append(
            {
                "failed": 0,
                "mean": float(np.nanmean([*valid, 0.0])),
                "spread": number(np.std(values[law]) if law in means else None),
                "rank": 1 + LAWS.index(law),
                "common_seeds": SEEDS - bad[law],
                "seeds": SEEDS - bad[law],
            }
        )
        if ranked and law in rank:
            ranks[law].append(rank[law])
    return known, naive, ranks


@scene
def ranking(bench):
    """Checks the ranking of laws for a mass on two parallel springs, in two scenes. In the second scene, the springs
    are so stiff that leapfrog is unstable for most laws, and the motion from some starting positions exceeds the
    bounds. The known ranking follows from its definition: means over common seeds, and ranks of these means.
    """
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
    table = Table(out / "ranking.csv")
    known, naive, ranks = rows_of_ranking(scenes, runs)
    wrong_answers = {
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
            (wrong_answers[name], [row[name] for row in naive])
            if name in wrong_answers
            else ("in another order", column[::-1])
        )
        bench.add(
            f"ranking.csv:{name}",
            table[name],
            column,
            how,
            ROUNDING if name in ("mean", "spread") else EXACT,
            wrong,
        )
    order = [law["algorithm"] for law in printed["laws"]]
    # In the scene `thrown`, most laws have a stiffness of at least K = 400 050 N/m. Leapfrog's limit is 4 M / dt^2 =
    # 4e5 N/m. Only virtual coupling has a smaller stiffness, 2 K / 3.
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
def compared(bench):
    """Checks that comparison.csv contains the summaries of single runs, one for each law. Checks that shell.csv
    contains the points of the file of a point shell."""
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
