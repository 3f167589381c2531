"""What an earlier program answered is still answered: the questions of questions.py against answers.txt, which it printed.

    equivalence_test.py PROGRAM              asks every question by its command of today
    equivalence_test.py PROGRAM --renew      writes answers.txt with what this program prints to the old commands
    … NAME…                                  only the questions of these names
"""
import csv
import json
import math
import shlex
import sys
import tempfile
import unittest
from io import StringIO
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "scripts"))
from fixture import PROGRAM, ran  # noqa: E402  (the path comes first)
from questions import GIVEN, QUESTIONS  # noqa: E402

ANSWERS = HERE / "answers.txt"  # a table behind each line "# question table"
NAMED = [word for word in sys.argv[2:] if not word.startswith("-")]
ASKED = [question for question in QUESTIONS if not NAMED or question.name in NAMED]


def on_record():
    """The rows of each table by the name of its question and its own."""
    parts = [part.partition("\n") for part in ANSWERS.read_text(encoding="utf-8").split("# ")[1:]]
    return {title: list(csv.DictReader(StringIO(text))) for title, _, text in parts}


def text_of(value):
    """A cell as CSV files have it."""
    return "" if value is None else str(value).lower() if isinstance(value, bool) else value if isinstance(value, str) else repr(value)


def cells_of(row, path=""):
    """A row of JSON as cells by name: "margins.gain" for an object in it, and for a list in it how long that is."""
    if not isinstance(row, dict):
        return {path: text_of(len(row) if isinstance(row, list) else row)}
    return {name: cell for key, value in row.items() for name, cell in cells_of(value, f"{path}.{key}" if path else key).items()}


def table_in(name, folder, printed):
    """Rows of a CSV file in the folder, or of the JSON that was printed: its list at a place such as interval.limits, or a panel's settings."""
    if isinstance(name, tuple):
        return name[1](table_in(name[0], folder, printed))
    if callable(name):
        return [cells_of(row) for row in name(json.loads(printed))]
    if name.endswith(".csv"):
        with open(folder / name, encoding="utf-8", newline="") as file:
            return list(csv.DictReader(file))
    found = json.loads(printed)
    if name.startswith("panel "):
        return [cells_of({**setting, "setting": setting["name"].partition("/")[2].removesuffix("/manual_time"), "outcome": setting["label"]})
                for setting in found["benchmarks"]]
    for key in filter(None, name.removeprefix("json").split(".")):
        found = found[key]
    return [cells_of(row) for row in (found if isinstance(found, list) else [found])]


def answer_to(question, command):
    """The rows of each table, by the name that it has on record."""
    with tempfile.TemporaryDirectory(prefix="hapbench-test-") as scratch:
        for name, text in GIVEN.items():
            Path(scratch, name).write_text(text, encoding="utf-8")
        if command.startswith("hapbench_accuracy "):
            program, panel = command.split()
            done = ran(Path(PROGRAM).with_name(program), f"--benchmark_filter={panel}", "--benchmark_min_time=0.0001", "--benchmark_format=json", cwd=scratch)
        else:
            done = ran(PROGRAM, *shlex.split(command), "--json", "--out", "out", cwd=scratch)
        if done.returncode != question.status:
            raise AssertionError(f"{command}: status {done.returncode}, expected {question.status}\n{done.stderr}")
        return {table: table_in(now, Path(scratch, "out"), done.stdout) for table, now in question.tables.items()}


def same(value, known, relative):
    if value == known:
        return True
    try:
        return math.isclose(float(value), float(known), rel_tol=relative, abs_tol=0.0)
    except ValueError:
        return False


def differences(question, table, rows):
    """What is not as on record, a line each."""
    known = KNOWN[f"{question.name} {table}"]
    if len(rows) != len(known):
        yield f"{table}: {len(known)} rows on record, now {len(rows)}"
    for i, (row, before) in enumerate(zip(rows, known)):
        for column, cell in before.items():
            now = question.columns.get(column, column)
            relative = question.tolerance.get(column, (0.0, ""))[0]
            if now is not None and not same(row.get(now, ""), cell, relative):
                yield f"{table}, row {i + 1} ({', '.join(list(before.values())[:2])}): {column} {cell} on record, now {row.get(now, 'missing')}"


def renew():
    tables = on_record() if ANSWERS.exists() else {}
    for question in ASKED:
        tables |= {f"{question.name} {table}": rows for table, rows in answer_to(question, question.old).items()}
    with open(ANSWERS, "w", encoding="utf-8", newline="") as file:
        for title, rows in tables.items():
            file.write(f"# {title}\n")
            writer = csv.DictWriter(file, list(dict.fromkeys(name for row in rows for name in row)), lineterminator="\n", restval="")
            writer.writeheader()
            writer.writerows(rows)


class Equivalence(unittest.TestCase):
    def test_old_answers_hold(self):
        for question in ASKED:
            with self.subTest(question=question.name):
                answer = answer_to(question, question.new or question.old)
                found = [line for table, rows in answer.items() for line in differences(question, table, rows)]
                self.assertEqual(found[:20], [], f"{len(found)} differences")

    def test_every_answer_on_record_has_its_question(self):
        self.assertEqual(sorted(KNOWN), sorted(f"{question.name} {table}" for question in QUESTIONS for table in question.tables))

    def test_tolerances_have_reasons(self):
        for question in QUESTIONS:
            for column, (relative, reason) in question.tolerance.items():
                self.assertTrue(0.0 < relative < 0.1 and len(reason) > 20, f"{question.name}: {column}")

    def test_another_number_is_found(self):
        question, table = QUESTIONS[0], next(iter(QUESTIONS[0].tables))
        rows = KNOWN[f"{question.name} {table}"]
        self.assertEqual(list(differences(question, table, rows)), [])
        for column, cell in rows[0].items():
            wrong = repr(math.nextafter(float(cell), math.inf)) if cell[:1].isdigit() else cell + "x"
            other = [{**rows[0], column: wrong}, *rows[1:]]
            self.assertEqual(len(list(differences(question, table, other))), 1, column)


if __name__ == "__main__":
    if "--renew" in sys.argv:
        renew()
    else:
        KNOWN = on_record()
        unittest.main(argv=sys.argv[:1])
