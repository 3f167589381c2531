"""Scenes behind contacts that come late: ages read off the force of one spring, and the sampled loop of its queries by numpy."""
import math

import numpy as np

from answers import EXACT, ROUNDING, Within, rms, scene
from of_precision import column, study
from physics import FILTERED, PLAIN, SPRING, Phases, bisected, nearest_rank, settled_high_pass


def run_of(K, B, M, dt, n, every, x=1e-3, v=0.0):
    """Rows of x, v and f of leapfrog on a spring of the place at the last query, with a damper of the row's velocity."""
    rows = []
    for k in range(n):
        held = x if k % every == 0 else held  # noqa: F821  (row 0 is a query)
        f = -K * held - B * v
        rows.append((x, v, f))
        v += dt * f / M
        x += dt * v
    return np.array(rows).T


def radius(K, B, M, dt, every):
    """Of the map from query to query, column by column."""
    ends = [run_of(K, B, M, dt, every + 1, every, *start)[:2, -1] for start in ((1.0, 0.0), (0.0, 1.0))]
    return np.abs(np.linalg.eigvals(np.column_stack(ends))).max()


@scene
def late(bench):
    """A mass on one spring whose contacts are asked for every fourth row, serve three rows later and are often lost."""
    K, dt, n = 2000.0, 0.0005, 400
    fields = {"time": {"step_s": dt, "steps": n}, "environment": SPRING, "initial": {"position_m": [1e-3, 0, 0]},
              "rendering": {**PLAIN, "algorithm": "summation", "stiffness_N_per_m": K, "damping_ratio": 0.2, "mass_kg": 0.1,
                            "contacts": {"every": 4, "delay_samples": 3, "dropout": 0.3}}}
    run = bench.run(bench.scenario("late", **fields))
    table = run.table()
    place, pull = table["px_m"], table["fspring_x_N"]
    asked = np.arange(0, n, 4)
    used = [min((q for q in asked if q + 3 <= k), key=lambda q: abs(pull[k] + K * place[q])) for k in range(3, n)]
    assert max(abs(pull[k] + K * place[q]) for k, q in zip(range(3, n), used)) < 1e-12  # no other place gives this force
    age, lost = dt * (np.arange(3, n) - used), len(asked) - len(set(used))
    how = "the place that the spring force is of"
    bench.metrics(run, [
        ("contacts.age_p50_s", nearest_rank(age, 0.5), how, ROUNDING, "the delay", 3 * dt),
        ("contacts.age_p95_s", nearest_rank(age, 0.95), how, ROUNDING, "without losses", 6 * dt),
        ("contacts.age_max_s", age.max(), how, ROUNDING, "without losses", 6 * dt),
        ("contacts.asked", len(asked), "every fourth row", EXACT, "those that served", len(set(used))),
        ("contacts.lost_share", lost / len(asked), "queries whose place is never used", ROUNDING, "their probability", 0.3)])


@scene
def late_study(bench):
    """A mass on one spring with contacts of every row and of every so manieth, held and linear."""
    K, M, dt, n, zeta = 2e4, 0.1, 0.0005, 4000, 0.7
    base = bench.scenario("spring", time={"step_s": dt, "steps": n}, environment=SPRING, initial={"position_m": [1e-3, 0, 0]},
                          rendering={**PLAIN, "algorithm": "summation", "stiffness_N_per_m": K, "damping_ratio": zeta, "mass_kg": M})
    table, _ = study(bench, "late_contacts", "--scenario", base)
    every = (1, 2, 4, 8, 16, 32)
    rows = [table["setting"].index(f"summation hold {m}") for m in every]
    column(bench, table, rows, "rate_Hz", [1 / (m * dt) for m in every], "1 / (n dt)", ROUNDING, "of the rows", [1 / dt] * 6)
    B = 2 * zeta * math.sqrt(K * M)
    edges = [bisected(lambda k, m=m: radius(k, 2 * zeta * math.sqrt(k * M), M, dt, m) <= 1, 1.0, 1e8, 1e-10) for m in every]
    column(bench, table, rows, "theory_N_per_m", edges, "eigenvalues of the map from query to query", Within(
        "numpy's bisection, 1e-10 of K", relative=1e-8), "of every row", edges[:1] * 6)
    for i, m in zip(rows, every):
        # So near the edge the 1 mm of the start dies out too slowly to be told from vibration, or grows too slowly.
        bench.add("precision_STUDY.csv:stiffness_max_N_per_m", float(table.rows[i]["stiffness_max_N_per_m"]), edges[every.index(m)],
                  "the same edge", Within("bisection to 5 %, and 2 % of K in which a run of 125 queries does not tell", relative=0.07),
                  ("of every row" if m > 1 else "undamped", edges[0] if m > 1 else 4 * M / dt**2))
    slow = [i for i, m in zip(rows, every) if m <= 8]
    runs = [run_of(K, B, M, dt, n, m) for m in every if m <= 8]
    behind = []
    for x, v, f in runs:
        force = np.column_stack([f, 0 * f, 0 * f])
        phases = Phases(np.full(n, True), dt)
        behind.append(rms(settled_high_pass(force, phases, dt)[phases.settled]))
    column(bench, table, slow, "force_rms_above_30Hz_N", behind, "scipy's filter on the recurrence's force", FILTERED,
           "of the whole force", [rms(f) for _, _, f in runs])
    apart = [math.sqrt(np.mean((x - runs[0][0]) ** 2)) for x, _, _ in runs]
    column(bench, table, slow, "error_rms_m", apart, "recurrences' difference", Within(
        "sums of places of a millimetre, known to 1e-15 of it", absolute=1e-14), "of the last row", [abs(x[-1] - runs[0][0][-1]) + 1e-9 for x, _, _ in runs])
