"""The interactive replay: its markup and its data."""
from pathlib import Path

from .markup import command, embedded_json, text
from .replay_record import SCENES, rerun_commands
from .template import fill

ASSETS = Path(__file__).parent / "assets"


def replay_section(scenes):
    if not scenes:
        return '<p class="note">No recorded runs were given (<code>--program</code> or <code>--replay</code>).</p>'
    shown = {scene["id"] for scene in scenes}
    commands = "".join(f"<p>{text(scene.title)}:</p>" + command("\n".join(rerun_commands(scene)))
                       for scene in SCENES if scene.id in shown)
    return (f"<p>Recorded runs, several algorithms on one clock.</p>{player(scenes)}"
            f"<details><summary>How these were recorded</summary>{commands}</details>")


def player(scenes):
    """The replay's markup and data. A page holds one."""
    sides = "".join(fill(ASSETS / "replay_side.html", {"which": which}) for which in "ABCD")
    return (fill(ASSETS / "replay.html", {"sides": sides})
            + f'<script type="application/json" id="replay-data">{embedded_json(scenes)}</script>')
