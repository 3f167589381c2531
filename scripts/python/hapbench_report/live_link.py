"""Links from a run to the live page, where its scene is under the reader's own hand."""
import json
import os
import shutil
from pathlib import Path
from urllib.parse import quote

from hapbench.results import at

# Where scripts/live/make puts it; a copy goes beside every page that links to it.
BUILT = Path(__file__).resolve().parents[3] / "build" / "live" / "live.html"
NAME = "live.html"


def live_page():
    """The built page, or None. HAPBENCH_LIVE names another, or, empty, none."""
    named = os.environ.get("HAPBENCH_LIVE")
    page = BUILT if named is None else Path(named)
    return page if page.is_file() else None


def names_a_file(value):
    parts = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return isinstance(value, dict) and isinstance(value.get("file"), str) or any(map(names_a_file, parts))


def live_link(scenario):
    """A sentence with the link; nothing where there is no live page or a pointer cannot lead the scene's tool."""
    position = at(scenario, "/motion/position")
    is_free = position is None or at(scenario, "/motion/position/type") == "free"
    if live_page() is None or not scenario or not is_free or names_a_file(scenario):
        return ""
    led = {key: value for key, value in scenario.items() if key not in ("$schema", "record", "expect", "description", "reference_force")}
    text = quote(json.dumps(led, separators=(",", ":"), ensure_ascii=False))
    return f'<p><a href="{NAME}#scenario={text}">Take this scene in hand</a></p>'


def place_live_page(folder):
    """Puts the live page beside the pages in the folder that link to it."""
    page = live_page()
    if page and page != folder / NAME:
        shutil.copyfile(page, folder / NAME)
