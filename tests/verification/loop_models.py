"""Linear loops of hand, device and contact, as matrices that map the state from one sample to the next. Also creates
random devices and hands. The loops are computed with numpy from the description of the devices in the manual. This file
shares no code with hapbench."""
import numpy as np
from scipy import signal
from scipy.linalg import expm


def map_of(step, n):
    """Returns the matrix of a linear function `step` that maps n numbers to n numbers."""
    return np.column_stack([step(unit) for unit in np.eye(n)])


def radius(A):
    return np.abs(np.linalg.eigvals(A)).max()


def held(rate, inputs, t):
    """Returns the matrices P and Q of the exact solution z(t) = P z(0) + Q u of z' = rate z + inputs u. `rate` and
    `inputs` are matrices, and the vector u is constant over the time t [s]."""
    n, m = rate.shape[0], inputs.shape[1]
    joint = np.zeros((n + m, n + m))
    joint[:n, :n], joint[:n, n:] = rate, inputs
    whole = expm(joint * t)
    return whole[:n, :n], whole[:n, n:]


class LowPass:
    """Butterworth low-pass of a sampled input. The filter treats the input as constant over the period T [s] before
    each sample, with the value at this sample. `given`: dict with the fields cutoff_Hz and order of a scenario, or None
    for no filter.
    """

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


def sampled_hand(hand, across=True):
    """Returns stiffness [N/m] and damping [N s/m] of a hand whose force is sampled and held over a step; (0, 0) for any
    other hand. `across`: true for the direction normal to the surface, false for a direction along the surface.
    """
    if hand["type"] == "impedance":
        return hand["stiffness_N_per_m"], hand["damping_N_s_per_m"]
    if hand["type"] == "drag":
        if across:
            return 0.0, hand["normal_damping_N_s_per_m"]
        return hand["stiffness_N_per_m"], hand["damping_N_s_per_m"]
    return 0.0, 0.0


def damping_of(scene, K=None):
    """Returns the damping of the rendering [N s/m] at the stiffness K [N/m]. K = None: the stiffness of the scene."""
    r = scene["rendering"]
    if "damping_N_s_per_m" in r:
        return r["damping_N_s_per_m"]
    K = r["stiffness_N_per_m"] if K is None else K
    return 2 * r["damping_ratio"] * np.sqrt(K * r["mass_kg"])


def impedance_map(scene, K, B=None, across=True):
    """Returns the matrix of one sample of an impedance device at a wall of stiffness K [N/m] and damping B [N s/m].
    Between samples, the handle (or motors and handle) follows the exact solution. The force of the wall depends on the
    measured position."""
    T, device = scene["time"]["step_s"], scene["device"]
    B = damping_of(scene) if B is None else B
    hand = scene["hand"]
    m, b = device["handle_mass_kg"], device["viscous_N_s_per_m"]
    attached = hand if hand["type"] == "mass_spring_damper" else {}
    sampled_k, sampled_c = sampled_hand(hand, across)
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
        forces = np.append(-K * y - B * w, forces)  # newest force first
        force_of_hand = -sampled_k * z[-2] - sampled_c * z[-1]
        last = [z[0]]
        for (of_state, of_input), force in ((before, forces[whole + 1]), (after, forces[whole])):
            z = of_state @ z + of_input @ [force, force_of_hand]
        return np.concatenate([z, last, of_position, of_velocity, forces[: whole + 1]])

    return map_of(step, sizes[-1])


def leapfrog(x, v, f, M, dt):
    v = v + f / M * dt
    return x + v * dt, v


def admittance_map(scene, K, B=None, across=True):
    """Returns the matrix of one step of an admittance device at a wall of stiffness K [N/m] and damping B [N s/m]. A
    step moves the virtual mass, computes the force of the servo on the carriage, and moves carriage and handle by the
    implicit midpoint rule."""
    dt, r, device, hand = (scene[name] for name in ("time", "rendering", "device", "hand"))
    dt = dt["step_s"]
    servo, parts = device["servo"], device["mechanics"]
    B = damping_of(scene) if B is None else B
    k, c = sampled_hand(hand, across)
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
        x, v = leapfrog(x, v, force - K * x - B * v, r["mass_kg"], dt)
        command = servo["stiffness_N_per_m"] * (x - z[0]) + servo["damping_N_s_per_m"] * (v - z[1])
        commands = np.append(command, commands)
        z = implicit @ ((np.eye(4) + dt / 2 * rate) @ z + dt * inputs @ [commands[delay], force])
        return np.concatenate([[x, v], z, commands[:delay]])

    return map_of(step, 6 + delay)


def ideal_map(scene, K, B=None, across=True):
    B = damping_of(scene) if B is None else B
    k, c = sampled_hand(scene["hand"], across)

    def step(state):
        x, v = state
        f = -(K + k) * x - (B + c) * v
        return np.array(leapfrog(x, v, f, scene["rendering"]["mass_kg"], scene["time"]["step_s"]))

    return map_of(step, 2)


MAPS = {"impedance": impedance_map, "admittance": admittance_map, "ideal": ideal_map}


def between(random, low, high):
    """Returns a random number between `low` and `high`, whose logarithm is uniformly distributed."""
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def random_hand(random, kind):
    target = {axis: 0 for axis in ("x_m", "y_m", "z_m")}
    spring = {
        "stiffness_N_per_m": between(random, 50, 1000),
        "damping_N_s_per_m": between(random, 0.5, 10),
        "target": target,
    }
    return {
        "none": {"type": "none"},
        "force": {"type": "force", "z_N": 0.0},
        "impedance": {"type": "impedance", **spring},
        "mass_spring_damper": {
            "type": "mass_spring_damper",
            "mass_kg": between(random, 0.02, 0.4),
            **spring,
        },
    }[kind]


def random_low_pass(random):
    return {"cutoff_Hz": between(random, 20, 300), "order": int(random.integers(1, 5))}


def random_device(random, kind):
    if kind == "ideal":
        return {"type": "ideal"}
    if kind == "admittance":
        return {
            "type": "admittance",
            "force_limit_N": None,
            "servo": {
                "stiffness_N_per_m": between(random, 1e4, 5e4),
                "damping_N_s_per_m": between(random, 80, 200),
                "max_force_N": 1e6,
                "delay_samples": int(random.integers(0, 3)),
            },
            "mechanics": {
                "carriage_mass_kg": between(random, 0.15, 0.5),
                "handle_mass_kg": between(random, 0.05, 0.15),
                "friction_N_s_per_m": between(random, 0.5, 4),
                "structure_stiffness_N_per_m": between(random, 5e4, 3e5),
                "structure_damping_N_s_per_m": between(random, 10, 60),
            },
        }
    device = {
        "type": "impedance",
        "handle_mass_kg": between(random, 0.04, 0.4),
        "viscous_N_s_per_m": between(random, 0.1, 3),
        "delay_samples": float(random.choice([0, 0.25, 1, 1.5, 2.3, 4])),
        "velocity_filter": {"type": "difference"},
    }
    if random.random() < 0.5:
        device["velocity_filter"] = {"type": "low_pass", **random_low_pass(random)}
    if random.random() < 0.4:
        device["position_filter"] = random_low_pass(random)
    if random.random() < 0.3:
        device["transmission"] = {
            "motor_share": float(random.uniform(0.2, 0.8)),
            "stiffness_N_per_m": between(random, 2e3, 5e4),
            "damping_N_s_per_m": between(random, 0.2, 5),
        }
    return device


def limit_of(stable, low=1e-3, high=1e9):
    """Returns the boundary of the values for which `stable` is true, or None if there is no single boundary below
    `high`. The test is made at values that grow by a factor of 1.1. They must be stable from `low` to the boundary, and
    unstable from there to 20 times the boundary."""
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
