"""The ledger of claims of the thesis: published numbers, measured numbers and verdicts. Also builds the summary of the
page."""
from collections import Counter

from hapbench.errors import InputError
from hapbench.results import at, objects, read_object, shown

from .figures import claim_link
from .markup import cell, command, folded, heading_cell, listed, table, text, typeset

# Mark and colour class of each verdict, in the order of the ledger: contradicted claims first. The last two verdicts
# are for findings of this project. The marks distinguish the verdicts without colour.
VERDICTS = {
    "contradicted": ("⊘", "bad"),
    "not replicated": ("✗", "bad"),
    "not consistent in simulation": ("✗", "bad"),
    "not judged": ("?", "none"),
    "qualitatively replicated": ("≈", "fair"),
    "consistent in simulation": ("✓", "good"),
    "replicated": ("✓", "good"),
    "not testable": ("–", "none"),
    "does not hold": ("✗", "bad"),
    "holds": ("✓", "good"),
}
FILTER = (
    '<div class="bar" data-filters="ledger-table"><label>Filter <input type="search" placeholder="words"></label>'
    '<label>Verdict <select data-column="1"><option value="">all</option></select></label><output></output></div>'
)


def load_claims(file):
    """Returns (claims, sentence with the number of claims per verdict, sentences of the abstract) of the ledger."""
    ledger = read_object(file)
    claims = objects(ledger, "claims", file)
    for i, claim in enumerate(claims):
        if claim.get("verdict") not in VERDICTS:
            words = ", ".join(f'"{word}"' for word in VERDICTS)
            raise InputError(
                f"{file}: /claims/{i}/verdict: got {shown(claim.get('verdict'))}; allowed: {words}"
            )
    return claims, str(ledger.get("headline") or ""), ledger.get("abstract") or []


def of_thesis(claims):
    """Returns the claims of the thesis, without findings of this project, in the order of VERDICTS."""
    order = list(VERDICTS)
    return sorted(
        (claim for claim in claims if not claim.get("ours")),
        key=lambda claim: order.index(claim["verdict"]),
    )


def verdict_mark(verdict):
    mark, tone = VERDICTS[verdict]
    return f'<span class="verdict {tone}">{mark} {text(verdict)}</span>'


def summary_section(runs, claims, headline, abstract, figures):
    met = sum(run.expected for run in runs)
    tiles = [
        (len(runs), "run" if len(runs) == 1 else "runs"),
        (f"{met}/{len(runs)}", "ended as their scenario expects"),
    ]
    counts = Counter(claim["verdict"] for claim in of_thesis(claims) if not claim.get("timing"))
    tiles += [(str(count), verdict_mark(verdict)) for verdict, count in counts.items()]
    if figures:
        tiles.append((len(figures), '<a href="#figures">figures</a>'))
    items = "".join(f"<li><b>{text(value)}</b><span>{label}</span></li>" for value, label in tiles)
    commits = ", ".join(
        sorted({str(at(run.summary, "/provenance/commit") or "unknown") for run in runs})
    )
    return (
        "<h1>hapbench: haptic rendering of object-to-object contact</h1>"
        '<p class="lead">hapbench runs force algorithms on scripted tool trajectories. It reports '
        "trajectories, stiffness ratios, stability limits and the cost of a step. "
        "This page compares all results with T. C. Lee, <cite>Rendering "
        "6-DOF Object-to-Object Interaction with 3-DOF Haptic Interfaces</cite> (“the thesis”); "
        "numbers such as Fig. A.2 or "
        f"3.3 are its figures and sections. Program of commit <code>{text(commits)}</code>.</p>"
        f'<ul class="cards">{items}</ul>{main_results(claims, abstract)}<p>{typeset(headline)}</p>'
        f"{warnings(runs)}{refusals(claims)}"
    )


def main_results(claims, abstract):
    """Returns a table as HTML: each sentence of the abstract, the claims that test it, and the command of each
    claim."""
    by_id = {claim["id"]: claim for claim in claims}

    def each(of_sentence, text_of):
        return cell("<br>".join(f"{claim_link(claim)} {text_of(claim)}" for claim in of_sentence))

    rows = []
    for sentence in abstract:
        tests = [by_id[id_] for id_ in sentence["claims"] if id_ in by_id]
        if not tests:
            continue
        only = ",".join(claim["id"] for claim in tests)
        rows.append(
            [
                cell(typeset(sentence["sentence"]), classes="prose"),
                each(tests, lambda claim: typeset(claim.get("published_short", ""))),
                each(tests, lambda claim: typeset(claim.get("number", ""))),
                each(tests, lambda claim: verdict_mark(claim["verdict"])),
                each(tests, lambda claim: text(claim.get("robustness", ""))),
                cell(f"<code>hapbench reproduce --only {text(only)}</code>"),
            ]
        )
    titles = ("The abstract claims", "Published", "Ours", "Verdict", "Robustness", "Command")
    headings = [heading_cell(title) for title in titles]
    title = "<b>What the abstract claims</b>"
    return table(headings, rows, title, "stack", "main-results") if rows else ""


def warnings(runs):
    """Returns a paragraph with the names of all runs that did not end as expected. Returns an empty text if all runs
    ended as expected."""
    missed = [f"{text(run.path)} ({text(run.outcome)})" for run in runs if not run.expected]
    return f'<p><b class="bad">✗ Not as expected:</b> {", ".join(missed)}.</p>' if missed else ""


def refusals(claims):
    """Returns a list, for the summary, of the claims of the thesis that are not confirmed."""
    items = "".join(
        f"<li>{verdict_mark(c['verdict'])} {claim_link(c)} ({text(c.get('place', ''))}): "
        f"{typeset(c.get('claim', ''))}</li>"
        for c in of_thesis(claims)
        if VERDICTS[c["verdict"]][1] == "bad"
    )
    return (
        f"<p>Claims of the thesis that these runs do not confirm:</p><ul>{items}</ul>"
        if items
        else ""
    )


def ledger_section(claims, figures):
    if not claims:
        return '<p class="note">No ledger was given (<code>--claims</code>).</p>'
    rows = [claim_row(claim, figures) for claim in of_thesis(claims)]
    ours = [claim_row(claim, figures) for claim in claims if claim.get("ours")]
    headings = [
        heading_cell(title)
        for title in ("Id", "Verdict", "Claim", "Published", "Measured", "Robustness")
    ]
    return (
        "<p>The table lists each claim of the thesis with the published number, the measured number of our runs, and a "
        "verdict. A row unfolds to show the rule of the verdict, figures and scenarios. "
        "Hands are calibrated to mean and standard deviation of the number of raw colliding points; all other numbers "
        "are predictions. Column “Robustness”: each assumption that the thesis leaves open "
        "(<code>results/reference/assumptions.json</code>) was set to its other plausible values, one at a time, and "
        "the column names the assumptions that change the verdict. Exact: the claim depends on no assumption; robust: "
        "no assumption changes the verdict.</p>"
        + FILTER
        + table(headings, rows, "<b>The ledger</b>", "sortable stack", "ledger-table")
        + (
            table(
                headings,
                ours,
                "<b>Additional findings, which are not claims of the thesis</b>",
                "sortable stack",
                "findings-table",
            )
            if ours
            else ""
        )
    )


def claim_row(claim, figures):
    id_ = text(claim.get("id", ""))
    shown_in = [
        f'<a href="#figure-{text(f.id)}">{text(f.name)}</a>' for f in figures if f.is_about(claim)
    ]
    scenarios = [f"<code>{text(name)}</code>" for name in claim.get("scenarios") or ()]
    more = (
        f"<p><b>Rule</b> {typeset(claim.get('rule', ''))}</p>"
        + listed("Figures", shown_in)
        + listed("Scenarios", scenarios)
        + command(f"hapbench reproduce --only {claim.get('id', '')}")
    )
    return [
        cell(f'<a id="claim-{id_}" href="#claim-{id_}">{id_}</a>', classes="id"),
        cell(verdict_mark(claim["verdict"])),
        cell(
            f"{typeset(claim.get('claim', ''))}<p class=note>{text(claim.get('place', ''))}</p>"
            + folded("Rule, figures, scenarios", more, classes="printed"),
            classes="prose",
        ),
        cell(typeset(claim.get("published", ""))),
        cell(
            f"{typeset(claim.get('measured', ''))}<p class=note>{typeset(claim.get('why', ''))}</p>",
            classes="prose",
        ),
        cell(text(claim.get("robustness", ""))),
    ]
