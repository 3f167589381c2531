"""Known answers for the metrics of summary.json: a mass with friction, bundled scenes recomputed from the rows of their
tables, and a run whose step is too long for some metrics."""
import math

import numpy as np

from answers import EXACT, ROUNDING, Within, norms, rms, scene
from of_touches import TOUCHES
from physics import BELOW, BINNED, FILTERED, Phases, nearest_rank, settled_high_pass


@scene
def rubbed(bench):
    """Checks a free mass that a hand pushes against a spring and sideways. From some row on, the friction exceeds the
    stability limit of leapfrog."""
    K, M, dt, n, mu_s, mu_f = 5000.0, 0.1, 0.001, 120, 2.0, 20.0
    B = 2 * 0.3 * math.sqrt(K * M)
    push = {"type": "ramp", "start": 0.0, "rate_per_s": -150.0}
    run = bench.run(
        bench.scenario(
            "rubbed",
            time={"step_s": dt, "steps": n},
            environment=BELOW,
            initial={"position_m": [0, 0, 0], "velocity_m_per_s": [0.01, 0, 0]},
            hand={"type": "force", "z_N": push, "x_N": 0.2},
            rendering={
                "algorithm": "summation",
                "stiffness_N_per_m": K,
                "damping_ratio": 0.3,
                "mass_kg": M,
                "friction": {"mu_s_N_s_per_m": mu_s, "mu_f_s_per_m": mu_f},
            },
        )
    )
    p, v, S = np.zeros((n, 3)), np.zeros((n, 3)), np.diag([0.0, 0, 1])
    f, spring = np.zeros((n, 3)), np.zeros((n, 3))
    v[0, 0] = 0.01
    for k in range(n):
        spring[k] = -K * S @ p[k] * (abs(p[k, 2]) > 0)
        f[k] = (
            spring[k] - B * S @ v[k] - (mu_s + mu_f * np.linalg.norm(spring[k])) * (v[k] - S @ v[k])
        )
        if k + 1 < n:
            v[k + 1] = v[k] + (f[k] + [0.2, 0, -150 * k * dt]) * dt / M
            p[k + 1] = p[k] + v[k + 1] * dt
    limit = (2 * M / dt - mu_s) / mu_f
    beyond = norms(spring) > limit
    bench.metrics(
        run,
        [
            (
                "explicit_friction_limit_N",
                limit,
                "(2 M / dt - mu_s) / mu_f",
                ROUNDING,
                "without mu_s",
                2 * M / dt / mu_f,
            ),
            (
                "explicit_friction_rows_beyond",
                int(beyond.sum()),
                "|f_spring| of the recurrence",
                EXACT,
                "|f| in place of |f_spring|",
                int((norms(f) > limit).sum()),
            ),
            (
                "explicit_friction_first_step",
                int(np.flatnonzero(beyond)[0]),
                "|f_spring| of the recurrence",
                EXACT,
                "|f| in place of |f_spring|",
                int(np.flatnonzero(norms(f) > limit)[0]),
            ),
        ],
    )
    held = Within(
        "120 steps, of which the last enlarge rounding by up to |1 - (mu_s + mu_f |f|) dt / M| "
        "each",
        relative=1e-9,
        absolute=1e-15,
    )
    bench.columns(
        run.table(),
        [
            (
                f"{name}{x}{unit}",
                series[:, i],
                "recurrence",
                held,
                *(("a row later", np.r_[series[1:, i], 0]) if x != "y" else ()),
            )
            for name, unit, series in (("p", "_m", p), ("v", "_m_per_s", v), ("f", "_N", f))
            for i, x in enumerate("xyz")
        ],
    )


@scene
def from_rows(bench):
    """Checks the metrics of bundled scenes on a mesh, in a hole, and with both kinds of devices. The known values are
    recomputed from the rows of trajectory.csv by the definitions of the metrics."""
    for name in (
        "drag_molar",
        "peg_in_hole_2d_original_averaging",
        "impedance_at_wall",
        "device_in_hole",
        "tap_corner",
    ):
        run = bench.run(
            name,
            "--set",
            "record.every=1",
            "--set",
            "record.trajectory=true",
            "--set",
            "expect={}",
            statuses=(0, 3),
        )
        rows = run.table()
        f, spring, p = (
            rows.vectors(*(f"{part}{x}{unit}" for x in "xyz"))
            for part, unit in (("f", "_N"), ("fspring_", "_N"), ("p", "_m"))
        )
        t, colliding, rendered = rows["time_s"], rows["colliding"], rows["rendered"]
        dt, touching, F = t[1] - t[0], colliding > 0, norms(f)
        phases = Phases(touching, dt)
        settled, landing = phases.settled, phases.landing
        steps, reverses = (
            np.r_[0.0, norms(np.diff(f, axis=0))],
            np.r_[False, np.sum(f[1:] * f[:-1], axis=1) < 0],
        )
        enough = settled.sum() * dt >= 1 / 30
        if_settled = lambda make: float(make()) if enough else None
        behind = settled_high_pass(f, phases, dt)
        how = "the rows of trajectory.csv"
        bench.metrics(
            run,
            [
                (
                    "force_max_N",
                    F.max(),
                    how,
                    ROUNDING,
                    "of f_spring",
                    norms(spring).max() * (1 + 1e-9),
                ),
                ("force_step_max_N", steps.max(), how, ROUNDING),
                ("force_reversals", int(reverses.sum()), how, EXACT),
                ("depth_max_m", rows["depth_max_m"].max(), how, EXACT),
                ("ratio_min", np.nanmin(rows["ratio_min"]), how, EXACT),
                ("ratio_max", np.nanmax(rows["ratio_max"]), how, EXACT),
                ("colliding_mean", colliding.mean(), how, ROUNDING),
                ("colliding_max", int(colliding.max()), how, EXACT),
                ("rendered_mean", rendered.mean(), how, ROUNDING),
                ("rendered_max", int(rendered.max()), how, EXACT),
                ("steps_in_contact", int(touching.sum()), how, EXACT),
                ("contact_share", touching.mean(), how, ROUNDING),
                ("last_contact_s", t[touching][-1], how, EXACT),
                ("landings", phases.landings, how, EXACT),
                ("landing_force_max_N", F[landing].max(), how, ROUNDING),
                ("landing_force_step_max_N", steps[landing].max(), how, ROUNDING),
                ("settled_s", settled.sum() * dt, how, ROUNDING),
                ("force_mean_in_contact_N", if_settled(lambda: F[settled].mean()), how, ROUNDING),
                ("settled_force_max_N", if_settled(lambda: F[settled].max()), how, ROUNDING),
                (
                    "force_step_p99_N",
                    if_settled(lambda: nearest_rank(steps[settled], 0.99)),
                    how,
                    BINNED,
                ),
                (
                    "settled_force_step_max_N",
                    if_settled(lambda: steps[settled].max()),
                    how,
                    ROUNDING,
                ),
                ("force_rms_above_30Hz_N", if_settled(lambda: rms(behind[settled])), how, FILTERED),
                (
                    "force_reversals_per_s",
                    if_settled(lambda: (reverses & settled).sum() / (settled.sum() * dt)),
                    how,
                    ROUNDING,
                ),
                *[(f"final_position_m.{x}", p[-1, i], how, EXACT) for i, x in enumerate("xyz")],
            ],
        )


@scene
def too_coarse(bench):
    """Checks that metrics without a value are empty, not 0. The time step of 20 ms has a Nyquist frequency of 25 Hz,
    so the run has no band above 30 Hz. Its contact lasts for a single time step."""
    run = bench.run(
        bench.scenario(
            "too_coarse",
            time={"step_s": 0.02, "steps": 50},
            environment={
                "type": "springs",
                "bilateral": False,
                "groups": [{"direction": [0, 0, -1], "count": 1}],
            },
            motion={
                "position": {
                    "type": "prescribed",
                    "x_m": 0,
                    "y_m": 0,
                    "z_m": {
                        "type": "waypoints",
                        "points": [[0, 1e-3], [0.49, 1e-3], [0.5, -1e-3], [0.51, 1e-3]],
                    },
                }
            },
            rendering={**TOUCHES["rendering"], "reduction": None},
        )
    )
    none = (
        "vibration_power_above_30Hz_m2_per_s2",
        "force_rms_above_30Hz_N",
        "vibration_last_quarter_m_per_s",
        "force_mean_in_contact_N",
        "settled_force_max_N",
        "force_step_p99_N",
        "force_reversals_per_s",
        "reduction_changes",
        "inside_max_m",
    )
    bench.metrics(
        run, [(name, None, "none is sampled, settled, or there", EXACT, "0", 0.0) for name in none]
    )
