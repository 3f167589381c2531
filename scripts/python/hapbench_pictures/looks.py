"""How runs are drawn: as their algorithm is everywhere, and with line styles where two runs share one."""
from dataclasses import dataclass, replace

from hapbench_looks import Look, look

DASHES = ((), (4, 1.5), (1, 1), (4, 1, 1, 1))
# Text, ground, grid and secondary text: of paper, and of the dark page.
LIGHT = ("#1d2126", "#ffffff", "#e6e6e6", "#5b636c")
DARK = ("#e7e9ea", "#1c2024", "#383e44", "#a3abb3")


# Colours of runs that share one algorithm, on paper and on the dark page, each with a contrast of at least 4.5.
SHARED = (("#000000", "#F2F2F2"), ("#C2500A", "#FFA366"), ("#0B6BC4", "#6CB4F5"), ("#9F0375", "#F07CC8"), ("#1D6A01", "#7EDB5A"),
          ("#775543", "#D3AE97"))
THIN = 0.6  # line width of the single runs of a group [points]


@dataclass(frozen=True)
class RunLook(Look):
    marker: str = ""  # curves of runs have none
    width: float = 1.3
    group: str = ""  # the label of all runs that differ in the seed only


def looks(runs, labels, groups=()):
    """`groups`: a name for each run, the same for those that differ in the seed only; by default the labels."""
    groups = groups or labels
    distinct = list(dict.fromkeys(zip(groups, (run.algorithm for run in runs))))
    algorithms = [algorithm for _, algorithm in distinct]
    nth = {group: algorithms[:i].count(algorithm) for i, (group, algorithm) in enumerate(distinct)}
    one_each, alike = len(set(algorithms)) == len(distinct), len(set(algorithms)) == 1
    width = RunLook.width if len(distinct) == len(runs) else THIN
    found = []
    for run, label, group in zip(runs, labels, groups):
        own, i = look(run.algorithm), nth[group]
        colours = SHARED[i % len(SHARED)] if alike and not one_each else (own.colour, own.dark)
        found.append(RunLook(label, *colours, own.dash if one_each else DASHES[i % len(DASHES)], width=width, group=group))
    return found


def on_dark(shown):
    return [replace(one, colour=one.dark) for one in shown]


def settings(paper):
    """matplotlib's colours for LIGHT or DARK."""
    ink, ground, grid, _ = paper
    return {"text.color": ink, "axes.labelcolor": ink, "xtick.color": ink, "ytick.color": ink, "axes.edgecolor": ink,
            "axes.facecolor": ground, "figure.facecolor": ground, "savefig.facecolor": ground, "grid.color": grid}
