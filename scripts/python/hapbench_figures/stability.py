"""Figures about stability: every algorithm on many springs (thesis Fig. A.4 and A.5), the root locus (A.3), the largest
stable stiffness over other fields (`limit --over`) and on each device (`limit --device`), and the largest stable
stiffness of a real paddle."""
import json

import numpy as np

import hapbench_style as style
from hapbench.columns import numbers, read_records
from hapbench_pictures.given import axis
from hapbench_pictures.limit_plot import Limits, draw_limits, draw_over

from . import scene

SPRING = scene.ROOT / "scenarios" / "library" / "limits" / "single_spring.json"


def draw_path(ax, rows, look):
    x, y = 1e3 * rows["px_m"], 1e3 * rows["py_m"]
    ax.plot(x, y, color=look.colour, lw=1.2, clip_on=True)
    ax.plot(x[:1], y[:1], "o", color=look.colour, mfc="white", ms=4)
    ax.plot(0, 0, "+", color=style.BLACK, ms=7, mew=1)


def settling(rows):
    """Returns the time after which the mass stays within 0.05 mm of the origin [ms], or None if the mass is not there
    at the end."""
    far = np.hypot(rows["px_m"], rows["py_m"]) > 5e-5
    if far[-1]:
        return None
    last = np.flatnonzero(far)
    return 1e3 * rows["time_s"][last[-1] + 1] if len(last) else 0.0


def paths(results, kind):
    """Returns the figure, and an empty dict because the caption has no values. Each panel draws the path of the mass
    with one algorithm and, for comparison, the path with stiffness shaping. `kind`: "limited" or "unlimited".
    """
    figure, axes = style.panels(2, 4, 4.3, sharex=True, sharey=True)
    proposed = results.table(f"thesis/springs_{kind}_shaped_stiffness/trajectory.csv")
    names = [
        name
        for name in style.ALGORITHMS
        if results.has(f"thesis/springs_{kind}_{name}/trajectory.csv")
    ]
    for ax, name in zip(axes.flat, names):
        look = style.look(name)
        rows = results.table(f"thesis/springs_{kind}_{name}/trajectory.csv")
        outcome = results.json(f"thesis/springs_{kind}_{name}/summary.json")["outcome"]
        if name != "shaped_stiffness":
            ax.plot(1e3 * proposed["px_m"], 1e3 * proposed["py_m"], color="#8A8A8A", lw=0.9)
        draw_path(ax, rows, look)
        ax.set(
            xlim=(-6.5, 6.5), ylim=(-6.5, 6.5), aspect="equal", xticks=[-5, 0, 5], yticks=[-5, 0, 5]
        )
        time = settling(rows)
        text = (
            "diverges"
            if outcome == "diverges"
            else f"settles in {time:.0f} ms"
            if time is not None
            else "has not settled"
        )
        # The title stands above the frame, because some curves fill the frame.
        ax.set_title(look.label, color=look.colour, pad=14)
        ax.text(0, 1.03, text, transform=ax.transAxes, fontsize=7)
    style.plt.setp(axes[-1], xlabel="x [mm]")
    style.plt.setp(axes[:, 0], ylabel="y [mm]")
    return figure, {}


def spaced(number):
    """Formats a number with spaces between thousands. A number below 1000 that is not an integer has three decimals."""
    return f"{number:,.{0 if number >= 1000 or number == round(number) else 3}f}".replace(",", " ")


def root_locus(results):
    spring = json.loads(SPRING.read_text(encoding="utf-8"))
    dt, M, zeta = (
        spring["time"]["step_s"],
        spring["rendering"]["mass_kg"],
        spring["rendering"]["damping_ratio"],
    )
    poles = lambda K, B: sorted(
        np.linalg.eigvals(
            [[1 - K * dt * dt / M, dt - B * dt * dt / M], [-K * dt / M, 1 - B * dt / M]]
        ),
        key=lambda pole: (-pole.imag, -pole.real),
    )
    undamped, damped = results.records("spring_stiffness/limit.csv")
    damper = results.records("spring_damping/limit.csv")[0]
    cases = (
        ("A4.stiffness", "B = 0, K grows", "K", "N/m", undamped, lambda K: poles(K, 0)),
        ("A4.damping", "K = 0, B grows", "B", "N s/m", damper, lambda B: poles(0, B)),
        (
            "A4.stiffness.damped",
            f"ζ = {zeta:g}, K grows",
            "K",
            "N/m",
            damped,
            lambda K: poles(K, 2 * zeta * np.sqrt(K * M)),
        ),
    )
    figure, axes = style.panels(1, 3, 2.7, sharey=True)
    turn = np.linspace(0, 2 * np.pi, 181)
    for ax, (id_, title, symbol, unit, ours, at) in zip(axes[0], cases):
        value = scene.published(id_)
        ax.plot(np.cos(turn), np.sin(turn), color=style.BLACK, lw=0.8)
        for locus, colour, line in zip(
            np.array([at(v) for v in np.linspace(0, 1.25 * value, 401)]).T,
            (style.PETROL, style.AMBER),
            ("-", (0, (4, 1.2))),
        ):
            ax.plot(locus.real, locus.imag, color=colour, ls=line, lw=1.5)
        leaving = min(
            at(value), key=lambda pole: pole.real
        )  # the pole that leaves the unit circle at -1; the other pole stays inside or at 1
        ax.plot(leaving.real, leaving.imag, marker="D", mfc="white", mec=style.RED, ms=5, zorder=5)
        style.note(
            ax, 0.5, 0.98, f"published {symbol} = {spaced(value)} {unit}", style.RED, ha="center"
        )
        style.note(
            ax, 0.5, 0.02, f"ours {spaced(float(ours['limit']))} {unit}", ha="center", va="bottom"
        )
        ax.set(title=title, xlabel="real part", xlim=(-1.75, 1.4), ylim=(-1.6, 1.6), aspect="equal")
    axes[0, 0].set_ylabel("imaginary part")
    return style.lettered(figure, axes[0]), {"mass": M, "step": 1000.0 * dt}


def over(results, study):
    """Returns the figure of the limits that a study of `limit --over` found, and the values of its caption."""
    found = Limits(results, f"stability_{study}/")
    return draw_over(found), {
        "field": axis(found.field),
        "over": axis(found.over[-1]),
        "theory": "its ratio to the limit from theory; then "
        if any(row["theoretical_limit"] for row in found.rows)
        else "",
        "known": "Thin lines: known limits, and the least over passive hands. "
        if found.known(found.rows)
        else "",
    }


def of_all_devices(results):
    return draw_limits(results, style.PAGE, "device_limits/"), {}


MEASURED = scene.ROOT / "scenarios" / "library" / "validation" / "measured.csv"
# Factor by which the measured limit of the same setting differed between two sessions.
SCATTER = 1.3


def hardware(results):
    """Draws the largest stable stiffness K over the damping B of the EPFL paddle, measured and predicted, with a panel
    for each of its three velocity filters."""
    predicted, (damping, stiffness) = results.records("hardware_paddle/limit.csv"), (
        "damping_N_s_per_m",
        "stiffness_N_per_m",
    )
    filters = {"A": "10 Hz filter", "A'": "50 Hz filter", "A''": "1 kHz filter"}
    figure, axes = style.panels(1, len(filters), 2.7, sharey=True)
    for ax, (case, title) in zip(axes[0], filters.items()):
        measured = [row for row in read_records(MEASURED) if row["case"] == case]
        rows = [
            row
            for row in predicted
            if float(row["device.velocity_filter.cutoff_Hz"])
            == float(measured[0]["velocity_filter_Hz"])
        ]
        ax.plot(
            numbers(rows, f"rendering.{damping}"),
            numbers(rows, "limit"),
            color=style.PETROL,
            label="predicted",
        )
        K = numbers(measured, stiffness)
        ax.errorbar(
            numbers(measured, damping),
            K,
            yerr=[K - K / SCATTER, K * SCATTER - K],
            fmt="o",
            color=style.AMBER,
            ms=3,
            lw=0.8,
            label=f"measured, x{SCATTER:g}",
        )
        ax.set(title=title, yscale="log", xlabel="damping B [N s/m]")
    axes[0, 0].set_ylabel("largest stable stiffness K [N/m]")
    axes[0, 0].legend()
    return figure, {}
