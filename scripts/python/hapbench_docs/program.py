"""The built program, and on which machine it runs."""
import datetime
import os
import re
import subprocess
from pathlib import Path

from hapbench.errors import InputError

COLUMNS = 100  # of a session in a manual


class Program:
    def __init__(self, file):
        if not file.is_file():
            raise InputError(f"{file}: no such file; build it, or name another with --program")
        self.file = file.resolve()

    def run(self, words, directory):
        """Standard output. A run that ends other than expected (3) has output, too."""
        # The tables are over the algorithms of this tree.
        environment = {name: value for name, value in os.environ.items() if name != "HAPBENCH_MODULE_PATH"}
        done = subprocess.run([self.file, *words], cwd=directory, capture_output=True, text=True, encoding="utf-8",
                              env={**environment, "COLUMNS": str(COLUMNS), "LC_ALL": "C.UTF-8"}, stdin=subprocess.DEVNULL)
        if done.returncode not in (0, 3):
            raise InputError(f"hapbench {' '.join(map(str, words))}: exit status {done.returncode}: {done.stderr.strip()}")
        return done.stdout

    def stamped(self, text, old):
        """The text and where it comes from; the old block where the text says the same, since a date or a time is no news."""
        known = old.rpartition("\n\nPrinted by ")[0]
        return old if same_but_for_times(text, known) else f"{text}\n\nPrinted by {self.provenance()}."

    def provenance(self):
        """Commit, date and processor: "commit 5e60010bc2c9, 2026-11-21, AMD EPYC"."""
        commit = re.search(r"\(([^)]+)\)", self.run(["--version"], "."))
        return f"commit {commit[1] if commit else 'unknown'}, {datetime.date.today()}, {processor()}"


def same_but_for_times(a, b):
    """Whether two outputs have the same words, apart from times in microseconds, which differ from run to run."""
    return _words(a) == _words(b)


def _words(text):
    text = re.sub(r"\S+ us( \(\w+\)|$)", "TIME us", text, flags=re.M)
    text = re.sub(r"\S+\s+(s\s+a\s+run|times\s+the\s+first)", r"TIME \1", text)
    if re.search(r" (us/|run s)$", text, re.M):  # a table whose last column is a time
        text = re.sub(r" [\d.e+-]+$", " TIME", text, flags=re.M)
    return re.sub(r"-{3,}", "---", text).split()


def processor():
    """The processor's name without what it says of its cores."""
    try:
        found = re.search(r"^model name\s*:\s*(.+)$", Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.M)
    except OSError:
        found = None
    return re.sub(r"\s+\d+-Core.*|\s*@.*|\(R\)|\(TM\)", "", found[1]).strip() if found else "unknown processor"
