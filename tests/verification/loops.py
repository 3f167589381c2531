"""Verification of linear limits. Eigenvalues of the loop of hand, device and contact, computed here with numpy from the
description of the devices in the manual, are compared with `limit` and with runs. Shares no code with hapbench.

  python3 tests/verification/loops.py PROGRAM [COUNT]    # COUNT random loops of each pair, default 2
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy import signal
from scipy.linalg import expm

PROGRAM = Path(sys.argv[1]).resolve()
COUNT = int(sys.argv[2]) if len(sys.argv) > 2 else 2
RANDOM = np.random.default_rng(85)
# `limit` bisects eigenvalues to 1e-11. A double eigenvalue has an error of the square root of rounding, 1e-8.
SPRINGS_AGREE = 1e-7
# The derivative of a rendered force is a difference quotient with an error of 1e-7; the limit depends on it about
# linearly.
SURFACES_AGREE = 1e-5
# Distance of K in the runs from the limit (relative), the amplitude ratio that a run must reach, and the largest number
# of steps.
BESIDE, GROWN, MOST_STEPS = 0.05, 100.0, 200_000


def map_of(step, n):
    """Returns the matrix of a linear function of n numbers."""
    return np.column_stack([step(unit) for unit in np.eye(n)])


def radius(A):
    return np.abs(np.linalg.eigvals(A)).max()


def held(rate, inputs, t):
    """Returns the maps of state and constant inputs of z' = rate z + inputs u over the time t."""
    n, m = rate.shape[0], inputs.shape[1]
    joint = np.zeros((n + m, n + m))
    joint[:n, :n], joint[:n, n:] = rate, inputs
    whole = expm(joint * t)
    return whole[:n, :n], whole[:n, n:]


class LowPass:
    """Butterworth low-pass with an input that is held over the period before its sample."""

    def __init__(self, given, T):
        if given is None:
            self.n = 0
            return
        analog = signal.butter(
            given["order"], 2 * np.pi * given["cutoff_Hz"], analog=True, output="zpk"
        )
        A, B, self.C, _ = signal.zpk2ss(*analog)
        self.A, self.B, *_ = signal.cont2discrete((A, B, self.C, 0), T)
        self.n = len(A)

    def step(self, state, u):
        if self.n == 0:
            return state, u
        state = self.A @ state + self.B[:, 0] * u
        return state, (self.C @ state)[0]


def impedance_map(scene, K):
    """The handle, or motors and handle, move exactly between samples. The wall acts on the measured position."""
    T, device, B = scene["time"]["step_s"], scene["device"], scene["rendering"]["damping_N_s_per_m"]
    hand = scene["hand"]
    m, b = device["handle_mass_kg"], device["viscous_N_s_per_m"]
    attached = hand if hand["type"] == "mass_spring_damper" else {}
    sampled = hand if hand["type"] == "impedance" else {}
    M, k, c = (
        attached.get(name, 0.0) for name in ("mass_kg", "stiffness_N_per_m", "damping_N_s_per_m")
    )
    if "transmission" in device:
        given = device["transmission"]
        motor = given["motor_share"] * m
        handle = m - motor + M
        s, d = given["stiffness_N_per_m"], given["damping_N_s_per_m"]
        rate = np.array(
            [
                [0, 1, 0, 0],
                [-s / motor, -(d + b) / motor, s / motor, d / motor],
                [0, 0, 0, 1],
                [s / handle, d / handle, -(s + k) / handle, -(d + c) / handle],
            ]
        )
        inputs = np.array([[0, 0], [1 / motor, 0], [0, 0], [0, 1 / handle]])
    else:
        rate = np.array([[0, 1], [-k / (m + M), -(b + c) / (m + M)]])
        inputs = np.array([[0, 0], [1 / (m + M), 1 / (m + M)]])
    body = len(rate)
    position, velocity = LowPass(device.get("position_filter"), T), LowPass(
        device["velocity_filter"] if device["velocity_filter"]["type"] == "low_pass" else None, T
    )
    delay = device["delay_samples"]
    whole, part = int(delay), delay - int(delay)
    before, after = held(rate, inputs, part * T), held(rate, inputs, (1 - part) * T)
    sizes = np.cumsum([body, 1, position.n, velocity.n, whole + 1])

    def step(state):
        z, last, of_position, of_velocity, forces = np.split(state, sizes[:-1])
        of_position, y = position.step(of_position, z[0])
        of_velocity, w = velocity.step(of_velocity, (z[0] - last[0]) / T)
        forces = np.append(-K * y - B * w, forces)  # the newest force first
        force_of_hand = (
            -sampled.get("stiffness_N_per_m", 0.0) * z[-2]
            - sampled.get("damping_N_s_per_m", 0.0) * z[-1]
        )
        last = [z[0]]
        for (of_state, of_input), force in ((before, forces[whole + 1]), (after, forces[whole])):
            z = of_state @ z + of_input @ [force, force_of_hand]
        return np.concatenate([z, last, of_position, of_velocity, forces[: whole + 1]])

    return map_of(step, sizes[-1])


def leapfrog(x, v, f, M, dt):
    v = v + f / M * dt
    return x + v * dt, v


def admittance_map(scene, K):
    """Steps the virtual mass, then the servo of the carriage, then carriage and handle by the implicit midpoint
    rule."""
    dt, r, device, hand = (scene[name] for name in ("time", "rendering", "device", "hand"))
    dt = dt["step_s"]
    servo, parts = device["servo"], device["mechanics"]
    k, c = (
        hand.get(name, 0.0) if hand["type"] == "impedance" else 0.0
        for name in ("stiffness_N_per_m", "damping_N_s_per_m")
    )
    s, d = parts["structure_stiffness_N_per_m"], parts["structure_damping_N_s_per_m"]
    mc, mh, b = parts["carriage_mass_kg"], parts["handle_mass_kg"], parts["friction_N_s_per_m"]
    rate = np.array(
        [
            [0, 1, 0, 0],
            [-s / mc, -(d + b) / mc, s / mc, d / mc],
            [0, 0, 0, 1],
            [s / mh, d / mh, -s / mh, -d / mh],
        ]
    )
    inputs = np.array([[0, 0], [1 / mc, 0], [0, 0], [0, 1 / mh]])
    implicit = np.linalg.inv(np.eye(4) - dt / 2 * rate)
    delay = servo["delay_samples"]

    def step(state):
        x, v, z, commands = state[0], state[1], state[2:6], state[6:]
        force = -k * z[2] - c * z[3]
        x, v = leapfrog(x, v, force - K * x - r["damping_N_s_per_m"] * v, r["mass_kg"], dt)
        command = servo["stiffness_N_per_m"] * (x - z[0]) + servo["damping_N_s_per_m"] * (v - z[1])
        commands = np.append(command, commands)
        z = implicit @ ((np.eye(4) + dt / 2 * rate) @ z + dt * inputs @ [commands[delay], force])
        return np.concatenate([[x, v], z, commands[:delay]])

    return map_of(step, 6 + delay)


def ideal_map(scene, K):
    r, hand = scene["rendering"], scene["hand"]
    k, c = hand.get("stiffness_N_per_m", 0.0), hand.get("damping_N_s_per_m", 0.0)

    def step(state):
        x, v = state
        f = -(K + k) * x - (r["damping_N_s_per_m"] + c) * v
        return np.array(leapfrog(x, v, f, r["mass_kg"], scene["time"]["step_s"]))

    return map_of(step, 2)


MAPS = {"impedance": impedance_map, "admittance": admittance_map, "ideal": ideal_map}


def between(low, high):
    """Returns a random number, uniform on a logarithmic scale."""
    return float(np.exp(RANDOM.uniform(np.log(low), np.log(high))))


def random_hand(kind):
    target = {axis: 0 for axis in ("x_m", "y_m", "z_m")}
    spring = {
        "stiffness_N_per_m": between(50, 1000),
        "damping_N_s_per_m": between(0.5, 10),
        "target": target,
    }
    return {
        "none": {"type": "none"},
        "force": {"type": "force", "z_N": 0.0},
        "impedance": {"type": "impedance", **spring},
        "mass_spring_damper": {
            "type": "mass_spring_damper",
            "mass_kg": between(0.02, 0.4),
            **spring,
        },
    }[kind]


def random_low_pass():
    return {"cutoff_Hz": between(20, 300), "order": int(RANDOM.integers(1, 5))}


def random_device(kind):
    if kind == "ideal":
        return {"type": "ideal"}
    if kind == "admittance":
        return {
            "type": "admittance",
            "force_limit_N": None,
            "servo": {
                "stiffness_N_per_m": between(1e4, 5e4),
                "damping_N_s_per_m": between(80, 200),
                "max_force_N": 1e6,
                "delay_samples": int(RANDOM.integers(0, 3)),
            },
            "mechanics": {
                "carriage_mass_kg": between(0.15, 0.5),
                "handle_mass_kg": between(0.05, 0.15),
                "friction_N_s_per_m": between(0.5, 4),
                "structure_stiffness_N_per_m": between(5e4, 3e5),
                "structure_damping_N_s_per_m": between(10, 60),
            },
        }
    device = {
        "type": "impedance",
        "handle_mass_kg": between(0.04, 0.4),
        "viscous_N_s_per_m": between(0.1, 3),
        "delay_samples": float(RANDOM.choice([0, 0.25, 1, 1.5, 2.3, 4])),
        "velocity_filter": {"type": "difference"},
    }
    if RANDOM.random() < 0.5:
        device["velocity_filter"] = {"type": "low_pass", **random_low_pass()}
    if RANDOM.random() < 0.4:
        device["position_filter"] = random_low_pass()
    if RANDOM.random() < 0.3:
        device["transmission"] = {
            "motor_share": float(RANDOM.uniform(0.2, 0.8)),
            "stiffness_N_per_m": between(2e3, 5e4),
            "damping_N_s_per_m": between(0.2, 5),
        }
    return device


def random_scene(device, hand):
    """Returns a scene with one bilateral spring along z."""
    return {
        "name": f"{device}_{hand}",
        "time": {"step_s": float(RANDOM.choice([0.00025, 0.0005, 0.001])), "steps": 16},
        "environment": {"type": "springs", "groups": [{"direction": [0, 0, 1], "count": 1}]},
        "initial": {"position_m": [0, 0, 1e-4]},
        "hand": random_hand(hand),
        "device": random_device(device),
        "rendering": {
            "algorithm": "summation",
            "stiffness_N_per_m": 1000,
            "damping_N_s_per_m": between(0.2, 8),
            "mass_kg": between(0.05, 0.3),
            "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0},
        },
    }


def edge_of(stable, low=1e-3, high=1e9):
    """Returns the limit up to which `stable` holds. Requires that it holds from `low` on, and at no value between the
    limit and 20 times the limit."""
    value, factor = low, 1.1
    while stable(value * factor):
        value *= factor
        if value > high:
            return None
    if value == low or any(stable(value * factor ** (i + 1)) for i in range(32)):
        return None
    inside, outside = value, value * factor
    while outside > inside * (1 + 1e-12):
        middle = np.sqrt(inside * outside)
        inside, outside = (middle, outside) if stable(middle) else (inside, middle)
    return inside


def told(folder, *words):
    ran = subprocess.run(
        [PROGRAM, *map(str, words), "--json", "--out", folder / "out"],
        capture_output=True,
        text=True,
        check=False,
    )
    if not ran.stdout:
        raise RuntimeError(f"{' '.join(map(str, words))}\n{ran.stderr}")
    return json.loads(ran.stdout)


def limit(folder, scene, low, high, *words):
    file = folder / "scene.json"
    file.write_text(json.dumps(scene))
    return told(
        folder, "limit", file, "--between", f"{low:.6g}:{high:.6g}", "--stable", "settled", *words
    )["limits"][0]


def grows(folder, scene, A, K):
    """Returns True if the amplitude of a run at K grows, False if it decays, and None if the decision would take too
    many steps."""
    steps = int(np.log(GROWN) / abs(np.log(radius(A)))) + 100
    if steps > MOST_STEPS:
        return None
    scene = json.loads(json.dumps(scene))
    scene["time"]["steps"] = 3 * steps
    scene["rendering"]["stiffness_N_per_m"] = K
    scene["expect"] = {"outcome": ["completes", "diverges"]}
    file = folder / "run.json"
    file.write_text(json.dumps(scene))
    ends = told(folder, "run", file)
    if "diverges" in json.dumps(ends):
        return True
    rows = np.genfromtxt(folder / "out" / "trajectory.csv", delimiter=",", names=True)
    z = np.abs(rows["pz_m"])
    third = len(z) // 3
    return bool(z[2 * third :].max() > z[third : 2 * third].max())


def check(name, got, known, within, faults):
    wrong = got is None or abs(got / known - 1) > within
    print(f"{'FAIL' if wrong else 'ok  '} {name}: {got} for {known:.8g}")
    if wrong:
        faults.append(name)


def check_springs(folder, faults):
    """Checks each device with each hand on a spring, and runs on both sides of the limit."""
    pairs = [(device, hand) for device in MAPS for hand in ("none", "force", "impedance")]
    pairs.append(("impedance", "mass_spring_damper"))
    for device, hand in pairs:
        made = 0
        while made < COUNT:
            scene = random_scene(device, hand)
            loop = lambda K: MAPS[device](scene, K)
            edge = edge_of(lambda K: radius(loop(K)) <= 1 + 1e-11)
            if edge is None:
                continue
            made += 1
            name = f"{device}, hand {hand}, {made}"
            row = limit(folder, scene, edge / 5, 5 * edge, "--resolution", 0.3)
            check(name, row["theoretical_limit"], edge, SPRINGS_AGREE, faults)
            if made > 2:
                continue
            for factor in (1 - BESIDE, 1 + BESIDE):
                K = factor * edge
                seen = grows(folder, scene, loop(K), K)
                if seen is not None and seen != (factor > 1):
                    print(
                        f"FAIL {name}: the run at {factor} of the limit {'grows' if seen else 'decays'}"
                    )
                    faults.append(f"{name}, run")


def pressed(device, hand, tip, diameter):
    """Returns a scene in which a hand presses a tool on a plane."""
    scene = random_scene(device, "none")
    scene.update(
        time={"step_s": 0.001, "duration_s": 2},
        environment={"type": "plane", "size_m": 0.02, "spacing_m": 0.0005},
        initial={"position_m": [0, 0, 0.0001]},
        tool={"diameter_m": diameter, "length_m": 0.01, "tip": tip},
        hand=hand,
    )
    scene["rendering"]["algorithm"] = "mean"
    return scene


def slope_of_flat_tip(K, F, radius_of_tip, spacing=0.0005):
    """Returns dF/dz of equal weights under a flat tip that F presses down by z. The depth of a point at distance rho
    from the axis is min(z, r - rho), the smaller distance to bottom and side."""
    at = spacing * np.arange(-50, 51)
    rho = np.hypot(*np.meshgrid(at, at)).ravel()
    side = radius_of_tip - rho[rho <= radius_of_tip * (1 + 1e-12)]
    low, high = 0.0, radius_of_tip
    for _ in range(200):
        z = 0.5 * (low + high)
        low, high = (z, high) if K * np.minimum(z, side).mean() < F else (low, z)
    return K * (side > z).mean()


def check_surfaces(folder, faults):
    """Checks a flat tip, whose contact is softer than K, and a drag, whose damping along the normal is in the loop."""
    for F in (0.5, 0.8):
        scene = pressed("impedance", {"type": "force", "z_N": -F}, "flat", 0.004)
        scene["device"] = {
            "type": "impedance",
            "handle_mass_kg": 0.15,
            "viscous_N_s_per_m": 0.4,
            "delay_samples": 0.5,
            "velocity_filter": {"type": "difference"},
        }
        scene["rendering"]["damping_N_s_per_m"] = 1.5
        still = json.loads(json.dumps(scene))
        still["hand"] = {"type": "none"}
        edge = edge_of(
            lambda K: radius(MAPS["impedance"](still, slope_of_flat_tip(K, F, 0.002))) <= 1, low=300
        )
        row = limit(folder, scene, edge / 4, 4 * edge, "--resolution", 0.05)
        check(f"flat tip, {F} N", row["linear_limit"], edge, SURFACES_AGREE, faults)
    for damping in (20, 60):
        drag = {
            "type": "drag",
            "force_N": 1,
            "path_m": [[-0.004, 0, 0], [0.004, 0, 0]],
            "speed_m_per_s": 0.004,
            "normal_damping_N_s_per_m": damping,
        }
        scene = pressed("impedance", drag, "round", 0.001)
        scene["initial"]["position_m"] = [-0.004, 0, 0.0006]
        scene["environment"]["spacing_m"] = 0.0002
        scene["rendering"][
            "depth_model"
        ] = "normal_projection"  # gives all points of a plane the same depth
        scene["device"] = {
            "type": "impedance",
            "handle_mass_kg": 0.2,
            "viscous_N_s_per_m": 1.4,
            "delay_samples": 1.5,
            "velocity_filter": {"type": "difference"},
        }
        scene["rendering"]["damping_N_s_per_m"] = 10
        along = json.loads(json.dumps(scene))
        along["hand"] = {
            "type": "impedance",
            "stiffness_N_per_m": 0.0,
            "damping_N_s_per_m": damping,
        }
        edge = edge_of(lambda K: radius(MAPS["impedance"](along, K)) <= 1)
        row = limit(folder, scene, edge / 8, 2 * edge, "--resolution", 0.2)
        check(f"drag, b_n = {damping}", row["linear_limit"], edge, SURFACES_AGREE, faults)


def main():
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        check_springs(Path(folder), faults)
        check_surfaces(Path(folder), faults)
    if faults:
        sys.exit(f"{len(faults)} wrong: {', '.join(faults)}")


main()
