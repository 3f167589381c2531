"""Known answers for the tables of `limit` and `stress`, from eigenvalues and the motion of linear recurrences."""
import math

import numpy as np

from answers import EXACT, ROUNDING, Table, Within, scene
from physics import PLAIN, SPRING, SUMMED, bisected, class_of, held_loop, limit_of, radius


@scene
def limits_of_springs(bench):
    """Checks the stability limits of two parallel springs with the integrators leapfrog (section A.3 of the thesis) and
    rk4."""
    M, dt, zeta, lam, K = 0.1, 0.0005, 0.7, 2.0, 20000.0
    base = bench.scenario(
        "limits_of_springs",
        time={"step_s": dt, "steps": 20000},
        initial={"position_m": [1e-3, 0, 0], "velocity_m_per_s": [1e-3, 0, 0]},
        environment={"type": "springs", "groups": [{"direction": [1, 0, 0], "count": 2}]},
        rendering={
            **PLAIN,
            "algorithm": "summation",
            "damping_ratio": zeta,
            "stiffness_N_per_m": K,
        },
    )

    def limits_of(folder, *words):
        bench.json(
            "limit", base, "--stable", "bounded", "--resolution", "1e-4", *words, "--out", folder
        )
        return Table(bench.folder / folder / "limit.csv")

    tables = (
        limits_of("K", "--between", "1e3:1e9", "--over", "rendering.damping_ratio=0,0.7"),
        limits_of(
            "B",
            "--vary",
            "rendering.damping_N_s_per_m",
            "--between",
            "1:1e5",
            "--set",
            "rendering.stiffness_N_per_m=0",
        ),
        limits_of("dt", "--vary", "time.step_s", "--between", "1e-5:0.1"),
    )
    # 4 - 2 lam B dt / M - lam K dt^2 / M = 0 with B = 2 zeta sqrt(K M): a quadratic in
    # s = sqrt(K) dt / sqrt(M).
    s = -2 * zeta + math.sqrt(4 * zeta**2 + 4 / lam)
    value = [4 * M / (lam * dt**2), M * s * s / dt**2, 2 * M / (lam * dt), s * math.sqrt(M / K)]
    fine = Within("bisected to 1e-12, of eigenvalues near a double one to rounding", relative=1e-9)
    runs = Within("bisection ends at 1e-4; growth of 2e-6 a step is seen", relative=1.1e-4)
    wrong = ("of a single spring", [2 * value[0], 433731.0, 2 * value[2], 2 * value[3]])
    for column, within in (
        ("closed_form_limit", fine),
        ("theoretical_limit", fine),
        ("limit", runs),
    ):
        bench.add(
            f"limit.csv:{column}",
            np.concatenate([table[column] for table in tables]),
            value,
            "4 - 2 lam B dt / M - lam K dt^2 / M = 0",
            within,
            wrong,
        )
    # Stability limit of rk4: the amplification |1 + z + z^2/2 + z^3/6 + z^4/24| is 1 at z = i 2 sqrt 2 without damping,
    # and on the real axis at the root of z^3/24 + z^2/6 + z/2 + 1.
    rk4 = ("--set", "integrator.type=rk4")
    real = -np.roots([1 / 24, 1 / 6, 1 / 2, 1]).real[
        np.abs(np.roots([1 / 24, 1 / 6, 1 / 2, 1]).imag) < 1e-9
    ][0]
    of_rk4 = (
        limits_of("rk4_K", "--between", "1e3:1e9", "--set", "rendering.damping_ratio=0", *rk4),
        limits_of(
            "rk4_B",
            "--vary",
            "rendering.damping_N_s_per_m",
            "--between",
            "1:1e5",
            "--set",
            "rendering.stiffness_N_per_m=0",
            *rk4,
        ),
    )
    bench.add(
        "limit.csv:theoretical_limit",
        np.concatenate([table["theoretical_limit"] for table in of_rk4]),
        [8 * M / (lam * dt**2), real * M / (lam * dt)],
        "polynomial of Runge and Kutta's method",
        fine,
        ("leapfrog's", [value[0], value[2]]),
    )


@scene
def smallest_mass(bench):
    """Checks the smallest stable mass M on one damped spring with leapfrog. The linear limit satisfies 4 - 2 B dt / M -
    K dt^2 / M = 0 with B = 2 zeta sqrt(K M). Its solution is M = K (dt / s)^2 with s = 2 (sqrt(1 + zeta^2) - zeta).
    """
    K, dt, zeta = 20000.0, 0.0005, 0.7
    base = bench.scenario(
        "smallest_mass",
        time={"step_s": dt, "steps": 20000},
        initial={"position_m": [1e-3, 0, 0]},
        environment=SPRING,
        rendering={**SUMMED, "damping_ratio": zeta, "stiffness_N_per_m": K},
    )
    words = ("limit", base, "--vary", "rendering.mass_kg", "--between", "1e-4:10", "--smallest")
    row = bench.json(*words, "--stable", "bounded", "--resolution", "1e-4", "--out", "mass")[
        "limits"
    ][0]
    known = K * (dt / (2 * (math.sqrt(1 + zeta**2) - zeta))) ** 2
    undamped = ("without damping", K * dt**2 / 4)
    fine = Within("bisected to 1e-12, of eigenvalues near a double one to rounding", relative=1e-9)
    runs = Within("bisection ends at 1e-4; growth of 2e-6 a step is seen", relative=1.1e-4)
    how = "4 - 2 B dt / M - K dt^2 / M = 0"
    bench.add("limit.csv:theoretical_limit", row["theoretical_limit"], known, how, fine, undamped)
    bench.add("limit.csv:limit", row["limit"], known, how, runs, undamped)
    bench.add(
        "limit.csv:stable_low",
        row["stable_low"],
        known,
        how,
        runs,
        ("the low end of the range", 1e-4),
    )
    bench.add("limit.csv:quoted_limit", row["quoted_limit"], known, how, runs, undamped)
    first_row = Table(bench.folder / "mass" / "limit.csv").rows[0]
    bench.add(
        "limit.csv:quoted_reason",
        first_row["quoted_reason"].split(";")[1],
        " the runs agree",
        "both limits are the root, within the resolution",
        EXACT,
        ("simulated limit", " no linear limit applies"),
    )
    bench.add(
        "limit.csv:no_linear_reason",
        first_row["no_linear_reason"],
        "",
        "there is a theoretical limit",
        EXACT,
        ("contacts", "contacts come and go in every stable run"),
    )


@scene
def smallest_stiffness(bench):
    """Checks the smallest stiffness K that holds a force F at rest within a distance x of the spring's free end: K = F
    / x."""
    F, x = 1.0, 5e-5
    base = bench.scenario(
        "smallest_stiffness",
        time={"step_s": 0.0005, "steps": 2000},
        environment=SPRING,
        hand={"type": "force", "x_N": F},
        rendering={**SUMMED, "damping_ratio": 0.7},
    )
    words = (
        "limit",
        base,
        "--vary",
        "rendering.stiffness_N_per_m",
        "--between",
        "1e3:1e5",
        "--smallest",
    )
    bound = ("--bound", f"final_position_m.x={x}", "--resolution", "1e-4", "--out", "held")
    row = bench.json(*words, *bound)["limits"][0]
    within = Within("bisection ends at 1e-4; the motion has died out to e^-300", relative=1.1e-4)
    bench.add("limit.csv:limit", row["limit"], F / x, "F / x", within, ("half of it", F / x / 2))
    bench.add(
        "limit.csv:stable_low", row["stable_low"], F / x, "F / x", within, ("the range's", 1e3)
    )
    bench.add(
        "limit.csv:unstable_below_class",
        row["unstable_below_class"],
        "beyond_bound",
        "F / K > x below",
        EXACT,
        ("it is stable", "stable"),
    )


HANDS = [(0, 0), *((m, k) for m in (0.1, 0.2, 0.5) for k in (100, 300, 1000))]


@scene
def over_another_field(bench):
    """Checks the limit of the stiffness K as a function of the damping, the delay and the hand, for a handle at a
    bilateral wall. The class of each run follows from a linear recurrence, and each limit from its eigenvalues.
    """
    words = (
        "limit",
        "wall_on_handle",
        "--algorithms",
        "summation",
        "--between",
        "1:1e9",
        "--stable",
        "bounded",
        "--resolution",
        1e-3,
    )
    damping, K = "rendering.damping_N_s_per_m", "rendering.stiffness_N_per_m"
    given = lambda printed, path: [row[path] for row in printed["limits"]]
    printed = bench.json(*words, "--over", f"{damping}=0.1:150:5:log", "--out", "walls")
    bench.add(
        f"limit --json: {damping}",
        given(printed, damping),
        np.geomspace(0.1, 150, 5),
        "as asked",
        ROUNDING,
        ("linear", np.linspace(0.1, 150, 5)),
    )
    bench.json(
        *words,
        "--over",
        f"{damping}=0.1:150:3:log",
        "--set",
        "device.viscous_N_s_per_m=0",
        "--out",
        "bare",
    )
    handle = lambda B, K, b=0.5, more=0.0, spring=0.0: held_loop(
        0.1 + more, b, 0.001, K, B, spring=spring
    )
    xs, limits, runs = (
        np.geomspace(0.1, 150, 5),
        Table(bench.folder / "walls" / "limit.csv"),
        Table(bench.folder / "walls" / "limit_runs.csv"),
    )
    tried, how = list(zip(runs[damping], runs[K])), "recurrence and its eigenvalues"
    bench.add(
        "limit_runs.csv:class",
        runs["class"],
        [class_of(handle(*at), 0.6e-3) for at in tried],
        "the rule on the recurrence",
        EXACT,
        (
            "by the eigenvalues",
            ["stable" if radius(handle(*at)) < 1 else "diverged" for at in tried],
        ),
    )
    theory = [limit_of(lambda K: handle(x, K), 1.0, 1e9) for x in xs]
    swings = [
        bisected(lambda K: class_of(handle(x, K), 0.6e-3) != "diverged", t / 2, 2 * t, 1e-5)
        for x, t in zip(xs, theory)
    ]
    close = Within("an edge by eigenvalues, bisected to 1e-9 or better", relative=1e-8)
    bench.add(
        "limit.csv:theoretical_limit",
        limits["theoretical_limit"],
        theory,
        how,
        close,
        ("passive, 2 b / T", [1000.0] * 5),
    )
    bench.add(
        "limit.csv:limit",
        limits["limit"],
        swings,
        how,
        Within("bisection on runs ends at 0.1 %", relative=1e-3),
        ("passive, 2 b / T", [1000.0] * 5),
    )
    bench.add(
        "limit.csv:no_theory_reason",
        sorted({row["no_theory_reason"] for row in limits.rows}),
        [""],
        "the loop is linear",
        EXACT,
        ("friction", ["dry friction"]),
    )
    limits_over_delay_and_hand(bench, words, close, given, handle)
    limits_of_walls(bench, limits, Table(bench.folder / "bare" / "limit.csv"), xs, handle)
    limits_over_encoder(bench, words, damping, given)
    stressed(bench)


def limits_over_delay_and_hand(bench, words, close, given, handle):
    """Checks the limit of the stiffness K as a function of the delay, and as a function of the stiffness of the hand.
    The known values come from the eigenvalues of the sampled loop."""
    hand = (
        '{"type":"mass_spring_damper","mass_kg":0.2,"stiffness_N_per_m":100,'
        '"damping_N_s_per_m":2,"target":{"x_m":0,"y_m":0,"z_m":0}}'
    )
    for name, path, values, loop, more in (
        (
            "delay",
            "device.delay_samples",
            np.linspace(0, 8, 6),
            lambda x, K: held_loop(0.1, 0.5, 0.001, K, 5.0, delay=x),
            (),
        ),
        (
            "hand",
            "hand.stiffness_N_per_m",
            np.geomspace(10, 1e4, 6),
            lambda x, K: held_loop(0.3, 2.5, 0.001, K, 5.0, spring=x),
            ("--set", f"hand={hand}"),
        ),
    ):
        printed = bench.json(
            *words,
            *more,
            "--over",
            f"{path}={values[0]}:{values[-1]}:6{'' if name == 'delay' else ':log'}",
            "--out",
            name,
        )
        bench.add(
            f"limit --json: {path}",
            given(printed, path),
            values,
            "as asked",
            ROUNDING,
            ("the other way round", values[::-1]),
        )
        table = Table(bench.folder / name / "limit.csv")
        bench.add(
            "limit.csv:theoretical_limit",
            table["theoretical_limit"],
            [limit_of(lambda K: loop(x, K), 1.0, 1e6) for x in values],
            "eigenvalues, delays of whole and broken samples",
            close,
            ("without", [limit_of(lambda K: handle(5.0, K), 1.0, 1e6)] * 6),
        )


def limits_over_encoder(bench, words, damping, given):
    """Checks the limit of the stiffness K as a function of the encoder step q, for a device with dry friction c and
    viscous friction b. The known limit of Abbott and Okamura is min(2 b / T, 2 c / q) with the sampling period T.
    """
    q = np.geomspace(1e-6, 1e-3, 4)
    printed = bench.json(
        *words,
        "--over",
        "device.encoder_step_m=1e-6:1e-3:4:log",
        "--set",
        "device.coulomb_N=0.02",
        "--set",
        f"{damping}=0",
        "--out",
        "encoder",
    )
    bench.add(
        "limit --json: device.encoder_step_m",
        given(printed, "device.encoder_step_m"),
        q,
        "as asked",
        ROUNDING,
        ("in mm", 1e3 * q),
    )
    table = Table(bench.folder / "encoder" / "limit.csv")
    bench.add(
        "limit.csv:passive_abbott_okamura",
        table["passive_abbott_okamura"],
        np.minimum(2 * 0.5 / 0.001, 2 * 0.02 / q),
        "min(2 b / T, 2 c / q)",
        ROUNDING,
        ("2 b / T alone", np.full(4, 1000.0)),
    )
    bench.add(
        "limit.csv:no_theory_reason",
        [bool(text) for text in table["no_theory_reason"]],
        [True] * 4,
        "dry friction is not linear",
        EXACT,
        ("linear_limit", [False] * 4),
    )


def limits_of_walls(bench, table, bare, xs, handle):
    b, T, m, how = 0.5, 0.001, 0.1, "theory's own formula"
    passive = [max(0.0, 2 * (b - B) / T) for B in xs]
    gil = [max(0.0, (b + B) / (T / 2)) if (b + B) * T / m <= 0.15 else math.nan for B in xs]
    worst = [
        min(
            limit_of(lambda K: handle(B, K, more=mass, spring=k), 1.0, 1e9)
            if radius(handle(B, 1.0, more=mass, spring=k)) < 1
            else 0.0
            for mass, k in HANDS
        )
        for B in xs
    ]
    for column, known, within, naive in (
        ("passive_colgate_schenkel", passive, ROUNDING, [2 * (b + B) / T for B in xs]),
        ("passive_with_delay", passive, ROUNDING, [2 * b / T] * 5),
        ("stable_gil_hulin", gil, ROUNDING, [(b + B) * 2 / T for B in xs]),
        (
            "worst_hand_limit",
            worst,
            Within("an edge by eigenvalues, bisected to 1e-9 or better", relative=1e-8),
            [1.0] * 5,
        ),
    ):
        bench.add(
            f"limit.csv:{column}",
            table[column],
            known,
            how,
            within,
            ("without its range, sign or hand", naive),
        )
    beta = np.geomspace(0.1, 150, 3) * T / m
    bench.add(
        "limit.csv:exact_undamped_handle",
        bare["exact_undamped_handle"],
        np.maximum(0, 2 * beta * (2 - beta) / (2 + beta) * m / T**2),
        "K T^2/m < 2 beta (2 - beta) / (2 + beta)",
        ROUNDING,
        ("4 beta", 4 * beta * m / T**2),
    )


def stressed(bench):
    bench.hapbench("stress", "--count", "2000", "--out", "s")
    table = Table(bench.folder / "s" / "stress.csv")
    rows = [table["algorithm"].index(law) for law in ("mean", "highest_depth", "mcneely")]
    bench.add(
        "stress.csv:algorithm",
        len(set(table["algorithm"])),
        len(table.rows),
        "each once",
        EXACT,
        ("some twice", len(table.rows) - 1),
    )
    reached = Within("sums of up to 137 equal springs, rounded", relative=1e-13)
    # The sets include parallel springs of equal depth. For them, `mean` and `highest_depth` render the stiffness of one
    # spring, and the 10/N rule (`mcneely`) renders the stiffness of ten springs.
    bench.add(
        "stress.csv:largest_force_per_K_d",
        table["largest_force_per_K_d"][rows],
        [1.0, 1.0, 10.0],
        "parallel springs of one depth",
        reached,
        ("the bound of shaping", [1.366] * 3),
    )
    bench.add(
        "stress.csv:largest_share_of_bound",
        table["largest_share_of_bound"][rows],
        [1.0] * 3,
        "which reach the bounds",
        reached,
        ("of mcneely's in K d", [1.0, 1.0, 10.0]),
    )
    tests = "tests/scenarios/analysis/stress/law_stress_test.cpp"
    for name in ("sets", "in_contact", "non_finite", "out_of_bound", "points_dropped"):
        bench.proven(
            f"stress.csv:{name}",
            tests,
            "LawStress.NoForceIsInfiniteOrOutOfBound",
            f"c.{name}",
            "first_bad",
        )
