"""Summary and ledger."""
from .claims import VERDICTS, robustness_text, verdict_counts
from .markup import cell, heading_cell, table, text


def verdict_mark(verdict):
    mark, tone = VERDICTS[verdict]
    return f'<span class="verdict {tone}">{mark} {text(verdict)}</span>'


def summary_section(runs, claims, figures, provenance):
    met = sum(run.expected for run in runs)
    cards = [(len(runs), "runs"), (f"{met}/{len(runs)}", "ended as their scenario expects")]
    cards += [(count, verdict_mark(verdict)) for verdict, count in verdict_counts(claims).items() if count]
    if figures:
        cards.append((len(figures), "figures"))
    items = "".join(f"<li><b>{text(value)}</b><span>{label}</span></li>" for value, label in cards)
    commits = ", ".join(sorted({str(p.get("commit", "unknown")) for p, _ in provenance})) or "unknown"
    return (
        "<h1>hapbench: haptic rendering of object-to-object contact</h1>"
        '<p class="lead">Scripted tool trajectories go through pluggable force algorithms; trajectories, stiffness ratios, '
        "stability limits and the cost of a step come out. Everything here is compared with T. C. Lee, <cite>Rendering "
        "6-DOF Object-to-Object Interaction with 3-DOF Haptic Interfaces</cite> (“the thesis”); numbers such as Fig. A.2 or "
        f"3.3 are its figures and sections. Program of commit <code>{text(commits)}</code>.</p>"
        f'<ul class="cards">{items}</ul>{warnings(runs)}{refusals(claims)}')


def warnings(runs):
    """The runs that ended otherwise than expected, by name: they must not hide in a long table."""
    missed = [f'<a href="#{run.anchor}">{text(run.path)}</a> ({text(run.outcome)})' for run in runs if not run.expected]
    return f'<p><b class="bad">✗ Not as expected:</b> {", ".join(missed)}.</p>' if missed else ""


def refusals(claims):
    """What the bench does not confirm, in the summary rather than somewhere below."""
    items = "".join(f"<li>{verdict_mark(c['verdict'])} {text(c.get('id', ''))} ({text(c.get('place', ''))}): "
                    f"{text(c.get('claim', ''))}</li>" for c in claims if VERDICTS[c["verdict"]][1] == "bad")
    return f"<p>What these runs do not confirm:</p><ul>{items}</ul>" if items else ""


def ledger_section(claims):
    if not claims:
        return '<p class="note">No ledger was given (<code>--claims</code>).</p>'
    rows = [[cell(f'<span id="claim-{text(c.get("id", ""))}">{text(c.get("id", ""))}</span>'), cell(text(c.get("place", ""))),
             cell(text(c.get("claim", "")), classes="prose"), cell(text(c.get("published", ""))),
             cell(text(c.get("measured", "")), classes="ours"), cell(verdict_mark(c["verdict"])),
             cell(text(robustness_text(c)), classes="prose"), cell(text(c.get("rule", "")), classes="prose"), cell(text(c.get("why", "")), classes="prose")] for c in claims]
    headings = [heading_cell(t) for t in ("Id", "Place", "Claim", "Published", "Measured", "Verdict", "Robustness", "Rule",
                                           "Why")]
    return ("<p>Each claim of the thesis, what it publishes, what the runs below give, and a verdict by the rule beside it. "
            "Hands are calibrated to mean and standard deviation of the raw colliding points; all else is a prediction. "
            "Robustness: how often the verdict is the same at points spread over the plausible ranges of everything the "
            'thesis leaves open (<a href="#choices">choices on record</a>), and the choice that decides it, if one does.</p>'
            + filters("ledger-table", [("Verdict", 5)])
            + table(headings, rows, "<b>The ledger</b>", "sortable", "ledger-table"))


def choices_section(choices):
    if not choices:
        return '<p class="note">None were given (<code>--choices</code>).</p>'
    rows = [[cell(text(c.get("id", ""))), cell(text(c.get("what", "")), classes="prose"),
             cell(text(c.get("thesis", "")), classes="prose"), cell(text(f"{c.get('value', '')} {c.get('unit', '')}".strip())),
             cell(text(plausible(c))), cell(text(c.get("chosen", ""))), cell(text(c.get("why", "")), classes="prose")]
            for c in choices]
    headings = [heading_cell(t) for t in ("Choice", "Of what", "The thesis", "Value", "Plausible", "Results seen", "Why")]
    return ("<p>Everything the thesis leaves open and a scenario had to choose. A value without a unit that stands beside a "
            "range around 1 multiplies what the scenarios have. “after” means that results had been seen when it was "
            "chosen.</p>" + table(headings, rows, "<b>Choices on record</b>", "sortable", "choices-table"))


def plausible(choice):
    """The values a choice could as well have had, as text."""
    options, range_ = choice.get("options"), choice.get("range")
    if isinstance(options, list):
        return ", ".join(map(str, options))
    return " to ".join(map(str, range_ if isinstance(range_, list) else [])) + (", log" if choice.get("scale") == "log" else "")


def filters(table_id, menus):
    """Controls of a filtered table: a text and menus over columns."""
    options = "".join(f'<label>{text(title)} <select data-column="{column}"><option value="">all</option></select></label>'
                      for title, column in menus)
    return (f'<div class="bar" data-filters="{table_id}"><label>Filter <input type="search" placeholder="words"></label>'
            f"{options}<output></output></div>")
