"""The page: its sections in order, with style and scripts inlined."""
from .credibility import credibility_section
from .figures import figures_section
from .ledger import choices_section, ledger_section, summary_section
from .links import Links
from .markup import ASSETS, command, fill, text
from .replay import replay_section
from .runs import parameters_section, provenance_of, provenance_section, runs_section
from .studies import studies_section, timing_section
from .thesis import index_section, limits_table, load_tables, parameter_tables, target_tables

STYLES = ("style.css", "replay.css")
SCRIPTS = ("theme.js", "tables.js", "page.js", "replay_data.js", "replay_camera.js", "replay_scene.js", "replay_tool.js", "replay_field.js",
           "replay_tracks.js", "replay_sound.js", "replay_export.js", "replay_player.js", "replay_controls.js")


def report(runs, studies, claims, choices, figures, scenes, credibility):
    """The HTML of the report. Depends on nothing but its arguments."""
    tables, provenance = load_tables(), provenance_of(runs)
    links = Links(runs, figures, claims, studies)
    sections = (
        ("summary", "Summary", "Summary", summary_section(runs, claims, figures, provenance)),
        ("ledger", "Ledger", "Ledger", ledger_section(claims, links)),
        ("credibility", "Credibility", "How far to believe a number", credibility_section(credibility)),
        ("choices", "Choices", "Choices on record", choices_section(choices)),
        ("replay", "Replay", "Replay", replay_section(scenes)),
        ("thesis", "Index", "Figures and tables of the thesis", index_section(figures, tables, links)),
        ("figures", "Figures", "Figures", figures_section(figures, links)),
        ("subjects", "Subjects", "Simulated subjects", target_tables(runs, tables)),
        ("tables", "Tables", "Parameters and limits of the thesis", parameter_tables(runs, tables) + limits_table(studies, tables)),
        ("runs", "Runs", "Runs", runs_section(runs)),
        ("studies", "Studies", "Tables of studies", studies_section(studies)),
        ("timing", "Timing", "Timing", timing_section(runs, studies)),
        ("rerun", "Rerun", "Run it again", rerun_section()),
        ("parameters", "Scenarios", "Scenario of every run", parameters_section(runs, links)),
        ("provenance", "Provenance", "Provenance", provenance_section(provenance)),
    )
    return whole_page(sections)


def whole_page(sections, title="hapbench report", further_style=""):
    """The page of sections, each a key, a short title for the navigation, a title and its HTML."""
    return fill(ASSETS / "page.html", {
        "style": "\n".join((ASSETS / name).read_text(encoding="utf-8") for name in STYLES) + further_style,
        "title": text(title),
        "navigation": "".join(f'<a href="#{key}">{text(title)}</a>' for key, title, _, _ in sections),
        "sections": "\n".join(section(*entry) for entry in sections),
        "script": "\n".join((ASSETS / name).read_text(encoding="utf-8") for name in SCRIPTS),
    })


def section(key, _, title, body):
    # The summary has the heading of the page.
    heading = "" if key == "summary" else f"<h2>{text(title)}</h2>"
    return f'<section id="{key}" aria-label="{text(title)}">{heading}{body}</section>'


def rerun_section():
    return ("<p>From the root of the repository. Everything, installing what is missing:</p>" + command("scripts/reproduce")
            + "<p>One part:</p>" + command(
                "hapbench=build/release/bin/hapbench\n"
                "$hapbench run scenarios/thesis/*.json --out results/out/reproduce/thesis       # the thesis's scenes\n"
                "$hapbench limit stability_z_width --out results/out/reproduce/stability_z_width  # a study; all: $hapbench describe studies\n"
                "$hapbench describe scenario                                                    # what every field means")
            + "<p>This report:</p>" + command(
                "scripts/report results/out/reproduce --figures results/out/figures --claims results/reference/claims.json \\\n"
                "  --out results/out/reproduce/report.html"))
