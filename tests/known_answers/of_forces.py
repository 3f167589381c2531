"""Known answers for the comparison with an exact or measured reference force."""
import math

import numpy as np

from answers import EXACT, ROUNDING, Table, Within, norms, profile, rms, scene
from physics import BELOW, STEPPED, SUMMED


# Points (time [s], position [m]) of a motion along z. The motion is not periodic, so only one lag fits the reference.
STEPS = [
    [0, 0],
    [0.1, -1e-3],
    [0.18, -0.4e-3],
    [0.3, -1.6e-3],
    [0.36, -1.1e-3],
    [0.52, -2e-3],
    [0.6, -0.3e-3],
    [0.8, -0.9e-3],
    [1, -0.5e-3],
]


@scene
def delayed_force(bench):
    """Checks the metrics of a force that lags the reference by 30 ms. The reference also has a perpendicular
    component."""
    K, dt, n, delay = 1000.0, 0.0005, 2000, 0.03
    reference = {
        "z_N": {"type": "waypoints", "points": [[max(0, s - delay), -K * z] for s, z in STEPS[1:]]},
        "x_N": 0.05,
    }
    path = {
        "x_m": {"type": "sine", "mean": 0, "amplitude": 4e-5, "period_s": 0.01, "phase_rad": 0.4},
        "y_m": 0,
        "z_m": {"type": "waypoints", "points": [[0, 0], *STEPS[1:]]},
    }
    run = bench.run(
        bench.scenario(
            "late_force",
            time={"step_s": dt, "steps": n},
            motion={"position": {"type": "prescribed", **path}},
            reference_force=reference,
            environment={
                "type": "springs",
                "groups": [
                    {"direction": [0, 0, -1], "count": 1},
                    {"direction": [1, 0, 0], "count": 1},
                ],
            },
            record={"force_reference": True},
            rendering={**SUMMED, "stiffness_N_per_m": K, "damping_ratio": 0.5, "mass_kg": 0.01},
        )
    )
    t, B = np.arange(n) * dt, math.sqrt(K * 0.01)
    p = np.column_stack([profile(path[a], t) for a in ("x_m", "y_m", "z_m")])
    v = np.diff(p, axis=0, prepend=[2 * p[0] - p[1]]) / dt
    spring = -K * p
    f = spring - B * v
    m = np.column_stack([np.full(n, 0.05), np.zeros(n), profile(reference["z_N"], t)])
    error, size = f - m, norms(m)
    unit = spring / np.maximum(1e-300, norms(spring))[:, None]
    along = np.sum(error * unit, axis=1)
    load = np.maximum(0.0, np.sum(m * unit, axis=1))
    line = m / size[:, None]
    across = f - np.sum(f * line, axis=1)[:, None] * line
    both = (size > 0.1) & (norms(f) > 0.1)
    angles = np.arccos(np.clip(np.sum(f * m, axis=1) / size / norms(f), -1, 1))
    shifts = np.arange(-200, 201)

    def fits(s):
        a, b = m[max(0, -s) : n - max(0, s)], f[max(0, s) : n - max(0, -s)]
        a, b = a - a.mean(axis=0), b - b.mean(axis=0)
        return np.sum(a * b) / math.sqrt(np.sum(a * a) * np.sum(b * b))

    lags = np.array([fits(s) for s in shifts])
    lag = shifts[np.argmax(lags)] * dt
    formula = "the rendered force's formula and the profile"
    fifth = Within("a lag is told to a row", absolute=0.5 * dt)
    bench.metrics(
        run,
        [
            (
                "fidelity.rows",
                n,
                "every row has a reference",
                EXACT,
                "rows of both above 0.1 N",
                int(both.sum()),
            ),
            (
                "fidelity.reference_force_rms_N",
                rms(m),
                formula,
                STEPPED,
                "of z alone",
                rms(m[:, 2]),
            ),
            (
                "fidelity.force_error_rms_N",
                rms(error),
                formula,
                STEPPED,
                "difference of the norms",
                rms(norms(f) - size),
            ),
            (
                "fidelity.force_error_relative",
                rms(error) / rms(m),
                formula,
                STEPPED,
                "over the rendered force",
                rms(error) / rms(f),
            ),
            (
                "fidelity.force_error_normal_rms_N",
                rms(along),
                "along f_spring",
                STEPPED,
                "along f",
                rms(np.sum(error * f, axis=1) / norms(f)),
            ),
            (
                "fidelity.force_error_tangential_rms_N",
                rms(error - along[:, None] * unit),
                "across f_spring",
                STEPPED,
                "across f_m",
                rms(error - np.sum(error * line, axis=1)[:, None] * line),
            ),
            (
                "fidelity.reference_mu",
                float(np.sum(load * norms(m - load[:, None] * unit)) / np.sum(load**2)),
                "least squares across f_spring over along it",
                STEPPED,
                "mean of the ratios",
                float(np.mean(norms(m - load[:, None] * unit) / np.maximum(load, 1e-9))),
            ),
            (
                "fidelity.force_artefact_share",
                rms(across) / rms(f),
                "across f_m over f",
                STEPPED,
                "over f_m",
                rms(across) / rms(m),
            ),
            (
                "fidelity.direction_rows",
                int(both.sum()),
                "rows of both above 0.1 N",
                EXACT,
                "all rows",
                n,
            ),
            (
                "fidelity.force_direction_error_rad",
                angles[both].mean(),
                "mean angle, by the cosine",
                Within("a cosine loses half the digits near 0", relative=1e-7),
                "over all rows",
                angles.mean(),
            ),
            (
                "fidelity.force_lag_s",
                lag,
                "numpy's correlation at every shift",
                fifth,
                "with the other sign",
                -lag,
            ),
            (
                "fidelity.force_lag_period_s",
                None,
                "the path repeats nothing",
                EXACT,
                "the ripple's period",
                0.01,
            ),
        ],
    )
    bench.tolerance(
        run,
        "fidelity.force_lag_s",
        0.5 * dt,
        "half a row",
        ROUNDING,
        ("a parabola's top is exact", 0.0),
        lag,
    )
    bench.columns(
        run.table("force_reference.csv"),
        [
            ("step", np.arange(n), "0, 1, ...", EXACT, "from 1", np.arange(n) + 1),
            ("time_s", t, "k dt", EXACT, "after the step", t + dt),
        ]
        + [
            (f"mf{x}_N", m[:, i], "the profile", ROUNDING, "f", f[:, i] + (x == "y"))
            for i, x in enumerate("xyz")
        ]
        + [
            (
                f"force_error_{x}_N",
                error[:, i],
                formula,
                STEPPED,
                "f_m - f",
                -error[:, i] + (x == "y"),
            )
            for i, x in enumerate("xyz")
        ],
    )


@scene
def periodic_force(bench):
    """Checks the lag of a force behind a reference of 20 Hz. A periodic force has many possible lags, which differ by
    the period. The known values are the smallest lag and the period."""
    run = bench.run(
        bench.scenario(
            "periodic_force",
            time={"step_s": 0.0005, "steps": 2000},
            reference_force={"z_N": {"type": "sine", "mean": 2, "amplitude": 1, "period_s": 0.05}},
            environment=BELOW,
            rendering=SUMMED,
            motion={
                "position": {
                    "type": "prescribed",
                    "x_m": 0,
                    "y_m": 0,
                    "z_m": {
                        "type": "sine",
                        "mean": -2e-3,
                        "amplitude": 1e-3,
                        "period_s": 0.05,
                        "phase_rad": math.pi - 0.4,
                    },
                }
            },
        )
    )
    # The force is proportional to -z, which lags the reference by 0.4 rad.
    lag = Within(
        "a parabola through three rows of a cosine finds its top to (omega dt)^2 / 24 of a row",
        absolute=1e-6,
    )
    bench.metrics(
        run,
        [
            (
                "fidelity.force_lag_s",
                0.4 / (2 * math.pi) * 0.05,
                "phase over angular frequency",
                lag,
                "a period earlier",
                -0.05 + 0.4 / (2 * math.pi) * 0.05,
            ),
            ("fidelity.force_lag_period_s", 0.05, "the sine's", lag, "half of it", 0.025),
        ],
    )


@scene
def recorded_force(bench):
    """Checks a stroke whose force was measured only in its middle. Motion and force are linear between samples. Rows
    outside of the measurement have no reference."""
    K, dt, n = 500.0, 0.001, 1000
    t = np.array([0.1, 0.25, 0.45, 0.7])
    position, force = np.array([0, -1e-3, -3e-3, -2e-3]), np.array(
        [[0, 0, 0.1], [0.1, 0, 0.6], [0.2, -0.1, 1.4], [0, 0, 1.1]]
    )
    bench.write(
        "stroke.csv",
        "time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z,mfx_N,mfy_N,mfz_N",
        np.column_stack([t, 0 * t, 0 * t, position, 0 * t, 0 * t, 0 * t - 1, force]),
    )
    run = bench.run(
        bench.scenario(
            "recorded_force",
            time={"step_s": dt, "steps": n},
            motion={"position": {"type": "file", "file": "stroke.csv"}},
            record={"force_reference": True},
            environment=BELOW,
            rendering={**SUMMED, "stiffness_N_per_m": K},
        )
    )
    at = np.arange(n) * dt
    m = np.column_stack([np.interp(at, t, force[:, i]) for i in range(3)])
    f = np.column_stack([0 * at, 0 * at, -K * np.interp(at, t, position)])
    has = (at >= t[0]) & (at <= t[-1])
    error = (f - m)[has]
    how = "linear between the samples"
    bench.metrics(
        run,
        [
            (
                "fidelity.rows",
                int(has.sum()),
                "rows from the first sample to the last",
                EXACT,
                "all rows",
                n,
            ),
            ("fidelity.reference_force_rms_N", rms(m[has]), how, STEPPED, "over all rows", rms(m)),
            ("fidelity.force_error_rms_N", rms(error), how, STEPPED, "over all rows", rms(f - m)),
            (
                "fidelity.force_artefact_share",
                rms(
                    f[has]
                    - np.sum(f * m, axis=1)[has, None] * m[has] / np.sum(m * m, axis=1)[has, None]
                )
                / rms(f[has]),
                "across f_m over f",
                STEPPED,
                "over all rows",
                rms(error) / rms(f),
            ),
        ],
    )
    bench.columns(
        run.table("force_reference.csv"),
        [
            (f"mf{x}_N", np.where(has, m[:, i], np.nan), how, STEPPED, "held beyond", m[:, i])
            for i, x in enumerate("xyz")
        ]
        + [
            (
                f"force_error_{x}_N",
                np.where(has, (f - m)[:, i], np.nan),
                how,
                STEPPED,
                "held beyond",
                (f - m)[:, i],
            )
            for i, x in enumerate("xyz")
        ],
    )


@scene
def imported(bench):
    """Checks the report of `import` for a recording whose positions have resolutions of 10, 20 and 5 um."""
    t = np.arange(400) * 0.002
    p = np.column_stack(
        [
            np.round(1e-3 * np.sin(7 * t) / 1e-5) * 1e-5,
            np.round(2e-3 * np.cos(5 * t) / 2e-5) * 2e-5,
            np.round(-1e-3 * t / 5e-6) * 5e-6,
        ]
    )
    f = np.column_stack([np.full(400, 0.1), np.full(400, 0.2), np.sin(t)])
    bench.write("rec.csv", "t,x,y,z,fx,fy,fz", np.column_stack([t, p, f]))
    summary = bench.json(
        "import",
        "stroke",
        "rec.csv",
        "--columns",
        "time=t,position=x,force=fx",
        "--out",
        "stroke.csv",
    )
    speed = norms(np.diff(p, axis=0)) / 0.002
    close = Within(
        "times and places as written, with all their digits", relative=1e-9, absolute=1e-15
    )
    q = np.array([1e-5, 2e-5, 5e-6])
    bench.add(
        "quantum (number of import)",
        summary["quantum_m"],
        q,
        "steps they were rounded to",
        close,
        ("least difference of places", [1e-18] * 3),
    )
    for key, known, within, naive_answer, naive in (
        ("quantum_m", q, close, "mean step", q * 2),
        ("quantum_force_N", 20000 * 2e-5, close, "of the finest axis", 0.1),
        ("rows_read", 400, EXACT, "with the header", 401),
        ("rows_left_out", 0, EXACT, "the header", 1),
        ("columns_not_read", [], EXACT, "the force's", ["fx"]),
        ("rows_per_held_sample", 1.0, EXACT, "each pose twice", 2.0),
        ("samples", 400, EXACT, "intervals", 399),
        ("rate_Hz", 500, close, "samples over duration", 400 / 0.798),
        ("resampled", False, EXACT, "rounded times", True),
        ("first_time_s", 0.0, EXACT, "the second", 0.002),
        ("duration_s", 0.798, close, "samples over rate", 0.8),
        ("gaps", 0, EXACT, "one", 1),
        (
            "box_m",
            [p.min(axis=0), p.max(axis=0)],
            close,
            "about the mean",
            [p.min(axis=0) - p.mean(axis=0), p.max(axis=0) - p.mean(axis=0)],
        ),
        (
            "speed_max_m_per_s",
            speed.max(),
            close,
            "largest component",
            np.abs(np.diff(p, axis=0)).max() / 0.002,
        ),
        (
            "speed_p99_m_per_s",
            np.percentile(speed, 99),
            Within("ranks of 99 % differ by one of 399", relative=0.02),
            "mean",
            speed.mean(),
        ),
        ("has_roll", False, EXACT, "poses", True),
        ("tip_direction", [0, 0, -1], ROUNDING, "up", [0, 0, 1]),
        ("tip_direction_spread_rad", 0.0, ROUNDING, "some", 1.0),
        ("unit_deviation", 0.0, ROUNDING, "some", 1.0),
        ("force_min_N", norms(f).min(), close, "of z", f[:, 2].min()),
        ("force_max_N", norms(f).max(), close, "of z", f[:, 2].max()),
        ("smoothing", None, EXACT, "some", 5),
        ("warnings", [], EXACT, "some", ["steps"]),
        ("file", "stroke.csv", EXACT, "the recording", "rec.csv"),
        ("next", "hapbench new stroke", EXACT, "run", "hapbench run rec.csv"),
    ):
        value = summary[key][:19] if key == "next" else summary[key]
        bench.add(
            f"import --json: {key}",
            value,
            known,
            "numpy on the recording",
            within,
            (naive_answer, naive),
        )
    columns = summary["columns"]
    for key, printed, known, naive in (
        ("orientation", columns["orientation"], [], [1]),
        (
            "component",
            [part["component"] for part in columns["position"]],
            list("xyz"),
            list("zyx"),
        ),
        ("column", [part["column"] for part in columns["force"]], [5, 6, 7], [4, 5, 6]),
    ):
        bench.add(
            f"import --json: {key}", printed, known, "as the header names", EXACT, ("others", naive)
        )
    for i, key in enumerate(("min", "median", "max")):
        bench.add(
            f"import --json: {key}",
            summary["interval_s"][key],
            0.002,
            "numpy on the recording",
            close,
            ("in milliseconds", 2.0),
        )


@scene
def rigid_tool_in_a_hand(bench):
    """Checks the metrics for a hand that lowers a round drill onto the face of a box. The reference is a rigid tool in
    the same hand."""
    x, y, z, radius, n, dt = 4.0, 3.0, 1.0, 0.5, 1200, 0.0005
    corners = [f"v {i} {j} {k}" for k in (-z, z) for j in (-y, y) for i in (-x, x)]
    faces = ["f 1 3 4 2", "f 5 6 8 7", "f 1 2 6 5", "f 3 7 8 4", "f 1 5 7 3", "f 2 4 8 6"]
    (bench.folder / "box.obj").write_text("\n".join(corners + faces) + "\n", encoding="utf-8")
    down = {"type": "waypoints", "points": [[0, 0.0021], [0.2, 0.0012], [0.5, 0.001]]}
    held = bench.scenario(
        "rigid_tool_in_a_hand",
        time={"step_s": dt, "steps": n},
        environment={"type": "mesh", "file": "box.obj", "scale": 0.001, "spacing_m": 1e-4},
        tool={"diameter_m": 2e-3 * radius, "length_m": 0.01, "tip": "round"},
        initial={"position_m": [0.0002, 0.0003, 0.0021]},
        hand={
            "type": "impedance",
            "stiffness_N_per_m": 400,
            "damping_N_s_per_m": 6,
            "target": {"x_m": 0.0002, "y_m": 0.0003, "z_m": down},
        },
        rendering={"algorithm": "mean", "stiffness_N_per_m": 3000, "mass_kg": 0.05},
        reference_force={"type": "rigid_contact"},
        record={"force_reference": True},
    )
    run = bench.run(held)
    target = profile(down, np.arange(n) * dt)
    rigid = np.column_stack(
        [
            np.full(n, 0.0002),
            np.full(n, 0.0003),
            np.maximum(target, 1e-3 * (z + radius)),
        ]
    )
    tip = run.table().vectors("px_m", "py_m", "pz_m")
    known = (
        rms(norms(tip - rigid)),
        "the free position of a ball over a face",
        Within("the distance to a triangle, in its own frame", relative=1e-9),
    )
    naive = ("distance from the target", rms(tip[:, 2] - target))
    bench.metrics(run, [("fidelity.displacement_rms_m", *known, *naive)])
    # reference_error_N is an estimate by the program. It must be at least the deviation of the reference force from the
    # closed form.
    reference = run.table("force_reference.csv").vectors("mfx_N", "mfy_N", "mfz_N")
    exact = 400.0 * (rigid - np.column_stack([rigid[:, :2], target]))
    error = run.summary["fidelity"]["reference_error_N"]
    largest = norms(reference - exact).max()
    bench.add(
        "run --json: reference_error_N",
        bool(largest <= error + 1e-14 and error < 1e-9),
        True,
        "at least the largest distance from the closed form, up to rounding of 1e-17 m times 400 N/m",
        EXACT,
        ("below it", bool(error < largest - 1e-14)),
    )
    force = run.table().vectors("fx_N", "fy_N", "fz_N")
    for metric, per_newton in (
        ("force_error_rms_N", 1.0),
        ("force_error_relative", 1.0 / rms(norms(reference))),
        ("force_error_normal_rms_N", 1.0),
        ("force_error_tangential_rms_N", 1.0),
        ("force_artefact_share", 1.0 / rms(norms(force))),
        ("force_direction_error_rad", 1.0 / 0.1),
        ("displacement_rms_m", 1.0 / 400.0),
    ):
        bench.add(
            f"run --json: tolerances.fidelity.{metric}",
            run.summary["tolerances"][f"fidelity.{metric}"],
            5.0 * error * per_newton,
            "five times the error of the reference, in the unit of the metric",
            ROUNDING,
            ("the error itself", error * per_newton),
        )
    over = bench.folder / "over"
    bench.hapbench("converge", held, "--over", "rendering.algorithm=mean", "--out", over, "--quiet")
    printed = Table(over / "convergence_model.csv")["displacement_rms_m"][0]
    bench.add("convergence_model.csv:displacement_rms_m", printed, *known, naive)
