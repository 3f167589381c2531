"""Known answers for the torques of a run: a tool rotates while it touches one point."""
import numpy as np
from scipy.spatial.transform import Rotation

from answers import ROUNDING, Within, norms, scene
from physics import SUMMED


@scene
def turned_into_point(bench):
    """Checks force and torque of a cylinder that rotates about its tip into one point. The depth is the radius r minus
    the distance of the point from the axis. The whole force acts at this point."""
    K, r, n, dt, at = 1000.0, 0.5e-3, 200, 0.001, np.array([0.6e-3, 0.0, 4e-3])
    bench.write("one.csv", "x_m,y_m,z_m,nx,ny,nz", [(*at, -1, 0, 0)])
    turn = {"type": "ramp", "start": 0.0, "rate_per_s": 0.5}
    run = bench.run(
        bench.scenario(
            "turned_into_point",
            time={"step_s": dt, "steps": n},
            environment={"type": "point_shell", "file": "one.csv"},
            tool={"diameter_m": 2 * r, "length_m": 0.01, "tip": "flat"},
            record={"energy": True, "torque": True, "contacts": True, "pose": True},
            motion={
                "orientation": {
                    "up": [0, 0, 1],
                    "lean": [1, 0, 0],
                    "tilt_rad": turn,
                    "azimuth_rad": 0,
                },
                "position": {"type": "prescribed", "x_m": 0, "y_m": 0, "z_m": 0},
            },
            rendering={**SUMMED, "depth_model": "shortest_distance", "stiffness_N_per_m": K},
        )
    )
    t = np.arange(n) * dt
    tilt = 0.5 * t
    axis = -np.column_stack([np.sin(tilt), 0 * t, np.cos(tilt)])
    across = at - (axis @ at)[:, None] * axis
    d = np.maximum(0, r - norms(across))
    u = across / norms(across)[:, None]
    f = -K * d[:, None] * u
    torque = np.cross(at, f)
    touching = d > 0
    works = -0.5 * np.sum((torque[1:] + torque[:-1]) * np.array([0, 0.5 * dt, 0]), axis=1)
    shape = Within(
        "depth is a difference of lengths of 0.5 mm, known to 1e-19 m",
        relative=1e-11,
        absolute=1e-15,
    )
    wedge = 0.5 * K * d**2
    bench.metrics(
        run,
        [
            (
                "torque.lost_mean_Nm",
                norms(torque)[touching].mean(),
                "|at x f| of rows in contact",
                shape,
                "over all rows",
                norms(torque).mean(),
            ),
            (
                "torque.lost_max_Nm",
                norms(torque).max(),
                "|at x f|",
                shape,
                "arm along the axis in full",
                norms(at) * norms(f).max(),
            ),
            (
                "energy.rotation_J",
                works.sum(),
                "trapezoidal rule of the torque over the turn",
                shape,
                "the stored energy",
                wedge[-1],
            ),
            (
                "energy.created_J",
                wedge[-1] - works.sum(),
                "stored less work",
                Within("two hundred roundings", absolute=1e-16),
                "none, as the force is conservative",
                0.0,
            ),
            (
                "passivity.energy_end_J",
                works.sum(),
                "the turn's work, as the tip stands still",
                shape,
                "the stored energy",
                wedge[-1],
            ),
        ],
    )
    bench.columns(
        run.table("energy.csv"),
        [
            (
                "rotation_J",
                np.r_[0, np.cumsum(works)],
                "trapezoidal rule of the torque over the turn",
                shape,
                "the stored energy",
                wedge,
            )
        ],
    )
    contact_with_point(bench, at, axis, d, r, run, shape, touching, u)
    pose_of_turned(bench, K, axis, d, f, n, run, shape, torque)


def pose_of_turned(bench, K, axis, d, f, n, run, shape, torque):
    """Checks columns of trajectory.csv: the quaternion of the tool with the axis -(sin a, 0, cos a) at the angle a, and
    the torque."""
    table = run.table()
    turned = Rotation.from_quat(table.vectors("qx", "qy", "qz", "qw")).apply([0, 0, 1])
    bench.add(
        "trajectory.csv:qw",
        table["qw"] ** 2 + table["qx"] ** 2 + table["qy"] ** 2 + table["qz"] ** 2,
        np.ones(n),
        "a unit quaternion",
        ROUNDING,
        ("without one component", np.full(n, 0.5)),
    )
    for i, name in enumerate(("qx", "qy", "qz")):
        bench.add(
            f"trajectory.csv:{name}",
            turned[:, i],
            -axis[:, i],
            f"{'xyz'[i]} of where it turns the body's upward axis",
            ROUNDING,
            ("the downward axis", axis[:, i] + (name == "qy")),
        )
    bench.columns(
        table,
        [
            (
                f"axis_{x}",
                axis[:, i],
                "-(sin a, 0, cos a)",
                ROUNDING,
                "up",
                -axis[:, i] + (x == "y"),
            )
            for i, x in enumerate("xyz")
        ]
        + [
            (f"t{x}_Nm", torque[:, i], "at x f", shape, "f x at", -torque[:, i] + (x != "y") * 1e-3)
            for i, x in enumerate("xyz")
        ]
        + [
            (
                f"f{x}_N",
                f[:, i],
                "-K d u",
                shape,
                "along the normal",
                K * d * (x == "x") + (x == "y"),
            )
            for i, x in enumerate("xyz")
        ],
    )


def contact_with_point(bench, at, axis, d, r, run, shape, touching, u):
    """Checks the columns of contacts.csv: the point of the file, its depth (radius r minus its distance from the axis),
    and the gradient of the depth."""
    k = np.flatnonzero(touching)
    sets = [
        (
            name,
            np.full(len(k), value),
            "the point of the file",
            ROUNDING,
            "seen from the tool",
            np.full(len(k), value) + axis[k, 0] * 1e-3 - 1e-5,
        )
        for name, value in zip(("x_m", "y_m", "z_m", "nx", "ny", "nz"), (*at, -1.0, 0.0, 0.0))
    ]
    bench.columns(
        run.table("contacts.csv"),
        [
            *sets,
            (
                "depth_m",
                d[k],
                "r less the distance to the axis",
                shape,
                "r - x",
                np.full(len(k), r - at[0]),
            ),
        ]
        + [
            (
                f"gradient_{x}",
                u[k, i],
                "from the axis to the point",
                ROUNDING,
                "minus the normal",
                np.full(len(k), float(x == "x")) + (x == "y"),
            )
            for i, x in enumerate("xyz")
        ],
    )
