"""Tests the manuals: documented commands and examples work, link targets exist, generated tables equal the stored
tables, and README.md keeps its size."""
import json
import math
import os
import re
import shutil
import sys
import unittest
from functools import cache, partial
from pathlib import Path

import numpy as np

from fixture import PROGRAM, SOURCE, hapbench, must, ran, scratch_folder

from hapbench.columns import read_columns
from hapbench.errors import InputError
from hapbench_docs.manuals import (
    MAKERS,
    STAMP,
    Manual,
    Program,
    broken_links,
    manuals,
    renewed,
    same_but_for_times,
    write_files_of_getting_started,
)

RECORD = SOURCE / "results" / "reference"
TUTORIALS = SOURCE / "scenarios" / "library" / "tutorials"
MANUALS = [Manual(file) for file in manuals()]
COMMANDS = [command for manual in MANUALS for command in manual.commands()]
started = partial(ran, LC_ALL="C.UTF-8")
# An unknown option that resembles no real option, so that the error message suggests none.
UNKNOWN = "--zzzz"
# Commands that take minutes. Their options are only parsed.
LONG = {"reproduce", "stress"}
FEW_STEPS = ["--set", 'time={"step_s": 0.0005, "steps": 40}']
SHORTER = {
    "run": FEW_STEPS,
    "compare": FEW_STEPS,
    "sweep": FEW_STEPS,
    "converge": [*FEW_STEPS, "--levels", "3"],
    "limit": [*FEW_STEPS, "--resolution", "0.5"],
    "tune": [*FEW_STEPS, "--damping-ratio", "0.3:0.7"],
}


def of_program(command):
    return not command.words[0].startswith("scripts/")


def text_of(name):
    return (SOURCE / name).read_text(encoding="utf-8")


def prepare(folder):
    """Writes into the folder the files that the manuals assume the reader to have."""
    for name, source in (
        ("my.stl", "tests/data/seeds/cube_text.stl"),
        ("log.txt", "scenarios/library/examples/data/wipe.hapi.txt"),
        ("epfl_paddle.json", "scenarios/library/validation/epfl_paddle.json"),
        ("mine.json", "scenarios/library/studies/stability_delay.json"),
        ("loop.csv", "tests/data/loop.csv"),
    ):
        shutil.copy(SOURCE / source, folder / name)
    # Recording of a straight stroke of 20 samples, in microseconds and millimetres, with a force and quaternions.
    stroke = "".join(f"{10000 * i},1,0,0,{i / 20},0,0,0,0,0,1\n" for i in range(20))
    # Log of a mass of 0.1 kg that a force of 1 N moves at 1 Hz. Positions have a resolution of 10 um.
    turns = [math.cos(math.tau * i / 100) for i in range(200)]
    log = "".join(
        f"{i / 100},{turn},{round(2.533e4 * (1 - turn)) * 1e-5}\n" for i, turn in enumerate(turns)
    )
    device = re.search(r"^    {\n.*?^    }$", text_of("device_model/STIFFNESS.md"), re.M | re.S)[0]
    for name, text in (
        ("rec.csv", f"t,fx,fy,fz,x,y,z,qx,qy,qz,qw\n{stroke}"),
        ("log.csv", f"time_s,force_N,position_m\n{log}"),
        ("mydevice.json", device),
        ("log_device.json", device),
    ):
        (folder / name).write_text(text, encoding="ascii")
    write_files_of_getting_started(folder)
    # Compiles the example in C with the command line of the manual.
    compiler = re.search(r"^    (gcc .*) -o \S+$", text_of("algorithms/WRITE_A_LAW.md"), re.M)[
        1
    ].split()
    must(*compiler, "-o", folder / "depth_weighted.so", cwd=SOURCE)
    shutil.copy(Path(PROGRAM).parents[1] / "tests/scenarios/module/sphere.so", folder)
    made = partial(must, PROGRAM, statuses=(0, 3), cwd=folder)
    made("new", "mesh", "--from", "my.stl", "--extent", "6mm", "--out", "my.json")
    for name in "abc":
        shutil.copy(folder / "my.json", folder / f"{name}.json")
    for shard in range(2):
        made(
            "sweep",
            "my.json",
            "--vary",
            "rendering.stiffness_N_per_m=1e3:2e3:2",
            *FEW_STEPS,
            "--shard",
            f"{shard}/2",
            "--out",
            "shards",
        )
    for out in ("results/good/peg", "results/out/peg"):
        made("run", "peg_in_hole_2d_shaped_stiffness", *FEW_STEPS, "--out", out)


def shortened(command, folder):
    """Returns the words of a command, with options that make its runs shorter. A word with "*" is replaced by the files
    that match it, in the source tree or in the folder."""
    given = list(command.words[1:])
    if (
        given[0] == "plot" and "--from" in given
    ):  # a shortened run does not contain the interval of time that starts at --from
        given = given[: given.index("--from")]
    runs = given[0] != "sweep" or "--vary" in given and "--row" not in given
    shorter = SHORTER.get(given[0], []) if runs else []
    if (
        given[0] == "limit"
        and given[1].startswith("stability_")
        and not {"--device", "--algorithms"} & set(given)
    ):
        shorter = [*shorter, "--algorithms", "shaped_stiffness"]  # for studies over all laws
    if "--errors" in given:
        # With --errors, the command also runs at half the spacing of the surface points. A wide spacing shortens these
        # runs.
        shorter = [*shorter, "--set", "environment.spacing_m=4e-4"]
    if "--resolution" in given:
        shorter = [word for word in shorter if word not in ("--resolution", "0.5")]
    found = []
    for word in given:
        root = SOURCE if word.startswith("scenarios/") else folder
        found += sorted(map(str, root.glob(word))) if "*" in word and "=" not in word else [word]
    return [*found, *shorter]


class Commands(unittest.TestCase):
    def test_the_program_knows_their_options(self):
        commands = list(filter(of_program, COMMANDS))
        self.assertGreater(len(commands), 50)
        for command in commands:
            if command.words[1:2] == ("--version",):
                continue  # also skips the following commands
            with self.subTest(str(command)):
                done = started(PROGRAM, *command.words[1:], UNKNOWN)
                self.assertEqual(done.returncode, 2, done.stderr)
                unknown = set(re.findall(r"(?<![\w-])--[a-z-]+", done.stderr)) - {"--help"}
                self.assertEqual(unknown, {UNKNOWN}, done.stderr)

    def test_short_ones_run(self):
        prepared = scratch_folder(self)
        prepare(prepared)
        for manual in MANUALS:
            if manual.file.is_relative_to(RECORD) or manual.file.is_relative_to(TUTORIALS):
                # Skips two kinds of manuals: records, whose commands take minutes, and tutorials, whose commands
                # tutorials_test.py runs.
                continue
            folder = shutil.copytree(prepared, scratch_folder(self), dirs_exist_ok=True)
            for command in manual.commands():
                if (
                    of_program(command)
                    and len(command.words) > 1
                    and LONG.isdisjoint(command.words)
                ):
                    with self.subTest(str(command)):
                        done = started(PROGRAM, *shortened(command, folder), cwd=folder)
                        self.assertIn(done.returncode, (0, 3), done.stderr)

    def test_scripts_know_their_options(self):
        help_of = cache(lambda script: started(script, "--help").stdout)
        commands = [command for command in COMMANDS if not of_program(command)]
        self.assertGreater(len(commands), 8)
        for command in commands:
            script = SOURCE / command.words[0]
            with self.subTest(str(command)):
                self.assertTrue(os.access(script, os.X_OK))
                help_text = help_of(script)
                for option in (
                    word.split("=")[0] for word in command.words[1:] if word.startswith("--")
                ):
                    self.assertRegex(help_text, rf"{option}\b")

    def test_commands_in_sentences_exist(self):
        known = set(re.findall(r"^[a-z ]{8}([a-z]+) ", started(PROGRAM).stdout, re.M))
        self.assertIn("run", known)
        named = [
            (str(manual.file), name)
            for manual in MANUALS
            for name in re.findall(r"`hapbench\s+([a-z]+)", manual.text)
        ]
        self.assertEqual([(file, name) for file, name in named if name not in known], [])


class Pages(unittest.TestCase):
    def test_links_lead_somewhere(self):
        self.assertEqual(
            [(str(manual.file), link) for manual in MANUALS for link in broken_links(manual)], []
        )

    def test_tables_are_tables(self):
        """A table whose rows were wrapped with the paragraphs is shown as a paragraph."""
        for manual in MANUALS:
            code = {number for number, _ in manual.code()}
            width = None  # number of cells of the table that contains the line before
            for number, line in enumerate(manual.text.splitlines(), 1):
                row = "" if number in code else line.strip()
                with self.subTest(file=manual.file, line=number):
                    if re.search(r"\|\s*:?-{3,}", row):
                        self.assertRegex(row, r"^\|(\s*:?-+:?\s*\|)+$")
                    if row.startswith("|"):
                        cells = len(re.findall(r"(?<!\\)\|", row))
                        self.assertTrue(
                            row.endswith("|"), "a row of a table, or a text that begins with |"
                        )
                        self.assertEqual(width or cells, cells)
                        width = cells
                    else:
                        width = None

    def test_fences_of_code_stand_alone(self):
        """A fence that was wrapped with its code is shown as a paragraph."""
        for manual in MANUALS:
            fences = [line for line in manual.text.splitlines() if "```" in line]
            with self.subTest(file=manual.file):
                self.assertEqual(
                    [line for line in fences if not re.fullmatch(r"\s*```\w*", line)], []
                )
                self.assertEqual(len(fences) % 2, 0)

    def test_the_first_page_keeps_its_size(self):
        lines = text_of("README.md").splitlines()
        self.assertLess(len(lines), 70)
        self.assertEqual(
            [line for line in lines if len(line) > 110 and not line.startswith("|")], []
        )

    def test_the_map_of_the_sources_keeps_its_size(self):
        section = text_of("CONTRIBUTING.md").split("\n## Architecture\n")[1].split("\n## ")[0]
        self.assertLessEqual(len(section.strip().splitlines()), 80)

    def test_every_algorithm_is_in_the_table(self):
        names = json.loads(
            re.search(
                r'\[\s*"original_averaging",[^]]*\]',
                text_of("scenarios/library/scenario.schema.json"),
            )[0]
        )
        self.assertGreater(len(names), 12)
        rows = re.findall(r"^\| `(\w+)` \|", text_of("algorithms/README.md"), re.M)
        self.assertEqual(set(names) - set(rows), set())

    def test_the_version_is_the_same_everywhere(self):
        version = re.search(r"project\(hapbench VERSION (\S+)", text_of("CMakeLists.txt"))[1]
        self.assertIn(f"\nversion: {version}\n", text_of("CITATION.cff"))
        self.assertIn(f"\n## {version}", text_of("CHANGELOG.md").replace("[", "").replace("]", ""))
        self.assertIn(version, started(PROGRAM, "--version").stdout)


def record(name):
    return json.loads((RECORD / f"{name}.json").read_text(encoding="utf-8"))


class Generated(unittest.TestCase):
    def test_tables_are_those_on_record(self):
        for manual in MANUALS:
            with self.subTest(str(manual.file)):
                self.assertEqual(
                    renewed(manual.text, MAKERS), manual.text, "renew it with scripts/docs --tables"
                )

    def test_controls_and_pairs_are_about_the_verdicts_on_record(self):
        """Checks that controls.json and pairs.json contain the same verdicts as claims.json, and controls.json the same
        numbers. Otherwise their results with a wrong law or a pair of assumptions were computed for another verdict.
        """
        ledger = {claim["id"]: claim for claim in record("claims")["claims"]}
        faults = json.loads((SOURCE / "tests/mutants/controls.json").read_text(encoding="utf-8"))
        controls = record("controls")["controls"]
        self.assertEqual(
            {fault["name"]: fault["meaning"] for fault in faults},
            {control["name"]: control["meaning"] for control in controls},
        )
        for control in controls:
            for case in control["cases"]:
                claim = ledger[case["id"]]
                self.assertEqual(case["recorded"], [claim["verdict"], claim["number"]], case)
        for entry in record("pairs")["claims"]:
            claim = ledger[entry["id"]]
            self.assertEqual(entry["verdict"], claim["verdict"], entry["id"])
            for pair in entry["pairs"]:
                self.assertLessEqual(set(pair["values"]), set(claim["deciders"]), entry["id"])

    def test_a_block_without_end_is_refused(self):
        with self.assertRaises(InputError):
            renewed("<!-- generated: robustness -->\n| a |\n", MAKERS)

    def test_a_session_names_the_version_and_no_commit(self):
        program, session = Program(Path(PROGRAM)), "    $ hapbench run x\n\n    mean   1.25"
        version = re.search(r"project\(hapbench VERSION (\S+)", text_of("CMakeLists.txt"))[1]
        stamped = program.stamped(session, "")
        head, _, stamp = stamped.rpartition("\n\nPrinted by ")
        self.assertEqual(head, session)
        self.assertRegex(stamp, STAMP)
        self.assertTrue(stamp.startswith(f"hapbench {version}, "), stamp)
        self.assertNotRegex(stamp, r"\b[0-9a-f]{7,}\b|dirty")
        earlier = re.sub(r"\d{4}-\d\d-\d\d", "2020-01-02", stamped)
        self.assertEqual(program.stamped(session, f"{earlier}\n"), f"{earlier}\n")
        older = stamped.replace(version, "0.1.0")
        self.assertEqual(program.stamped(session, f"{older}\n"), stamped)
        with_commit = f"{session}\n\nPrinted by commit 0123456789ab-dirty, 2026-11-28, AMD EPYC.\n"
        self.assertEqual(program.stamped(session, with_commit), stamped)

    def test_measured_times_are_no_news(self):
        old = (
            "    law     force   us/\n                   step\n    ------  -----  ----\n    mean     1.25  0.25\n\n"
            "    99 % of the time steps are computed within 0.24 us (mean) to 4.2 us (proxy)"
        )
        slower = (
            old.replace("0.25", "10.5")
            .replace("  ----", "  -----")
            .replace("4.2 us (proxy)", "14 us (summation)")
        )
        self.assertTrue(same_but_for_times(old, slower))
        self.assertFalse(same_but_for_times(old, slower.replace("1.25", "1.26")))
        self.assertFalse(same_but_for_times(old.replace("us/", "N/"), slower.replace("us/", "N/")))


class Examples(unittest.TestCase):
    def test_the_force_on_a_sphere_by_python_is_that_of_the_sphere(self):
        """Checks that the force of a fixed sphere on a spherical tool is K times the depth, along the line between the
        centres of the two spheres."""
        folder = scratch_folder(self)
        must(
            sys.executable,
            SOURCE / "algorithms" / "module" / "examples" / "sphere_trace.py",
            folder,
        )
        hapbench("run", folder / "sphere.json", "--out", folder / "out", "--quiet")
        rows = read_columns(folder / "out" / "trajectory.csv")
        position, force = (
            np.column_stack([rows[name.format(x)] for x in "xyz"]) for name in ("p{}_m", "f{}_N")
        )
        distance = np.linalg.norm(position, axis=1, keepdims=True)
        known = 20000 * np.maximum(0, 0.0025 - distance) * position / distance
        self.assertGreater(np.count_nonzero(known[:, 2]), 500)
        # The tolerance is K times a few rounding errors of a length of 2.5 mm.
        self.assertLess(np.abs(force - known).max(), 1e-13)
