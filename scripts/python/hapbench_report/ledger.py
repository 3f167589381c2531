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


class Claims(list):
    """The ledger's claims; `headline` says how many verdicts another reading would leave as they are."""

    headline = ""


def load_claims(file):
    ledger = read_object(file)
    claims = Claims(objects(ledger, "claims", file))
    claims.headline = str(ledger.get("headline") or "")
    for i, claim in enumerate(claims):
        verdict = claim.get("verdict")
        if verdict not in VERDICTS:
            raise InputError(f"{file}: /claims/{i}/verdict: got {shown(verdict)}; allowed: {shown_verdicts()}")
        if claim.get("majority") not in (None, *VERDICTS):
            raise InputError(f"{file}: /claims/{i}/majority: got {shown(claim['majority'])}; allowed: {shown_verdicts()}")
    return claims


def shown_verdicts():
    return ", ".join(f'"{verdict}"' for verdict in VERDICTS)


def of_thesis(claims):
    return [claim for claim in claims if not claim.get("ours")]


def verdict_counts(claims, key="verdict"):
    """How many claims of the thesis have which verdict: on record, or in most samples, where there are any."""
    return {verdict: sum((claim.get(key) or claim["verdict"]) == verdict for claim in of_thesis(claims)) for verdict in VERDICTS}


def verdict_mark(verdict):
    mark, tone = VERDICTS[verdict]
    return f'<span class="verdict {tone}">{mark} {text(verdict)}</span>'


def verdict_marks(claim):
    """The recorded verdict; in front of it that of most samples, if it is another one."""
    recorded, majority = claim["verdict"], claim.get("majority")
    if majority in (None, recorded):
        return verdict_mark(recorded)
    return f"{verdict_mark(majority)} in most samples<br>{verdict_mark(recorded)} recorded"


def summary_section(runs, claims, figures):
    met = sum(run.expected for run in runs)
    tiles = [(len(runs), "run" if len(runs) == 1 else "runs"), (f"{met}/{len(runs)}", "ended as their scenario expects")]
    recorded, majority = verdict_counts(claims), verdict_counts(claims, "majority")
    tiles += [(str(count) if count == majority[verdict] else f"{count} | {majority[verdict]}",
               verdict_mark(verdict) + (" (recorded | in most samples)" if count != majority[verdict] else ""))
              for verdict, count in recorded.items() if count or majority[verdict]]
    if figures:
        tiles.append((len(figures), '<a href="#figures">figures</a>'))
    items = "".join(f"<li><b>{text(value)}</b><span>{label}</span></li>" for value, label in tiles)
    headline = getattr(claims, "headline", "")
    commits = ", ".join(sorted({str(at(run.summary, "/provenance/commit") or "unknown") for run in runs}))
    return (
        "<h1>hapbench: haptic rendering of object-to-object contact</h1>"
        '<p class="lead">Scripted tool trajectories go through pluggable force algorithms; trajectories, stiffness ratios, '
        "stability limits and the cost of a step come out. Everything here is compared with T. C. Lee, <cite>Rendering "
        "6-DOF Object-to-Object Interaction with 3-DOF Haptic Interfaces</cite> (“the thesis”); numbers such as Fig. A.2 or "
        f"3.3 are its figures and sections. Program of commit <code>{text(commits)}</code>.</p>"
        f'<ul class="cards">{items}</ul>{headline and f"<p>{typeset(headline)}</p>"}{warnings(runs)}{refusals(claims)}')


def warnings(runs):
    """The runs that ended otherwise than expected, by name: they must not hide in a long table."""
    missed = [f'<a href="#{run.anchor}">{text(run.path)}</a> ({text(run.outcome)})' for run in runs if not run.expected]
    return f'<p><b class="bad">✗ Not as expected:</b> {", ".join(missed)}.</p>' if missed else ""


def refusals(claims):
    """The claims of the thesis that are not confirmed. They belong into the summary."""
    items = "".join(f"<li>{verdict_marks(c)} {claim_link(c)} ({text(c.get('place', ''))}): "
                    f"{typeset(c.get('claim', ''))}</li>" for c in of_thesis(claims) if VERDICTS[c["verdict"]][1] == "bad")
    return f"<p>What these runs do not confirm:</p><ul>{items}</ul>" if items else ""


def ledger_section(claims, links):
    if not claims:
        return '<p class="note">No ledger was given (<code>--claims</code>).</p>'
    rows = [claim_row(claim, links) for claim in of_thesis(claims)]
    ours = [claim_row(claim, links) for claim in claims if claim.get("ours")]
    headings = [heading_cell(title) for title in ("Id", "Verdict", "Claim", "Published", "Measured", "Robustness")]
    return ("<p>Each claim of the thesis, what it publishes, what the runs below give, and a verdict by a rule, which unfolds "
            "with the figures and runs behind it. "
            "Hands are calibrated to mean and standard deviation of the raw colliding points; all else is a prediction. "
            "Robustness: how often the verdict is the same at points spread over the plausible ranges of everything the "
            'thesis leaves open (<code>results/reference/choices.md</code>), '
            "and the choice that decides it, if one does, "
            "with its first-order Sobol index S.</p>"
            + filters("ledger-table", [("Verdict", 1)])
            + table(headings, rows, "<b>The ledger</b>", "sortable stack", "ledger-table")
            + (table(headings, ours, "<b>Found on the way, and no claims of the thesis</b>", "sortable stack", "findings-table")
               if ours else ""))


def claim_row(claim, links):
    id_ = text(claim.get("id", ""))
    figures, runs = links.of_claim(claim)
    more = (f"<p><b>Rule</b> {typeset(claim.get('rule', ''))}</p>" + listed("Figures", figures) + listed("Runs", runs)
            + command(f"hapbench reproduce --only {claim.get('id', '')}"))
    return [cell(f'<a id="claim-{id_}" href="#claim-{id_}">{id_}</a>', classes="id"), cell(verdict_marks(claim)),
            cell(f"{typeset(claim.get('claim', ''))}<p class=note>{links.place(str(claim.get('place', '')))}</p>"
                 + folded("Rule, figures, runs", more, classes="printed"), classes="prose"),
            cell(typeset(claim.get("published", ""))),
            cell(f"{typeset(claim.get('measured', ''))}<p class=note>{typeset(claim.get('why', ''))}</p>", classes="prose"),
            cell(text(claim.get("sureness") or ""))]
