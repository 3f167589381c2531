"""Known answers for subjects and targets: the time at which a target is reached, and means over subjects."""
import math

import numpy as np

from answers import EXACT, ROUNDING, norms, scene


@scene
def subjects(bench):
    """Checks means and standard errors over subjects. Each subject contributes the mean of its targets."""
    run = bench.run(
        "vertical_peg_in_hole_shaped_stiffness",
        "--set",
        "hand.trials=1",
        "--set",
        "expect={}",
        "--set",
        "hand.task.time_limit_s=3",
        out="subjects",
        statuses=(0, 3),
    )
    table, rows = run.table("targets.csv"), []
    for target in (0, 1):
        for field, column in (
            ("success_rate", "removed"),
            ("completion_time_s", "time_s"),
            ("model_force_N", "model_force_N"),
            ("speed_m_per_s", "speed_m_per_s"),
        ):
            at, value = table["place"] == target, table[column]
            known = at & ~np.isnan(value)
            means = np.array(
                [
                    value[known & (table["subject"] == subject)].mean()
                    for subject in np.unique(table["subject"][known])
                ]
            )
            pooled = value[known]
            name = f"targets.{target}.{field}"
            spread = means.std(ddof=1) / math.sqrt(len(means))
            removed, weight = table["removed"][known] == 1, table["rows_on_target"][known]
            wrong = {
                "success_rate": ("of subjects who removed all", np.mean(means == 1)),
                "completion_time_s": ("of removed targets alone", pooled[removed].mean()),
            }.get(field, ("weighted by rows", np.sum(weight * pooled) / weight.sum()))
            rows += [
                (
                    f"{name}.mean",
                    means.mean(),
                    "of the subjects' means in targets.csv",
                    ROUNDING,
                    *(wrong if target == 0 or field[0] in "ms" and field != "success_rate" else ()),
                ),
                (
                    f"{name}.standard_error",
                    spread,
                    "sample deviation over root of subjects",
                    ROUNDING,
                    "with n in place of n - 1",
                    means.std() / math.sqrt(len(means)),
                ),
                (
                    f"{name}.subjects",
                    len(means),
                    "subjects with a value",
                    EXACT,
                    "targets",
                    len(pooled),
                ),
            ]
    bench.metrics(run, rows)


@scene
def one_subject(bench):
    """Checks the targets of one subject by their rule. A target is reached if the tool stays within 0.2 mm of the
    target for 1 s without interruption while the force on the hand is at least 1 N. The target ends after 1.5 s. The
    force on the hand is the rendered force of the previous row."""
    run = bench.run(
        "vertical_peg_in_hole_shaped_stiffness",
        "--set",
        "hand.subjects=[{}]",
        "--set",
        "hand.trials=1",
        "--set",
        "expect={}",
        "--set",
        "hand.task.time_limit_s=1.5",
        "--set",
        "hand.task.targets_per_place=3",
        "--set",
        "record.trajectory=true",
        out="one",
        statuses=(0, 3),
    )
    table, rows = run.table("targets.csv"), run.table()
    positions = np.array([[0, 0], [0.00052, 0]])
    order = table["place"].astype(int)  # order in which the targets were drawn
    dt, tip, f = 1 / 2048, rows.vectors("px_m", "py_m"), rows.vectors("fx_N", "fy_N", "fz_N")
    found, active, shown, held, on = [], False, 0, 0, []

    def near(k):
        return (
            len(found) < len(order) and np.hypot(*(positions[order[len(found)]] - tip[k])) <= 0.0002
        )

    for k in range(len(tip)):
        if len(found) == len(order):
            break
        pressed = k > 0 and f[k - 1, 2] >= 1  # the force of the previous row acts on the hand
        if pressed and not active:
            active, shown = True, 0
        shown, held = shown + 1, held + 1 if pressed and near(k) else 0
        removed = held >= 2048
        if removed or shown >= 3072:
            found.append((removed, shown * dt, on))
            active, shown, held, on = False, 0, 0, []
        on += [k] if near(k) else []
    how = "the rule on the rows of trajectory.csv"
    counts = np.array([len(on) for _, _, on in found])
    known = [
        ("subject", np.zeros(6), "one", EXACT, "from 1", np.ones(6)),
        ("trial", np.zeros(6), "one", EXACT, "from 1", np.ones(6)),
        ("target", np.arange(6), "in order", EXACT, "from 1", np.arange(6) + 1),
        ("removed", [float(r) for r, _, _ in found], how, EXACT, "all", np.ones(6)),
        ("time_s", [t for _, t, _ in found], how, ROUNDING, "the hold", np.ones(6)),
        ("rows_on_target", counts, how, EXACT, "with the last", counts + 1),
        (
            "model_force_N",
            [norms(f[on]).mean() for _, _, on in found],
            how,
            ROUNDING,
            "its vertical part",
            [f[on, 2].mean() for _, _, on in found],
        ),
    ]
    bench.columns(table, known)
    bench.proven(
        "targets.csv:speed_m_per_s",
        "tests/results/observe/target_metrics_test.cpp",
        "TargetMetrics.MeansAreOverTheRowsOnTheTargetOfTheTrial",
        "EXPECT_EQ(observer.rows()[0].speed, 5.0)",
        "step(0.001, 100.0, 100.0);  // off the target",
    )
    first = sorted(order) == [0, 0, 0, 1, 1, 1]
    bench.add(
        "targets.csv:place",
        first,
        True,
        "three of each place, in an order that is drawn",
        EXACT,
        ("any", False),
    )
