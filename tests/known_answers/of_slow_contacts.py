"""Scenes behind contacts that come late: ages read off the force of one spring."""
import numpy as np

from answers import EXACT, ROUNDING, scene
from physics import PLAIN, SPRING, nearest_rank


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
