"""The HTML page of a report: sections with inlined style and scripts. A link leads to the live page, on which the
reader moves the tool of a scene."""
import json
import os
from pathlib import Path
from urllib.parse import quote

from hapbench.columns import read_bytes
from hapbench.results import at, objects_in

from .figures import figures_section
from .ledger import ledger_section, summary_section
from .markup import ASSETS, command, fill, text
from .replay import player, replays
from .runs import provenance_of, provenance_section

STYLES = ("style.css", "replay.css")
SCRIPTS = (
    "theme.js",
    "tables.js",
    "page.js",
    "replay_data.js",
    "replay_camera.js",
    "replay_scene.js",
    "replay_tool.js",
    "replay_field.js",
    "replay_tracks.js",
    "replay_sound.js",
    "replay_export.js",
    "replay_player.js",
    "replay_controls.js",
)
# File name of the live page; a copy is placed in the folder of every page that links to it.
LIVE = "live.html"
BUILT = Path(__file__).resolve().parents[3] / "build" / "live" / LIVE  # output of scripts/live/make
NO_REPLAY = '<p class="note">No recorded runs were given (<code>--program</code>).</p>'


def thesis_page(runs, ledger, figures, replayed):
    """Returns the HTML of the report on the thesis. `ledger`: the result of load_claims(). The HTML depends only on the
    arguments."""
    claims, headline, abstract = ledger
    replay = (
        player(replays(replayed, [run.algorithm.replace("_", " ") for run in replayed]))
        if replayed
        else NO_REPLAY
    )
    return whole_page(
        (
            (
                "summary",
                "Summary",
                "Summary",
                summary_section(runs, claims, headline, abstract, figures),
            ),
            ("ledger", "Ledger", "Ledger", ledger_section(claims, figures)),
            ("replay", "Replay", "Replay", replay),
            ("figures", "Figures", "Figures", figures_section(figures, claims)),
            ("rerun", "Rerun", "Run it again", rerun_section()),
            ("provenance", "Provenance", "Provenance", provenance_section(provenance_of(runs))),
        )
    )


def whole_page(sections, title="hapbench report", further_style=""):
    """Returns the HTML of the page. Each section has a key, a short title for the navigation, a title and its HTML."""
    return fill(
        ASSETS / "page.html",
        {
            "style": "\n".join((ASSETS / name).read_text(encoding="utf-8") for name in STYLES)
            + further_style,
            "title": text(title),
            "navigation": "".join(
                f'<a href="#{key}">{text(title)}</a>' for key, title, _, _ in sections
            ),
            "sections": "\n".join(section(*entry) for entry in sections),
            "script": "\n".join((ASSETS / name).read_text(encoding="utf-8") for name in SCRIPTS),
        },
    )


def section(key, _, title, body):
    # The first heading of the page is also the heading of the summary.
    heading = "" if key == "summary" else f"<h2>{text(title)}</h2>"
    return f'<section id="{key}" aria-label="{text(title)}">{heading}{body}</section>'


def rerun_section():
    return (
        "<p>In the root of the repository, this command writes all results:</p>"
        + command("scripts/reproduce")
        + "<p>These commands write a part of the results:</p>"
        + command(
            "hapbench=build/release/bin/hapbench\n"
            "$hapbench run scenarios/library/thesis/*.json --out results/out/reproduce/thesis"
            "       # the thesis's scenes\n"
            "$hapbench limit stability_z_width --out results/out/reproduce/stability_z_width"
            "  # a study; all: $hapbench describe studies\n"
            "$hapbench describe scenario                                                    # what every field means"
        )
        + "<p>This command writes this report:</p>"
        + command(
            "scripts/report results/out/reproduce --figures results/out/figures --claims "
            "results/reference/claims.json \\\n"
            "  --out results/out/reproduce/report.html"
        )
    )


def live_page():
    """Returns the file of the live page, or None if the file does not exist. HAPBENCH_LIVE names another file; an empty
    HAPBENCH_LIVE disables the live page."""
    named = os.environ.get("HAPBENCH_LIVE")
    page = BUILT if named is None else Path(named)
    return page if page.is_file() else None


def live_link(scenario):
    """Returns a sentence with a link that opens the scenario in the live page. Returns an empty text if there is no
    live page, if the scenario prescribes the position of the tool, or if the scenario names a file.
    """
    position = at(scenario, "/motion/position")
    is_free = position is None or at(scenario, "/motion/position/type") == "free"
    names_a_file = any(isinstance(part.get("file"), str) for part in objects_in(scenario))
    if live_page() is None or not scenario or not is_free or names_a_file:
        return ""
    led = {
        key: value
        for key, value in scenario.items()
        if key not in ("$schema", "record", "expect", "description", "reference_force")
    }
    scene = quote(json.dumps(led, separators=(",", ":"), ensure_ascii=False))
    return f'<p><a href="{LIVE}#scenario={scene}">Touch this scene in the live page</a></p>'


def live_page_in(folder):
    """Returns a dict from the live page's file in `folder` to its content, for write_all(): the folder holds pages that
    link to the live page. The dict is empty if the live page does not exist, or is in this folder already.
    """
    page, copy = live_page(), folder / LIVE
    if not page or copy.exists() and copy.samefile(page):
        return {}
    return {copy: read_bytes(page)}
