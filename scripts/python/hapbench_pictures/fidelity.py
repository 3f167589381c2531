"""How near a rendered force comes to the one that was measured with the stroke: a section of the page of runs."""
import numpy as np

from hapbench_report.json_input import number_or_none
from hapbench_report.markup import cell, heading_cell, number_cell, table, text

from .curves import drawing, key
from .looks import looks
from .panels import SPANS
from .quantities import REFERENCE, TRAJECTORY, Samples, quantity, tables_of
from .reduced import curve

SIZE = (4.0, 2.0)  # [inch], as the other curves of the page
# Name in section "fidelity" of summary.json -> heading, factor.
METRICS = (
    ("reference_force_rms_N", "Reference rms, N", 1),
    ("force_error_rms_N", "Error rms, N", 1),
    ("force_error_relative", "Error, %", 100),
    ("force_error_normal_rms_N", "Normal, N", 1),
    ("force_error_tangential_rms_N", "Tangential, N", 1),
    ("force_direction_error_rad", "Direction, °", 180 / np.pi),
    ("force_lag_s", "Lag, ms", 1000),
)


def fidelity_section(runs, labels):
    """Empty without a run whose stroke has a measured force."""
    known = [(run, label) for run, label in zip(runs, labels) if run.summary.get("fidelity")]
    if not known:
        return ""
    rows = [[cell(text(label), classes="name"), *(number_cell(scaled(run, name, factor), 3) for name, _, factor in METRICS)]
            for run, label in known]
    headings = [heading_cell("Run"), *(heading_cell(title, True) for _, title, _ in METRICS)]
    return (table(headings, rows, "<b>Rendered against measured force</b> The normal is that of what is rendered, before "
                  "damping and friction; <code>hapbench describe</code> explains each", "sortable")
            + curves([run for run, _ in known], [label for _, label in known]))


def scaled(run, name, factor):
    value = number_or_none(run.summary["fidelity"].get(name))
    return None if value is None else value * factor


def curves(runs, labels):
    """Of those that recorded both forces."""
    drawn = [(run, label) for run, label in zip(runs, labels) if {TRAJECTORY, REFERENCE} <= set(tables_of(run))]
    if not drawn:
        return "<p class=note>With --set record.force_reference=true the curves stand here.</p>"
    runs, labels = zip(*drawn)
    force, reference, error = (quantity(name, runs) for name in ("force", "reference", "force_error"))
    samples, light = [Samples(run, (force, reference, error)) for run in runs], looks(runs, labels)

    def both(ax, shown):
        # One recording is behind all runs of a scene: its curve is drawn once, in the colour of the text.
        time, _, measured = samples[0].of(reference)
        ax.plot(*curve(time, measured, measured, SPANS), color=ax.xaxis.label.get_color(), lw=0.8, ls=":")
        for s, one in zip(samples, shown):
            time, _, rendered = s.of(force)
            ax.plot(*curve(time, rendered, rendered, SPANS), color=one.colour, ls=one.line, lw=0.9)
        ax.set_ylabel("force [N]")

    def errors(ax, shown):
        for s, one in zip(samples, shown):
            time, _, off = s.of(error)
            ax.plot(*curve(time, off, off, SPANS), color=one.colour, ls=one.line, lw=0.9)
        ax.set_ylabel("||f - f_m|| [N]")

    figures = [drawing(SIZE, both, light, "Rendered and measured force [N] over time", words(samples, labels, reference),
                       xlabel="time [s]"),
               drawing(SIZE, errors, light, "Their difference [N] over time", words(samples, labels, error), xlabel="time [s]")]
    return f"<p>{key(light)} Dotted: the force measured with the stroke.</p><div class=curves>{''.join(figures)}</div>"


def words(samples, labels, shown):
    """The picture in words: the largest value of each run."""
    return "; ".join(f"{label} up to {np.nanmax(s.of(shown)[2], initial=0.0):.3g} N" for s, label in zip(samples, labels))
