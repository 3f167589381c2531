"""The tables of targets as Markdown, and their place in the manual of the tests."""
import json

from .program import ROOT, BenchError

RECORD = ROOT / "results" / "reference" / "performance.json"
MANUAL = ROOT / "tests" / "README.md"

BEGIN = "<!-- performance: scripts/bench --record writes what follows, from results/reference/performance.json -->"
END = "<!-- /performance -->"
SCALES = {"s": ((1, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns")), "B": ((1e6, "MB"), (1, "B")), "": ((1, ""),)}


def record():
    """The record of scripts/bench --record."""
    return json.loads(RECORD.read_text(encoding="utf-8"))


def quantity(value, unit):
    """Three digits with the largest unit that leaves a number of at least one."""
    scale, name = next(((s, n) for s, n in SCALES[unit] if abs(value) >= s), SCALES[unit][-1])
    return f"{number(value / scale)} {name}".strip()


def number(value):
    """Three digits, with an exponent only where the zeros would have to be counted."""
    if value and abs(value) < 1e-3:
        return f"{value:.3g}".replace("e-0", "e-")
    return f"{value:.0f}" if abs(value) >= 1e3 else f"{value:.3g}"


def spread(row):
    """Half the distance of the quartiles, as part of the median."""
    return f"± {50 * (row['high'] - row['low']) / row['ratio']:.0f} %"


def met(value, at_most):
    return "" if at_most is None else "yes" if value <= at_most else "**no**"


def markdown(performance):
    """All of it: where it was measured, ratios, limits."""
    machine = performance["machine"]
    lines = [f"{machine['cpu']}, {machine['processors']} processors, {machine['instruction_set']}; {machine['compiler']},",
             f"{machine['flags']};", f"commit {performance['commit']}, {performance['date']}.",
             f"Medians of {performance['repetitions']} interleaved repetitions, half their quartile range after ±.", "",
             "| what | over | ratio | target | met | takes |", "|---|---|---|---|---|---|"]
    for row in performance["ratios"]:
        target = "" if row["at_most"] is None else f"≤ {number(row['at_most'])}"
        lines.append(f"| {row['what']} | {row['over']} | {number(row['ratio'])} {spread(row)} | {target} | {met(row['ratio'], row['at_most'])} | "
                     f"{quantity(row['seconds'], 's')} |")
    lines += ["", "| what | measured | limit | met |", "|---|---|---|---|"]
    for row in performance["limits"]:
        lines.append(f"| {row['what']} | {quantity(row['value'], row['unit'])} | ≤ {quantity(row['at_most'], row['unit'])} | "
                     f"{met(row['value'], row['at_most'])} |")
    return "\n".join(lines) + "\n"


def aligned(text):
    """The same with columns of equal width, for a terminal."""
    out, rows = [], []
    for line in [*text.splitlines(), ""]:
        if line.startswith("|"):
            rows.append([cell.strip().replace("`", "").replace("**", "") for cell in line.strip("|").split("|")])
            continue
        widths = [max(map(len, column)) for column in zip(*rows)]
        out += ["  ".join(("-" * w if set(cell) == {"-"} else cell.ljust(w)) for cell, w in zip(row, widths)).rstrip()
                for row in rows]
        rows = []
        out.append(line)
    return "\n".join(out).rstrip() + "\n"


def spliced(document, text, begin=BEGIN, end=END):
    """The document with what stands between the marks replaced."""
    head, found, rest = document.partition(begin)
    _, ended, tail = rest.partition(end)
    if not (found and ended):
        raise BenchError(f"tests/README.md: no place for the table; needed are the lines {begin} and {end}")
    return f"{head}{begin}\n\n{text}\n{end}{tail}"
