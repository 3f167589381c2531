"""Runs the blocks of code of every tutorial in order, in a folder with the contents of a clone. Every number in a
sentence of the tutorial must occur in a block or in its output. Arguments: the program, the folder of the built Python
package."""
import json
import re
import sys
import unittest
from concurrent.futures import ThreadPoolExecutor

from fixture import ENVIRONMENT, PROGRAM, SOURCE, must, scratch_folder

TUTORIALS = [
    file
    for file in sorted((SOURCE / "scenarios" / "library" / "tutorials").glob("*.md"))
    if file.name != "README.md"
]
CODE = re.compile(r"^```(bash|python)\n(.*?)^```\n", re.M | re.S)
CHECKS = re.compile(r"^<!-- checked by .*?^-->\n", re.M | re.S)
# Matches a number in a sentence, but not a part of a name, such as C5 or 2-D.
NUMBER = re.compile(r"(?<![\w.^-])\d+(?:\.\d+)?(?:e-?\d+)?(?![\w-]|\.\d)")
# One interpreter runs all Python blocks of a tutorial; each shell block runs in its own shell, in the same order.
PLAYER = """
import json, subprocess, sys
names = {"__name__": "__main__"}
for number, (language, code) in enumerate(json.loads(sys.argv[1]), 1):
    sys.stdout.flush()
    if language == "bash":
        subprocess.run(["bash", "-e", "-o", "pipefail", "-c", code], check=True, stdin=subprocess.DEVNULL)
    else:
        exec(compile(code, f"block {number}", "exec"), names)
"""


def played(text, folder):
    """Runs the blocks of code in a text and returns their output. Stops at the first block that fails, with its error
    message."""
    clone = folder / "hapbench"
    clone.mkdir()
    for name in (
        "algorithms",
        "device_model",
        "scenarios",
        "scripts",
        "sim",
        "tests",
    ):  # commands write to results/
        (clone / name).symlink_to(SOURCE / name)
    environment = {
        **ENVIRONMENT,
        "PATH": f"{PROGRAM.parent}:{ENVIRONMENT['PATH']}",
        "PYTHONPATH": sys.argv[-1],
        "MPLBACKEND": "Agg",
        "HAPBENCH_MODULE_PATH": "",
        "COLUMNS": "100",
        "LC_ALL": "C.UTF-8",
    }
    return must(
        sys.executable, "-c", PLAYER, json.dumps(CODE.findall(text)), cwd=clone, env=environment
    )


def unproven_numbers(text, printed):
    """Returns the numbers in the sentences of a text that occur neither in a block nor in its output. `printed`: output
    of the blocks."""
    shown = CHECKS.sub("", text)
    known = set(NUMBER.findall(printed)) | {
        number for _, code in CODE.findall(shown) for number in NUMBER.findall(code)
    }
    prose = re.sub(r"\]\([^)]*\)|`[^`]*`", "", CODE.sub("", shown))
    return [number for number in NUMBER.findall(prose) if number not in known]


class Tutorials(unittest.TestCase):
    def test_each_runs_and_prints_what_it_shows(self):
        self.assertEqual(len(TUTORIALS), 6)
        texts = {file.stem: file.read_text(encoding="utf-8") for file in TUTORIALS}
        with ThreadPoolExecutor(2) as pool:
            printed = {
                name: pool.submit(played, text, scratch_folder(self))
                for name, text in texts.items()
            }
        for name, text in texts.items():
            with self.subTest(name):
                self.assertEqual(unproven_numbers(text, printed[name].result()), [])
