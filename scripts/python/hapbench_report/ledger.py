"""The ledger: what the thesis claims, what it publishes, what we measure, and the verdict; with the
summary of the page."""
from collections import Counter

from hapbench.errors import InputError
from hapbench.results import at, objects, read_object, shown

from .figures import claim_link
from .markup import cell, command, folded, heading_cell, listed, table, text, typeset

# Verdict -> (mark, tone), what is contradicted first; the last two are of findings of ours. The
# mark tells verdicts apart without colour.
VERDICTS = {
    "refuted": ("⊘", "bad"),
    "not reproduced": ("✗", "bad"),
    "reproduced in kind": ("≈", "fair"),
    "reproduced": ("✓", "good"),
    "not reproducible": ("–", "none"),
    "does not hold": ("✗", "bad"),
    "holds": ("✓", "good"),
}
FILTER = (
    '<div class="bar" data-filters="ledger-table"><label>Filter <input type="search" placeholder="words"></label>'
    '<label>Verdict <select data-column="1"><option value="">all</option></select></label><output></output></div>'
)
SURENESS = ("steady", "fragile", "not sampled")


def load_claims(file):
    """The ledger's claims, and its sentence on how many have which verdict and how many verdicts are steady."""
    ledger = read_object(file)
    claims = objects(ledger, "claims", file)
    for i, claim in enumerate(claims):
        for key, allowed in (("verdict", VERDICTS), ("sureness", SURENESS)):
            if claim.get(key) not in allowed:
                words = ", ".join(f'"{word}"' for word in allowed)
                raise InputError(
                    f"{file}: /claims/{i}/{key}: got {shown(claim.get(key))}; allowed: {words}"
                )
    return claims, str(ledger.get("headline") or "")


def of_thesis(claims):
    """Those of the thesis, the contradicted ones first."""
    order = list(VERDICTS)
    return sorted(
        (claim for claim in claims if not claim.get("ours")),
        key=lambda claim: order.index(claim["verdict"]),
    )


def verdict_mark(verdict):
    mark, tone = VERDICTS[verdict]
    return f'<span class="verdict {tone}">{mark} {text(verdict)}</span>'


def summary_section(runs, claims, headline, figures):
    met = sum(run.expected for run in runs)
    tiles = [
        (len(runs), "run" if len(runs) == 1 else "runs"),
        (f"{met}/{len(runs)}", "ended as their scenario expects"),
    ]
    counts = Counter(claim["verdict"] for claim in of_thesis(claims))
    tiles += [(str(count), verdict_mark(verdict)) for verdict, count in counts.items()]
    if figures:
        tiles.append((len(figures), '<a href="#figures">figures</a>'))
    items = "".join(f"<li><b>{text(value)}</b><span>{label}</span></li>" for value, label in tiles)
    commits = ", ".join(
        sorted({str(at(run.summary, "/provenance/commit") or "unknown") for run in runs})
    )
    return (
        "<h1>hapbench: haptic rendering of object-to-object contact</h1>"
        '<p class="lead">Scripted tool trajectories go through pluggable force algorithms; '
        "trajectories, stiffness ratios, "
        "stability limits and the cost of a step come out. Everything here is compared with T. C. Lee, <cite>Rendering "
        "6-DOF Object-to-Object Interaction with 3-DOF Haptic Interfaces</cite> (“the thesis”); "
        "numbers such as Fig. A.2 or "
        f"3.3 are its figures and sections. Program of commit <code>{text(commits)}</code>.</p>"
        f'<ul class="cards">{items}</ul>{main_results(claims)}<p>{typeset(headline)}</p>'
        f"{warnings(runs)}{refusals(claims)}"
    )


def main_results(claims):
    """The results that a reader should have seen, with the command of each."""
    rows = [
        [
            cell(f"{claim_link(claim)} {typeset(claim['main']['claim'])}", classes="prose"),
            cell(text(claim["place"])),
            cell(typeset(claim["main"]["published"])),
            cell(typeset(claim["main"]["ours"])),
            cell(verdict_mark(claim["verdict"])),
            cell(text(sureness(claim))),
            cell(f"<code>{text(claim['command'])}</code>"),
            cell(text("< 1" if claim["seconds"] < 1 else f"{claim['seconds']:.0f}")),
        ]
        for claim in claims
        if claim.get("main")
    ]
    headings = [
        heading_cell(title)
        for title in (
            "Claim",
            "Place",
            "Published",
            "Ours",
            "Verdict",
            "Sureness",
            "Command",
            "Seconds",
        )
    ]
    return table(headings, rows, "<b>Main results</b>", "stack", "main-results") if rows else ""


def warnings(runs):
    """The runs that ended otherwise than expected, by name: they must not hide in a long table."""
    missed = [f"{text(run.path)} ({text(run.outcome)})" for run in runs if not run.expected]
    return f'<p><b class="bad">✗ Not as expected:</b> {", ".join(missed)}.</p>' if missed else ""


def refusals(claims):
    """The claims of the thesis that are not confirmed. They belong into the summary."""
    items = "".join(
        f"<li>{verdict_mark(c['verdict'])} {claim_link(c)} ({text(c.get('place', ''))}): "
        f"{typeset(c.get('claim', ''))}</li>"
        for c in of_thesis(claims)
        if VERDICTS[c["verdict"]][1] == "bad"
    )
    return f"<p>What these runs do not confirm:</p><ul>{items}</ul>" if items else ""


def ledger_section(claims, figures):
    if not claims:
        return '<p class="note">No ledger was given (<code>--claims</code>).</p>'
    rows = [claim_row(claim, figures) for claim in of_thesis(claims)]
    ours = [claim_row(claim, figures) for claim in claims if claim.get("ours")]
    headings = [
        heading_cell(title)
        for title in ("Id", "Verdict", "Claim", "Published", "Measured", "Sureness")
    ]
    return (
        "<p>Each claim of the thesis, what it publishes, what our runs give, and a verdict by a rule, which unfolds "
        "with the figures and scenarios behind it. "
        "Hands are calibrated to mean and standard deviation of the raw colliding points; all else is a prediction. "
        "Steady: more than half of the samples spread over the plausible ranges of everything the thesis leaves open "
        "(<code>results/reference/choices.json</code>) have the verdict; else fragile, or not sampled.</p>"
        + FILTER
        + table(headings, rows, "<b>The ledger</b>", "sortable stack", "ledger-table")
        + (
            table(
                headings,
                ours,
                "<b>Found on the way, and no claims of the thesis</b>",
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
        cell(text(sureness(claim))),
    ]


def sureness(claim):
    """The word, and in how many samples."""
    counts = claim.get("robustness")
    return claim["sureness"] + (f": {counts['holds']} of {counts['judged']}" if counts else "")
