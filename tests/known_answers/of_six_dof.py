"""Known answers for the comparison with a 6-DOF device: a drill is pressed against one point."""
import numpy as np

from answers import EXACT, Within, rms, scene
from physics import SUMMED


@scene
def pressed_on_one_point(bench):
    """Checks the forces of springs in series. The hand presses a tool by the distance D against one point. The lever
    from the force point to the contact is l, and the grip is at the force point.

    The force of a device with torque is D / (1/K' + l^2 / K_r'), and the force of a device without torque is D K'.
    The stiffnesses in series are
    K' = K_t K_h / (K_t + K_h) and K_r' = K_r K_phi / (K_r + K_phi), with the stiffness K_t of the
    rendering, the rotational stiffness K_r of the coupling, and the stiffnesses K_h and K_phi of the hand.
    """
    K, hand, turning, coupling = 2000.0, 500.0, 0.2, 0.4
    r, a, height, n, step, dt = 0.5e-3, 0.03, 2e-3, 101, 1e-8, 0.01
    # Normal of the surface; the point lies on the other side of the tool.
    normal = np.array([0.8, 0.6, 0.0])
    bench.write("one.csv", "x_m,y_m,z_m,nx,ny,nz", [(*(-r * normal + [0, 0, height]), *normal)])
    rate = -step / dt * normal
    run = bench.run(
        bench.scenario(
            "pressed_on_one_point",
            time={"step_s": dt, "steps": n},
            environment={"type": "point_shell", "file": "one.csv"},
            tool={"diameter_m": 2 * r, "length_m": 0.01, "tip": "flat"},
            motion={
                "orientation": {"up": [0, 0, 1], "lean": [1, 0, 0]},
                "position": {
                    "type": "prescribed",
                    **{
                        f"{x}_m": {"type": "ramp", "start": 0.0, "rate_per_s": rate[i]}
                        for i, x in enumerate("xyz")
                    },
                },
            },
            rendering={**SUMMED, "depth_model": "shortest_distance", "stiffness_N_per_m": K},
            six_dof={
                "hand_stiffness_N_per_m": hand,
                "hand_rotational_stiffness_N_m_per_rad": turning,
                "coupling_rotational_stiffness_N_m_per_rad": coupling,
                "force_point_m": a,
            },
            record={"six_dof": True},
        )
    )
    lever = a - height
    series, rotation = K * hand / (K + hand), coupling * turning / (coupling + turning)
    press = step * np.arange(n)
    size = press / (1 / series + lever**2 / rotation)
    of_law = series * press
    force = size[:, None] * normal
    # Torque: the force times the arm from the force point down to the contact. The torque rotates tool and handle.
    torque = np.cross([0, 0, -lever], force)
    handle_turn = torque / turning
    position = -press[:, None] * normal + force / K + force / hand
    tool_turn = torque / rotation
    axis = np.array([0, 0, -1.0]) + np.cross(tool_turn, [0, 0, -1.0])
    tip = position + [0, 0, a] + a * axis
    # Rotations of up to 1e-4 rad change arms and normals by this fraction.
    linear = Within(
        "turns of 1e-4 rad; Newton steps of the law end at 1e-11 N", relative=2e-4, absolute=2e-11
    )
    small = Within("the second order of turns of 1e-4 rad", absolute=2e-8)
    tilted = Within(
        "the contact's normal turns with the tool",
        absolute=1.01 * size.max() * np.linalg.norm(tool_turn[-1]) + 2e-11,
    )
    error = of_law - size
    bench.metrics(
        run,
        [
            (
                "six_dof.reference_force_rms_N",
                rms(size),
                "springs in series with the turn",
                linear,
                "without the turn",
                rms(of_law),
            ),
            (
                "six_dof.lost_torque_rms_Nm",
                lever * rms(size),
                "force times lever",
                linear,
                "about the tip",
                height * rms(size),
            ),
            (
                "six_dof.force_error_rms_N",
                rms(error),
                "difference of the closed forms",
                linear,
                "force of the law",
                rms(of_law),
            ),
            (
                "six_dof.force_error_max_N",
                error.max(),
                "difference of the closed forms at the end",
                linear,
                "force of the law",
                of_law.max(),
            ),
            (
                "six_dof.ghost_displacement_rms_m",
                rms(error) / hand,
                "the hand yields to the difference",
                linear,
                "coupling and hand yield",
                rms(error) / series,
            ),
            (
                "six_dof.unresisted_turn_max_rad",
                lever * size.max() / turning,
                "the torque turns the hand",
                linear,
                "the turn of the tool",
                lever * size.max() / rotation,
            ),
            (
                "six_dof.work_J",
                -0.5 * series * (1 - series / hand) * press[-1] ** 2,
                "the handle moves by the press less what the hand yields",
                linear,
                "the press in full",
                -0.5 * series * press[-1] ** 2,
            ),
            ("six_dof.law_unbalanced_steps", 0, "one spring", EXACT, "every step", n),
            (
                "six_dof.reference_residual_max_N",
                0.0,
                "equilibrium",
                Within("kSolved", absolute=1e-9),
                "of a step that has not converged",
                1e-6,
            ),
            ("six_dof.reference_jumps", 0, "one contact, pressed steadily", EXACT, "its touch", 1),
            ("six_dof.reference_unsolved_steps", 0, "there is room", EXACT, "every step", n),
        ],
    )
    columns = []
    for i, x in enumerate("xyz"):
        columns += [
            (
                f"reference_{x}_N",
                force[:, i],
                "springs in series",
                linear if i < 2 else tilted,
                "of the law",
                of_law + 1e-3 * (i == 2),
            ),
            (
                f"torque_{x}_Nm",
                torque[:, i],
                "arm x force",
                linear,
                "its opposite",
                -torque[:, i] + 1e-6 * (i == 2),
            ),
            (f"tool_{x}_m", tip[:, i], "moved and turned", small, "the intent", tip[:, i] + 1e-6),
            (f"tool_axis_{x}", axis[:, i], "turned", small, "upwards", -axis[:, i] + 1e-6),
            (
                f"handle_turn_{x}_rad",
                handle_turn[:, i],
                "torque over the hand's stiffness",
                linear if i < 2 else small,
                "turn of the tool",
                tool_turn[:, i] + 1e-6 * (i == 2),
            ),
            (
                f"law_{x}_N",
                of_law * normal[i],
                "springs in series without a turn",
                linear,
                "with a turn",
                force[:, i] + 1e-6 * (i == 2),
            ),
        ]
    bench.columns(
        run.table("six_dof.csv"),
        [
            ("step", np.arange(n), "counted", EXACT, "from 1", 1 + np.arange(n)),
            (
                "time_s",
                dt * np.arange(n),
                "k dt",
                Within("rounding", relative=1e-15),
                "from dt",
                dt + dt * np.arange(n),
            ),
            *columns,
        ],
    )
