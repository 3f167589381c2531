"""Links between claims, the runs that decide them, and the figures drawn of those runs."""
import re

from .markup import text
from .runs import find_run


class Links:
    """Ready links in every direction; empty where nothing belongs."""

    def __init__(self, runs, figures, claims):
        self.runs, self.figures, self.claims = runs, figures, claims
        folders = {figure.id: {source.rpartition("/")[0] for source in figure.sources} for figure in figures}
        self._drawn = {id_: [run for run in runs if run.path in of] for id_, of in folders.items()}
        self._deciding = {id(claim): [find_run(runs, name) for name in scenarios_of(claim)] for claim in claims}

    def of_claim(self, claim):
        """Figures and runs of a claim, each as links; scenarios that it runs for itself by their names."""
        runs = zip(scenarios_of(claim), self._deciding[id(claim)])
        return (figure_links(self._figures_of(claim)),
                [run_link(run) if run else f"<code>{text(name)}</code>" for name, run in runs])

    def of_figure(self, figure):
        """Claims and runs of a figure."""
        claims = [claim_link(claim) for claim in self.claims if figure in self._figures_of(claim)]
        return claims, [run_link(run) for run in self._drawn[figure.id]]

    def of_run(self, run):
        """Claims that a run decides, and figures that show it."""
        claims = [claim_link(claim) for claim in self.claims if run in self._deciding[id(claim)]]
        return claims + figure_links(figure for figure in self.figures if run in self._drawn[figure.id])

    def place(self, place):
        """A place in the thesis, its figures as links where the page has them."""
        out = []
        for part in re.split(rf"({FIGURE})", place):
            found = [f for f in self.figures if part.startswith("Fig. ") and figure_labels(part) & figure_labels(f.thesis_figure)]
            out.append(f'<a href="#figure-{text(found[0].id)}">{text(part)}</a>' if found else text(part))
        return "".join(out)

    def _figures_of(self, claim):
        """Figures that the claim's place names, then figures that show a run which decides it."""
        labels = figure_labels(" ".join(re.findall(FIGURE, str(claim.get("place", "")))))
        named = [f for f in self.figures if labels & figure_labels(f.thesis_figure)]
        runs = self._deciding[id(claim)]
        return named + [f for f in self.figures if f not in named and any(run in runs for run in self._drawn[f.id])]


FIGURE = r"Fig\. (?:[A-F]\.?)?\d+"


def figure_labels(thesis_figure):
    """"7a–c, B.4" -> {"7", "B.4"}: the numbers without their parts."""
    return {prefix + digits for prefix, digits in
            re.findall(r"(?<![A-Za-z0-9.])((?:[A-F]\.)?)(\d+)(?![0-9])", re.sub(r"\b([A-F])(?=\d)", r"\1.", thesis_figure))}


def scenarios_of(claim):
    """Names of the thesis's scenarios that a claim was measured with; a ledger of an older program has none."""
    names = claim.get("scenarios")
    return [str(name) for name in names] if isinstance(names, list) else []


def figure_name(figure):
    return f"Fig. {figure.thesis_figure.removeprefix('Fig. ')}" if figure.thesis_figure else figure.title or figure.id


def figure_links(figures):
    return [f'<a href="#figure-{text(f.id)}">{text(figure_name(f))}</a>' for f in figures]


def claim_link(claim):
    id_ = text(claim.get("id", ""))
    return f'<a href="#claim-{id_}">{id_}</a>'


def run_link(run):
    return f'<a href="#{run.anchor}">{text(run.path.removeprefix("thesis/"))}</a>'
