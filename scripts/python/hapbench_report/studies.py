"""Tables that hapbench writes beside runs as CSV (stability limits, comparisons, times): folded,
with units in their heads."""
from dataclasses import dataclass
from pathlib import Path

from hapbench.columns import read_rows

from .json_input import at, number_or_none
from .markup import cell, column, counted, folded, heading_cell, number_cell, table, text

# The limits of a spring, which stand beside the published ones.
LIMITS = ("spring_stiffness/limit.csv", "spring_damping/limit.csv", "spring_time_step/limit.csv")
# A longer one is the data of a figure, not a table to read.
MOST_ROWS = 100


@dataclass
class Study:
    path: str  # of its file, relative to the results
    header: list
    rows: list

    @property
    def title(self):
        return Path(self.path).stem.replace("_", " ")

    @property
    def anchor(self):
        return "study-" + "".join(c if c.isalnum() else "-" for c in self.path)


def load_study(file: Path, results: Path):
    return Study(file.relative_to(results).as_posix(), *read_rows(file))


def load_studies(results: Path):
    """The CSV tables that stand beside runs rather than in one."""
    files = [file for file in sorted(results.rglob("*.csv"))
             if not file.with_name("summary.json").exists() and is_table(file.relative_to(results))]
    return [study for study in (load_study(file, results) for file in files) if len(study.rows) <= MOST_ROWS]


def is_table(path: Path):
    return path.as_posix() in LIMITS or (path.parts[0] != "replay" and path.name not in ("limit.csv", "limit_runs.csv"))


def studies_section(studies):
    # Limits and times have places of their own.
    others = [s for s in studies if s.path not in LIMITS and not s.path.endswith("_timing.csv")]
    shown = "".join(study_table(study) for study in others)
    return shown or '<p class="note">No studies among these results.</p>'


def study_table(study):
    columns = list(zip(*study.rows)) or [()] * len(study.header)
    numeric = [all(is_number(value) for value in values) for values in columns]
    heads = [column(name, [float(v) for v in values if is_number(v)]) for name, values in zip(study.header, columns)]
    rows = [[study_cell(value, factor) for value, (_, _, factor) in zip(row, heads)] for row in study.rows]
    headings = [heading_cell(text(title), right, unit) for (title, unit, _), right in zip(heads, numeric)]
    summary = (f"{text(study.title)} <span class=note>{counted(len(rows), 'row')}, "
               f"<code>{text(study.path)}</code></span>")
    return folded(summary, table(headings, rows, f"<b>{text(study.title)}</b>", "sortable"), study.anchor)


def is_number(value):
    try:
        return number_or_none(float(value)) is not None
    except ValueError:
        return False


def study_cell(value, factor):
    return number_cell(float(value) * factor) if is_number(value) else cell(text(value))


def timing_section(runs, studies):
    timed = [run for run in runs if run.timing]
    rows = [[cell(f'<a href="#{run.anchor}">{text(run.path)}</a>'), cell(text(run.algorithm)),
             number_cell(in_microseconds(run), 3), number_cell(at(run.timing, "/shell_s"), 3),
             number_cell(at(run.timing, "/loop_s"), 3), cell(text(at(run.timing, "/build/instruction_set") or "–"))]
            for run in timed]
    headings = [heading_cell("Run"), heading_cell("Algorithm"), heading_cell("Mean step", True, "µs"),
                heading_cell("Shell", True, "s"), heading_cell("Loop", True, "s"), heading_cell("Instruction set")]
    of_runs = folded(f"Runs that recorded their time <span class=note>{counted(len(rows), 'run')}</span>",
                     table(headings, rows, "<b>Runs that recorded their time</b>", "sortable")) if rows else ""
    of_studies = "".join(study_table(study) for study in studies if study.path.endswith("_timing.csv"))
    note = ("<p>Wall times on the machine named under provenance; the only numbers here that differ from run to run. "
            "The trainer's loop has 488 µs per step (2048 Hz).</p>")
    return note + (of_runs + of_studies or '<p class="note">No times were recorded (<code>--set record.timing=true</code>).</p>')


def in_microseconds(run):
    seconds = number_or_none(at(run.timing, "/step_mean_s"))
    return None if seconds is None else 1e6 * seconds
