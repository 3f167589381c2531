"""How runs are drawn: as their algorithm is everywhere, and with line styles where two runs share one."""
from dataclasses import dataclass

from hapbench_looks import look

DASHES = ((), (4, 1.5), (1, 1), (4, 1, 1, 1))
# Text, ground, grid and secondary text: of paper, and of the dark page.
LIGHT = ("#1d2126", "#ffffff", "#e6e6e6", "#5b636c")
DARK = ("#e7e9ea", "#1c2024", "#383e44", "#a3abb3")


@dataclass(frozen=True)
class RunLook:
    label: str
    colour: str
    dark: str
    dash: tuple

    @property
    def line(self):
        """The line's style as matplotlib has it."""
        return (0, self.dash) if self.dash else "-"


def looks(runs, labels):
    seen, found = {}, []
    alone = len({run.algorithm for run in runs}) == len(runs)
    for run, label in zip(runs, labels):
        nth = seen[run.algorithm] = seen.get(run.algorithm, -1) + 1
        own = look(run.algorithm)
        found.append(RunLook(label, own.colour, own.dark, own.dash if alone else DASHES[nth % len(DASHES)]))
    return found


def on_dark(shown):
    return [RunLook(one.label, one.dark, one.dark, one.dash) for one in shown]


def settings(paper):
    """matplotlib's colours for LIGHT or DARK."""
    ink, ground, grid, _ = paper
    return {"text.color": ink, "axes.labelcolor": ink, "xtick.color": ink, "ytick.color": ink, "axes.edgecolor": ink,
            "axes.facecolor": ground, "figure.facecolor": ground, "savefig.facecolor": ground, "grid.color": grid}
