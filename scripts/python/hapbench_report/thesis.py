"""An index of the figures and tables of the thesis, and its tables beside ours."""
import json
import re
from pathlib import Path

from .json_input import at, number_or_none
from .markup import ABSENT, cell, command, heading_cell, number, table, text
from .runs import find_run
from .studies import LIMITS

HERE = Path(__file__).parent
MEASURES = {"success_rate": ("Success rate", "1"), "completion_time_s": ("Completion time", "s"),
            "model_force_N": ("Model force", "N"), "speed_m_per_s": ("Measured velocity", "m/s")}
# The thesis's names for its two methods.
METHODS = (("DP", "original_averaging"), ("HS", "shaped_stiffness"))


def load_tables():
    return json.loads((HERE / "thesis_tables.json").read_text(encoding="utf-8"))


def anchor(label):
    return "thesis-" + re.sub(r"[^a-z0-9]+", "-", label.lower()).strip("-")


def figure_labels(thesis_figure):
    """"7a–c, B.4" -> {"7", "B.4"}: the numbers without their parts."""
    return {prefix + digits for prefix, digits in
            re.findall(r"(?<![A-Za-z0-9.])((?:[A-F]\.)?)(\d+)(?![0-9])", re.sub(r"\b([A-F])(?=\d)", r"\1.", thesis_figure))}


def drawn(entry, figures):
    label, _, _, *keyword = entry
    found = [f for f in figures if label in figure_labels(f.thesis_figure)]
    # The thesis numbers two figures A.4.
    return [f for f in found if not keyword or re.search(keyword[0], f"{f.thesis_figure} {f.title} {f.id}", re.IGNORECASE)]


def thesis_figures():
    return json.loads((HERE / "thesis_index.json").read_text(encoding="utf-8"))["figures"]


def index_section(figures, tables, links):
    rows = []
    for entry in thesis_figures():
        label, title, why_not = entry[:3]
        shown = ", ".join(f'<a href="#figure-{text(f.id)}">{text(f.title or f.id)}</a>' for f in drawn(entry, figures))
        rows.append([cell(f"Fig. {text(label)}"), cell(text(title)),
                     cell(shown or f'<span class="note">{text(why_not or "not among the given figures")}</span>'),
                     cell(", ".join(links.claims_at(entry)))])
    for part in (*tables["parameters"], tables["limits"], *tables["targets"]):
        rows.append([cell(text(part["label"])), cell(text(part["title"])),
                     cell(f'<a href="#{anchor(part["label"])}">beside ours</a>'), cell("")])
    headings = [heading_cell(title) for title in ("Thesis", "Shows", "In this report", "Claims")]
    return ("<p>For a reader with the thesis in hand. Appendices A and D both number their tables A.1 to A.4.</p>"
            + table(headings, rows, "<b>Figures and tables of the thesis</b>", "stack"))


def target_tables(runs, tables):
    parts = [
        "<p>Tables A.1 to A.4 of appendix D compare six people who removed targets with the original algorithm (DP) and with "
        "stiffness shaping (HS). Ours are six simulated subjects, whose parameters are ours. "
        "Values are means ± standard errors over subjects.</p>"
        '<p class="note">A simulated subject shows what the dynamics of hand, device and algorithm do to a task: whether a '
        "target can be held at all, at what force and speed. It cannot show what people feel, how they learn or tire, what "
        "they try, or how much one person differs from the next; agreement in sign and order of magnitude is what can be "
        "asked of it.</p>"]
    for part in tables["targets"]:
        parts.append(f'<div id="{anchor(part["label"])}">{target_table(runs, part)}</div>')
    return "".join(parts)


def target_table(runs, part):
    found = [find_run(runs, f"{part['task']}_{algorithm}") for _, algorithm in METHODS]
    rows = []
    for measure, *published in part["rows"]:
        title, unit = MEASURES[measure]
        cells = [cell(text(title)), cell(text(unit))]
        for value, run in zip(published, found):
            ours = mean_and_error(at(run.summary, f"/targets/{part['place']}/{measure}")) if run else ABSENT
            cells += [cell(text(value), classes="number"), cell(ours, classes="number ours")]
        rows.append(cells)
    headings = [heading_cell("Measure"), heading_cell("Unit")]
    headings += [heading_cell(f"{name} {who}", True) for name, _ in METHODS for who in ("thesis", "ours")]
    links = " and ".join(f'<a href="#{run.anchor}">{text(run.name)}</a>' for run in found if run)
    return table(headings, rows, f"<b>{text(part['label'])}</b> {text(part['title'])}; our runs: {links or 'none'}")


def mean_and_error(value):
    mean, error = (number_or_none(at(value or {}, f"/{key}")) for key in ("mean", "standard_error"))
    return ABSENT if mean is None else f"{number(mean, 3)} ± {number(error, 2)}"


def parameter_tables(runs, tables):
    return "".join(f'<div id="{anchor(part["label"])}">{parameter_table(runs, part)}</div>' for part in tables["parameters"])


def parameter_table(runs, part):
    run = find_run(runs, part["run"])
    rows = [[cell(text(title)), cell(text(unit)), cell(text(published), classes="number"),
             cell(ours(run, pointer, scale), classes="number ours"), cell(f"<code>{text(pointer)}</code>")]
            for title, published, unit, pointer, scale in part["rows"]]
    headings = [heading_cell("Parameter"), heading_cell("Unit"), heading_cell("Thesis", True), heading_cell("Ours", True),
                heading_cell("Field of the scenario")]
    link = f'<a href="#{run.anchor}">{text(run.name)}</a>' if run else "not among these results"
    return table(headings, rows, f"<b>{text(part['label'])}</b> {text(part['title'])}; our run: {link}")


def ours(run, pointer, scale):
    value = at(run.scenario, pointer) if run else None
    if isinstance(value, list):
        return ", ".join(scaled(x, scale) for x in value)
    return scaled(value, scale)


def scaled(value, scale):
    value = number_or_none(value)
    return ABSENT if value is None else number(value * scale)


# Field and zeta -> limit and unit.
LIMIT_CASES = {("rendering.stiffness_N_per_m", "0"): ("stiffness undamped", "N/m"), ("rendering.stiffness_N_per_m", "0.7"): ("stiffness damped", "N/m"),
               ("rendering.damping_N_s_per_m", ""): ("damping alone", "N s/m"), ("time.step_s", ""): ("time step", "s")}


def limits_table(studies, tables):
    part = tables["limits"]
    rows = []
    for study in (s for path in LIMITS for s in studies if s.path == path):
        for row in study.rows:
            value = dict(zip(study.header, row))
            case, unit = LIMIT_CASES[value["field"], value.get("rendering.damping_ratio", "")]
            rows.append([cell(text(case)), cell(text(unit)), cell(text(part["published"].get(case, ABSENT)), classes="number"),
                         *(cell(shown_number(value.get(key, "")), classes="number ours") for key in ("closed_form", "theory", "limit"))])
    headings = [heading_cell("Limit"), heading_cell("Unit"), *(heading_cell(t, True) for t in ("Thesis", "Closed form", "Eigenvalues", "Simulation"))]
    return (f'<div id="{anchor(part["label"])}">' + table(
        headings, rows, f"<b>Section {text(part['label'])}</b> {text(part['title'])} of the leapfrog step with Table A.4 (appendix A)")
        + "</div>" + command("hapbench limit spring_stiffness\nhapbench limit spring_damping\nhapbench limit spring_time_step"))


def shown_number(value):
    try:
        return number(float(value), 6)
    except ValueError:
        return text(value)
