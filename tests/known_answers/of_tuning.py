"""Known answers for the tables of `tune`, from the eigenvalues of the sampled loop of a handle on one spring."""
import json
import math

import numpy as np

from answers import EXACT, ROUNDING, Table, Within, scene
from physics import SPRING, SUMMED, held_loop, limit_of


@scene
def tuned(bench):
    """Checks the recommendation for a handle on one spring with a delay of one sample. The stability limit of the
    sampled loop depends on the damping B. The known stiffness is the largest of these limits over all B, divided by the
    margin."""
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
    words = ("--margin", "2", "--bound", "force_rms_above_30Hz_N=1e3", "--allow-vibration")
    printed = bench.json("tune", base, *words, "--out", out)
    law, table, trials = (
        printed["algorithms"][0],
        Table(out / "tune.csv"),
        Table(out / "tune_trials.csv"),
    )
    loop = lambda K, B, more=0.0: held_loop(m, b, T, K, B, delay=delay + more)
    bench.add(
        "tune.csv:bounds",
        json.dumps(json.loads(table.rows[0]["bounds"])),
        json.dumps({"force_rms_above_30Hz_N": {"max": 1e3}}),
        "--bound",
        EXACT,
        ("without bounds", "{}"),
    )
    limit_at = lambda B: limit_of(lambda K: loop(K, B), 1.0, 1e5)
    B = max(np.geomspace(1, 100, 60), key=limit_at)
    B = max(np.linspace(0.93 * B, 1.07 * B, 60), key=limit_at)
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
        "tune.csv:stiffness_N_per_m",
        K,
        limit_at(B) / 2,
        by,
        near,
        ("without the margin", limit_at(B)),
    )
    # `at_K` is the damping at the stiffness K. If a gain g multiplies K at constant zeta, the damping grows by sqrt(g).
    at_K = 2 * zeta * math.sqrt(K * m)
    gain = limit_of(lambda g: loop(g * K, math.sqrt(g) * at_K), 1.0, 64.0)
    bench.add(
        "tune.csv:rendering.damping_ratio",
        float(table["rendering.damping_ratio"][0]),
        B / (2 * math.sqrt(limit_at(B) * m)),
        "B of the largest edge over 2 sqrt(K M) there",
        Within("K falls by as many percent as zeta is off on either side", relative=0.05),
        ("with B at K", B / (2 * math.sqrt(limit_at(B) / 2 * m))),
    )
    tuned_margins(bench, K, at_K, by, delay, gain, law, loop, margin, table, zeta)
    tuned_words(bench, law, m)
    for name, within in (
        ("linear_limit_N_per_m", Within("bisected to 1e-12", relative=1e-9)),
        ("simulated_limit_N_per_m", margin),
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
    """Checks margins by the eigenvalues z of the sampled loop: the gain and the delay at which an eigenvalue leaves the
    unit circle, and the smallest damping ratio -Re s / |s| with s = ln z / T and the sampling period T.
    """
    delay_limit = limit_of(lambda d: loop(K, at_K, d), 0.0, 8.0)
    z = np.linalg.eigvals(loop(K, at_K))
    s = np.log(z[np.abs(z) > 1e-9].astype(complex))
    for name, csv, value, naive in (
        ("gain", "gain_margin", gain, 1.0),
        ("delay_samples", "delay_margin_samples", delay_limit, delay_limit + delay),
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
    """Checks the columns and fields that follow from tuning a single law, and the bounds, which repeat the options."""
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
        "tune --json: low_vibration",
        limits["low_vibration"],
        False,
        "--allow-vibration, as asked",
        EXACT,
        ("the default", True),
    )
    bench.add(
        "tune --json: max",
        limits["force_rms_above_30Hz_N"]["max"],
        1e3,
        "as asked",
        EXACT,
        ("none", None),
    )


def tuned_words(bench, law, m):
    """Checks fields of the answer for a law whose stiffness is limited only by the stability of its loop. Also checks
    fields that repeat the options."""
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
    """Checks the row of the recommendation among the trials: its fields repeat the options, and its metrics equal the
    metrics of a separate run."""
    row_of_choice = next(
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
            row_of_choice[name],
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
            float(row_of_choice[name]),
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
    """Checks each trial by eigenvalues. A trial is feasible below half the limit at its damping ratio zeta. Trials
    within 2 % of this boundary are skipped, because runs cannot resolve them."""
    given = [row for row in trials.rows if row["feasible"] in ("true", "false")]
    limits = [
        limit_of(
            lambda k: loop(k, 2 * float(row["rendering.damping_ratio"]) * math.sqrt(k * m)),
            1e-3,
            1e6,
        )
        / 2
        for row in given
    ]
    clear = [
        (row, e)
        for row, e in zip(given, limits)
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
