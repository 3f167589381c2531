"""Functions for the manuals: their files, their commands, their links, and their generated blocks. A generated block
stands between `<!-- generated: NAME -->` and `<!-- /generated -->`. It is a session (a command and its output), or a
table that is made from files in results/reference, such as the ledger claims.json."""
import csv
import datetime
import json
import os
import re
import shlex
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from hapbench.errors import InputError

ROOT = Path(__file__).resolve().parents[3]
NOT_OURS = ("build", "results/out")
COMMAND = re.compile(r"^\s*(?:\$ )?((?:build/\S+/hapbench|hapbench|scripts/[a-z]+)(?:\s.*)?)$")
LINK = re.compile(r"\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#{1,6} (.+)$", re.M)
# Matches a word at which the arguments of a command in a shell line end: a pipe, a redirection, && or ;.
ENDS = re.compile(r"^(?:\||&&|;|\d?>.*|<.*)$")
BLOCK = re.compile(r"(<!-- generated: (\S+)[^\n]*-->\n)(.*?)(<!-- /generated -->)", re.S)
BEGIN = "<!-- generated:"
COLUMNS = 100  # terminal width of a session in a manual
STARTED = ROOT / "scenarios" / "GETTING_STARTED.md"
REFERENCE = ROOT / "results" / "reference"
TASKS = {
    "D1": "upright, 0.52 mm aside",
    "D2": "upright, centre",
    "D3": "turning, 3 mm high",
    "D4": "turning, 4 mm high",
}
# Matches a result of Program.provenance(), followed by a full stop.
STAMP = re.compile(r"hapbench \d[\w.]*, \d{4}-\d\d-\d\d, [^\n]+\.")
PAIR = re.compile(r"success(?: rate)? (.+?) vs ([^;(]+)")


def manuals():
    """Yields every Markdown file of the source tree, except hidden files and files in hidden folders and in the folders
    NOT_OURS."""
    for file in sorted(ROOT.rglob("*.md")):
        where = file.relative_to(ROOT)
        hidden = any(part.startswith(".") for part in where.parts)
        if not hidden and not any(where.is_relative_to(folder) for folder in NOT_OURS):
            yield file


@dataclass(frozen=True)
class Command:
    manual: Path
    line: int
    words: tuple  # words of the command, without comments, redirections and pipes

    def __str__(self):
        return f"{self.manual.relative_to(ROOT)}:{self.line}: {' '.join(self.words)}"


class Manual:
    def __init__(self, file):
        self.file = Path(file)
        self.text = self.file.read_text(encoding="utf-8")

    def code(self):
        """Yields (line number, line) of each line of code: lines in fences, and lines indented by at least four
        blanks."""
        fenced = False
        for number, line in enumerate(self.text.splitlines(), 1):
            if line.lstrip().startswith("```"):
                fenced = not fenced
            elif fenced or line.startswith("    "):
                yield number, line

    def commands(self):
        """Yields the Command of each line of code that begins with hapbench, build/…/hapbench or scripts/…. A backslash
        at the end of a line joins the next line."""
        lines = list(self.code())
        while lines:
            number, line = lines.pop(0)
            while line.endswith("\\") and lines:
                line = line[:-1] + lines.pop(0)[1].strip()
            found = COMMAND.match(line)
            if found:
                words = shlex.split(found[1], comments=True)
                end = next((i for i, word in enumerate(words) if ENDS.match(word)), len(words))
                yield Command(self.file, number, tuple(words[:end]))

    def anchors(self):
        """Returns the anchors that GitHub gives the headings."""
        return {
            re.sub(r"[^\w\- ]", "", title.strip().lower()).replace(" ", "-")
            for title in HEADING.findall(self.text)
        }


def broken_links(manual):
    """Yields the relative links of a manual whose file or anchor does not exist."""
    for link in LINK.findall(manual.text):
        if re.match(r"^[a-z]+:", link):
            continue
        path, _, fragment = link.partition("#")
        target = (manual.file.parent / path) if path else manual.file
        if (
            not target.exists()
            or fragment
            and target.suffix == ".md"
            and fragment not in Manual(target).anchors()
        ):
            yield link


def renewed(text, makers):
    """Returns the text with each generated block NAME replaced by `makers[NAME](old)`, where `old` is the block's
    current content. A block without an entry in `makers` is unchanged."""
    if text.count(BEGIN) != len(BLOCK.findall(text)):
        raise InputError(
            'a block that begins with "<!-- generated: NAME -->" lacks its end "<!-- /generated -->"'
        )

    def replaced(found):
        head, name, old, tail = found.groups()
        return f"{head}{makers[name](old).strip(chr(10))}\n{tail}" if name in makers else found[0]

    return BLOCK.sub(replaced, text)


def session(old, program, directory):
    """Executes the first command in the block `old` and returns the new block: a session, which is the command and its
    output, followed by version, date and processor. `old`: the current content of the block."""
    line = next(
        (line.strip() for line in old.splitlines() if line.strip().startswith("$ hapbench ")), None
    )
    if line is None:
        raise InputError("a session begins with an indented line: $ hapbench …")
    output = program.run(shlex.split(line)[2:], directory)
    shown = "\n".join(
        f"    {text}".rstrip() for text in [line, "", *output.strip("\n").splitlines()]
    )
    return program.stamped(shown, old)


def write_files_of_getting_started(folder):
    """Writes the files that the tutorial GETTING_STARTED creates without hapbench: the mesh my.obj and the compiled law
    mine.so."""
    shutil.copy(ROOT / "scenarios/library/examples/data/molar.obj", folder / "my.obj")
    text = STARTED.read_text(encoding="utf-8")
    law = re.search(r"^```c\n(.*?)^```$", text, re.M | re.S)[1]
    (folder / "mine.c").write_text(law, encoding="utf-8")
    compiler = re.search(r"^    (gcc .*) mine.c -o mine.so$", text, re.M)[1].split()
    command = [*compiler, folder / "mine.c", "-o", folder / "mine.so"]
    subprocess.run(command, cwd=ROOT, check=True)


def read(name):
    return json.loads((REFERENCE / name).read_text(encoding="utf-8"))


def main_results(_old=""):
    """Returns the table in claims.md that lists the sentences of the thesis's abstract, with links into the ledger."""
    page = (REFERENCE / "claims.md").read_text(encoding="utf-8")
    return next(part for part in page.split("\n\n") if part.startswith("| claim of the abstract |"))


def experiments(_old=""):
    """Returns a table of the success rates in the thesis's experiments: measured with simulated subjects, and published
    with people."""
    by_id = {claim["id"]: claim for claim in read("claims.json")["claims"]}
    lines = [
        "| task and target | original algorithm, ours (published) | stiffness shaping, ours (published) |",
        "|---|---|---|",
    ]
    for id_, task in TASKS.items():
        published = PAIR.search(re.sub(r" \(printed [^)]*\)", "", by_id[id_]["published"]))
        measured = PAIR.search(by_id[id_]["measured"])
        cells = (f"{measured[i].strip()} ({published[i].strip()})" for i in (1, 2))
        lines.append(f"| {task} ({id_}) | {' | '.join(cells)} |")
    return "\n".join(lines)


def robustness(_old=""):
    """Returns a table with a row for each assumption that decides the verdict of a claim. The row lists these
    claims."""
    claims = read("claims.json")["claims"]
    what = {entry["id"]: entry["what"] for entry in read("assumptions.json")["assumptions"]}
    decided = {}
    for claim in claims:
        for name in claim["deciders"]:
            alone = len(claim["deciders"]) == 1
            decided.setdefault(name, []).append(f"**{claim['id']}**" if alone else claim["id"])
    lines = ["| assumption | what | decides |", "|---|---|---|"]
    for name, ids in sorted(decided.items(), key=lambda entry: (-len(entry[1]), entry[0])):
        lines.append(f"| `{name}` | {what[name]} | {' '.join(ids)} |")
    return "\n".join(lines)


def controls(_old=""):
    """Returns a list of the wrong laws in controls.json with their meanings, and a table with a row for each claim: the
    wrong laws that change the verdict of the claim."""
    changes, judged, meanings = {}, {}, []
    for control in read("controls.json")["controls"]:
        meanings.append(f"- `{control['name']}`: {control['meaning']}.")
        for case in control["cases"]:
            judged[case["id"]] = judged.get(case["id"], 0) + 1
            names = changes.setdefault(case["id"], [])
            if case["verdict"] != case["recorded"][0]:
                names.append(f"`{control['name']}` ({case['verdict']})")
    lines = ["| claim | verdict | changes | controls (new verdict) |", "|---|---|---|---|"]
    for claim in read("claims.json")["claims"]:
        if claim["id"] in changes:
            names = changes[claim["id"]]
            lines.append(
                f"| {claim['id']} | {claim['verdict']} | {len(names)} of {judged[claim['id']]} | "
                f"{', '.join(names) or '–'} |"
            )
    return "\n".join([*meanings, "", *lines])


def pairs(_old=""):
    """Returns a table with a row for each claim that several assumptions decide. The row groups the pairs of these
    assumptions by the verdict of the claim when both assumptions of the pair are changed. This verdict is the recorded
    verdict (first group), the verdict when only one assumption of the pair is changed (second group), or another
    verdict (third group). The row has the number of pairs in the second group, and lists the pairs of the other groups.
    """
    lines = [
        "| claim | recorded verdict | number of pairs | pairs with the recorded verdict | number of pairs with the "
        "verdict of one assumption alone | pairs with a third verdict |",
        "|---|---|---|---|---|---|",
    ]
    for claim in read("pairs.json")["claims"]:
        back, others = [], []
        for pair in claim["pairs"]:
            text = " and ".join(f"`{name}` = {value}" for name, value in pair["values"].items())
            if pair["verdict"] == claim["verdict"]:
                back.append(text)
            elif pair["verdict"] not in pair["alone"]:
                others.append(f"{text}: {pair['verdict']}")
        rest = len(claim["pairs"]) - len(back) - len(others)
        lines.append(
            f"| {claim['id']} | {claim['verdict']} | {len(claim['pairs'])} | {'; '.join(back) or '–'} | {rest} | "
            f"{'; '.join(others) or '–'} |"
        )
    return "\n".join(lines)


def six_dof(_old=""):
    """Returns the table of the study six_dof, whose sweep.csv is stored as six_dof.csv. Each scene has a row with the
    default hand, grip and pivot; the scenes edge and slot also have a row for each case with another hand, grip or
    pivot. The columns are the reference force of the device with torque, the lost torque, the unresisted rotation, and
    for each law the force error and the energy that the law creates in a cycle."""
    with open(REFERENCE / "six_dof.csv", newline="", encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    laws = list(dict.fromkeys(row["six_dof.law"] for row in rows))
    lines = [
        "| scene | hand, grip, pivot | reference force [N rms] | lost torque [mN m rms] | unresisted turn [rad] | "
        + " | ".join(law.replace("_", " ") for law in laws)
        + " |",
        "|---|---|---|---|---|" + "---|" * len(laws),
    ]
    cases = dict.fromkeys((row["scenario"], row["six_dof"]) for row in rows)
    for scene, fields in cases:
        of_case = {
            row["six_dof.law"]: row
            for row in rows
            if (row["scenario"], row["six_dof"]) == (scene, fields)
        }
        given = {
            key.partition("_")[0]: value
            for key, value in json.loads(fields).items()
            if key != "force_point_m"
        }
        names = {"hand": "K_phi {:g} N m/rad", "grip": "grip {:g} m", "pivot": "pivot {:g} m"}
        if given and scene not in ("six_dof_edge", "six_dof_slot"):
            continue
        shown = ", ".join(names[key].format(value) for key, value in given.items()) or "usual"
        first = next(iter(of_case.values()))
        value = lambda row, name: float(row["six_dof." + name] or "nan")  # noqa: E731
        size = lambda error: f"{error:.2g}" if error >= 1e-6 else "< 1e-6"  # noqa: E731
        cells = [
            f"{size(value(row, 'force_error_rms_N'))}, {1e3 * value(row, 'work_J'):.2g}"
            + (
                f" ({row['six_dof.law_unbalanced_steps']})"
                if row["six_dof.law_unbalanced_steps"] != "0"
                else ""
            )
            for row in of_case.values()
        ]
        lines.append(
            f"| {scene.removeprefix('six_dof_')} | {shown} | {value(first, 'reference_force_rms_N'):.2g} | "
            f"{1e3 * value(first, 'lost_torque_rms_Nm'):.2g} | "
            f"{value(of_case[laws[1]], 'unresisted_turn_max_rad'):.2g} | "
            + " | ".join(cells)
            + " |"
        )
    return "\n".join(lines)


class Program:
    def __init__(self, file):
        if not file.is_file():
            raise InputError(f"{file}: no such file; build it, or name another with --program")
        self.file = file.resolve()

    def run(self, words, directory):
        """Runs the program in a directory and returns its standard output. A run with an unexpected outcome (status 3)
        is no failure."""
        # Removes the folders of additional modules, so that tables contain only the algorithms of this source tree.
        environment = {
            name: value for name, value in os.environ.items() if name != "HAPBENCH_MODULE_PATH"
        }
        done = subprocess.run(
            [self.file, *words],
            cwd=directory,
            capture_output=True,
            text=True,
            encoding="utf-8",
            env={**environment, "COLUMNS": str(COLUMNS), "LC_ALL": "C.UTF-8"},
            stdin=subprocess.DEVNULL,
        )
        if done.returncode not in (0, 3):
            raise InputError(
                f"hapbench {' '.join(map(str, words))}: exit status {done.returncode}: {done.stderr.strip()}"
            )
        return done.stdout

    def stamped(self, text, old):
        """Returns the text, with its provenance in a last line. Returns the block `old` unchanged instead if three
        conditions are met: its text differs from `text` only in run times, its provenance matches STAMP, and its
        version is the version of the program."""
        known, _, stamp = old.strip("\n").rpartition("\n\nPrinted by ")
        is_current = STAMP.fullmatch(stamp) and stamp.startswith(f"{self.version()}, ")
        if is_current and same_but_for_times(text, known):
            return old
        return f"{text}\n\nPrinted by {self.provenance()}."

    def provenance(self):
        """Returns version, date and processor, such as "hapbench 0.3.0, 2026-11-21, AMD EPYC". The commit is omitted,
        because stamped() compares only the version."""
        return f"{self.version()}, {datetime.date.today()}, {processor()}"

    def version(self):
        """Returns the program's name and version, such as "hapbench 0.3.0"."""
        return self.run(["--version"], ".").partition(" (")[0].strip()


def same_but_for_times(a, b):
    """Returns True if two outputs are equal except for run times and ratios of run times."""
    return _words(a) == _words(b)


def _words(text):
    text = re.sub(r"\S+ us( \(\w+\)|$)", "TIME us", text, flags=re.M)
    text = re.sub(
        r"\S+\s+(s\s+(?:a|per)\s+run|times\s+the\s+(?:time\s+of\s+the\s+)?first)", r"TIME \1", text
    )
    if re.search(r" (us/|run s)$", text, re.M):  # a table whose last column is a time
        text = re.sub(r" [\d.e+-]+$", " TIME", text, flags=re.M)
    return re.sub(r"-{3,}", "---", text).split()


def processor():
    """Returns the processor's name without the number of cores."""
    try:
        found = re.search(
            r"^model name\s*:\s*(.+)$", Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.M
        )
    except OSError:
        found = None
    return (
        re.sub(r"\s+\d+-Core.*|\s*@.*|\(R\)|\(TM\)", "", found[1]).strip()
        if found
        else "unknown processor"
    )


# Functions that make a table without running the program, by the name of the generated block.
MAKERS = {
    "main_results": main_results,
    "experiments": experiments,
    "robustness": robustness,
    "controls": controls,
    "pairs": pairs,
    "six_dof": six_dof,
}
