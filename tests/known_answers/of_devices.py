"""Known answers for the comparison of devices by `limit`, from the motion of linear recurrences."""
import math

import numpy as np

from answers import EXACT, ROUNDING, Table, Within, scene
from physics import PLAIN, bisected, class_of, held_loop, high_pass, limit_of, motion_of


@scene
def devices(bench):
    """Checks the stiffness limits of devices on two springs and at a unilateral wall. The known limits follow from the
    motion of the sampled loop and scipy's high-pass filter."""
    m, b, T, B, n, resolution, max_vibration = 0.1, 0.5, 0.001, 2.0, 2000, 1e-3, 1e-3
    (bench.folder / "mine.json").write_text(
        '{"type":"impedance","handle_mass_kg":0.1,"viscous_N_s_per_m":0.5}', encoding="utf-8"
    )
    common = dict(
        time={"step_s": T, "steps": n},
        initial={"position_m": [1e-3, 0, 0]},
        device={"type": "impedance", "preset": "omega.3"},
        rendering={**PLAIN, "algorithm": "summation", "damping_N_s_per_m": B},
    )
    del common["rendering"]["mass_kg"], common["rendering"]["damping_ratio"]
    bench.scenario(
        "both_ways",
        environment={"type": "springs", "groups": [{"direction": [1, 0, 0], "count": 2}]},
        **common,
    )
    hand = {
        "type": "mass_spring_damper",
        "mass_kg": 0.2,
        "stiffness_N_per_m": 300,
        "damping_N_s_per_m": 2,
        "target": {"x_m": 0.01, "y_m": 0, "z_m": 0},
    }
    bench.scenario(
        "pushes",
        environment={
            "type": "springs",
            "bilateral": False,
            "groups": [{"direction": [1, 0, 0], "count": 1}],
        },
        hand=hand,
        **common,
    )
    printed = bench.json(
        "limit",
        "both_ways.json",
        "pushes.json",
        "--device",
        "mine.json,omega.3",
        "--friction",
        "none",
        "--algorithms",
        "summation,mean",
        "--stable",
        "still",
        "--resolution",
        resolution,
        "--out",
        "d",
    )
    table, runs = Table(bench.folder / "d" / "limit.csv"), Table(
        bench.folder / "d" / "limit_runs.csv"
    )
    cell = {(row["device"], row["scenario"], row["algorithm"]): row for row in table.rows}
    number = lambda row, name: float(row[name]) if row[name] else math.nan
    loop = lambda K, lam, m=m, b=b: held_loop(m, b, T, lam * K, lam * B)

    def vibration(*of):
        v = motion_of(loop(*of), 1e-3, n)
        return (
            math.inf if v is None else math.sqrt(np.mean(high_pass(v[:, None], T)[n // 4 :] ** 2))
        )

    stiffer, keys = (2.0, 1.0), [("mine", "both_ways", "summation"), ("mine", "both_ways", "mean")]
    exact_limits = [
        bisected(lambda K: vibration(K, lam) <= max_vibration, 100.0, 1e5, 1e-7) for lam in stiffer
    ]
    theory = [limit_of(lambda K: loop(K, lam), 100.0, 1e5) for lam in stiffer]
    fine = Within("bisection ends at a relative width of 1e-3", relative=1e-3)
    limits = [number(cell[key], "limit") for key in keys]
    rows = [
        [row for row in runs.rows if (row["device"], row["scenario"], row["algorithm"]) == key]
        for key in keys
    ]
    tried, printed_classes = [
        [float(row["rendering.stiffness_N_per_m"]) for row in of] for of in rows
    ], [row["class"] for of in rows for row in of]
    judged = [
        [
            "stable"
            if vibration(K, lam) <= max_vibration
            else "diverged"
            if class_of(loop(K, lam), 1e-3, n) == "diverged"
            else "vibrating"
            for K in values
        ]
        for lam, values in zip(stiffer, tried)
    ]
    beyond = [min(K for K in values if K > limit) for values, limit in zip(tried, limits)]
    how = "handle's speed above 30 Hz by the held loop and scipy"
    exact = [
        ("limit", exact_limits, fine, "edge of the eigenvalues", theory),
        ("first_unstable", beyond, EXACT, "the limit", limits),
        ("stable_low", [min(v) for v in tried], EXACT, "the limit", limits),
        ("unstable_below", [math.nan] * 2, EXACT, "0", [0.0] * 2),
        (
            "vibration_m_per_s",
            [vibration(K, lam) for K, lam in zip(limits, stiffer)],
            Within(
                "filter and recurrence in another order, over 2000 " "rows near the edge",
                relative=1e-6,
            ),
            "that is allowed",
            [max_vibration] * 2,
        ),
        ("contacts", [2.0, 2.0], EXACT, "by stiffness", [2.0, 1.0]),
        ("lambda_max", [2.0, 1.0], ROUNDING, "of each spring", [1.0, 1.0]),
        (
            "stiffness_ratio",
            [1.0, limits[1] / limits[0]],
            ROUNDING,
            "the other way round",
            [1.0, limits[0] / limits[1]],
        ),
        (
            "rendered_ratio",
            [1.0, limits[1] / limits[0] / 2],
            ROUNDING,
            "of K",
            [1.0, limits[1] / limits[0]],
        ),
        ("runs", [len(v) for v in tried], EXACT, "of the scan", [17.0, 17.0]),
        ("non_monotonic_runs", [0.0] * 2, EXACT, "beyond", [1.0] * 2),
    ]
    for name, known, within, naive, value in exact:
        bench.add(
            f"limit.csv:{name}",
            [number(cell[key], name) for key in keys],
            known,
            how,
            within,
            (naive, value),
        )
    row_of = {(row["device"], row["scenario"], row["algorithm"]): row for row in printed["limits"]}
    widths = [x - limit for x, limit in zip(beyond, limits)]
    bench.add(
        "limit --json: limit_tolerance",
        [row_of[key]["limit_tolerance"] for key in keys],
        widths,
        "from the limit to the next tried",
        ROUNDING,
        ("the resolution asked", [resolution * limit for limit in limits]),
    )
    limits_of_both_ends(bench, fine, how, max_vibration, resolution, vibration)
    classes = [j[v.index(x)] for j, v, x in zip(judged, tried, beyond)]
    bench.add(
        "limit.csv:first_unstable_class",
        [cell[key]["first_unstable_class"] for key in keys],
        classes,
        how,
        EXACT,
        ("diverged", ["diverged"] * 2),
    )
    bench.add(
        "limit_runs.csv:class",
        printed_classes,
        judged[0] + judged[1],
        how,
        EXACT,
        (
            "by the eigenvalues",
            [
                "stable" if K < limit else "diverged"
                for values, limit in zip(tried, theory)
                for K in values
            ],
        ),
    )
    names_of_devices(bench, number, runs, table)
    linear_limit_of_device(bench, B, T, b, cell, m, number, printed, theory)


def linear_limit_of_device(bench, B, T, b, cell, m, number, printed, theory):
    """Checks the linear limit of a device that a hand holds, by the eigenvalues of the sampled loop."""
    pushed = ("mine", "pushes", "summation")
    linear = limit_of(lambda K: held_loop(m + 0.2, b + 2, T, K, B, spring=300), 100.0, 1e6)
    close = Within("an edge by eigenvalues, bisected to 1e-9 or better", relative=1e-8)
    bench.add(
        "limit.csv:linear_limit",
        number(cell[pushed], "linear_limit"),
        linear,
        "eigenvalues of the held loop with the hand",
        close,
        ("without the hand", 2 * theory[0]),
    )
    alone = {(r["device"], r["scenario"]): r["unstable_without_contact"] for r in printed["limits"]}
    bench.add(
        "limit --json: unstable_without_contact",
        alone["mine", "pushes"],
        False,
        "handle and hand are passive",
        EXACT,
        ("with the wall", True),
    )


def names_of_devices(bench, number, runs, table):
    """Checks device, scene and law of each row, and the stiffness limit that is published for the device."""
    order = [
        (d, s, a)
        for d in ("mine", "omega.3")
        for s in ("both_ways", "pushes")
        for a in ("summation", "mean")
    ]
    for i, name in enumerate(("device", "scenario", "algorithm")):
        bench.add(
            f"limit.csv:{name}",
            table[name],
            [key[i] for key in order],
            "devices, scenes, algorithms",
            EXACT,
            ("reversed", [key[i] for key in order[::-1]]),
        )
        bench.add(
            f"limit_runs.csv:{name}",
            list(dict.fromkeys(runs[name])),
            list(dict.fromkeys(key[i] for key in order)),
            "devices, scenes, algorithms",
            EXACT,
            ("reversed", list(dict.fromkeys(key[i] for key in order[::-1]))),
        )
    of_maker = [number(row, "published_N_per_m") for row in table.rows]
    bench.add(
        "limit.csv:published_N_per_m",
        of_maker,
        [math.nan] * 4 + [5000.0] * 4,
        "CHAI3D's largest stiffness for an omega.3",
        EXACT,
        ("its maker's closed loop", [math.nan] * 4 + [14500.0] * 4),
    )


def limits_of_both_ends(bench, fine, how, max_vibration, resolution, vibration):
    """Checks the stiffness limits at both ends of the ranges of a preset's unpublished parameters. The ends are the
    mass divided and multiplied by 1.3, and a viscous friction of 0.5 and 5 N s/m."""
    # Without dry friction, encoder and saturation, the only estimated parameters of an omega.3 are its mass and viscous
    # friction.
    bare = [
        word
        for field in ("coulomb_N=0", "encoder_step_m=0", "force_max_N=null")
        for word in ("--set", f"device.{field}")
    ]
    others = bench.json(
        "limit",
        "both_ways.json",
        "--device",
        "omega.3",
        *bare,
        "--algorithms",
        "mean",
        "--stable",
        "still",
        "--resolution",
        resolution,
        "--out",
        "i",
    )["limits"]
    ends = [
        bisected(lambda K: vibration(K, 1.0, of, viscous) <= max_vibration, 100.0, 1e6, 1e-7)
        for of, viscous in ((0.2, 0.5), (0.2 / 1.3, 0.5), (0.2 * 1.3, 5.0))
    ]
    bench.add(
        "limit.csv:device",
        [row["device"] for row in others],
        ["omega.3*", "omega.3*[soft]", "omega.3*[stiff]"],
        "both ends by default",
        EXACT,
        ("the preset alone", ["omega.3*"]),
    )
    bench.add(
        "limit.csv:limit",
        [row["limit"] for row in others],
        ends,
        how,
        fine,
        ("of the preset's own numbers", [ends[0]] * 3),
    )


@scene
def touch_at_the_limit(bench):
    """Checks the speed at the first contact and the force of the hand in the run at a limit. A constant force moves a
    free handle with viscous friction: v = F / b (1 - exp(-b t / m)), and x is its integral."""
    m, b, T, F, start = 0.1, 0.5, 0.001, 0.5, -2e-3
    bench.scenario(
        "arrives",
        time={"step_s": T, "steps": 3000},
        environment={
            "type": "springs",
            "bilateral": False,
            "groups": [{"direction": [1, 0, 0], "count": 1}],
        },
        initial={"position_m": [start, 0, 0]},
        device={"type": "impedance", "handle_mass_kg": m, "viscous_N_s_per_m": b},
        hand={"type": "force", "x_N": F},
        rendering={"algorithm": "summation", "stiffness_N_per_m": 500, "damping_N_s_per_m": 2},
    )
    bench.json("limit", "arrives.json", "--resolution", 0.01, "--out", "a")
    t = T * np.arange(3000)
    v = F / b * (1 - np.exp(-b / m * t))
    x = start + F / b * (t - m / b * (1 - np.exp(-b / m * t)))
    touch = int(np.argmax(x > 0))
    row = Table(bench.folder / "a" / "limit.csv").rows[0]
    exact = Within("exponentials of one step, raised to the 90th power", relative=1e-12)
    how = "motion of a free handle under a constant force"
    number = float(row["touch_speed_m_per_s"])
    bench.add(
        "limit.csv:touch_speed_m_per_s",
        number,
        v[touch],
        how,
        exact,
        ("a step before", v[touch - 1]),
    )
    bench.add(
        "limit.csv:hand_force_max_N", float(row["hand_force_max_N"]), F, how, EXACT, ("none", 0.0)
    )
