"""Links between claims, the runs that decide them, and the figures drawn of those runs."""
import re

from .markup import text
from .runs import find_run
from .thesis import anchor, drawn, figure_labels, load_tables, thesis_figures
from .studies import LIMITS


class Links:
    """Ready links in every direction; empty where nothing belongs."""

    def __init__(self, runs, figures, claims, studies):
        self.runs, self.figures, self.claims = runs, figures, claims
        self._by_path = {run.path: run for run in runs}
        self._runs_of_claim = {id(claim): self._deciding(claim) for claim in claims}
        self._runs_of_figure = {figure.id: self._drawn_of(figure) for figure in figures}
        self._tables = {}
        tables = load_tables()
        # The limits stand beside the published ones.
        self._studies = {s.path: anchor(tables["limits"]["label"]) if s.path in LIMITS else s.anchor for s in studies}
        for part in (*tables["parameters"], *tables["targets"]):
            self._tables[part["label"]] = anchor(part["label"])

    def of_claim(self, claim):
        """Figures and runs of a claim, each as links; scenarios that it runs for itself by their names."""
        runs = [(name, find_run(self.runs, name)) for name in scenarios_of(claim)]
        return (self._figure_links(self._figures_of_claim(claim)),
                [run_link(run) if run else f"<code>{text(name)}</code>" for name, run in runs])

    def of_figure(self, figure):
        """Claims and runs of a figure."""
        claims = [claim for claim in self.claims if figure in self._figures_of_claim(claim)]
        return [claim_link(claim) for claim in claims], [run_link(run) for run in self._runs_of_figure[figure.id]]

    def of_run(self, run):
        """Claims that a run decides, and figures that show it."""
        claims = [claim_link(claim) for claim in self.claims if run in self._runs_of_claim[id(claim)]]
        return claims, self._figure_links([f for f in self.figures if run in self._runs_of_figure[f.id]])

    def of_source(self, path):
        """A result file, as a link to its run or its table where the page has one."""
        run = self._by_path.get(path.rpartition("/")[0])
        target = run.anchor if run else self._studies.get(path, "")
        shown = f"<code>{text(path)}</code>"
        return f'<a href="#{target}">{shown}</a>' if target else shown

    def place(self, place):
        """A place in the thesis, its figures and tables as links where the page has them."""
        out = []
        appendix = "appendix D" if place.startswith("D") else "appendix A"
        for part in re.split(r"(Fig\. [A-F]?\.?\d+|Table [A-F]\.\d+)", place):
            target = ""
            if part.startswith("Fig. "):
                found = [f for f in self.figures if figure_labels(part) & figure_labels(f.thesis_figure)]
                target = f"figure-{found[0].id}" if found else ""
            elif part.startswith("Table "):
                target = self._tables.get(part) or self._tables.get(f"{part} ({appendix})", "")
            out.append(f'<a href="#{text(target)}">{text(part)}</a>' if target else text(part))
        return "".join(out)

    def claims_at(self, entry):
        """The claims whose place names a figure of the thesis's index."""
        found = drawn(entry, self.figures)
        own = [claim for claim in self.claims if entry[0] in figure_labels(" ".join(named_figures(claim)))]
        # The thesis numbers two figures A.4: a claim belongs to the one that is drawn of its runs.
        if len([e for e in thesis_figures() if e[0] == entry[0]]) > 1:
            own = [claim for claim in own if any(self._share(claim, figure) for figure in found)]
        return [claim_link(claim) for claim in own]

    def _deciding(self, claim):
        return [run for run in (find_run(self.runs, name) for name in scenarios_of(claim)) if run]

    def _drawn_of(self, figure):
        paths = dict.fromkeys(source.rpartition("/")[0] for source in figure.sources)
        return [self._by_path[path] for path in paths if path in self._by_path]

    def _share(self, claim, figure):
        return any(run in self._runs_of_figure[figure.id] for run in self._runs_of_claim[id(claim)])

    def _figures_of_claim(self, claim):
        """Figures that the claim's place names, then figures that show a run which decides it."""
        labels = figure_labels(" ".join(named_figures(claim)))
        named = [f for f in self.figures if labels & figure_labels(f.thesis_figure)]
        return named + [f for f in self.figures if f not in named and self._share(claim, f)]

    def _figure_links(self, figures):
        return [f'<a href="#figure-{text(f.id)}">{text(figure_name(f))}</a>' for f in figures]


def scenarios_of(claim):
    """Names of the thesis's scenarios that a claim was measured with; a ledger of an older program has none."""
    names = claim.get("scenarios")
    return [str(name) for name in names] if isinstance(names, list) else []


def named_figures(claim):
    return re.findall(r"Fig\. [A-F]?\.?\d+", str(claim.get("place", "")))


def figure_name(figure):
    return f"Fig. {figure.thesis_figure.removeprefix('Fig. ')}" if figure.thesis_figure else figure.title or figure.id


def claim_link(claim):
    id_ = text(claim.get("id", ""))
    return f'<a href="#claim-{id_}">{id_}</a>'


def run_link(run):
    return f'<a href="#{run.anchor}">{text(run.path.removeprefix("thesis/"))}</a>'
