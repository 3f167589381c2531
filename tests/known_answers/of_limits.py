"""Scenes behind the tables of limit, tune and stress: the eigenvalues and the motion of linear
recurrences."""
import math

import numpy as np

from answers import EXACT, ROUNDING, Table, Within, scene
from physics import (
    PLAIN,
    SPRING,
    SUMMED,
    bisected,
    class_of,
    edge_of,
    held_loop,
    high_pass,
    motion_of,
    radius,
)


@scene
def limits_of_springs(bench):
    """The limits of two springs side by side under leapfrog (thesis A.3), and under rk4."""
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

    def asked(folder, *words):
        bench.json(
            "limit", base, "--stable", "bounded", "--resolution", "1e-4", *words, "--out", folder
        )
        return Table(bench.folder / folder / "limit.csv")

    tables = (
        asked("K", "--between", "1e3:1e9", "--over", "rendering.damping_ratio=0,0.7"),
        asked(
            "B",
            "--vary",
            "rendering.damping_N_s_per_m",
            "--between",
            "1:1e5",
            "--set",
            "rendering.stiffness_N_per_m=0",
        ),
        asked("dt", "--vary", "time.step_s", "--between", "1e-5:0.1"),
    )
    # 4 - 2 lam B dt / M - lam K dt^2 / M = 0 with B = 2 zeta sqrt(K M): a quadratic in
    # s = sqrt(K) dt / sqrt(M).
    s = -2 * zeta + math.sqrt(4 * zeta**2 + 4 / lam)
    value = [4 * M / (lam * dt**2), M * s * s / dt**2, 2 * M / (lam * dt), s * math.sqrt(M / K)]
    fine = Within("bisected to 1e-12, of eigenvalues near a double one to rounding", relative=1e-9)
    runs = Within("bisection ends at 1e-4; growth of 2e-6 a step is seen", relative=1.1e-4)
    wrong = ("of a single spring", [2 * value[0], 433731.0, 2 * value[2], 2 * value[3]])
    for column, within in (("closed_form", fine), ("theory", fine), ("limit", runs)):
        bench.add(
            f"limit.csv:{column}",
            np.concatenate([table[column] for table in tables]),
            value,
            "4 - 2 lam B dt / M - lam K dt^2 / M = 0",
            within,
            wrong,
        )
    # |1 + z + z^2/2 + z^3/6 + z^4/24| = 1 at z = i 2 sqrt 2, and on the real axis at the root of
    # z^3/24 + z^2/6 + z/2 + 1.
    rk4 = ("--set", "integrator.type=rk4")
    real = -np.roots([1 / 24, 1 / 6, 1 / 2, 1]).real[
        np.abs(np.roots([1 / 24, 1 / 6, 1 / 2, 1]).imag) < 1e-9
    ][0]
    of_rk4 = (
        asked("rk4_K", "--between", "1e3:1e9", "--set", "rendering.damping_ratio=0", *rk4),
        asked(
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
        "limit.csv:theory",
        np.concatenate([table["theory"] for table in of_rk4]),
        [8 * M / (lam * dt**2), real * M / (lam * dt)],
        "polynomial of Runge and Kutta's method",
        fine,
        ("leapfrog's", [value[0], value[2]]),
    )


@scene
def smallest_mass(bench):
    """The smallest mass of one damped spring under leapfrog, from 4 - 2 B dt / M - K dt^2 / M = 0
    with B = 2 zeta sqrt(K M): M = K (dt / s)^2 with s = 2 (sqrt(1 + zeta^2) - zeta)."""
    K, dt, zeta = 20000.0, 0.0005, 0.7
    base = bench.scenario(
        "smallest_mass",
        time={"step_s": dt, "steps": 20000},
        initial={"position_m": [1e-3, 0, 0]},
        environment=SPRING,
        rendering={**SUMMED, "damping_ratio": zeta, "stiffness_N_per_m": K},
    )
    ask = ("limit", base, "--vary", "rendering.mass_kg", "--between", "1e-4:10", "--smallest")
    row = bench.json(*ask, "--stable", "bounded", "--resolution", "1e-4", "--out", "mass")[
        "limits"
    ][0]
    known = K * (dt / (2 * (math.sqrt(1 + zeta**2) - zeta))) ** 2
    undamped = ("without damping", K * dt**2 / 4)
    fine = Within("bisected to 1e-12, of eigenvalues near a double one to rounding", relative=1e-9)
    runs = Within("bisection ends at 1e-4; growth of 2e-6 a step is seen", relative=1.1e-4)
    how = "4 - 2 B dt / M - K dt^2 / M = 0"
    bench.add("limit.csv:theory", row["theory"], known, how, fine, undamped)
    bench.add("limit.csv:limit", row["limit"], known, how, runs, undamped)
    bench.add("limit.csv:low", row["low"], known, how, runs, ("the low end of the range", 1e-4))


@scene
def smallest_stiffness(bench):
    """The smallest stiffness that holds a force F at rest within x of the spring's free end:
    K = F / x."""
    F, x = 1.0, 5e-5
    base = bench.scenario(
        "smallest_stiffness",
        time={"step_s": 0.0005, "steps": 2000},
        environment=SPRING,
        hand={"type": "force", "x_N": F},
        rendering={**SUMMED, "damping_ratio": 0.7},
    )
    ask = (
        "limit",
        base,
        "--vary",
        "rendering.stiffness_N_per_m",
        "--between",
        "1e3:1e5",
        "--smallest",
    )
    bound = ("--bound", f"final_position_m.x={x}", "--resolution", "1e-4", "--out", "held")
    row = bench.json(*ask, *bound)["limits"][0]
    within = Within("bisection ends at 1e-4; the motion has died out to e^-300", relative=1.1e-4)
    bench.add("limit.csv:limit", row["limit"], F / x, "F / x", within, ("half of it", F / x / 2))
    bench.add("limit.csv:low", row["low"], F / x, "F / x", within, ("the range's", 1e3))
    bench.add(
        "limit.csv:class_below",
        row["class_below"],
        "beyond_bound",
        "F / K > x below",
        EXACT,
        ("it is stable", "stable"),
    )


@scene
def tuned(bench):
    """A handle on one spring, with a sample of delay: the largest edge of the held loop over B,
    over the margin, and what lies around it."""
    m, b, T, delay = 0.1, 0.5, 0.001, 1
    base = bench.scenario(
        "tuned",
        time={"step_s": T, "steps": 8000},
        initial={"position_m": [1e-3, 0, 0]},
        device={
            "type": "impedance",
            "handle_mass_kg": m,
            "viscous_N_s_per_m": b,
            "delay_samples": delay,
        },
        environment=SPRING,
        rendering={**SUMMED, "mass_kg": m},
    )
    out = bench.folder / "tune"
    printed = bench.json(
        "tune", base, "--margin", "2", "--bound", "force_rms_above_30Hz_N=1e3", "--out", out
    )
    law, table, trials = (
        printed["algorithms"][0],
        Table(out / "tune.csv"),
        Table(out / "tune_trials.csv"),
    )
    loop = lambda K, B, more=0.0: held_loop(m, b, T, K, B, delay=delay + more)
    edge = lambda B: edge_of(lambda K: loop(K, B), 1.0, 1e5)
    B = max(np.geomspace(1, 100, 60), key=edge)
    B = max(np.linspace(0.93 * B, 1.07 * B, 60), key=edge)
    K, zeta, runs = law["stiffness_N_per_m"], law["damping_ratio"], printed["runs"]
    by = "eigenvalues of the held loop"
    near = Within(
        "the search ends at 0.5 % of K and 0.4 % of zeta, runs need a strip of 1 % to tell decay",
        relative=0.03,
    )
    margin = Within(
        "bisection ends at 0.5 % of the gain, 0.02 samples and runs need a strip of 1 %",
        relative=0.03,
        absolute=0.02,
    )
    bench.add(
        "tune.csv:stiffness_N_per_m", K, edge(B) / 2, by, near, ("without the margin", edge(B))
    )
    at_K = 2 * zeta * math.sqrt(K * m)  # B at K; along zeta it grows with the root of the gain
    gain = edge_of(lambda g: loop(g * K, math.sqrt(g) * at_K), 1.0, 64.0)
    bench.add(
        "tune.csv:rendering.damping_ratio",
        float(table["rendering.damping_ratio"][0]),
        B / (2 * math.sqrt(edge(B) * m)),
        "B of the largest edge over 2 sqrt(K M) there",
        Within("K falls by as many percent as zeta is off on either side", relative=0.05),
        ("with B at K", B / (2 * math.sqrt(edge(B) / 2 * m))),
    )
    tuned_margins(bench, K, at_K, by, delay, gain, law, loop, margin, table, zeta)
    tuned_words(bench, law, m)
    for name, within in (
        ("linear_edge", Within("bisected to 1e-12", relative=1e-9)),
        ("edge_in_runs", margin),
    ):
        bench.add(f"tune --json: {name}", law[name], gain * K, by, within, ("K", K))
    bench.add(
        "tune.csv:why",
        "unstable" in law["why"],
        True,
        "the loop is what ends it",
        EXACT,
        ("a limit", "vibration" in law["why"]),
    )
    tuned_order(bench, law, printed, runs, table)
    tuned_trials(bench, by, loop, m, trials)
    tuned_choice(bench, K, base, trials, zeta)


def tuned_margins(bench, K, at_K, by, delay, gain, law, loop, margin, table, zeta):
    """Margins by the eigenvalues of the held loop: the gain and the delay at which one leaves the
    unit circle, and the smallest damping ratio -Re s / |s|, s = ln z / T."""
    late = edge_of(lambda d: loop(K, at_K, d), 0.0, 8.0)
    z = np.linalg.eigvals(loop(K, at_K))
    s = np.log(z[np.abs(z) > 1e-9].astype(complex))
    for name, csv, value, naive in (
        ("gain", "gain_margin", gain, 1.0),
        ("delay_samples", "delay_margin_samples", late, late + delay),
        ("damping_ratio", "damping_margin", float((-s.real / np.abs(s)).min()), zeta),
    ):
        bench.add(
            f"tune.csv:{csv}",
            float(table[csv][0]),
            value,
            by,
            margin,
            ("of the margin asked, with the own delay, or zeta", naive),
        )
        bench.add(
            f"tune --json: {name}",
            law["margins"][name],
            float(table[csv][0]),
            "as in tune.csv",
            ROUNDING,
            ("the margin asked for", 2.0 if name != "gain" else 1.0),
        )


def tuned_order(bench, law, printed, runs, table):
    """What holds of a single law, and the limits as asked."""
    bench.add(
        "tune.csv:algorithm",
        table["algorithm"],
        ["summation"],
        "as asked",
        EXACT,
        ("all", ["mean"]),
    )
    bench.add(
        "tune.csv:runs",
        int(table["runs"][0]),
        runs,
        "the sum over one law",
        EXACT,
        ("the verified", law["verified"]),
    )
    bench.add(
        "tune --json: recommended",
        printed["recommended"],
        "summation",
        "the only law",
        EXACT,
        ("none", None),
    )
    bench.add(
        "tune --json: runner_up",
        printed["runner_up"],
        None,
        "the only law",
        EXACT,
        ("the same", "summation"),
    )
    limits = printed["limits"]
    bench.add("tune --json: margin", limits["margin"], 2.0, "as asked", EXACT, ("of one", 1.0))
    bench.add(
        "tune --json: max",
        limits["force_rms_above_30Hz_N"]["max"],
        1e3,
        "as asked",
        EXACT,
        ("none", None),
    )


def tuned_words(bench, law, m):
    """The words of the answer: one law, whose loop alone binds, as asked."""
    for name, known, naive in (
        ("feasible", True, False),
        ("lambda_max", 1.0, 2.0),
        ("binding", "margin", "range"),
        ("relax", "", "the margin"),
        ("verified", 56, 5),
        ("may_fail_share", 1 - 0.05 ** (1 / 48), 0.05),
        ("velocity_filter", "", "difference"),
        ("mass_kg", None, m),
    ):
        how = (
            "one spring, whose loop alone binds; 48 gains between and 8 just below the margin; "
            "nothing to relax or chosen beside K and zeta"
        )
        bench.add(
            f"tune.csv:{name}",
            law[name],
            known,
            how,
            ROUNDING if name == "may_fail_share" else EXACT,
            ("another", naive),
        )


def tuned_choice(bench, K, base, trials, zeta):
    """The row of the choice among the trials: its words as asked, its metrics by a run
    of its own."""
    own = next(
        row
        for row in trials.rows
        if float(row["stiffness_N_per_m"]) == K and float(row["rendering.damping_ratio"]) == zeta
    )
    for name, known, naive in (
        ("algorithm", "summation", "mean"),
        ("mass_kg", "", "0.1"),
        ("velocity_filter", "", "difference"),
        ("inside_max_m", "", "0.001"),
    ):
        bench.add(
            f"tune_trials.csv:{name}",
            own[name],
            known,
            "as asked; springs have no inside",
            EXACT,
            ("another", naive),
        )
    tried = bench.run(
        base,
        "--set",
        f"rendering.stiffness_N_per_m={K!r}",
        "--set",
        f"rendering.damping_ratio={zeta!r}",
        out="own",
    )
    for name in ("force_rms_above_30Hz_N", "settled_force_step_max_N"):
        bench.add(
            f"tune_trials.csv:{name}",
            float(own[name]),
            tried.metric(name),
            "a run with --set",
            EXACT,
            ("in kN", tried.metric(name) / 1e3),
        )
    for name, cell in (("stiffness_N_per_m", K), ("rendering.damping_ratio", zeta)):
        bench.add(
            f"tune_trials.csv:{name}",
            sum(float(row[name]) == cell for row in trials.rows) > 0,
            True,
            "the choice was tried",
            EXACT,
            ("twice it was", sum(float(row[name]) == 2 * cell for row in trials.rows) > 0),
        )


def tuned_trials(bench, by, loop, m, trials):
    """Each trial by its own eigenvalues: feasible below half the edge of its zeta, but for the
    strip in which runs cannot tell."""
    # Each trial by its own eigenvalues: feasible below half the edge of its zeta, but for the strip
    # in which runs cannot tell.
    given = [row for row in trials.rows if row["feasible"] in ("true", "false")]
    edges = [
        edge_of(
            lambda k: loop(k, 2 * float(row["rendering.damping_ratio"]) * math.sqrt(k * m)),
            1e-3,
            1e6,
        )
        / 2
        for row in given
    ]
    clear = [
        (row, e)
        for row, e in zip(given, edges)
        if abs(float(row["stiffness_N_per_m"]) / e - 1) > 0.02
    ]
    stable = [float(row["stiffness_N_per_m"]) < e for row, e in clear]
    bench.add(
        "tune_trials.csv:feasible",
        [float(row["feasible"] == "true") for row, _ in clear],
        [float(s) for s in stable],
        by,
        EXACT,
        ("up to the edge", [float(float(row["stiffness_N_per_m"]) < 2 * e) for row, e in clear]),
    )
    bench.add(
        "tune_trials.csv:binding",
        [row["binding"] for row, _ in clear],
        ["" if s else "margin" for s in stable],
        by,
        EXACT,
        ("settled", ["" if s else "settled" for s in stable]),
    )
    bench.add(
        "tune_trials.csv:why",
        [float("unstable" in row["why"]) for row, _ in clear],
        [float(not s) for s in stable],
        by,
        EXACT,
        ("always", [1.0] * len(stable)),
    )


HANDS = [(0, 0), *((m, k) for m in (0.1, 0.2, 0.5) for k in (100, 300, 1000))]


@scene
def over_another_field(bench):
    """K over B, delay and hand of a handle at a wall on both sides: each class by the linear
    recurrence, each edge by its eigenvalues."""
    ask = (
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
    given = lambda told, path: [row[path] for row in told["limits"]]
    told = bench.json(*ask, "--over", f"{damping}=0.1:150:5:log", "--out", "walls")
    bench.add(
        f"limit --json: {damping}",
        given(told, damping),
        np.geomspace(0.1, 150, 5),
        "as asked",
        ROUNDING,
        ("linear", np.linspace(0.1, 150, 5)),
    )
    bench.json(
        *ask,
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
    xs, edges, runs = (
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
    theory = [edge_of(lambda K: handle(x, K), 1.0, 1e9) for x in xs]
    swings = [
        bisected(lambda K: class_of(handle(x, K), 0.6e-3) != "diverged", t / 2, 2 * t, 1e-5)
        for x, t in zip(xs, theory)
    ]
    close = Within("an edge by eigenvalues, bisected to 1e-9 or better", relative=1e-8)
    bench.add(
        "limit.csv:theory", edges["theory"], theory, how, close, ("passive, 2 b / T", [1000.0] * 5)
    )
    bench.add(
        "limit.csv:limit",
        edges["limit"],
        swings,
        how,
        Within("bisection on runs ends at 0.1 %", relative=1e-3),
        ("passive, 2 b / T", [1000.0] * 5),
    )
    bench.add(
        "limit.csv:no_theory",
        sorted({row["no_theory"] for row in edges.rows}),
        [""],
        "the loop is linear",
        EXACT,
        ("friction", ["dry friction"]),
    )
    limits_over_delay_and_hand(bench, ask, close, given, handle)
    limits_of_walls(bench, edges, Table(bench.folder / "bare" / "limit.csv"), xs, handle)
    limits_over_encoder(bench, ask, damping, given)
    stressed(bench)


def limits_over_delay_and_hand(bench, ask, close, given, handle):
    """K over a delay and over the stiffness of the hand, by the eigenvalues of the held loop."""
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
        told = bench.json(
            *ask,
            *more,
            "--over",
            f"{path}={values[0]}:{values[-1]}:6{'' if name == 'delay' else ':log'}",
            "--out",
            name,
        )
        bench.add(
            f"limit --json: {path}",
            given(told, path),
            values,
            "as asked",
            ROUNDING,
            ("the other way round", values[::-1]),
        )
        table = Table(bench.folder / name / "limit.csv")
        bench.add(
            "limit.csv:theory",
            table["theory"],
            [edge_of(lambda K: loop(x, K), 1.0, 1e6) for x in values],
            "eigenvalues, delays of whole and broken samples",
            close,
            ("without", [edge_of(lambda K: handle(5.0, K), 1.0, 1e6)] * 6),
        )


def limits_over_encoder(bench, ask, damping, given):
    """K over the encoder's step q with dry friction c: min(2 b / T, 2 c / q) of Abbott and
    Okamura."""
    q = np.geomspace(1e-6, 1e-3, 4)
    told = bench.json(
        *ask,
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
        given(told, "device.encoder_step_m"),
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
        "limit.csv:no_theory",
        [bool(text) for text in table["no_theory"]],
        [True] * 4,
        "dry friction is not linear",
        EXACT,
        ("linear", [False] * 4),
    )


def limits_of_walls(bench, table, bare, xs, handle):
    b, T, m, how = 0.5, 0.001, 0.1, "theory's own formula"
    passive = [max(0.0, 2 * (b - B) / T) for B in xs]
    gil = [max(0.0, (b + B) / (T / 2)) if (b + B) * T / m <= 0.15 else math.nan for B in xs]
    worst = [
        min(
            edge_of(lambda K: handle(B, K, more=mass, spring=k), 1.0, 1e9)
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
            "worst_hand",
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


@scene
def devices(bench):
    """The stiffness of two springs, and of a wall that only pushes, on a handle: by the held loop's
    motion behind scipy's filter."""
    m, b, T, B, n, resolution, most = 0.1, 0.5, 0.001, 2.0, 2000, 1e-3, 1e-3
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
    edges = [bisected(lambda K: vibration(K, lam) <= most, 100.0, 1e5, 1e-7) for lam in stiffer]
    theory = [edge_of(lambda K: loop(K, lam), 100.0, 1e5) for lam in stiffer]
    fine = Within("bisection ends at a relative width of 1e-3", relative=1e-3)
    limits = [number(cell[key], "limit") for key in keys]
    rows = [
        [row for row in runs.rows if (row["device"], row["scenario"], row["algorithm"]) == key]
        for key in keys
    ]
    tried, says = [[float(row["rendering.stiffness_N_per_m"]) for row in of] for of in rows], [
        row["class"] for of in rows for row in of
    ]
    judged = [
        [
            "stable"
            if vibration(K, lam) <= most
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
        ("limit", edges, fine, "edge of the eigenvalues", theory),
        ("beyond", beyond, EXACT, "the limit", limits),
        ("low", [min(v) for v in tried], EXACT, "the limit", limits),
        ("below", [math.nan] * 2, EXACT, "0", [0.0] * 2),
        (
            "vibration_m_per_s",
            [vibration(K, lam) for K, lam in zip(limits, stiffer)],
            Within(
                "filter and recurrence in another order, over 2000 " "rows near the edge",
                relative=1e-6,
            ),
            "that is allowed",
            [most] * 2,
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
        ("inconsistent_runs", [0.0] * 2, EXACT, "beyond", [1.0] * 2),
        ("astray", [0.0] * 2, EXACT, "beyond", [1.0] * 2),
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
    told = {(row["device"], row["scenario"], row["algorithm"]): row for row in printed["limits"]}
    widths = [x - limit for x, limit in zip(beyond, limits)]
    bench.add(
        "limit --json: limit_tolerance",
        [told[key]["limit_tolerance"] for key in keys],
        widths,
        "from the limit to the next tried",
        ROUNDING,
        ("the resolution asked", [resolution * limit for limit in limits]),
    )
    limits_of_both_ends(bench, fine, how, most, resolution, vibration)
    classes = [j[v.index(x)] for j, v, x in zip(judged, tried, beyond)]
    bench.add(
        "limit.csv:class_beyond",
        [cell[key]["class_beyond"] for key in keys],
        classes,
        how,
        EXACT,
        ("diverged", ["diverged"] * 2),
    )
    bench.add(
        "limit_runs.csv:class",
        says,
        judged[0] + judged[1],
        how,
        EXACT,
        (
            "by the eigenvalues",
            [
                "stable" if K < edge else "diverged"
                for values, edge in zip(tried, theory)
                for K in values
            ],
        ),
    )
    names_of_devices(bench, number, runs, table)
    linear_limit_of_device(bench, B, T, b, cell, m, number, printed, theory)


def linear_limit_of_device(bench, B, T, b, cell, m, number, printed, theory):
    """The linear edge with the hand, by the eigenvalues of the held loop."""
    pushed = ("mine", "pushes", "summation")
    linear = edge_of(lambda K: held_loop(m + 0.2, b + 2, T, K, B, spring=300), 100.0, 1e6)
    close = Within("an edge by eigenvalues, bisected to 1e-9 or better", relative=1e-8)
    bench.add(
        "limit.csv:linear",
        number(cell[pushed], "linear"),
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
    """Which device, scene and law a row is of, and what its maker publishes."""
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


def limits_of_both_ends(bench, fine, how, most, resolution, vibration):
    """Both ends of what nobody published of a preset: mass over and times 1.3, viscous friction
    from 0.5 to 5 N s/m."""
    # What is ours of an omega.3 is its mass and viscous friction once dry friction, encoder and
    # saturation are gone.
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
        bisected(lambda K: vibration(K, 1.0, of, viscous) <= most, 100.0, 1e6, 1e-7)
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
    # Parallel springs of one depth are among the sets: as stiff as one, and under the rule
    # of 10 / N as ten.
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
