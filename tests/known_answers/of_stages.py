"""Known answers for two stages that modify the force of the springs (dry friction, energy tank), and for the age of
multi-rate contacts: contacts that are searched in some steps only, arrive delayed, and may be lost."""
import math

import numpy as np

from answers import EXACT, ROUNDING, profile, scene
from physics import BELOW, SPRING, STEPPED, SUMMED, nearest_rank


@scene
def bristle(bench):
    """Checks dry friction on a tool that moves back and forth while it is pressed deeper into one spring."""
    K, M, dt, n, mu, kt, zeta = 1000.0, 0.01, 0.0005, 2000, 0.4, 2000.0, 0.5
    path = {
        "x_m": {"type": "sine", "mean": 0, "amplitude": 1e-3, "period_s": 0.25, "phase_rad": 0.3},
        "y_m": 0,
        "z_m": {"type": "waypoints", "points": [[0, -1e-3], [1, -2e-3]]},
    }
    run = bench.run(
        bench.scenario(
            "bristle",
            time={"step_s": dt, "steps": n},
            motion={"position": {"type": "prescribed", **path}},
            environment=BELOW,
            record={"trajectory": True},
            rendering={
                "algorithm": "summation",
                "stiffness_N_per_m": K,
                "damping_ratio": 0,
                "mass_kg": M,
                "friction": {
                    "type": "dry",
                    "mu": mu,
                    "stiffness_N_per_m": kt,
                    "damping_ratio": zeta,
                },
            },
        )
    )
    t = np.arange(n) * dt
    p = np.column_stack([profile(path[a], t) for a in ("x_m", "y_m", "z_m")])
    v = np.diff(p[:, 0], prepend=2 * p[0, 0] - p[1, 0]) / dt
    load = -K * p[:, 2]
    bt = 2 * zeta * math.sqrt(kt * M)
    e, force, slides = 0.0, np.zeros(n), np.zeros(n, bool)
    for k in range(n):
        g = kt * e + (kt * dt + bt) * v[k]
        slides[k] = abs(g) > mu * load[k]
        g = np.clip(g, -mu * load[k], mu * load[k])
        e = (dt * g + bt * e) / (kt * dt + bt)
        force[k] = -g
    began = int(np.sum(slides[1:] & ~slides[:-1]))
    law = "the bristle's equations, row by row"
    bench.metrics(
        run,
        [
            (
                "friction.stick_share",
                int(np.sum(~slides)) / n,
                law,
                EXACT,
                "rows with the force below mu N",
                float(np.mean(np.abs(force) < 0.99 * mu * load)),
            ),
            (
                "friction.slips_per_s",
                began / (n * dt),
                law,
                EXACT,
                "rows that slide",
                slides.sum() / (n * dt),
            ),
        ],
    )
    bench.columns(
        run.table("trajectory.csv"),
        [("fx_N", force, law, STEPPED, "Coulomb's alone", -mu * load * np.sign(v))],
    )


@scene
def tank(bench):
    """Checks an energy tank for a mass on one spring, row by row, with the formula of the tank. The capacity of the
    tank is a tenth of the spring's energy."""
    K, B, M, dt, n, capacity = 2000.0, 2.0, 0.1, 0.0005, 400, 1e-4
    run = bench.run(
        bench.scenario(
            "tank",
            time={"step_s": dt, "steps": n},
            environment=SPRING,
            initial={"position_m": [1e-3, 0, 0]},
            rendering={
                **SUMMED,
                "stiffness_N_per_m": K,
                "damping_N_s_per_m": B,
                "mass_kg": M,
                "force_stage": {"type": "energy_tank", "capacity_J": capacity},
            },
        )
    )
    x, v, energy, changed, taken, rendered = 1e-3, 0.0, 0.5 * K * 1e-6, 0, 0.0, []
    level = min(capacity, energy)
    for k in range(n):
        f = -K * x - B * v
        excess = f * v * dt - max(level, 0.0)
        out = f - excess / (v * dt) if f * v > 0 and excess > 0 else f
        rendered.append(out)
        changed += out != f
        after = v + dt * out / M
        displacement = 0.5 * dt * (v + after)
        if k < n - 1:
            taken += (f - out) * displacement
        level = min(capacity, level - out * displacement)
        v = after
        x += dt * v
    formula = "the tank's formula, row by row"
    bench.metrics(
        run,
        [
            ("force_stage.changed_share", changed / n, formula, EXACT, "rows in contact", 1.0),
            (
                "force_stage.removed_J",
                taken,
                formula,
                STEPPED,
                "the spring's energy less the tank's",
                0.5 * K * 1e-6 - capacity,
            ),
        ],
    )
    bench.columns(
        run.table("trajectory.csv"),
        [
            (
                "fx_N",
                np.array(rendered),
                formula,
                STEPPED,
                "without the tank",
                -K * np.array(rendered),
            )
        ],
    )


@scene
def multi_rate(bench):
    """Checks the age of contacts for a mass on one spring. Contacts are requested every fourth row, used three rows
    later, and lost with a probability of 0.3."""
    K, dt, n = 2000.0, 0.0005, 400
    run = bench.run(
        bench.scenario(
            "late",
            time={"step_s": dt, "steps": n},
            environment=SPRING,
            initial={"position_m": [1e-3, 0, 0]},
            rendering={
                **SUMMED,
                "stiffness_N_per_m": K,
                "damping_ratio": 0.2,
                "contacts": {"every": 4, "delay_samples": 3, "dropout": 0.3},
            },
        )
    )
    table = run.table()
    position, pull = table["px_m"], table["fspring_x_N"]
    requested = np.arange(0, n, 4)
    used = [
        min((q for q in requested if q + 3 <= k), key=lambda q: abs(pull[k] + K * position[q]))
        for k in range(3, n)
    ]
    assert (
        max(abs(pull[k] + K * position[q]) for k, q in zip(range(3, n), used)) < 1e-12
    )  # no other position gives this force
    age, lost = dt * (np.arange(3, n) - used), len(requested) - len(set(used))
    how = "the place that the spring force is of"
    bench.metrics(
        run,
        [
            ("contacts.age_p50_s", nearest_rank(age, 0.5), how, ROUNDING, "the delay", 3 * dt),
            (
                "contacts.age_p95_s",
                nearest_rank(age, 0.95),
                how,
                ROUNDING,
                "without losses",
                6 * dt,
            ),
            ("contacts.age_max_s", age.max(), how, ROUNDING, "without losses", 6 * dt),
            (
                "contacts.searches",
                len(requested),
                "every fourth row",
                EXACT,
                "those that served",
                len(set(used)),
            ),
            (
                "contacts.lost_share",
                lost / len(requested),
                "queries whose place is never used",
                ROUNDING,
                "their probability",
                0.3,
            ),
        ],
    )
