"""Links between claims, the runs that decide them, and the figures drawn of those runs."""
import re

from .markup import text
from .runs import find_run

FIGURE = r"Fig\. (?:[A-F]\.?)?\d+"


class Links:
    """Ready links between what belongs together."""

    def __init__(self, runs, figures, claims):
        self.figures, self.claims = figures, claims
        self._drawn = {figure.id: [run for run in runs if run.path in {source.rpartition("/")[0] for source in figure.sources}] for figure in figures}
        self._deciding = {id(claim): {str(name): find_run(runs, str(name)) for name in claim.get("scenarios") or ()} for claim in claims}

    def of_claim(self, claim):
        """Figures and runs of a claim, each as links; scenarios that it runs for itself by their names."""
        return ([f'<a href="#figure-{text(f.id)}">{text(f.name)}</a>' for f in self._figures_of(claim)],
                [run_link(run) if run else f"<code>{text(name)}</code>" for name, run in self._deciding[id(claim)].items()])

    def of_figure(self, figure):
        """Claims and runs of a figure."""
        return [claim_link(claim) for claim in self.claims if figure in self._figures_of(claim)], [run_link(run) for run in self._drawn[figure.id]]

    def _figures_of(self, claim):
        """Figures that the claim's place names, then figures that show a run which decides it."""
        labels = figure_labels(" ".join(re.findall(FIGURE, str(claim.get("place", "")))))
        named = [f for f in self.figures if labels & figure_labels(f.thesis_figure)]
        runs = self._deciding[id(claim)].values()
        return named + [f for f in self.figures if f not in named and any(run in runs for run in self._drawn[f.id])]


def figure_labels(thesis_figure):
    """"7a–c, B.4" -> {"7", "B.4"}: the numbers without their parts."""
    return {prefix + digits for prefix, digits in
            re.findall(r"(?<![A-Za-z0-9.])((?:[A-F]\.)?)(\d+)(?![0-9])", re.sub(r"\b([A-F])(?=\d)", r"\1.", thesis_figure))}


def claim_link(claim):
    id_ = text(claim.get("id", ""))
    return f'<a href="#claim-{id_}">{id_}</a>'


def run_link(run):
    return f'<a href="#{run.anchor}">{text(run.path.removeprefix("thesis/"))}</a>'
