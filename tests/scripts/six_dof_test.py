"""Compares the force of a 6-DOF device (six_dof.csv) with an independent minimiser, which uses scipy's NNLS and shares
no code with hapbench. The minimiser recomputes the signed distances between the points of the shell and the drill, and
the energies of the springs."""
import csv
import json
import unittest

import numpy as np
from scipy.optimize import nnls
from scipy.spatial.transform import Rotation

from fixture import PROGRAM, must, scratch_folder

RADIUS, LENGTH = 0.5e-3, 0.01  # radius and length of the drill [m]
NEAR = 0.1e-3  # largest distance from the drill [m] at which a point can be in contact
DOWN = np.array([0.0, 0.0, -1.0])  # axis of the drill in its own frame
MM = 1e-3
PASSES, LONGEST = 300, 0.02  # iterations of the search, and largest step [mm, rad]
# Standard deviations of the starting values around the known pose [mm, rad].
START = np.repeat([1e-4, 1e-5], [3, 6])
# Springs of hand and coupling. The grip is not at the force point, so that the force also rotates the handle.
SPRINGS = {
    "hand_stiffness_N_per_m": 500,
    "hand_rotational_stiffness_N_m_per_rad": 0.2,
    "coupling_rotational_stiffness_N_m_per_rad": 0.4,
    "force_point_m": 0.03,
    "grip_m": -0.01,
    "pivot_m": 0.0,
}


def shortest_turn(a, b):
    """Returns the smallest rotation from the unit vector a to b."""
    cross = np.cross(a, b)
    sine = np.linalg.norm(cross)
    return Rotation.from_rotvec(cross / sine * np.arctan2(sine, a @ b) if sine > 0 else np.zeros(3))


def distances(points, tip, turn):
    """Returns (signed distance of each point to a drill with a flat tip [m], normal of the drill at its closest
    point)."""
    axis = turn.apply(DOWN)
    q = points - tip
    s = q @ axis
    across = q - s[:, None] * axis
    rho = np.linalg.norm(across, axis=1)
    out = across / rho[:, None]
    side, end = rho - RADIUS, np.maximum(s, -LENGTH - s)
    forward = np.where(s >= -LENGTH - s, 1.0, -1.0)[:, None] * axis
    radial = np.hypot(side, end)
    beyond = (side > 0) & (end > 0)
    distance = np.where(beyond, radial, np.maximum(side, end))
    with np.errstate(invalid="ignore", divide="ignore"):
        corner = (side[:, None] * out + end[:, None] * forward) / radial[:, None]
    normal = np.where(beyond[:, None], corner, np.where((side >= end)[:, None], out, forward))
    return distance, normal


class Problem:
    """Energy and contacts of tool and handle near a start pose. The unknowns x are the displacement of the tool's force
    point [mm], and the rotation vectors of the tool and of the handle [rad]."""

    def __init__(self, points, stiffness, tip, axis, intent_tip, intent_axis, handle_turn):
        self.points = points
        self.wanted = shortest_turn(DOWN, intent_axis)
        self.handle = Rotation.from_rotvec(handle_turn) * self.wanted
        self.tool = shortest_turn(self.handle.apply(DOWN), axis) * self.handle
        self.position = tip - SPRINGS["force_point_m"] * axis
        self.grip = intent_tip + (SPRINGS["grip_m"] - SPRINGS["force_point_m"]) * intent_axis
        hand = SPRINGS["hand_stiffness_N_per_m"]
        self.stiffness = stiffness * hand / (stiffness + hand)

    def poses(self, x):
        return (
            self.position + MM * x[:3],
            Rotation.from_rotvec(x[3:6]) * self.tool,
            Rotation.from_rotvec(x[6:]) * self.handle,
        )

    def force(self, x):
        position, _, handle = self.poses(x)
        return self.stiffness * (position + SPRINGS["grip_m"] * handle.apply(DOWN) - self.grip)

    def energy(self, x):
        """Returns the energy of the springs at x [uJ]."""
        _, tool, handle = self.poses(x)
        twist = (handle.inv() * tool).as_rotvec()
        yielded = (self.wanted.inv() * handle).as_rotvec()
        return 1e6 * (
            0.5 * self.force(x) @ self.force(x) / self.stiffness
            + 0.5 * SPRINGS["coupling_rotational_stiffness_N_m_per_rad"] * twist @ twist
            + 0.5 * SPRINGS["hand_rotational_stiffness_N_m_per_rad"] * yielded @ yielded
        )

    def gaps(self, x):
        """Returns the distance between the tool and each point at x [mm]."""
        position, tool, _ = self.poses(x)
        tip = position + SPRINGS["force_point_m"] * tool.apply(DOWN)
        return distances(self.points, tip, tool)[0] / MM

    def solution(self, random):
        """Returns the pose x of least energy without penetration, by sequential quadratic programs. scipy's NNLS solves
        each program (least distance programming of Lawson and Hanson)."""

        def derivative(function, x, h=1e-5):
            """Returns the derivative by central differences with the step h [mm or rad]. At h = 1e-5, the truncation
            error is about 1e-10 times the third derivative, and the rounding error is about 1e-11.
            """
            step = h * np.eye(9)
            return np.stack([(function(x + d) - function(x - d)) / (2 * h) for d in step], axis=-1)

        x = START * random.standard_normal(9)
        gradient = lambda at: derivative(self.energy, at)  # noqa: E731
        hessian = derivative(gradient, x, 1e-3)
        lower = np.linalg.cholesky(0.5 * (hessian + hessian.T))
        for _ in range(PASSES):
            wanted = np.linalg.solve(lower, gradient(x))
            rows = np.linalg.solve(lower, derivative(self.gaps, x).T).T
            slack = -self.gaps(x) + rows @ wanted
            matrix = np.vstack([rows.T, slack])
            aim = np.r_[np.zeros(9), 1.0]
            rest = matrix @ nnls(matrix, aim, maxiter=1000)[0] - aim
            step = np.linalg.solve(lower.T, -rest[:9] / rest[9] - wanted)
            longest = np.abs(step).max()
            x = x + step * min(1.0, LONGEST / longest)
            if longest < 1e-10:
                break
        return x


def table_of(file):
    with open(file, newline="", encoding="utf-8") as lines:
        return list(csv.DictReader(lines))


def vector(row, prefix, suffix):
    return np.array([float(row[f"{prefix}_{x}{suffix}"]) for x in "xyz"])


class SixDof(unittest.TestCase):
    def test_an_independent_minimiser_finds_ten_random_poses(self):
        folder, random, compared = scratch_folder(unittest), np.random.default_rng(91), 0
        for scene in ("six_dof_task2", "six_dof_edge", "six_dof_peg", "six_dof_slot"):
            out, shell = folder / scene, folder / f"{scene}.csv"
            must(
                PROGRAM,
                *("run", scene, "--out", out, "--set", f"six_dof={json.dumps(SPRINGS)}"),
                *("--set", "six_dof.law=proxy", "--set", "record.trajectory=true"),
                statuses=(0, 3),
            )
            must(PROGRAM, "validate", scene, "--points", shell)
            points = np.loadtxt(shell, delimiter=",", skiprows=1)[:, :3]
            rows, intents = table_of(out / "six_dof.csv"), table_of(out / "trajectory.csv")
            held = [
                k
                for k, row in enumerate(rows)
                if row["reference_x_N"] and np.linalg.norm(vector(row, "reference", "_N")) > 0.05
            ]
            self.assertGreater(len(held), 20, scene)
            for k in random.choice(held, 4, replace=False):
                tip, axis = vector(rows[k], "tool", "_m"), vector(rows[k], "tool_axis", "")
                near = points[distances(points, tip, shortest_turn(DOWN, axis))[0] < NEAR]
                problem = Problem(
                    near,
                    20000.0,
                    tip,
                    axis,
                    np.array([float(intents[k][f"p{x}_m"]) for x in "xyz"]),
                    vector(intents[k], "axis", ""),
                    vector(rows[k], "handle_turn", "_rad"),
                )
                x = problem.solution(random)
                force = vector(rows[k], "reference", "_N")
                # Iterations end with a step below 1e-10 mm. At 500 N/m, 1e-6 N corresponds to 2e-6 mm.
                error = np.linalg.norm(problem.force(x) - force)
                self.assertLess(error, 1e-6, f"{scene} {k}")
                compared += 1
        self.assertGreaterEqual(compared, 10)


if __name__ == "__main__":
    unittest.main()
