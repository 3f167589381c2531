"""The torque of the contacts of a turned drill, which a device of three degrees of freedom cannot render."""
import numpy as np

import hapbench_style as style

ALGORITHMS = ("original_averaging", "shaped_stiffness")


def norm(rows, prefix, unit):
    return np.sqrt(sum(rows[f"{prefix}{axis}_{unit}"] ** 2 for axis in "xyz"))


def lost(results):
    figure, axes = style.panels(1, 3, 2.7)
    force_over_time, torque_over_time, arm_over_time = axes[0]
    most = {}
    for name in ALGORITHMS:
        rows, look = results.table(f"torque/{name}/trajectory.csv"), style.look(name)
        force, torque = norm(rows, "f", "N"), norm(rows, "t", "Nm")
        acting = force > 0
        time, line = rows["time_s"][acting], {"color": look.colour, "lw": 1.1, "label": look.label}
        force_over_time.plot(time, force[acting], **line)
        torque_over_time.plot(time, 1e3 * torque[acting], **line)
        arm_over_time.plot(time, 1e3 * torque[acting] / force[acting], **line)
        most[look.label] = force.max(), 1e3 * torque.max()
    force_over_time.set(xlabel="time [s]", ylabel="‖f‖ [N]", ylim=(0, None), title="force rendered")
    torque_over_time.set(xlabel="time [s]", ylabel="‖τ‖ [mN m]", ylim=(0, None), title="torque lost")
    arm_over_time.set(xlabel="time [s]", ylabel="‖τ‖ / ‖f‖ [mm]", ylim=(0, None), title="lost per newton rendered")
    force_over_time.legend(loc="upper left", fontsize=6.5)
    force_over_time.set_ylim(top=1.35 * force_over_time.get_ylim()[1])  # room for the legend
    style.letter(axes[0])
    shown = ", ".join(f"{label} {force:.2g} N and {torque:.2g} mN m" for label, (force, torque) in most.items())
    return figure, ("A drill whose tip rests against the wall of the hole is turned by script until its side meets the rim "
                    "opposite, and back; both algorithms see the same contacts. (a) The force that is rendered. (b) The "
                    "torque about the tip that the contacts would exert by their shares of the spring force, and that a "
                    "device of three degrees of freedom loses: what Fig. 1 is about. (c) Their ratio. While wall and rim "
                    "push against each other, most of the contact is torque. Shaping renders the little force that is "
                    "left; the original algorithm makes it up by dividing by the nearly cancelled sum of directions. At "
                    f"most: {shown}. Ours.")
