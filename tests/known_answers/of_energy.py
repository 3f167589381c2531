"""Known answers for the energies of a run. The known values come from recurrences and from the trapezoidal rule along
paths."""
import math

import numpy as np

from answers import EXACT, ROUNDING, Within, profile, rms, scene
from physics import FILTERED, SPRING, STEPPED, SUMMED, high_pass


@scene
def mean_of_two(bench):
    """Checks the energies of a tool that moves onto two springs, then sideways off one spring, then away from the other
    spring. The law `mean` halves the force of two springs, so that this cycle creates energy."""
    K, dt, n = 1000.0, 0.001, 400
    U = np.array([[0, 0, -1.0], [0.8, 0, -0.6]])
    path = {
        "x_m": {"type": "ramp", "start": 5e-4, "rate_per_s": -0.02},
        "y_m": 0,
        "z_m": {
            "type": "sine",
            "mean": -1e-3,
            "amplitude": 2.5e-3,
            "period_s": 0.4,
            "phase_rad": 2.0,
        },
    }
    run = bench.run(
        bench.scenario(
            "mean_of_two",
            time={"step_s": dt, "steps": n},
            record={"energy": True},
            motion={"position": {"type": "prescribed", **path}},
            environment={
                "type": "springs",
                "bilateral": False,
                "groups": [{"direction": list(u), "count": 1} for u in U],
            },
            rendering={
                "algorithm": "mean",
                "stiffness_N_per_m": K,
                "damping_ratio": 0.02,
                "mass_kg": 0.01,
                "friction": {"mu_s_N_s_per_m": 0.01, "mu_f_s_per_m": 0},
            },
        )
    )
    t, B = np.arange(n) * dt, 0.04 * math.sqrt(K * 0.01)
    p = np.column_stack([profile(path[a], t) for a in ("x_m", "y_m", "z_m")])
    v = np.diff(p, axis=0, prepend=[2 * p[0] - p[1]]) / dt
    d = np.maximum(0, p @ U.T)
    count = np.sum(d > 0, axis=1)
    c = (d > 0) / np.maximum(1, count)[:, None]
    spring = -K * (c * d) @ U
    normal = np.einsum("kn,ni,nj,kj->ki", c, U, U, v)
    f = spring - B * normal - 0.01 * (v - normal) * (count > 0)[:, None]
    stored = 0.5 * K * np.sum(c * d**2, axis=1)
    moved, halves = np.diff(p, axis=0), lambda x: 0.5 * (x[1:] + x[:-1])
    onto = lambda force: np.r_[
        0, np.cumsum(np.sum(halves(force) * moved, axis=1))
    ]  # trapezoidal rule
    held = lambda force: np.r_[0, np.cumsum(np.sum(force[:-1] * moved, axis=1))]
    created = np.diff(stored) + np.diff(onto(spring))
    kinetic = 0.5 * 0.01 * np.sum(v**2, axis=1)
    script = kinetic - kinetic[0] - onto(f)
    observed = stored[0] - onto(f)
    lowest = int(np.argmin(observed))
    by, rect = "trapezoidal rule along the path", "the row's force held over the step"
    bench.metrics(
        run,
        [
            (
                "energy.created_sum_J",
                created[created > 0].sum(),
                by,
                STEPPED,
                "net of what is destroyed",
                created.sum(),
            ),
            (
                "energy.created_max_J",
                created.max(),
                by,
                STEPPED,
                "largest of the absolute values",
                np.abs(created).max() + created.max(),
            ),
            (
                "energy.created_J",
                created.sum(),
                by,
                Within("twenty roundings of 1e-18 J a row", absolute=1e-17),
                rect,
                stored[-1] - stored[0] + held(spring)[-1],
            ),
            ("energy.spring_J", onto(spring)[-1], by, STEPPED, rect, held(spring)[-1]),
            ("energy.damping_J", onto(f - spring)[-1], by, STEPPED, rect, held(f - spring)[-1]),
            (
                "energy.script_J",
                script[-1],
                "kinetic energy less the work of f",
                STEPPED,
                "without the kinetic energy",
                -onto(f)[-1],
            ),
            (
                "energy.integration_J",
                0.0,
                "nothing is integrated",
                Within("twenty roundings of 1e-18 J a row", absolute=1e-17),
                rect,
                held(spring)[-1] - onto(spring)[-1],
            ),
            (
                "passivity.energy_min_J",
                observed[lowest],
                "E_k = E_0 - sum of the rule",
                STEPPED,
                rect,
                (stored[0] - held(f)).min(),
            ),
            (
                "passivity.time_of_min_s",
                t[lowest],
                "the row with that",
                EXACT,
                "the last row",
                t[-1],
            ),
            (
                "passivity.energy_end_J",
                observed[-1],
                "E_k of the last row",
                STEPPED,
                rect,
                stored[0] - held(f)[-1],
            ),
            (
                "passivity.net_created_J",
                max(0, -observed[lowest]),
                "max(0, -min E)",
                STEPPED,
                "all steps that created some",
                created[created > 0].sum(),
            ),
        ],
    )
    events_of_two(bench, by, count, created, d, run, t)
    rows_of_two(
        bench,
        K,
        by,
        created,
        d,
        dt,
        f,
        held,
        kinetic,
        n,
        onto,
        rect,
        run,
        script,
        spring,
        stored,
        t,
    )


def rows_of_two(
    bench, K, by, created, d, dt, f, held, kinetic, n, onto, rect, run, script, spring, stored, t
):
    """Checks the rows of energy.csv: the work accumulated along the path."""
    rows = [
        ("step", np.arange(n), "0, 1, ...", EXACT, "from 1", np.arange(n) + 1),
        ("time_s", t, "k dt", EXACT, "after the step", t + dt),
        ("kinetic_J", kinetic, "M v^2 / 2", STEPPED, "of the handle's speed squared", 2 * kinetic),
        (
            "stored_J",
            stored,
            "sum K c d^2 / 2",
            STEPPED,
            "of all springs in full",
            0.5 * K * np.sum(d**2, axis=1),
        ),
        ("spring_J", onto(spring), by, STEPPED, rect, held(spring)),
        ("damping_J", onto(f - spring), by, STEPPED, rect, held(f - spring)),
        (
            "created_J",
            np.r_[0, np.cumsum(created)],
            by,
            STEPPED,
            rect,
            stored - stored[0] + held(spring),
        ),
        (
            "script_J",
            script,
            "kinetic energy less the work of f",
            STEPPED,
            "without the kinetic energy",
            -onto(f),
        ),
    ]
    bench.columns(run.table("energy.csv"), rows)


def events_of_two(bench, by, count, created, d, run, t):
    """Checks the rows that create the most energy, and the contacts that begin or end in these rows."""
    events = [
        event for event in run.summary["energy"]["events"] if event["created_J"] > 1e-12
    ]  # the other amounts are rounding errors
    largest = 1 + np.argsort(-created)[: len(events)]
    changes = np.diff((d > 0).astype(int), axis=0, prepend=0)
    pairs = [x for k in largest for x in (count[k - 1], count[k])]
    for key, known, how, naive in (
        ("step", list(largest), "rows that created most, in order", list(largest - 1)),
        ("time_s", list(t[largest]), "the same", list(t[largest - 1])),
        ("created_J", list(created[largest - 1]), by, list(-created[largest - 1])),
        ("colliding", pairs, "springs before and after", pairs[::-1]),
        ("rendered", pairs, "springs before and after", pairs[::-1]),
        (
            "appeared",
            [int((changes[k] > 0).sum()) for k in largest],
            "new springs",
            [9] * len(largest),
        ),
        (
            "vanished",
            [int((changes[k] < 0).sum()) for k in largest],
            "springs that went",
            [9] * len(largest),
        ),
    ):
        printed = [
            x
            for event in events
            for x in (event[key] if isinstance(event[key], list) else [event[key]])
        ]
        bench.add(
            "energy.created_max_J" if key == "created_J" else f"run --json: {key}",
            printed,
            known,
            how,
            STEPPED,
            ("another order, or row", naive),
        )


@scene
def limited_hand(bench):
    """Checks the energies of a free mass on a damped spring. The force of the hand is a ramp that the device limits, so
    that the motion is a linear recurrence."""
    K, M, dt, n, limit = 2000.0, 0.2, 0.001, 300, 0.6
    B = 2 * 0.1 * math.sqrt(K * M)
    run = bench.run(
        bench.scenario(
            "limited_hand",
            time={"step_s": dt, "steps": n},
            record={"energy": True},
            initial={"position_m": [1e-3, 0, 0], "velocity_m_per_s": [0.02, 0, 0]},
            environment=SPRING,
            hand={"type": "force", "x_N": {"type": "ramp", "start": 0.1, "rate_per_s": 3.0}},
            device={"type": "ideal", "force_limit_N": limit},
            rendering={**SUMMED, "stiffness_N_per_m": K, "damping_ratio": 0.1, "mass_kg": M},
        )
    )
    x, v, t = np.zeros(n), np.zeros(n), np.arange(n) * dt
    hand = 0.1 + 3.0 * t
    given = np.minimum(hand, limit)
    x[0], v[0] = 1e-3, 0.02
    for k in range(n - 1):
        v[k + 1] = v[k] + (given[k] - K * x[k] - B * v[k]) * dt / M
        x[k + 1] = x[k] + v[k + 1] * dt
    held = Within(
        "a recurrence of 300 steps, each rounded in another order", relative=1e-11, absolute=1e-17
    )
    total = lambda w: np.r_[0, np.cumsum(w)]
    mean_displacement = (
        0.5 * (v[1:] + v[:-1]) * dt
    )  # displacement along which the held force does work
    along = lambda force: total(force[:-1] * mean_displacement)
    displacement = np.diff(x)
    spring = -K * x
    kinetic, stored = 0.5 * M * v**2, 0.5 * K * x**2
    integration = along(spring) - total(0.5 * (spring[1:] + spring[:-1]) * displacement)
    by, naive = "held force times mean velocity", "held force times the displacement"
    on = lambda force: total(force[:-1] * displacement)
    rows = [
        ("input_J", along(given), by, held, naive, on(given)),
        ("spring_J", along(spring), by, held, naive, on(spring)),
        ("damping_J", along(-B * v), by, held, naive, on(-B * v)),
        (
            "hand_J",
            along(hand),
            "the same of the hand's force",
            held,
            "the limited force",
            along(given),
        ),
        (
            "actuator_J",
            along(given - hand),
            "what the limiter takes away",
            held,
            "none",
            np.zeros(n),
        ),
        (
            "integration_J",
            integration,
            "less the trapezoidal rule along the displacement",
            held,
            "none",
            np.zeros(n),
        ),
        ("rotation_J", np.zeros(n), "nothing turns", EXACT),
    ]
    bench.metrics(
        run,
        [
            (
                f"energy.{name}",
                series[-1],
                *rest[:2],
                *((rest[2], rest[3][-1]) if len(rest) > 2 else ()),
            )
            for name, series, *rest in rows
            if name not in ("spring_J", "damping_J")
        ],
    )
    rounded = Within("300 roundings of terms up to 2 mJ", absolute=300 * 2e-3 * 2.0**-52)
    bench.metrics(
        run,
        [
            (
                "energy.residual_max_J",
                0.0,
                "the terms explain everything",
                rounded,
                "with the works along the displacement",
                float(np.max(np.abs(kinetic - kinetic[0] - on(given - K * x - B * v)))),
            )
        ],
    )
    bench.columns(
        run.table("energy.csv"),
        [
            *rows,
            ("kinetic_J", kinetic, "M v^2 / 2", held, "of the next row", np.r_[kinetic[1:], 0]),
            ("stored_J", stored, "K x^2 / 2", held, "of the next row", np.r_[stored[1:], 0]),
            (
                "created_J",
                np.zeros(n),
                "a linear spring",
                rounded,
                naive,
                stored - stored[0] + on(spring),
            ),
            (
                "residual_J",
                np.zeros(n),
                "the terms explain everything",
                rounded,
                "with the works along the displacement",
                kinetic - kinetic[0] - on(given - K * x - B * v),
            ),
        ],
    )
    bench.columns(
        run.table(),
        [
            ("px_m", x, "recurrence", held, "explicit Euler's", x - v * dt),
            ("vx_m_per_s", v, "recurrence", held, "of the next row", np.r_[v[1:], 0]),
            ("fmeas_x_N", hand, "the ramp", ROUNDING, "the limited force", given),
            ("fin_x_N", given, "cut at 0.6 N", ROUNDING, "uncut", hand),
            *[
                (
                    f"{name}_{y}_N",
                    np.zeros(n),
                    "the hand pushes along x",
                    EXACT,
                    "the same as along x",
                    hand,
                )
                for name in ("fmeas", "fin")
                for y in "yz"
            ],
        ],
    )


@scene
def handle_on_spring(bench):
    """Checks the energies of the handle of an impedance device on a spring. The spring force is delayed by a sample and
    held, so that the motion between samples has a closed form."""
    m, b, K, dt, n, push = 0.3, 2.0, 800.0, 0.002, 400, 0.5
    run = bench.run(
        bench.scenario(
            "handle_on_spring",
            time={"step_s": dt, "steps": n},
            record={"energy": True},
            initial={"position_m": [1e-3, 0, 0]},
            environment=SPRING,
            hand={"type": "force", "x_N": push},
            rendering={**SUMMED, "stiffness_N_per_m": K},
            device={
                "type": "impedance",
                "handle_mass_kg": m,
                "viscous_N_s_per_m": b,
                "delay_samples": 1,
            },
        )
    )
    decay = math.exp(-b * dt / m)
    x, v, motors = np.zeros(n), np.zeros(n), np.zeros(n)
    x[0] = 1e-3
    for k in range(n - 1):
        motors[k] = 0 if k == 0 else -K * x[k - 1]
        end = (motors[k] + push) / b  # terminal velocity
        v[k + 1] = end + (v[k] - end) * decay
        x[k + 1] = x[k] + end * dt + (v[k] - end) * (1 - decay) * m / b
    held = Within(
        "400 steps of a decaying loop, each rounded in another order",
        relative=1e-11,
        absolute=1e-17,
    )
    displacement, total = np.diff(x), lambda w: np.r_[0, np.cumsum(w)]
    hand, motor, kinetic = (
        total(push * displacement),
        total(motors[:-1] * displacement),
        0.5 * m * v**2,
    )
    lost = hand + motor - (kinetic - kinetic[0])
    shown_v = np.r_[0.0, np.diff(x) / dt]
    spring = -K * x
    work = total(spring[:-1] * displacement)
    zero = np.zeros(n)
    bench.columns(
        run.table("energy.csv"),
        [
            (
                "device_dissipated_J",
                -lost,
                "kinetic energy less the work of hand and motors",
                held,
                "-b v^2 dt",
                -total(b * v[:-1] ** 2 * dt),
            ),
            (
                "device_stored_J",
                kinetic,
                "m v^2 / 2 of the exact speed",
                held,
                "of the measured speed",
                0.5 * m * shown_v**2,
            ),
            (
                "hand_J",
                hand,
                "push times way",
                held,
                "with the measured speed a row late",
                total(push * shown_v[:-1] * dt),
            ),
            ("actuator_J", motor, "held late force times way", held, "without the delay", work),
            (
                "spring_J",
                work,
                "row's force times the way to the next",
                held,
                "trapezoidal rule",
                total(0.5 * (spring[1:] + spring[:-1]) * displacement),
            ),
            (
                "integration_J",
                work + 0.5 * K * (x**2 - x[0] ** 2),
                "work of the held force less that of the spring",
                held,
                "none",
                zero,
            ),
            ("kinetic_J", zero, "there is no virtual mass", EXACT, "of the handle", kinetic),
        ],
    )
    bench.metrics(
        run,
        [
            (
                "energy.hand_J",
                hand[-1],
                "push times way",
                held,
                "with the force of the virtual tool",
                hand[-1] + work[-1],
            ),
            (
                "energy.actuator_J",
                motor[-1],
                "held late force times way",
                held,
                "without the delay",
                work[-1],
            ),
            (
                "energy.script_J",
                -work[-1],
                "work of the handle on the rendering",
                held,
                "none",
                0.0,
            ),
            (
                "vibration_last_quarter_m_per_s",
                rms(high_pass(v[:, None], dt)[300:]),
                "scipy's filter on the exact speed",
                FILTERED,
                "on the measured speed",
                rms(high_pass(shown_v[:, None], dt)[300:]),
            ),
            (
                "speed_max_m_per_s",
                np.abs(v).max(),
                "the handle's own speed",
                held,
                "the measured one, difference of positions",
                np.abs(shown_v).max(),
            ),
            (
                "passivity.energy_end_J",
                0.5 * K * x[0] ** 2 - work[-1],
                "E_0 less the held work",
                held,
                "the energy stored at the end",
                0.5 * K * x[-1] ** 2,
            ),
        ],
    )
    bench.columns(
        run.table(),
        [
            ("hx_m", x, "exact motion of the handle", held, "Euler's", x + v * dt),
            ("hvx_m_per_s", v, "the handle's own speed", held, "the measured one", shown_v),
            ("vx_m_per_s", shown_v, "difference of positions", held, "the handle's own", v),
            ("fx_N", spring, "-K x of the row", held, "a row late", motors),
        ],
    )
