"""The ledger: what the thesis claims, what it publishes, what we measure, and the verdict; with the summary of the page."""
from hapbench.errors import InputError
from hapbench.results import at, objects, read_object, shown

from .links import claim_link
from .markup import cell, command, filters, folded, heading_cell, listed, table, text, typeset

# Verdict -> (mark, tone). The mark tells verdicts apart without colour.
VERDICTS = {
    "reproduced": ("✓", "good"),
    "reproduced in kind": ("≈", "fair"),
    "not reproduced": ("✗", "bad"),
    "refuted": ("⊘", "bad"),
    "not reproducible": ("–", "none"),
    # Of findings of ours.
    "holds": ("✓", "good"),
    "does not hold": ("✗", "bad"),
}


# In this order: what is contradicted comes first.
ORDER = ("refuted", "not reproduced", "reproduced in kind", "reproduced", "not reproducible", "does not hold", "holds")
SURENESS = ("steady", "fragile", "not sampled")


class Claims(list):
    """The ledger's claims; `headline` says how many have which verdict, and how many verdicts are steady."""

    headline = ""


def load_claims(file):
    ledger = read_object(file)
    claims = Claims(objects(ledger, "claims", file))
    claims.headline = str(ledger.get("headline") or "")
    for i, claim in enumerate(claims):
        verdict = claim.get("verdict")
        if verdict not in VERDICTS:
            raise InputError(f"{file}: /claims/{i}/verdict: got {shown(verdict)}; allowed: {listed_words(VERDICTS)}")
        if claim.get("sureness") not in SURENESS:
            raise InputError(f"{file}: /claims/{i}/sureness: got {shown(claim.get('sureness'))}; allowed: {listed_words(SURENESS)}")
    return claims


def listed_words(words):
    return ", ".join(f'"{word}"' for word in words)


def of_thesis(claims):
    """Those of the thesis, the contradicted ones first."""
    return sorted((claim for claim in claims if not claim.get("ours")), key=lambda claim: ORDER.index(claim["verdict"]))


def verdict_counts(claims):
    """How many claims of the thesis have which verdict."""
    return {verdict: sum(claim["verdict"] == verdict for claim in of_thesis(claims)) for verdict in VERDICTS}


def verdict_mark(verdict):
    mark, tone = VERDICTS[verdict]
    return f'<span class="verdict {tone}">{mark} {text(verdict)}</span>'


def summary_section(runs, claims, figures):
    met = sum(run.expected for run in runs)
    tiles = [(len(runs), "run" if len(runs) == 1 else "runs"), (f"{met}/{len(runs)}", "ended as their scenario expects")]
    tiles += [(str(count), verdict_mark(verdict)) for verdict, count in verdict_counts(claims).items() if count]
    if figures:
        tiles.append((len(figures), '<a href="#figures">figures</a>'))
    items = "".join(f"<li><b>{text(value)}</b><span>{label}</span></li>" for value, label in tiles)
    commits = ", ".join(sorted({str(at(run.summary, "/provenance/commit") or "unknown") for run in runs}))
    return (
        "<h1>hapbench: haptic rendering of object-to-object contact</h1>"
        '<p class="lead">Scripted tool trajectories go through pluggable force algorithms; trajectories, stiffness ratios, '
        "stability limits and the cost of a step come out. Everything here is compared with T. C. Lee, <cite>Rendering "
        "6-DOF Object-to-Object Interaction with 3-DOF Haptic Interfaces</cite> (“the thesis”); numbers such as Fig. A.2 or "
        f"3.3 are its figures and sections. Program of commit <code>{text(commits)}</code>.</p>"
        f'<ul class="cards">{items}</ul>{main_results(claims)}{headline(claims)}{warnings(runs)}{refusals(claims)}')


def main_results(claims):
    """The results that a reader should have seen, with the command of each."""
    rows = [[cell(f"{claim_link(claim)} {typeset(claim['main']['claim'])}", classes="prose"), cell(text(claim["place"])),
             cell(typeset(claim["main"]["published"])), cell(typeset(claim["main"]["ours"])), cell(verdict_mark(claim["verdict"])),
             cell(f"<code>{text(claim['command'])}</code>"), cell(text("< 1" if claim["seconds"] < 1 else f"{claim['seconds']:.0f}"))]
            for claim in claims if claim.get("main")]
    headings = [heading_cell(title) for title in ("Claim", "Place", "Published", "Ours", "Verdict", "Command", "Seconds")]
    return table(headings, rows, "<b>Main results</b>", "stack", "main-results") if rows else ""


def headline(claims):
    said = getattr(claims, "headline", "")
    return f"<p>{typeset(said)}</p>" if said else ""


def warnings(runs):
    """The runs that ended otherwise than expected, by name: they must not hide in a long table."""
    missed = [f'<a href="#{run.anchor}">{text(run.path)}</a> ({text(run.outcome)})' for run in runs if not run.expected]
    return f'<p><b class="bad">✗ Not as expected:</b> {", ".join(missed)}.</p>' if missed else ""


def refusals(claims):
    """The claims of the thesis that are not confirmed. They belong into the summary."""
    items = "".join(f"<li>{verdict_mark(c['verdict'])} {claim_link(c)} ({text(c.get('place', ''))}): "
                    f"{typeset(c.get('claim', ''))}</li>" for c in of_thesis(claims) if VERDICTS[c["verdict"]][1] == "bad")
    return f"<p>What these runs do not confirm:</p><ul>{items}</ul>" if items else ""


def ledger_section(claims, links):
    if not claims:
        return '<p class="note">No ledger was given (<code>--claims</code>).</p>'
    rows = [claim_row(claim, links) for claim in of_thesis(claims)]
    ours = [claim_row(claim, links) for claim in claims if claim.get("ours")]
    headings = [heading_cell(title) for title in ("Id", "Verdict", "Claim", "Published", "Measured", "Sureness")]
    return (headline(claims) + "<p>Each claim of the thesis, what it publishes, what the runs below give, and a verdict by a rule, which unfolds "
            "with the figures and runs behind it. "
            "Hands are calibrated to mean and standard deviation of the raw colliding points; all else is a prediction. "
            "Steady: more than half of the samples spread over the plausible ranges of everything the thesis leaves open "
            '(<code>results/reference/choices.md</code>) have the verdict; else fragile, or not sampled.</p>'
            + filters("ledger-table", [("Verdict", 1)])
            + table(headings, rows, "<b>The ledger</b>", "sortable stack", "ledger-table")
            + (table(headings, ours, "<b>Found on the way, and no claims of the thesis</b>", "sortable stack", "findings-table")
               if ours else ""))


def claim_row(claim, links):
    id_ = text(claim.get("id", ""))
    figures, runs = links.of_claim(claim)
    more = (f"<p><b>Rule</b> {typeset(claim.get('rule', ''))}</p>" + listed("Figures", figures) + listed("Runs", runs)
            + command(f"hapbench reproduce --only {claim.get('id', '')}"))
    return [cell(f'<a id="claim-{id_}" href="#claim-{id_}">{id_}</a>', classes="id"), cell(verdict_mark(claim["verdict"])),
            cell(f"{typeset(claim.get('claim', ''))}<p class=note>{links.place(str(claim.get('place', '')))}</p>"
                 + folded("Rule, figures, runs", more, classes="printed"), classes="prose"),
            cell(typeset(claim.get("published", ""))),
            cell(f"{typeset(claim.get('measured', ''))}<p class=note>{typeset(claim.get('why', ''))}</p>", classes="prose"),
            cell(text(sureness(claim)))]


def sureness(claim):
    """The word, and in how many samples."""
    counts = claim.get("robustness")
    return claim["sureness"] + (f": {counts['holds']} of {counts['judged']}" if counts else "")
