"""Known answers for printed words: outcomes of runs, and the classes of motion by which `limit` finds limits."""
import math

from answers import EXACT, ROUNDING, Table, Within, scene
from physics import PLAIN, SPRING, bisected, class_of, radius, step_matrix

FLAT = {"type": "plane", "size_m": 0.1, "spacing_m": 0.001}
BALL = {"type": "bur", "family": "ball", "diameter_m": 0.004}


@scene
def ends(bench):
    """Checks runs whose outcome follows from physics. Each row has the word for this outcome, and a wrong word that
    only looks plausible."""
    time = {"step_s": 0.0005, "steps": 1000}
    free = {"rendering": {**PLAIN, "algorithm": "summation"}}
    pressed = {
        "environment": FLAT,
        "tool": BALL,
        "time": time,
        "initial": {"position_m": [0, 0, 0.002]},
    }
    highest = {**PLAIN, "algorithm": "highest_depth", "damping_ratio": 2.0}
    rub = {
        "algorithm": "shaped_stiffness",
        "stiffness_N_per_m": 20000,
        "damping_ratio": 1.0,
        "mass_kg": 0.4,
    }
    slope = {
        "up": [0, 0, 1],
        "lean": [1, 0, 0],
        "tilt_rad": {"type": "ramp", "start": 0.1, "rate_per_s": 5.0},
        "azimuth_rad": 0,
    }

    def drag(force, stiffness):
        return {
            "type": "drag",
            "force_N": force,
            "path_m": [[-0.04, 0, 0], [0.04, 0, 0]],
            "speed_m_per_s": 0.02,
            "stiffness_N_per_m": stiffness,
            "damping_N_s_per_m": 0,
        }

    on_flat = {
        "environment": FLAT,
        "tool": BALL,
        "time": {"step_s": 0.0005, "steps": 8000},
        "initial": {"position_m": [-0.04, 0, 0.002]},
    }
    grips = {"type": "waypoints", "points": [[0, 0.1], [1.0, 0.1], [1.1, 9.0], [4, 9.0]]}
    scenes = [
        # The motion on an undamped spring is bounded for a stiffness below 4 M / dt^2 = 1.6e6 N/m, and unbounded above
        # it.
        (
            "completes",
            dict(
                time=time,
                environment=SPRING,
                initial={"position_m": [1e-3, 0, 0]},
                rendering={**free["rendering"], "stiffness_N_per_m": 1.59e6},
            ),
            "diverges",
            1000,
        ),
        (
            "diverges",
            dict(
                time=time,
                environment=SPRING,
                initial={"position_m": [1e-3, 0, 0]},
                rendering={**free["rendering"], "stiffness_N_per_m": 1.7e6},
            ),
            "completes",
            None,
        ),
        # y_k = -1.02 mm + k 0.05 mm first exceeds 0 at k = 21.
        (
            "leaves_hole",
            dict(
                time={**time, "stop_when": ["leaves_hole"]},
                environment={"type": "springs", "groups": []},
                initial={"position_m": [0, -1.02e-3, 0], "velocity_m_per_s": [0, 0.1, 0]},
                **free,
            ),
            "completes",
            22,
        ),
        # 0.1 + 5 t first reaches pi / 2 at k = 589 (0.2945 s).
        (
            "tool_horizontal",
            dict(
                time={**time, "stop_when": ["tool_horizontal"]},
                environment={"type": "springs", "groups": []},
                motion={"orientation": slope},
                **free,
            ),
            "completes",
            590,
        ),
        (
            "no_contact",
            dict(pressed, initial={"position_m": [0, 0, 0.01]}, **free),
            "completes",
            1000,
        ),
        # A force of 1 N moves 0.1 kg by 1.25 m in 0.5 s, away from a plane of 0.1 m.
        (
            "lost_contact",
            dict(
                pressed,
                hand={"type": "force", "z_N": 1.0},
                rendering={**free["rendering"], "stiffness_N_per_m": 1},
                initial={"position_m": [0, 0, 0.00199]},
            ),
            "completes",
            1000,
        ),
        # The depth of a contact is at most the radius r of the ball: the largest force K r = 2 N cannot balance 3 N.
        (
            "went_through",
            dict(pressed, hand={"type": "force", "z_N": -3.0}, rendering=highest),
            "completes",
            1000,
        ),
        # Friction of 300 N s/m against a hand of 1 N/m has a time constant of 300 s, while the path takes 4 s.
        (
            "not_dragged",
            dict(
                on_flat,
                hand=drag(0.5, 1.0),
                rendering={**rub, "friction": {"mu_s_N_s_per_m": 300, "mu_f_s_per_m": 0}},
            ),
            "completes",
            8000,
        ),
        # Friction increases from 20 to 1355 N s/m. Against a hand of 40 N/m, the time constants are 0.5 and 34 s.
        (
            "stuck",
            dict(
                on_flat,
                hand=drag(grips, 40.0),
                rendering={**rub, "friction": {"mu_s_N_s_per_m": 5, "mu_f_s_per_m": 150}},
            ),
            "completes",
            8000,
        ),
    ]
    for word, fields, glance, rows in scenes:
        run = bench.run(bench.scenario(f"end_{word}", **fields), statuses=(0, 3))
        bench.add(
            f"{word} (outcome of a run)",
            run.summary["outcome"],
            word,
            "physics: see the scene",
            EXACT,
            ("what the step count says", glance),
        )
        if rows:
            bench.add(
                "run --json: duration_s",
                run.summary["duration_s"],
                rows * 0.0005,
                "rows times dt",
                ROUNDING,
                ("to the last row", (rows - 1) * 0.0005),
            )
            bench.add(
                "run --json: steps",
                run.summary["steps"],
                rows,
                "rows",
                EXACT,
                ("last row's number", rows - 1),
            )
        failure = word not in ("completes", "leaves_hole", "tool_horizontal")
        bench.add(
            "run --json: expected",
            run.summary["expected"],
            not failure,
            "by default a run completes or is stopped",
            EXACT,
            ("unasked", failure),
        )
        bench.add(
            "run --json: outcome",
            run.summary["outcome"],
            word,
            "physics",
            EXACT,
            ("what the step count says", glance),
        )
        if word == "diverges":
            divergence(bench, run)
    classes(bench)


def classes(bench):
    """Checks the classes of runs that do not vibrate but are not valid: for example, the tool goes through the surface
    or loses contact."""
    words = ("--vary", "rendering.stiffness_N_per_m", "--between")
    row = bench.json(
        "limit",
        "end_went_through.json",
        *words,
        "500:5000",
        "--smallest",
        "--set",
        "time.steps=4000",
        "--resolution",
        "1e-3",
        "--out",
        "through",
    )["limits"][0]
    bench.add(
        "limit.csv:limit",
        row["limit"],
        1500.0,
        "3 N over the radius of 2 mm",
        Within(
            "bisection ends at 1e-3, and an overdamped tool "
            "is given 2 s, within which it comes to e^(-2 K / B) of its end",
            relative=5e-3,
        ),
        ("any, as a bur never vibrates", 500.0),
    )
    bench.add(
        "went_through (class of motion, of limit and stability)",
        row["first_unstable_class"],
        "went_through",
        "K r < 3 N",
        EXACT,
        ("a tool at rest in free fall is stable", "stable"),
    )
    # The scene has two patches of points. The tool is dragged off the first patch and sinks at 0.02 m/s = 1 N / (50 N
    # s/m). At the end, the distance of the tool from the bounding box of the points is less than the tool's reach.
    bench.write(
        "gap.csv",
        "x_m,y_m,z_m,nx,ny,nz",
        [
            (x * 1e-3, y * 1e-3, 0, 0, 0, 1)
            for x in (*range(-20, 1), *range(30, 41))
            for y in range(-4, 5)
        ],
    )
    bench.scenario(
        "end_gap",
        environment={"type": "point_shell", "file": "gap.csv"},
        tool=BALL,
        time={"step_s": 0.0005, "steps": 2000},
        initial={"position_m": [-0.01, 0, 0.002]},
        rendering={
            **PLAIN,
            "algorithm": "shaped_stiffness",
            "damping_ratio": 2.0,
            "stiffness_N_per_m": 20000,
        },
        hand={
            "type": "drag",
            "force_N": 1.0,
            "path_m": [[-0.01, 0, 0], [0.035, 0, 0]],
            "speed_m_per_s": 0.02,
        },
    )
    for word, end, between in (
        ("thrown_out", "lost_contact", "500:5000"),
        ("no_contact", "no_contact", "500:5000"),
        ("lost_contact", "gap", "19000:21000"),
        ("not_dragged", "not_dragged", "19000:21000"),
        ("stuck", "stuck", "19000:21000"),
    ):
        out = bench.folder / word
        bench.hapbench(
            "limit", f"end_{end}.json", *words, between, "--resolution", "0.5", "--out", out
        )
        found = Table(out / "limit_runs.csv")["class"]
        bench.add(
            f"{word} (class of motion, of limit and stability)",
            found,
            [word] * len(found),
            "physics, as of the outcome",
            EXACT,
            ("a tool that does not vibrate is stable", ["stable"] * len(found)),
        )


def divergence(bench, run):
    x, v, M, dt, K = 1e-3, 0.0, 0.1, 0.0005, 1.7e6
    divergence, k = run.summary["divergence"], 0
    within = lambda: abs(x) <= 1e3 and abs(v) <= 1e6 and abs(K * x) <= 1e12
    while within():
        v -= K * x * dt / M
        x += v * dt
        k += 1
    grown = Within("the recurrence in another order of operations, over 100 steps", relative=1e-10)
    quantity, size, bound = ("position", abs(x), 1e3) if abs(x) > 1e3 else ("velocity", abs(v), 1e6)
    for key, known, naive in (
        ("step", k, k - 1),
        ("time_s", k * dt, k),
        ("magnitude", size, bound),
        ("bound", bound, size),
    ):
        bench.add(
            f"run --json: {key}",
            divergence[key],
            known,
            "recurrence against the bounds",
            grown,
            ("the row before, or the other", naive),
        )
    bench.add(
        "run --json: quantity",
        divergence["quantity"],
        quantity,
        "recurrence against the bounds",
        EXACT,
        ("the first thing checked", "force"),
    )
    # Leapfrog without damping is stable up to K = 4 M / dt^2. `share` is K divided by this limit.
    findings, share = run.summary["diagnosis"], K * dt**2 / (4 * M)
    finding = next(one for one in findings if one["rule"] == "edge")
    cells = [
        ("value", share, "half the edge, of a step of the speed alone", 2 * share),
        ("threshold", 0.8, "the edge itself", 1.0),
        ("unit", "1", "of K", "N/m"),
        (
            "says",
            f"K is {share:.3g} times the linear stability limit",
            "as if stable",
            "K is 0.5 times",
        ),
    ]
    for name, known, naive, value in cells:
        bench.add(
            f"run --json: diagnosis.{name}",
            finding[name],
            known,
            "4 - K dt^2 / M = 0",
            EXACT,
            (naive, value),
        )
    bench.add(
        "run --json: diagnosis.rule",
        [finding["rule"] for finding in findings][:2],
        ["diverged", "edge"],
        "what happened, then why",
        EXACT,
        ("what happened alone", ["diverged"]),
    )
    for name, words in (
        ("number", "K divided by the linear limit"),
        ("try", "a shorter time.step_s"),
    ):
        bench.add(
            f"run --json: diagnosis.{name}",
            words in finding[name],
            True,
            "4 - K dt^2 / M = 0",
            EXACT,
            ("another cause", False),
        )


@scene
def limit_of_spring(bench):
    """Checks the stability limit of the stiffness K of one damped spring. The recurrence determines the class of each
    run. The linear limit satisfies 4 - 2 B dt / M - K dt^2 / M = 0, with the damping B, the mass M and the step dt.
    """
    M, dt, n, zeta, resolution = 0.1, 0.0005, 400, 0.02, 1e-4
    base = bench.scenario(
        "limit_of_spring",
        time={"step_s": dt, "steps": n},
        environment=SPRING,
        initial={"position_m": [1e-3, 0, 0]},
        rendering={
            **PLAIN,
            "algorithm": "summation",
            "damping_ratio": zeta,
            "stiffness_N_per_m": 20000,
        },
    )
    field = "rendering.stiffness_N_per_m"
    command = (
        "limit",
        base,
        "--vary",
        field,
        "--between",
        "1e3:1e7",
        "--resolution",
        resolution,
        "--out",
        "spring",
    )
    printed = bench.json(*command)
    table, runs = Table(bench.folder / "spring" / "limit.csv"), Table(
        bench.folder / "spring" / "limit_runs.csv"
    )
    matrix = lambda K: step_matrix(K, 2 * zeta * math.sqrt(K * M), M, dt)
    theory = M * (2 * (math.sqrt(1 + zeta**2) - zeta)) ** 2 / dt**2
    judged = lambda K: class_of(matrix(K), 1e-3, n)
    values = runs[field]
    classes = [judged(K) for K in values]
    coarse = ["stable" if radius(matrix(K)) < 1 else "diverged" for K in values]
    bench.add(
        "limit_runs.csv:class",
        runs["class"],
        classes,
        "rule on the recurrence",
        EXACT,
        ("stable where the eigenvalues are", coarse),
    )
    bench.add(
        "limit_runs.csv:{field}",
        len(set(values)),
        len(values),
        "each value once",
        EXACT,
        ("both ends twice", len(values) - 1),
    )
    for word in ("stable", "decaying", "vibrating", "diverged"):
        at = [i for i, name in enumerate(classes) if name == word]
        bench.add(
            f"{word} (class of motion, of limit and stability)",
            [runs["class"][i] for i in at],
            [word] * len(at),
            "rule on the recurrence",
            EXACT,
            ("by the eigenvalues", [coarse[i] if word != coarse[i] else "" for i in at]),
        )
    # A motion decays if its amplitude decreases by at least a tenth from each quarter of the run to the next. The limit
    # of this condition is below the linear limit.
    rests = lambda K: judged(K) in ("stable", "decaying")
    stable = [K for K, name in zip(values, classes) if name in ("stable", "decaying")]
    limit, beyond, strongest = (
        max(stable),
        min(K for K in values if K > max(stable)),
        bisected(rests, 1e6, theory),
    )
    low, below = min(stable), max(K for K in values if K < min(stable))
    slowest = bisected(lambda K: not rests(K), below, low)
    strip = Within("bisection ends at a relative width of 1e-4", relative=resolution)
    row = printed["limits"][0]
    cells = [
        ("algorithm", "summation", EXACT, "mean"),
        ("field", field, EXACT, "K"),
        ("side", "largest", EXACT, "smallest"),
        ("limit", strongest, strip, 4 * M / dt**2),
        ("first_unstable", beyond, EXACT, limit),
        ("first_unstable_class", classes[list(values).index(beyond)], EXACT, "vibrating"),
        ("stable_low", slowest, strip, 1000.0),
        ("unstable_below", below, EXACT, 1000.0),
        ("unstable_below_class", "vibrating", EXACT, "stable"),
        ("stable_high", limit, EXACT, beyond),
        ("unstable_above", beyond, EXACT, limit),
        ("unstable_above_class", classes[list(values).index(beyond)], EXACT, "vibrating"),
        ("theoretical_limit", theory, Within("bisected to 1e-12", relative=3e-12), 4 * M / dt**2),
        ("linear_limit", math.nan, EXACT, theory),
        ("undecided_runs", 0, EXACT, sum(name == "vibrating" for name in classes)),
        ("runs", len(values), EXACT, 17),
        ("non_monotonic_runs", 0, EXACT, 1),
        ("tried_between", 48, EXACT, 56),
        ("may_fail_share", 1 - 0.05 ** (1 / 48), ROUNDING, 0.05),
    ]
    for name, known, within, naive in cells:
        bench.add(
            f"limit.csv:{name}",
            table[name][0],
            known,
            "rule on the recurrence, and the eigenvalues",
            within,
            ("of the eigenvalues alone, or the value beside", naive),
        )
    for key, known, naive in (
        ("limit_tolerance", beyond - limit, resolution * limit),
        ("high_tolerance", beyond - limit, resolution * limit),
        ("low_tolerance", low - below, resolution * low),
    ):
        bench.add(
            f"limit --json: {key}",
            row[key],
            known,
            "from the last stable value to the next tried",
            ROUNDING,
            ("the resolution asked", naive),
        )
    digits(bench, base, field)
    words_of_limit(bench, base, printed, resolution, row)
    limit_under_bound(bench, base, field, strip)


def limit_under_bound(bench, base, field, strip):
    """Checks the limit of the stiffness K under a bound on the force. The force is largest at the start, where it is K
    times 1 mm, as long as damping removes more energy than the integrator adds."""
    command = (
        "limit",
        base,
        "--vary",
        field,
        "--between",
        "1e3:1e5",
        "--resolution",
        "1e-4",
        "--out",
        "bound",
        "--bound",
        "force_max_N=30",
    )
    row = bench.json(*command)["limits"][0]
    bench.add(
        "limit.csv:limit",
        row["limit"],
        30000.0,
        "bound over the start's 1 mm",
        strip,
        ("the stable limit", 1e5),
    )
    bench.add(
        "beyond_bound (class of motion, of limit and stability)",
        row["first_unstable_class"],
        "beyond_bound",
        "K 1 mm > 30 N",
        EXACT,
        ("it is stable", "stable"),
    )


def words_of_limit(bench, base, printed, resolution, row):
    """Checks entries of the JSON of `limit` that repeat its options or answer yes or no. The varied field changes the
    runs."""
    for key, known, naive in (
        ("from", 1e3, 1.0),
        ("to", 1e7, 1e6),
        ("resolution", resolution, 1e-3),
        ("has_effect", True, False),
        ("unstable_without_contact", False, True),
        ("no_contiguous_interval", False, True),
    ):
        bench.add(
            f"limit --json: {key}",
            printed[key] if key in printed else row[key],
            known,
            "as asked; one spring, and no device",
            EXACT,
            ("a default", naive),
        )
    bench.add(
        "limit --json: rule",
        "comes to rest or its oscillation decays" in printed["rule"],
        True,
        "describe stability",
        EXACT,
        ("bounded", False),
    )
    unmoved = bench.json(
        "limit", base, "--vary", "rendering.iterations", "--between", "1:9", "--out", "none"
    )["limits"][0]
    bench.add(
        "limit --json: has_effect",
        unmoved["has_effect"],
        False,
        "summation has no iterations",
        EXACT,
        ("as a limit was found", True),
    )


def digits(bench, base, field):
    """Checks the rounding of a limit in the printed table, for three values of --resolution: the last printed digit has
    the position of the first non-zero digit of limit_tolerance, the width of the interval around the limit.
    """
    for resolution in (0.1, 1e-3, 1e-5):
        command = (
            "limit",
            base,
            "--vary",
            field,
            "--between",
            "1e5:1e7",
            "--resolution",
            resolution,
            "--out",
            "digits",
        )
        row, text = bench.json(*command)["limits"][0], bench.hapbench(*command)
        cell = next(line for line in text.splitlines() if line.startswith("summation ")).split("  ")
        digit = 10.0 ** math.floor(math.log10(row["limit_tolerance"]))
        known = f"{math.floor(row['limit'] / digit) * digit:.{max(0, -round(math.log10(digit)))}f}"
        bench.add(
            "limit.csv:limit",
            known in [part.strip() for part in cell],
            True,
            "the table rounds the limit down, to the first digit of the width",
            EXACT,
            ("six digits", f"{row['limit']:.6g}" in [part.strip() for part in cell]),
        )
