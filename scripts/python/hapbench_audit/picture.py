"""Draws the picture of an audit: force and energy over time, force against position, and the spectrum of the force."""
import numpy as np
from hapbench_looks import SERIES
from hapbench_style import SETTINGS, curve, lettered, panels, picture, plt

from .energy import Port

SPANS = 1200  # number of intervals of a curve; each shows its smallest and its largest value
MAX_POINTS = 4000  # largest number of points of force against position
MAX_SHADED = 200  # largest number of shaded contacts
SMALL = 5e-5  # travel below which positions are drawn in micrometres [m]


class Drawing:
    """Draws the panels of an audit. Each panel is a method that draws on `ax` in the given colours, for light or dark
    background."""

    def __init__(self, log, audit, contacts, spectrum):
        self.log, self.audit, self.contacts, self.spectrum = log, audit, contacts, spectrum
        self.time = log.time

    def panels(self):
        """Returns (title, function draw(ax, colours)) of each panel. A panel is omitted if the log does not determine
        its contents."""
        found = [("force over time", self.force), ("energy given to the hand", self.energy)]
        if self.audit["stiffness"]:
            found.append((self.spring_title(), self.spring))
        if self.spectrum is not None:
            found.append(("spectrum of the force in contact", self.frequencies))
        return found

    def spring_title(self):
        spring = self.audit["stiffness"]
        return f"force against position, {spring['start_s']:.4g} to {spring['end_s']:.4g} s"

    def force(self, ax, colours):
        size = np.linalg.norm(self.log.force, axis=1)
        ax.plot(*curve(self.time, size, size, SPANS), color=colours[0], lw=1.0)
        ends = np.minimum(self.contacts.runs, len(self.time) - 1)
        for first, after in ends[:MAX_SHADED].tolist():
            ax.axvspan(self.time[first], self.time[after], color=colours[1], alpha=0.12, lw=0)
        at = self.audit["metrics"]["time_of_largest_step_s"]
        row = int(np.argmin(np.abs(self.time - at)))
        ax.plot([at], [size[row]], marker="v", color=colours[1], ls="none", label="largest step")
        ax.legend(loc="upper right")
        ax.set(xlabel="time [s]", ylabel="force [N]", ylim=(0, 1.15 * max(size.max(), 1e-12)))

    def energy(self, ax, colours):
        held = energy_curve(self.log, self.contacts)
        ax.plot(*curve(self.time, held, held, SPANS), color=colours[0], lw=1.0)
        energy = self.audit["energy"]
        ax.axhline(0.0, color=colours[2], lw=0.6)
        if energy["net_created_J"] is not None:
            self.created(ax, energy, colours[1])
        ax.set(xlabel="time [s]", ylabel="work on the tool [mJ]")

    def created(self, ax, energy, colour):
        stored = energy["stored_at_start_J"]
        ax.errorbar(
            [energy["time_of_max_s"]],
            [1e3 * (energy["net_created_J"] + stored)],
            [1e3 * energy["net_created_error_J"]],
            marker="o",
            color=colour,
            capsize=2,
            ls="none",
            label=f"created {1e3 * energy['net_created_J']:.3g} mJ",
        )
        ax.legend(loc="best")

    def spring(self, ax, colours):
        spring, log = self.audit["stiffness"], self.log
        direction = np.array(spring["direction"])
        is_used = (log.time >= spring["start_s"]) & (log.time <= spring["end_s"])
        rows = np.flatnonzero(is_used & self.contacts.in_contact)
        delay = spring["delay_rows"] or 0
        rows = rows[delay :: max(1, len(rows) // MAX_POINTS)]
        position = log.position[rows - delay] @ direction
        unit, factor = ("um", 1e6) if np.ptp(position) < SMALL else ("mm", 1e3)
        position, along = factor * position, log.force[rows] @ direction
        ax.plot(position, along, ".", ms=1.5, color=colours[0])
        x = np.array([position.min(), position.max()])
        line = along.mean() - spring["stiffness_N_per_m"] / factor * (x - position.mean())
        low, high = along.min(), along.max()
        ax.plot(x, line, color=colours[1], ls="--", lw=1.0)
        ax.set(
            xlabel=f"position along the force [{unit}]",
            ylabel="force along it [N]",
            ylim=(low - 0.1 * (high - low), high + 0.25 * (high - low)),
        )
        ax.legend([ax.lines[-1]], [f"K = {spring['stiffness_N_per_m']:.4g} N/m"], loc="upper right")

    def frequencies(self, ax, colours):
        frequency, amplitude, _ = self.spectrum
        keep = frequency > 0.0
        ax.plot(
            *curve(frequency[keep], amplitude[keep], amplitude[keep], SPANS),
            color=colours[0],
            lw=0.9,
        )
        for one in self.audit["buzz"]:
            ax.plot([one["frequency_Hz"]], [one["amplitude_N"]], "v", color=colours[1])
        if self.audit["buzz"]:
            first = self.audit["buzz"][0]
            ax.annotate(
                f"{first['frequency_Hz']:.4g} Hz",
                (first["frequency_Hz"], first["amplitude_N"]),
                textcoords="offset points",
                xytext=(5, 2),
                fontsize=7,
            )
        device = self.audit["device"]
        if device and device["expected_frequency_Hz"]:
            ax.axvline(
                device["expected_frequency_Hz"],
                color=colours[2],
                ls=":",
                lw=1.0,
                label=f"expected from {device['device']}",
            )
            ax.legend(loc="upper right")
        ax.set(xlabel="frequency [Hz]", ylabel="amplitude [N]", xlim=(0, frequency[-1]))
        ax.set_ylim(0, 1.2 * max(float(amplitude[keep].max()), 1e-12))


def energy_curve(log, contacts):
    """Returns for each row the work on the tool since the start of the log [mJ], if each force acts until the next
    row."""
    return 1e3 * np.concatenate([[0.0], np.cumsum(Port(log, contacts).held)])


def colours_of(dark=False):
    return [one.dark if dark else one.colour for one in SERIES]


def draw(drawing, kind="svg"):
    """Returns the bytes of the picture with all panels. `kind`: file format."""
    with plt.rc_context(SETTINGS):
        parts = drawing.panels()
        figure, grid = panels(2, 2, 4.6)
        axes = grid.ravel().tolist()
        for ax, (title, part) in zip(axes, parts):
            part(ax, colours_of())
            ax.set_title(title)
        for ax in axes[len(parts) :]:
            ax.remove()
        data = picture(lettered(figure, axes[: len(parts)]), kind)
        plt.close(figure)
    return data
