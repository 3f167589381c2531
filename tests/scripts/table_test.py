"""Tests the option --table of the program: tables as Markdown, LaTeX and CSV. latex_test.py compiles the LaTeX
tables."""
import csv
import io
import re
import unittest

import printed_tables
from fixture import PROGRAM, ran
from printed_tables import COMMANDS, LAWS, NASTY, printed


def markdown_rows(text):
    """Returns the cells of a Markdown table by row, without the separator line."""
    lines = [line for line in text.splitlines() if line.startswith("|")]
    rows = [[c.strip() for c in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines]
    return rows[:1] + rows[2:]


def setUpModule():
    printed_tables.make_scene()


def csv_rows(name):
    return list(csv.reader(io.StringIO(printed(name, "csv"))))


class Tables(unittest.TestCase):
    def test_standard_output_has_the_tables_and_nothing_else(self):
        for name in COMMANDS:
            for part in printed(name, "latex").split("\n\n"):
                self.assertRegex(part, r"^% [^\n]*\n\\begin{tabular}", name)
                self.assertRegex(part, r"\\end{tabular}\n?$", name)
        for name in ("errors", "seeds", "claims"):
            for part in printed(name, "csv").split("\n\n"):
                rows = list(csv.reader(io.StringIO(part)))
                self.assertEqual({len(row) for row in rows}, {len(rows[0])}, part)
        for name in ("run", "seeds", "claims"):
            rows = markdown_rows(printed(name, "markdown"))
            self.assertEqual({len(row) for row in rows}, {len(rows[0])}, name)

    def test_names_are_those_of_the_scenario(self):
        heads, *rows = csv_rows("run")
        self.assertEqual(rows[0][heads.index("scenario")], NASTY)
        row = markdown_rows(printed("run", "markdown"))[1]
        self.assertEqual(re.sub(r"\\(.)", r"\1", row[0]), NASTY)

    def test_a_comparison_over_seeds_is_one_table_of_laws_and_metrics(self):
        heads, *rows = csv_rows("seeds")
        self.assertEqual(heads[:3], ["scenario", "algorithm", "failed runs"])
        self.assertEqual(len(rows), 2 * 3)
        self.assertEqual({row[1] for row in rows}, set(LAWS.split(",")))
        for head in heads[3:-1]:
            self.assertRegex(head, r"\[[^]]+\]")
        with (printed_tables.ROOT / "results/out/compare/ranking.csv").open(
            encoding="utf-8"
        ) as file:
            ranking = list(csv.DictReader(file))
        for row in rows:
            for entry in ranking:
                if (entry["scenario"], entry["algorithm"]) == (row[0], row[1]):
                    self.assertEqual(row[2], entry["failed"])

    def test_heads_have_units(self):
        heads = csv_rows("limit")[0]
        self.assertIn("quote [N/m]", heads)
        self.assertIn("linear limit [N/m]", heads)
        heads = csv_rows("converge")[0]
        self.assertIn("time.step_s [s]", heads)

    def test_claims_have_verdicts_and_numbers(self):
        heads, *rows = csv_rows("claims")
        self.assertEqual(heads[:2], ["claim", "summary"])
        self.assertIn("T3", {row[0] for row in rows})
        for name in ("verdict", "published", "measured"):
            self.assertTrue(all(row[heads.index(name)] for row in rows if row[0] == "T3"))

    def test_what_cannot_be_a_table_is_refused(self):
        for words, message in (
            (("run", "tap_wall", "--table", "html"), 'allowed: "markdown", "latex", "csv"'),
            (("run", "tap_wall", "--table", "csv", "--json"), "--json"),
            (("describe", "mean", "--table", "csv"), "allowed: the name of a list, such as claims"),
            (("validate", "tap_wall", "--table", "csv"), "--table"),
        ):
            done = ran(PROGRAM, *words, cwd=printed_tables.ROOT)
            self.assertEqual(done.returncode, 2, words)
            self.assertIn(message, done.stderr)

    def test_several_csv_tables_are_announced(self):
        done = ran(PROGRAM, *COMMANDS["latency"], "--table", "csv", cwd=printed_tables.ROOT)
        self.assertIn("2 CSV tables", done.stderr)
