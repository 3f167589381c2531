"""Tests that LaTeX compiles the tables of --table latex. Needs LaTeX with booktabs and siunitx (scripts/setup --check).
Because of this requirement, scripts/check latex runs this test, and ctest does not."""
import re
import unittest

import printed_tables
from fixture import ran
from printed_tables import COMMANDS, printed


def setUpModule():
    printed_tables.make_scene()


class Latex(unittest.TestCase):
    def test_every_table_compiles(self):
        tables = [printed(name, "latex") for name in COMMANDS]
        (printed_tables.ROOT / "tables.tex").write_text(
            "\\documentclass{article}\n\\usepackage{booktabs,siunitx}\n\\begin{document}\n\\tiny\n"
            + "\n\n\\clearpage\n".join(tables)
            + "\\end{document}\n",
            encoding="utf-8",
        )
        words = ("pdflatex", "-interaction=nonstopmode", "-halt-on-error", "tables.tex")
        done = ran(*words, cwd=printed_tables.ROOT)
        log = re.sub(r"(?s)^.*?(?=^!)", "", done.stdout, flags=re.M)
        self.assertEqual(done.returncode, 0, log[:2000])
        self.assertNotRegex(done.stdout, "Missing character|Undefined|siunitx Error")
