"""Runs commands that print tables, for the tests of the formats of --table."""
import json
import unittest
from functools import cache

from fixture import PROGRAM, must, scratch_folder

NASTY = r'50 % of {a_b} & #1 ~ $x^2$ \y |q| <z> "w" --n [s] é µ ≤ λ'
LAWS = "mean,least_squares,summation"  # some of these laws fail in the hole
PEG = "peg_in_hole_2d_shaped_stiffness"
SHORT = ("--set", "time.steps=300", "--set", "expect={}")


def make_scene():
    """Creates the scratch folder with a scene whose name has characters that every format must escape."""
    global ROOT
    ROOT = scratch_folder(unittest)
    scene = {"extends": "tap_wall", "name": NASTY, "time": {"steps": 300}, "expect": {}}
    (ROOT / "nasty.json").write_text(json.dumps(scene), encoding="utf-8")


# Command lines that print tables, with failures, missing values, errors and texts from files.
COMMANDS = {
    "run": ("run", "nasty.json", "tap_wall", *SHORT),
    "latency": ("run", "nasty.json", "--latency"),
    "compare": ("compare", "nasty.json", "--algorithms", LAWS),
    "seeds": (
        "compare",
        "tap_wall",
        PEG,
        *("--algorithms", LAWS, "--seeds", 2, "--jitter", 1e-6, "--set", "time.steps=300"),
    ),
    "errors": ("compare", "nasty.json", "--algorithms", "mean,proxy", "--errors", "--time"),
    "limit": ("limit", "spring_stiffness"),
    "devices": ("limit", "tap_wall", "--device", "touch,ideal", "--resolution", 0.1),
    "tune": ("tune", "tap_wall", "--algorithms", "mean"),
    "converge": ("converge", "nasty.json", "--levels", 3),
    "over": ("converge", "tap_wall", "--over", "integrator.type=all", "--levels", 3, *SHORT),
    "claims": ("describe", "claims"),
    "terms": ("describe", "terms"),
    "everything": ("describe", "--grep", "stiffness"),
}


@cache
def printed(name, form):
    return must(PROGRAM, *COMMANDS[name], "--table", form, cwd=ROOT, statuses=(0, 3))
