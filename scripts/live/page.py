"""Assembles the live page from a compiled engine: page.py ENGINE.wasm OUT.html. scripts/live/make runs this file."""
import base64
import gzip
import json
import sys
from pathlib import Path

from hapbench.results import objects_in
from hapbench_report.markup import ASSETS, fill

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "scripts" / "live" / "page"
SCENARIOS = ROOT / "scenarios" / "library"
REPLAY = (
    "replay_camera.js",
    "replay_scene.js",
    "replay_tool.js",
    "replay_field.js",
    "replay_tracks.js",
)


def packed_files(scenes):
    """Returns the bundled scenarios, and the files that the scenarios of the page name, by their path in the page."""
    bundled = {
        file.stem: file
        for file in sorted(SCENARIOS.glob("*/*.json"))
        if file.parent.name not in ("studies", "presets")
    }  # scenario files by name
    url_of = lambda file: f"/scenarios/{file.relative_to(SCENARIOS).as_posix()}"
    files = {url_of(file): file.read_text(encoding="utf-8") for file in bundled.values()}
    for scene in scenes:
        name = scene["scenario"]
        while name:
            scenario = json.loads(bundled[name].read_text(encoding="utf-8"))
            for file in (
                bundled[name].parent / part["file"]
                for part in objects_in(scenario)
                if isinstance(part.get("file"), str)
            ):
                files[url_of(file)] = file.read_text(encoding="utf-8")
            name = Path(scenario["extends"]).stem if "extends" in scenario else None
    return files


def values_of(schema, name):
    """Yields the schema of each property of this name, at any depth of the scenario schema."""
    return (
        part["properties"][name]
        for part in objects_in(schema)
        if name in part.get("properties", {})
    )


def first_value(schema, name, key):
    return next(value for value in values_of(schema, name) if key in value)[key]


def choices(schema):
    """Returns the choices of the page's menus: laws and force stages by their names in the schema, and devices."""
    stages = [
        kind["const"] for kind in values_of(first_value(schema, "force_stage", "anyOf"), "type")
    ]
    return {
        "laws": first_value(schema, "algorithm", "enum"),
        "devices": [
            {"title": "as in the scene", "set": []},
            {"title": "ideal", "set": ['device={"type":"ideal"}']},
            {"title": "the trainer's (admittance)", "set": ['device={"type":"admittance"}']},
            *(
                {
                    "title": f"{preset} (impedance)",
                    "set": [f'device={{"type":"impedance","preset":"{preset}"}}'],
                }
                for preset in first_value(schema, "preset", "enum")
            ),
        ],
        "stages": [
            {"title": "none", "set": []},
            {"title": "angular damping", "set": ["rendering.angular_damping=true"]},
            {"title": "passivity controller", "set": ["rendering.passivity_controller=true"]},
            *(
                {
                    "title": stage.replace("_", " "),
                    "set": [f'rendering.force_stage={{"type":"{stage}"}}'],
                }
                for stage in stages
            ),
        ],
    }


def pressed(content):
    """Returns the content (bytes) compressed and encoded as text. The same content always gives the same text."""
    return base64.b64encode(gzip.compress(content, mtime=0)).decode()


def page(engine):
    scenes = json.loads((PAGE / "scenes.json").read_text(encoding="utf-8"))
    schema = json.loads((SCENARIOS / "scenario.schema.json").read_text(encoding="utf-8"))
    read = lambda folder, *names: "\n".join(
        (folder / name).read_text(encoding="utf-8") for name in names
    )
    data = {
        "engine": pressed(engine),
        "files": pressed(json.dumps(packed_files(scenes)).encode()),
        "scenes": scenes,
        **choices(schema),
    }
    return fill(
        PAGE / "live.html",
        {
            "style": read(ASSETS, "style.css", "replay.css") + read(PAGE, "live.css"),
            "sides": "\n".join(fill(PAGE / "side.html", {"which": str(i)}) for i in (1, 2)),
            "data": json.dumps(data).replace("</", "<\\/"),
            "worker": '"use strict";\n' + read(PAGE, "engine.js", "worker.js"),
            "script": "\n".join(
                (
                    read(ASSETS, "theme.js", *REPLAY),
                    read(
                        PAGE,
                        "engine.js",
                        "live_sound.js",
                        "live_view.js",
                        "live_hands.js",
                        "live.js",
                    ),
                )
            ),
        },
    )


engine, out = map(Path, sys.argv[1:])
text = page(engine.read_bytes())
out.parent.mkdir(parents=True, exist_ok=True)
out.write_text(text, encoding="utf-8")
print(f"{out} ({len(text) / 1e6:.1f} MB)")
