"""How far stiffness shaping decouples the force from the density of points, over its updates (P1; ours)."""
import hapbench_style as style

from . import ledger

TIMES = (40, 10, 4)


def decoupling(results):
    """Error of the force over the updates, a curve for each density."""
    cases = [case["values"] for case in ledger.cases(results, "P1") if case["name"].startswith(("m = ", "shaped_stiffness"))]
    cases.sort(key=lambda values: values["updates"])
    figure, axes = style.panels(1, 1, 2.6)
    figure.set_size_inches(3.8, 2.6)
    ax = axes[0, 0]
    for times, look in zip(TIMES, style.SERIES):
        ax.plot([values["updates"] for values in cases], [100 * values[f"x{times}"] for values in cases], color=look.colour,
                marker=look.marker, label=f"{times} times the points")
    ax.set(xscale="log", yscale="log", xlabel="updates of the weights", ylabel="change of the force, rms [%]")
    ax.axhline(5, color=style.GREY, ls="--", lw=0.9)
    ax.axvline(3, color=style.RED, ls=(0, (1, 1.5)), lw=1)
    ax.legend(loc="lower left", fontsize=6.5)
    style.note(ax, 0.4, 0.97, "red: the thesis's three updates", style.RED)
    return figure, {}
