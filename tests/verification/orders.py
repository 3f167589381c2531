"""Code verification: compares the observed order of convergence in the time step with the formal order, for every
integrator, device, hand and law. The exact motions are known in closed form or from an independent computation.
hapbench only executes the runs.

  python3 tests/verification/orders.py PROGRAM           # recomputes every seventh row and compares it with the table
  python3 tests/verification/orders.py PROGRAM --write   # writes the table again
"""
import json
import math
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.linalg import expm

PROGRAM = Path(sys.argv[1]).resolve()
PAGE = Path(__file__).resolve().parent / "README.md"
BETWEEN = " / "  # separator of cases that share a line of the table
BEGIN, END = "<!-- orders -->\n", "<!-- /orders -->\n"
END_S = 0.02  # duration of a run [s]: 1.4 periods of the spring
STEPS = [1e-3 / 2**i for i in range(6)]  # time steps [s]
# Stiffness [N/m], mass [kg], initial position [m] and initial velocity [m/s].
K, M, X0, V0 = 20000.0, 0.1, 1e-3, 0.2
# Formal order of each integrator, without damping and with damping. Any force that is sampled and held over a step
# reduces the order to 1.
FORMAL = {
    "leapfrog": (1, 1),
    "velocity_verlet": (2, 1),
    "rk4": (4, 4),
    "implicit_euler": (1, 1),
    "implicit_midpoint": (2, 2),
    "event": (4, 4),
}
# Largest allowed difference between observed and formal order. If the error at the step h is C h^p (1 + D h), and D h
# is below 0.07 at the second-finest step, the observed order differs from p by less than log2(1.07) = 0.1.
WITHIN = 0.1
NONLINEAR = {"static_coupling"}  # laws without a closed form, because their spring softens
# Smallest error that is used, relative to the amplitude of the motion. Smaller errors are caused by rounding.
ROUNDING = 1e-11


@dataclass
class Case:
    part: str
    name: str
    formal: float
    scene: dict
    exact: object  # function (step, phase) -> (position, velocity) at END_S
    why: str = ""
    changes: object = field(default=lambda *_: {})  # function (step, phase) -> changes of the scene
    # Number of starting times within a step; the largest error over these starts counts.
    phases: int = 1


def linear(A, b=0.0, x=(X0, V0), t=END_S):
    """Returns the state of x' = A x + b at the time t [s]. `x`: state at the time 0."""
    n = len(x)
    joint = np.zeros((n + 1, n + 1))
    joint[:n, :n], joint[:n, n] = A, b
    return (expm(joint * t) @ np.append(x, 1.0))[:n]


def driven(K, B, force=0.0, k=0.0, b=0.0, amplitude=0.0, omega=0.0):
    """Returns a function of (step, phase) that computes (position, velocity) of the mass M at END_S. The mass has a
    spring K and a damper B. The force of the hand is force + amplitude sin(omega t) - k x - b v. The sine adds two
    states to the linear system."""
    A = np.array(
        [
            [0, 1, 0, 0],
            [-(K + k) / M, -(B + b) / M, amplitude / M, 0],
            [0, 0, 0, omega],
            [0, 0, -omega, 0],
        ]
    )
    return lambda *_: linear(A, np.array([0, force / M, 0, 0]), (X0, V0, 0.0, 1.0))[:2]


def delayed_spring(K, b, tau):
    """Returns a function that computes (position, velocity) at END_S for M x'' = -b x' - K x(t - tau), with a spring
    force of zero before tau [s]. The motions in successive intervals of length tau form one linear system.
    """
    whole, part = divmod(END_S, tau)
    begins = np.array([X0, V0])
    for n in range(1, int(whole) + 2):
        A = np.kron(np.eye(n), [[0, 1], [0, -b / M]]) + np.kron(
            np.eye(n, k=-1), [[0, 0], [-K / M, 0]]
        )
        begins = np.append(begins, linear(A, 0.0, begins, tau if n <= whole else part)[-2:])
    return lambda *_: begins[-2:]


MOTORS = {
    "motor_share": 0.4,
    "stiffness_N_per_m": 20000.0,
    "damping_N_s_per_m": 4.0,
}  # elastic transmission between motors and handle, which share the mass M


def geared(K, B, force=0.0, k=0.0, b=0.0, amplitude=0.0, omega=0.0):
    """Returns a function of (step, phase) that computes (position, velocity) of the motors at END_S. Spring and damper
    act on the motors; the force of the hand acts on the handle. Arguments: see driven()."""
    share, gear, loss = MOTORS.values()
    m, h = share * M, (1 - share) * M
    A = np.array(
        [
            [0, 1, 0, 0, 0, 0],
            [-(K + gear) / m, -(B + loss) / m, gear / m, loss / m, 0, 0],
            [0, 0, 0, 1, 0, 0],
            [gear / h, loss / h, -(gear + k) / h, -(loss + b) / h, amplitude / h, 0],
            [0, 0, 0, 0, 0, omega],
            [0, 0, 0, 0, -omega, 0],
        ]
    )
    return lambda *_: linear(A, np.array([0, 0, 0, force / h, 0, 0]), (X0, V0, X0, V0, 0.0, 1.0))[
        :2
    ]


def scene(integrator="leapfrog", B=0.0, law="summation", **parts):
    return {
        "name": "verified",
        "environment": {"type": "springs", "groups": [{"direction": [0, 0, 1], "count": 1}]},
        "initial": {"position_m": [0, 0, X0], "velocity_m_per_s": [0, 0, V0]},
        "integrator": {"type": integrator},
        "rendering": {
            "algorithm": law,
            "stiffness_N_per_m": K,
            "damping_N_s_per_m": B,
            "mass_kg": M,
            "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0},
        },
        **parts,
    }


# Name of the hand, its scenario fields, and the arguments of driven() and geared() for its force.
HANDS = (
    ("none", {"type": "none"}, {}),
    ("force, constant", {"type": "force", "z_N": 3.0}, {"force": 3.0}),
    (
        "force, sine",
        {"type": "force", "z_N": {"type": "sine", "mean": 0, "amplitude": 3.0, "period_s": 0.013}},
        {"amplitude": 3.0, "omega": 2 * math.pi / 0.013},
    ),
    ("push", {"type": "push", "force_N": 3.0}, {"force": -3.0}),
    (
        "impedance",
        {
            "type": "impedance",
            "stiffness_N_per_m": 500.0,
            "damping_N_s_per_m": 4.0,
            "target": {"x_m": 0, "y_m": 0, "z_m": 0.002},
        },
        {"force": 500.0 * 0.002, "k": 500.0, "b": 4.0},
    ),
)
GAP, BOUNCES = 4e-4, 32  # initial distance from the spring [m], number of starting phases


def stiffness_of_bounce(phase):
    """Returns the stiffness [N/m] of the spring for one starting time of the bounce. The stiffness differs between the
    starting times, so that the bounces end at different fractions of a step. `phase`: fraction of a step by which the
    bounce begins later."""
    return K * (1.0 + 0.4 * (phase * 0.6180339887 * BOUNCES % 1.0))


def bounce(step, phase):
    """Returns (position, velocity) at END_S after a bounce off a unilateral spring without damping. The contact lasts
    half a period, and the tool leaves with its initial speed."""
    t2 = GAP / V0 + phase * step + math.pi / math.sqrt(stiffness_of_bounce(phase) / M)
    return np.array([-V0 * (END_S - t2), -V0])


def start_of_bounce(step, phase):
    return {
        "initial": {"position_m": [0, 0, -GAP - phase * step * V0], "velocity_m_per_s": [0, 0, V0]},
        "rendering": scene()["rendering"] | {"stiffness_N_per_m": stiffness_of_bounce(phase)},
    }


def cases(laws):
    for integrator, orders in FORMAL.items():
        for B, order in zip((0.0, 20.0), orders):
            yield Case(
                "integrator", f"{integrator}, B = {B:g}", order, scene(integrator, B), driven(K, B)
            )
    for law in sorted(set(laws) - NONLINEAR):
        share = last_row(scene(law=law), 1e-3, 1)["fspring_z_N"] / (
            -K * X0
        )  # couplings are in series with the spring
        yield Case(
            "law",
            law,
            4,
            scene("rk4", 20.0, law),
            driven(share * K, share * 20.0),
            f"renders {share:.6g} times the stiffness of one spring"
            if abs(share - 1) > 1e-6  # not visible in the printed number
            else "",
        )
    for name, hand, force in HANDS:
        why = "its force is sampled and held" if name in ("force, sine", "impedance") else ""
        for integrator, orders in FORMAL.items():
            yield Case(
                "hand",
                f"{name}; {integrator}",
                1 if why else orders[1],
                scene(integrator, 20.0, hand=hand, device={"type": "ideal"}),
                driven(K, 20.0, **force),
                why,
            )
        if name != "impedance":  # the device pulls the handle, which lags behind the virtual tool
            yield Case(
                "device",
                f"device admittance; hand {name}",
                1,
                scene(
                    "leapfrog",
                    20.0,
                    hand=hand,
                    device={"type": "admittance", "force_limit_N": None},
                ),
                driven(K, 20.0, **force),
                why,
            )
    for name, hand, force in HANDS:
        device = {"type": "impedance", "handle_mass_kg": M, "viscous_N_s_per_m": 6.0}
        yield Case(
            "device",
            f"device impedance; hand {name}",
            1,
            scene(B=0.0, hand=hand, device=device),
            driven(K, 6.0, **force),
            "the rendered force is held",
        )
        yield Case(
            "device",
            f"device impedance, elastic transmission; hand {name}",
            1,
            scene(B=0.0, hand=hand, device=device | {"transmission": MOTORS}),
            geared(K, 6.0, **force),
            "the rendered force is held",
        )
    for samples in (1.0, 0.5, 1.37):
        tau = 1e-3 * samples
        device = {"type": "impedance", "handle_mass_kg": M, "viscous_N_s_per_m": 40.0}
        yield Case(
            "delay",
            f"{1e3 * tau:g} ms, {samples:g} sample{'' if samples == 1.0 else 's'} of 1 ms",
            1,
            scene(device=device),
            delayed_spring(K, 40.0, tau),
            "the rendered force is held",
            lambda step, _, tau=tau: {"device": {**device, "delay_samples": tau / step}},
        )
    one_sided = {
        "environment": {
            "type": "springs",
            "bilateral": False,
            "groups": [{"direction": [0, 0, 1], "count": 1}],
        }
    }
    for integrator, orders in FORMAL.items():
        finds = integrator == "event"
        # When contact begins, the force is continuous but its derivative is not. Methods of second order keep their
        # order. Leapfrog also has second order: without contact, its state equals the state of velocity Verlet, and a
        # bounce begins and ends without contact.
        formal = orders[0] if finds else 1 if integrator == "implicit_euler" else 2
        yield Case(
            "switching",
            f"bounce; {integrator}",
            formal,
            scene(integrator, 0.0) | one_sided,
            bounce,
            "" if finds else "contact begins and ends between two steps",
            start_of_bounce,
            BOUNCES,
        )


def last_row(content, step, rows):
    """Runs a scene and returns the last row of its trajectory.csv. `step`: time step [s]. `rows`: number of rows."""
    with tempfile.TemporaryDirectory(prefix="hapbench-orders-") as folder:
        file = Path(folder) / "scene.json"
        file.write_text(
            json.dumps(content | {"time": {"step_s": step, "steps": rows}}), encoding="utf-8"
        )
        done = subprocess.run(
            [PROGRAM, "run", file, "--quiet", "--set", "expect={}", "--out", Path(folder) / "out"],
            capture_output=True,
            text=True,
        )
        assert done.returncode in (0, 3), done.stderr
        table = np.atleast_1d(
            np.genfromtxt(Path(folder) / "out" / "trajectory.csv", delimiter=",", names=True)
        )
        assert table.size == rows, f"{table.size} of {rows} rows"
        return table[-1]


def error_at(case, step, phase):
    """Returns the relative error of the last row. It is the square root of a ratio of two energies: the energy formula
    applied to the errors of position and velocity, divided by the initial energy."""
    row = last_row(case.scene | case.changes(step, phase), step, round(END_S / step) + 1)
    x, v = case.exact(step, phase)
    energy = lambda x, v: 0.5 * (K * x * x + M * v * v)
    return math.sqrt(energy(row["pz_m"] - x, row["vz_m_per_s"] - v) / energy(X0, V0))


def row(case):
    """Returns the row of a case in the table: part, case, formal order, observed order, errors at the coarsest and at
    the finest step, and verdict."""
    errors = [
        max(error_at(case, step, i / case.phases) for i in range(case.phases)) for step in STEPS
    ]
    useful = [error for error in errors if error > ROUNDING]
    # The largest error over the starting phases scatters by a factor of up to 1.5. Over three halvings, this changes
    # the observed order by up to log2(1.5) / 3 = 0.2.
    halvings, within = (3, 0.3) if case.phases > 1 else (1, WITHIN)
    observed = math.log2(useful[-1 - halvings] / useful[-1]) / halvings
    return (
        case.part,
        case.name,
        f"{case.formal:g}",
        f"{observed:.2f}",
        f"{errors[0]:.1e}",
        f"{errors[-1]:.1e}",
        ("passes" if abs(observed - case.formal) <= within else "FAILS")
        + (f"; {case.why}" if case.why else ""),
    )


def table_of(rows):
    """Returns the lines of the table. Rows that differ only in the case are joined to one line."""
    cases_of = {}
    for part, case, *rest in rows:
        cases_of.setdefault((part, *rest), []).append(case)
    return [
        "| " + " | ".join((part, BETWEEN.join(shared), *rest)) + " |"
        for (part, *rest), shared in cases_of.items()
    ]


def rows_in(table):
    cells = [
        [cell.strip() for cell in line.split("|")[1:-1]]
        for line in table.splitlines()
        if line.startswith("|")
    ]
    return {(part, case, *rest) for part, shared, *rest in cells for case in shared.split(BETWEEN)}


def main():
    listed = json.loads(
        subprocess.run(
            [PROGRAM, "describe", "algorithms", "--json"],
            capture_output=True,
            text=True,
            check=True,
        ).stdout
    )
    laws = [entry["name"] for entry in listed]
    write = "--write" in sys.argv
    every = [case for i, case in enumerate(cases(laws)) if write or i % 7 == 0]
    with ThreadPoolExecutor() as pool:
        rows = list(pool.map(row, every))
    text = PAGE.read_text(encoding="utf-8")
    if write:
        lines = [
            "| part | case | formal | observed | error at 1 ms | at 1/32 ms | result |",
            "|---|---|---|---|---|---|---|",
        ]
        lines += table_of(rows)
        head, _, rest = text.partition(BEGIN)
        PAGE.write_text(
            head + BEGIN + "\n".join(lines) + "\n" + END + rest.partition(END)[2], encoding="utf-8"
        )
        print(f"{len(rows)} rows, {sum('FAILS' in r[-1] for r in rows)} fail")
    known = rows_in(PAGE.read_text(encoding="utf-8"))
    missing = [r for r in rows if r not in known]
    for r in missing:
        print("not in the table:", r)
    sys.exit(1 if missing or any("FAILS" in r[-1] for r in rows) else 0)


main()
