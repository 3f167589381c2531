"""Known answers for the table of `sweep`, recomputed from the summaries of single runs."""
import math

from answers import EXACT, Table, scene
from physics import PLAIN, UP


@scene
def swept(bench):
    """Checks that the rows of a sweep equal single runs."""
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
    printed = bench.json(
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
    # 4e6 N/m is ten times the stability limit 4 M / dt^2, so that this run diverges.
    for key, known, naive in (
        ("unexpected", 1, 0),
        ("completes", 3, 4),
        ("diverges", 1, 0),
        ("file", "sweep/sweep.csv", "sweep.csv"),
    ):
        bench.add(
            f"sweep --json: {key}",
            printed.get(key, printed["outcomes"].get(key)),
            known,
            "one of four is unstable",
            EXACT,
            ("those that complete, or all", naive),
        )
    bench.add(
        f"sweep --json: {field}",
        [row[field] for row in printed["rows"]],
        values,
        "as asked",
        EXACT,
        ("of the scenario", [1000.0] * 4),
    )
    bench.add(
        "sweep --json: definition",
        printed["definition"]
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
