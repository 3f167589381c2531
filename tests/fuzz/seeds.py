"""Writes the seed inputs of a libFuzzer target: seeds.py TARGET FOLDER. Seeds are files in the folders scenarios and
tests/data."""
import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LARGEST = 20_000  # largest size of a seed [bytes]; scripts/fuzz does not generate larger inputs
PATTERNS = {"scenario": "*.json", "run": "*.json", "device": "*.json", "module": "module"}


def without_prose(target, text):
    """Returns a scene as JSON without blanks and descriptions, because mutations of blanks and descriptions find no
    errors. For the target "device", returns only the device of the scene. Returns None if `text` is no scene.
    """
    scene = json.loads(text)
    if not isinstance(scene, dict) or not {"environment", "extends"} & scene.keys():
        return None
    scene = (
        scene.get("device")
        if target == "device"
        else {key: value for key, value in scene.items() if key not in ("description", "source")}
    )
    return json.dumps(scene, separators=(",", ":")).encode() if isinstance(scene, dict) else None


def tables(text):
    """Yields variants of the first rows of a table, in other notations that the readers accept."""
    lines = text.splitlines()[:5]
    rows = b"\n".join(lines) + b"\n"
    semicolons = rows.replace(b",", b";")
    yield semicolons
    yield semicolons.replace(b".", b",") if b"." in rows else rows.replace(b",", b"\t")
    yield b"\xef\xbb\xbf% comment\r\n# " + rows.replace(b"\n", b"\r\n")
    yield rows.replace(b",", b" ").replace(b"\n", b"\r")
    yield b"\n".join(b'"' + line.replace(b",", b'","') + b'",' for line in lines)
    yield b"\n".join(b",".join([b"other", *reversed(line.split(b","))]) for line in lines)


def main(target, folder):
    pattern = PATTERNS.get(target, f"*.{target.rsplit('_', 1)[1]}" if "_" in target else "*.csv")
    seeds = {
        file.read_bytes()
        for folder in ("scenarios", "tests/data")
        for file in (ROOT / folder).rglob(pattern)
        if file.is_file()
    }
    if pattern == "*.csv":
        seeds |= {variant for text in seeds for variant in tables(text)}
    if pattern == "*.json":
        seeds = {without_prose(target, text) for text in seeds} - {None}
    for number, seed in enumerate(sorted(s for s in seeds if len(s) <= LARGEST)):
        (Path(folder) / f"{number:03}").write_bytes(seed)


main(*sys.argv[1:])
