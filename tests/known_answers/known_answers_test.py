"""Tests that every field that the program prints has a known answer, and that the program prints this answer
(tests/known_answers/README.md). The program itself lists its printed fields."""
import json
import re
import unittest
from importlib import import_module
from pathlib import Path

from answers import SCENES, Answer, Bench, Within
from fixture import PROGRAM, must, scratch_folder

for scenes in sorted(Path(__file__).parent.glob("of_*.py")):
    import_module(scenes.stem)

FOUND = {}  # Bench of each scene
ANSWERS = []
NO_TABLES = {"run", "import"}  # commands whose JSON does not repeat a table
# Kinds of words without an answer of their own. The entries of an object of summary.json have their own rows.
NO_WORDS = {"file of the results", "object of summary.json"}
TOLERANCES = "tolerances"
DIAGNOSIS = "diagnosis"
# JSON members that describe the origin of a result and contain no results.
NO_ANSWERS = {"provenance", "name", "algorithm", "scenario"}


def described(what):
    return json.loads(must(PROGRAM, "describe", what, "--json"))


def keys_of(data):
    """Yields (key, True if its value only groups other keys) for each key of the JSON `data`. A grouping value is an
    object or a list of objects."""
    for part in data if isinstance(data, list) else ():
        yield from keys_of(part)
    if not isinstance(data, dict):
        return
    members = {
        key: value
        for key, value in data.items()
        if key not in NO_ANSWERS and key not in (TOLERANCES, DIAGNOSIS)
    }
    members.update(
        {f"{TOLERANCES}.{name}": value for name, value in data.get(TOLERANCES, {}).items()}
    )  # in addition to the columns of the metrics
    members.update(
        {
            f"{DIAGNOSIS}.{name}": value
            for finding in data.get(DIAGNOSIS, [])
            for name, value in finding.items()
        }
    )  # members of each finding of the diagnosis
    for key, value in members.items():
        grouping = (
            isinstance(value, dict)
            or isinstance(value, list)
            and any(isinstance(v, dict) for v in value)
        )
        yield key, grouping
        if grouping:
            yield from keys_of(value)


def printed_fields():
    """Returns the names of all printed fields: metrics by their name, columns as FILE:COLUMN, words as "WORD (KIND)",
    and other keys of JSON as "COMMAND --json: KEY"."""
    metrics = [metric["name"] for metric in described("metrics")[0]["metrics"]]
    parts = {part for name in metrics for part in name.split(".")}
    fields, columns = [re.sub(r"^targets\.\d+", "targets.PLACE", name) for name in metrics], set()
    for table in described("columns"):
        names = [column["name"] for column in table["columns"]]
        columns |= set(names)
        shared = table["name"] in ("sweep.csv", "comparison.csv")
        fields += [
            f"{table['name']}:{name.split('.')[0] if name.startswith(TOLERANCES) else name}"
            for name in names
            if not shared or name not in metrics
        ]
        fields += [f"{table['name']}:metrics"] if shared else []
    fields += [
        f"{word['name']} ({word['kind']})"
        for word in described("words")["words"]
        if word["kind"] not in NO_WORDS
    ]
    # Keys that repeat a column or a key of `run --json` are not listed again, except for the commands in NO_TABLES.
    printed = [
        (command, *key)
        for bench in FOUND.values()
        for command, data in bench.printed
        for key in keys_of(data)
    ]
    groups = {(command, key) for command, key, grouping in printed if grouping}
    keys = {
        (command, key) for command, key, _ in printed if key not in parts or command != "run"
    } - groups
    of_runs = {key for command, key in keys if command == "run"}
    fields += [
        f"{command} --json: {key}"
        for command, key in sorted(keys)
        if command in NO_TABLES or key not in columns | of_runs
    ]
    return list(dict.fromkeys(fields))


def setUpModule():
    folder = scratch_folder(unittest)
    for name, work in SCENES.items():
        FOUND[name] = Bench(name, folder / name)
        work(FOUND[name])
        ANSWERS.extend(FOUND[name].answers)


class KnownAnswers(unittest.TestCase):
    def test_what_is_printed_is_known_and_no_naive_answer(self):
        for answer in ANSWERS:
            with self.subTest(field=answer.field, scene=answer.scene):
                self.assertEqual(list(answer.faults()), [])

    def test_every_field_has_one_that_a_naive_answer_fails(self):
        answered = {answer.field for answer in ANSWERS if answer.naive}
        self.assertEqual(
            [field for field in printed_fields() if field not in answered],
            [],
            "a printed field without a row in a scene of tests/known_answers",
        )

    def test_rows_are_of_printed_fields(self):
        self.assertEqual(sorted({answer.field for answer in ANSWERS} - set(printed_fields())), [])

    def test_columns_of_files_are_described(self):
        fields = {field for field in printed_fields() if ":" in field}
        for bench in FOUND.values():
            for file in bench.folder.rglob("*.csv"):
                name = file.name
                header = file.read_text(encoding="utf-8").split("\n")[0].split(",")
                if f"{name}:{header[0]}" in fields and f"{name}:metrics" not in fields:
                    varied = {
                        column
                        for column in header
                        if "." in column and name in ("limit_runs.csv", "sweep_timing.csv")
                    }
                    self.assertEqual(
                        {f"{name}:{column}" for column in set(header) - varied} - fields, set()
                    )

    def test_a_wrong_number_is_found(self):
        within = Within("", relative=1e-6)
        wrong = Answer("x", "y", "", within, 1.0, 1.0 + 1e-5, ("", 1.0 + 1e-7))
        self.assertEqual(len(list(wrong.faults())), 2)
        self.assertEqual(
            list(Answer("x", "y", "", within, 1.0, 1.0 + 1e-7, ("", 1.1)).faults()), []
        )
        self.assertEqual(len(list(Answer("x", "y", "", within, "stable", "vibrating").faults())), 1)
        self.assertEqual(len(list(Answer("x", "y", "", within, 1.0, None).faults())), 1)
