"""Known answers for `compare --replay`: the log of a haptic loop on one spring is rendered again along its motion."""
import json

import numpy as np

from answers import EXACT, ROUNDING, Table, scene
from physics import PLAIN, SPRING

K, PERIOD, LIMIT, CALLS = 1000.0, 1e-3, 1.5, 40
GAP, FAULT, REARM = (
    20,
    30,
    34,
)  # the call after a gap of 20 ms, the call with NaN, and the call that ends the fault
WAITS = 4  # number of calls below engage_force
WAITING, ON, CLAMPED, STALE, IS_FAULT = 0, 2, 3, 4, 5
NOT_FINITE, MAX_FORCE = 1, 1

NAMES = (
    "call,time_ns,has,hx_m,hy_m,hz_m,qw,qx,qy,qz,vx_m_per_s,vy_m_per_s,vz_m_per_s,"
    "wx_rad_per_s,wy_rad_per_s,wz_rad_per_s,fhand_x_N,fhand_y_N,fhand_z_N,"
    "fapplied_x_N,fapplied_y_N,fapplied_z_N,input_reserved,fx_N,fy_N,fz_N,tx_N_m,ty_N_m,tz_N_m,"
    "set_x_m,set_y_m,set_z_m,set_vx_m_per_s,set_vy_m_per_s,set_vz_m_per_s,gain,dt_s,status,contacts,reason,limited"
)


def statuses():
    """Returns the status of each call by the rules of the renderer. The force has no ramp: it is either on or off."""
    found, below = [], 0
    for call in range(CALLS):
        if call == GAP:
            found.append(STALE)
            below = 0
        elif FAULT <= call < REARM:
            found.append(IS_FAULT)
            below = 0
        elif below < WAITS:
            found.append(WAITING)
            below += 1
        else:
            found.append(ON)
    return np.array(found)


@scene
def replay_of_a_log(bench):
    """Checks the replayed forces. The force of the spring is -K x while the renderer is on, limited to LIMIT."""
    scenario = bench.scenario(
        "replay",
        time={"step_s": PERIOD, "steps": CALLS},
        environment=SPRING,
        rendering={**PLAIN, "algorithm": "summation", "stiffness_N_per_m": K},
        device={"type": "impedance", "handle_mass_kg": 0.1},
    )
    calls = np.arange(CALLS)
    x = 2e-3 * np.cos(0.3 * calls)
    status = statuses()
    spring = np.where(status == ON, -K * x, 0.0)
    force = np.clip(spring, -LIMIT, LIMIT)
    status[np.abs(spring) > LIMIT] = CLAMPED
    time_ns = 1_000_000 * (calls + np.where(calls >= GAP, 20, 0))
    # A zero force is +0 or -0, depending on the product that gives it. Perpendicular to the spring, the product is -K
    # times 0. While the force is off, the product is 0 times the last force before the force turned off.
    recorded = force.copy()
    fallen = np.isin(status, (STALE, IS_FAULT))
    recorded[GAP] *= np.sign(force[GAP - 1])
    recorded[FAULT:REARM] *= np.sign(force[FAULT - 1])
    recorded[10] += 0.25  # one recorded call has a wrong force, which the replay must detect
    setup = {
        "version": 1,
        "scenario": "another",
        "scenario_hash": "0",
        "period_s": PERIOD,
        "mode": "impedance",
        "torque": False,
        "mount": {
            "world_from_device": {"position_m": [0, 0, 0], "orientation_wxyz": [1, 0, 0, 0]},
            "scale": 1,
            "handle_from_tip": {"position_m": [0, 0, 0], "orientation_wxyz": [1, 0, 0, 0]},
            "max_force_N": LIMIT,
            "max_force_rate_N_per_s": None,
            "ramp_s": 0,
            "stale_s": 0.01,
            "engage_force_N": 10,
        },
    }
    outputs = {
        "fx_N": recorded,
        "fy_N": np.where(status == WAITING, 0.0, -0.0),
        "fz_N": np.where(status == WAITING, 0.0, -0.0),
        "gain": np.isin(status, (ON, CLAMPED)),
        "dt_s": np.diff(time_ns, prepend=time_ns[0]) * 1e-9,
        "status": status,
        "contacts": ~fallen,
        "reason": NOT_FINITE * (status == IS_FAULT),
        "limited": MAX_FORCE * (status == CLAMPED),
    }
    inputs = {
        "call": calls,
        "time_ns": time_ns,
        "has": 32 * (calls == REARM),
        "hx_m": np.where(calls == FAULT, np.nan, x),
        "qw": np.ones(CALLS),
    }
    columns = {**inputs, **outputs}
    lines = ["# hapbench loop log: " + json.dumps(setup), NAMES]
    for i in calls:
        lines.append(
            ",".join(repr(columns[n][i].item()) if n in columns else "0" for n in NAMES.split(","))
        )
    text = "\n".join(lines).replace("True", "1").replace("False", "0")
    (bench.folder / "loop.csv").write_text(text + "\n", encoding="utf-8")
    words = ("compare", scenario, "--replay", "loop.csv", "--algorithms", "summation,mean")
    bench.hapbench(*words, "--out", "again", "--quiet")
    again = Table(bench.folder / "again" / "replay_comparison.csv")
    change = np.abs(np.diff(force, prepend=0.0)).max()
    for name, known, naive, wrong in (
        ("algorithm", "summation", "the second", "mean"),
        ("calls", CALLS, "without the first", CALLS - 1),
        ("equal_calls", CALLS - 1, "all", CALLS),
        ("loop_force_difference_max_N", 0.25, "none", 0.0),
        ("loop_force_max_N", LIMIT, "without the limit", np.abs(spring).max()),
        (
            "loop_force_rms_N",
            np.sqrt(np.mean(force**2)),
            "of ON",
            np.sqrt(np.mean(force[force != 0] ** 2)),
        ),
        ("loop_force_change_max_N", change, "without the limit", np.abs(np.diff(spring)).max()),
        ("fault_calls", REARM - FAULT, "the first", 1),
        ("stale_calls", 1, "none", 0),
        ("clamped_calls", np.sum(status == CLAMPED), "with ON", np.sum(force != 0)),
    ):
        bench.add(
            f"replay_comparison.csv:{name}",
            again[name],
            [known] * 2 if name != "algorithm" else ["summation", "mean"],
            "a spring whose force is on or off",
            EXACT if isinstance(known, (str, int)) else ROUNDING,
            (naive, [wrong] * 2),
        )
