"""The arena: one page of submissions, and its numbers as CSV, from which the page can be made again."""
import csv
import io
import json
import math
import re
from dataclasses import dataclass, field
from pathlib import Path

from hapbench.columns import read_records
from hapbench_looks import look
from hapbench_report.markup import cell, command, heading_cell, in_colour, named, number, table, text
from hapbench_report.page import whole_page

from .law import Law
from .scores import Score, leads, pareto, score, tremor_bands
from .submission import FILE, TREMOR, read_parts
from .suite import Suite, SuiteError
from .verify import law_of

STYLE = Path(__file__).parent / "page.css"
ABOUT = ("suite", "label", "law", "kind", "division", "overrides", "licence", "law_sha256", "commit")
COLUMNS = (*ABOUT, "entry", "value", "low", "high", "worst", "failed")
PAIRS = (("force_error", "vibration"), ("way", "force_step"), ("inside", "felt_stiffness"), ("energy_created", "task"))
COST = "over_brute_force"
FRAME = 420, 320, 60, 40  # of a plot: width, height, and the room for the axes to the left and below
# What a passive law that passes 10 dB less tremor above 30 Hz passes more of it between 7.5 and 30 Hz [dB]: by Bode's integral, whose weight is
# 1 / omega^2, the ratio of 1/30 to 1/7.5 - 1/30.
DEBT_DB = 10 * (1 / 30) / (1 / 7.5 - 1 / 30)


@dataclass
class Row:
    """One submission."""

    about: dict
    scores: list  # of the suite's axes, in their order
    cost: dict  # scene: time of a step over brute force
    failures: list = field(default_factory=list)  # of (scene, seed, outcome)
    tremor: dict = field(default_factory=dict)  # of tremor_bands
    folder: Path | None = None  # of the submission; None: read from a CSV file
    replays: dict = field(default_factory=dict)  # (scene, seed): page that replays it, relative to the arena's
    front: bool = False

    def command(self):
        return " ".join(["hapbench suite run", self.about["suite"], *self._law(), *([f"--division open {sets}"] if (sets := self._sets()) else [])])

    def replay(self, suite, scene, seed):
        file = suite.file(scene)
        given = ["--seeds", str(seed + 1), "--jitter", f"{suite.jitter_m:g}"] if suite.jitter_of(scene) else []
        of = [] if self.about["kind"] == "built_in" else ["--plugin FILE"]
        return " ".join(["hapbench compare", f"scenarios/suites/{suite.name}/{file.name}", *of, "--algorithms", self.about["law"], self._sets(), *given,
                         "--set record.trajectory=true --html"]).replace("  ", " ")

    def submitted_law(self):
        """The Law itself, or None where it is not at hand."""
        if self.folder:
            return law_of(self.folder, json.loads((self.folder / FILE).read_text(encoding="utf-8")))
        return Law("built_in", self.about["law"], None, self._overrides()) if self.about["kind"] == "built_in" else None

    def _overrides(self):
        return [one for one in self.about["overrides"].split(" ") if one]

    def _law(self):
        kind = self.about["kind"]
        return [f"--{'algorithm ' + self.about['law'] if kind == 'built_in' else kind + ' FILE'}"]

    def _sets(self):
        return " ".join(f"--set '{one}'" for one in self._overrides())

    def look(self):
        return look(self.about["law"] if not self.about["overrides"] else self.about["label"])


def read_rows(files):
    """The suite and the submissions of folders and of CSV files that this page wrote."""
    rows, suite = [], None
    for file in files:
        found = rows_of_csv(file) if file.suffix == ".csv" else [row_of_folder(file)]
        for own, row in found:
            if suite is not None and own.name != suite.name:
                raise SuiteError(f"{file}: is of suite {own.name}, others are of {suite.name}; allowed: submissions to one suite")
            suite = own
            rows.append(row)
    for row, front in zip(rows, pareto([row.scores for row in rows])):
        row.front = front
    return suite, rows


def row_of_folder(folder):
    if not (folder / FILE).is_file():
        raise SuiteError(f"{folder}: holds no {FILE}; allowed: folders that \"hapbench suite run\" wrote, or a CSV file of \"suite page\"")
    about = json.loads((folder / FILE).read_text(encoding="utf-8"))
    suite = Suite(about["suite"])
    parts = read_parts(suite, folder)
    cost = {one["scene"]: one["over_brute_force"] for one in json.loads((folder / "cost.json").read_text(encoding="utf-8"))}
    failures = [(place, row["seed"], row["outcome"]) for place, part in parts.items() for row in part.get("rows", ()) if row["failed"]]
    failures += [(place, "", "no stable value") for place, part in parts.items() if "limit" in part and part["limit"]["felt_N_per_m"] is None]
    shown = {"commit": about["hapbench"]["commit"], "overrides": " ".join(about["overrides"])}
    return suite, Row({name: str({**about, **shown}[name] or "") for name in ABOUT}, [score(a, parts, suite.seeds) for a in suite.axes], cost, failures,
                      tremor_bands(suite, parts[TREMOR][TREMOR]) if suite.tremor else {}, folder)


def rows_of_csv(file):
    """Of the tables that arena_csv writes."""
    by_law = {}
    for line in read_records(file):
        by_law.setdefault(tuple(line[name] for name in ABOUT), []).append(line)
    for about, lines in by_law.items():
        suite = Suite(about[0])
        entries = {line["entry"]: line for line in lines}
        scores = []
        for axis in suite.axes:
            line = entries[axis.name]
            scores.append(Score(axis, *(float(line[name]) for name in ("value", "low", "high", "worst")), int(line["failed"]), ()))
        kinds = {entry: entry.split(" ") for entry in entries}
        yield suite, Row(dict(zip(ABOUT, about)), scores, {words[1]: float(entries[entry]["value"]) for entry, words in kinds.items() if words[0] == COST},
                         [(words[1], int(words[2]) if words[2] else "", entries[entry]["value"]) for entry, words in kinds.items() if words[0] == "failure"],
                         {words[1]: float(entries[entry]["value"]) for entry, words in kinds.items() if words[0] == TREMOR})


def write_replays(suite, rows, folder, say):
    """A page for the first failed run of each law in each scene, for the links of the table of failures. Of plugins and scripts only where
    the folder of the submission is given, which holds them."""
    for row in rows:
        first = {}
        for scene, seed, _ in row.failures:
            if scene in suite.scenes_run():
                first.setdefault(scene, seed)
        law = row.submitted_law() if first else None
        for scene, seed in first.items() if law else ():
            say(f"{row.about['label']} in {scene}")
            page = folder / f"{re.sub(r'[^A-Za-z0-9.]+', '_', row.about['label'])}_{scene}.html"
            law.replay(suite.file(scene), seed, suite.jitter_of(scene), page)
            row.replays[scene, seed] = f"{folder.name}/{page.name}"


def arena_csv(rows):
    """A line for each law and axis, then its times over brute force, the stiffness that tremor feels [N/m] and its failures."""
    out = io.StringIO()
    lines = csv.writer(out, lineterminator="\n")
    lines.writerow(COLUMNS)
    for row in rows:
        about = [row.about[name] for name in ABOUT]
        for one in row.scores:
            lines.writerow([*about, one.axis.name, *(f"{x:.6g}" for x in (one.value, one.low, one.high, one.worst)), one.failed])
        for scene, ratio in row.cost.items():
            lines.writerow([*about, f"{COST} {scene}", f"{ratio:.3g}", "", "", "", ""])
        for band, felt in row.tremor.items():
            lines.writerow([*about, f"{TREMOR} {band}", f"{felt:.6g}", "", "", "", ""])
        for scene, seed, outcome in row.failures:
            lines.writerow([*about, f"failure {scene} {seed}", outcome, "", "", "", ""])
    return out.getvalue()


def arena_page(suite, rows):
    sections = (
        ("summary", "Summary", "Summary", summary(suite, rows)),
        ("scores", "Scores", "Scores", scores_table(suite, rows)),
        ("pareto", "Pareto", "Two axes at a time", pareto_plots(suite, rows)),
        ("tremor", "Tremor", "Quiet against stiff", tremor_plot(rows)),
        ("radars", "Profiles", "Profile of each law", radars(suite, rows)),
        ("failures", "Failures", "Failures", failures_table(suite, rows)),
        ("repeat", "Repeat", "Repeat a row", repeats(rows)),
        ("history", "Versions", "Versions and provenance", history(rows)),
        ("axes", "Axes", "What is measured", axes_table(suite)),
    )
    return whole_page([one for one in sections if one[3]], title=f"hapbench arena, suite {suite.name}", further_style=STYLE.read_text(encoding="utf-8"))


def shown_name(row):
    return in_colour(row.look(), named(row.about["label"]))


def scale_of(axis):
    """Unit and factor in which an axis is shown."""
    return {"m": ("mm", 1e3), "J": ("mJ", 1e3)}.get(axis.unit, (axis.unit, 1))


def summary(suite, rows):
    front = ", ".join(shown_name(row) for row in rows if row.front)
    best = [next(row for row in rows if leads([other.scores for other in rows], row.scores, i)) for i in range(len(suite.axes))]
    winners = "".join(f"<li>{text(axis.title)}: {shown_name(row)}</li>" for axis, row in zip(suite.axes, best))
    return (f"<h1>Arena of force laws, suite {text(suite.name)}</h1><p>{len(rows)} submissions, each judged in {len(suite.scenes_run())} frozen scenes "
            f"with {suite.seeds} seeds and by {len(suite.limits)} limits, on {len(suite.axes)} axes. There is no total: which axis matters is the "
            f"reader's choice. No other law is as good on all axes and better on one as these, the Pareto front: {front}.</p>"
            f"<p>Best of each axis:</p><ul class=winners>{winners}</ul>")


def scores_table(suite, rows):
    headings = [heading_cell("Law"), heading_cell("Front"), heading_cell("Division")]
    for axis in suite.axes:
        headings.append(heading_cell(text(axis.title) + (" ↑" if axis.more_is_better else " ↓"), True, scale_of(axis)[0]))
    headings += [heading_cell("Failed", True), heading_cell("Time of a step", True, "of brute force")]
    body = []
    for row in rows:
        cells = [cell(shown_name(row), classes="name"), cell("●" if row.front else "", 0 if row.front else 1), cell(text(row.about["division"]))]
        for i, one in enumerate(row.scores):
            factor = scale_of(one.axis)[1]
            best = leads([other.scores for other in rows], row.scores, i)
            half = (one.high - one.low) / 2 * factor
            spread = f' <span class="unit">± {number(half, 1)}</span>' if half > 1e-4 * one.value * factor else ""
            cells.append(cell(("<b>" if best else "") + number(one.value * factor, 3) + ("</b>" if best else "") + spread, repr(one.value), "number"))
        cells.append(cell(str(len(row.failures)), len(row.failures), "number"))
        ratio = math.exp(sum(map(math.log, row.cost.values())) / len(row.cost)) if row.cost else None
        cells.append(cell(number(ratio, 2), "" if ratio is None else ratio, "number"))
        body.append(cells)
    caption = ("<b>Geometric means over scenes and seeds</b> ± half the 95 % interval over seeds; ↓ less is better, ↑ more is. Bold: the best. A run that "
               "failed counts as the axis's worst. The last column is measured on one machine and not verified. Click a heading to sort.")
    return table(headings, body, caption, "sortable", "scores-table")


def log_axis(values):
    """The ends of a logarithmic axis with some room beside the values."""
    low, high = min(values), max(values)
    room = (high / low) ** 0.08 if high > low else math.sqrt(math.e)
    return low / room, high * room


def pareto_plots(suite, rows):
    names = [axis.name for axis in suite.axes]
    return '<div class="plots">' + "".join(scatter(suite, rows, names.index(a), names.index(b)) for a, b in PAIRS if {a, b} <= set(names)) + "</div>"


def scatter(suite, rows, ix, iy):
    """Both axes logarithmic, the better end below and to the left."""
    width, height, left, bottom = FRAME
    ax, ay = suite.axes[ix], suite.axes[iy]
    spans = [log_axis([row.scores[i].value for row in rows]) for i in (ix, iy)]

    def place(axis, span, value, length):
        share = math.log(value / span[0]) / math.log(span[1] / span[0])
        return (1 - share if axis.more_is_better else share) * length

    places = [(left + place(ax, spans[0], row.scores[ix].value, width - left - 12),
               height - bottom - place(ay, spans[1], row.scores[iy].value, height - bottom - 12)) for row in rows]
    marks = marks_at(rows, places, [f"{said_of(row.scores[ix])}, {said_of(row.scores[iy])}" for row in rows])
    ends = "".join(f'<text class=tick x="{x}" y="{height - bottom + 14}" text-anchor="{anchor}">{value_text(ax, end)}</text>' for x, anchor, end in (
        (left, "start", spans[0][ax.more_is_better]), (width - 12, "end", spans[0][not ax.more_is_better])))
    ends += "".join(f'<text class=tick x="{left - 4}" y="{y}" text-anchor="end">{value_text(ay, end)}</text>' for y, end in (
        (height - bottom, spans[1][ay.more_is_better]), (20, spans[1][not ay.more_is_better])))
    said = f"{ax.title} against {ay.title}: {len(rows)} laws, the better the further down and left"
    return (f'<figure><svg viewBox="0 0 {width} {height}" role="img" aria-label="{text(said)}"><path class=frame d="M{left} 12V{height - bottom}H{width - 12}"/>'
            f'{ends}{marks}<text class=title x="{(left + width) / 2}" y="{height - 8}" text-anchor="middle">{text(ax.title)} (better to the left)</text>'
            f'<text class=title transform="translate(12 {height / 2 - 14}) rotate(-90)" text-anchor="middle">{text(ay.title)} (better below)</text></svg></figure>')


def marks_at(rows, places, said):
    """A dot and the name of each row at its place, filled for those on the front, which stand above the others."""
    width, height, _, bottom = FRAME
    marks, taken = [], [(x - 5, y - 5, x + 5, y + 5) for x, y in places]
    for row, (x, y), words in sorted(zip(rows, places, said), key=lambda one: not one[0].front):
        label = row.about["label"]
        one, short = row.look(), label if len(label) <= 30 else label[:29] + "…"
        at, anchor = label_place(short, x, y, width, height - bottom, taken)
        marks.append(f'<g class=run-name style="--light:{one.colour};--dark:{one.dark}"><circle cx="{x:.1f}" cy="{y:.1f}" r="{5 if row.front else 3.5}" '
                     f'fill="{"currentColor" if row.front else "none"}" stroke="currentColor" stroke-width="1.5"><title>{text(label)}: {words}</title></circle>'
                     f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" text-anchor="{anchor}">{text(short)}</text></g>')
    return "".join(marks)


def label_place(label, x, y, width, lowest, taken):
    """Where a label stands without covering one of `taken`, to which it is added: beside its mark, or a line above or below."""
    long = 5.9 * len(label)
    for shift in sorted(range(-99, 100, 11), key=abs):
        for anchor, from_x in (("start", x + 7), ("end", x - 7 - long)):
            box = (from_x, y + shift - 5, from_x + long, y + shift + 5)
            if box[0] > 58 and box[2] < width and 8 < box[1] and box[3] < lowest and not any(box[0] < t[2] and t[0] < box[2] and box[1] < t[3] and t[1] < box[3] for t in taken):
                taken.append(box)
                return (x + 7 if anchor == "start" else x - 7, y + shift + 3.5), anchor
    return (x + 7, y + 3.5) if x + 7 + long < width else (x - 7, y + 3.5), "start" if x + 7 + long < width else "end"


def said_of(one):
    return f"{one.axis.title} {value_text(one.axis, one.value)}"


def value_text(axis, value):
    unit, factor = scale_of(axis)
    return f"{number(value * factor, 2)} {unit}"


def tremor_plot(rows):
    """Each law by the stiffness that a still hand feels and by that which a trembling one feels above 30 Hz, with the curve that joins them."""
    shown = [row for row in rows if row.tremor]
    if not shown:
        return ""
    width, height, left, bottom = FRAME
    low, high = log_axis([row.tremor[band] for row in shown for band in ("rest", "high")])
    low /= 4  # room for the names of the softest
    share = lambda value: math.log(value / low) / math.log(high / low)
    at = lambda rest, above: (left + share(rest) * (width - left - 12), height - bottom - share(above) * (height - bottom - 12))
    line = lambda factor: "M{:.1f} {:.1f}L{:.1f} {:.1f}".format(*at(low * max(1, 1 / factor), low * max(1, factor)), *at(high * min(1, 1 / factor), high * min(1, factor)))
    quieter = 10 ** -0.5  # by 10 dB
    said = [", ".join(f"{number(row.tremor[band], 3)} N/m {words}" for band, words in (
        ("rest", "at rest"), ("low", "trembling at 8 to 16 Hz"), ("high", "at 32 to 128 Hz"))) for row in shown]
    end = at(high, high * quieter)
    return ('<p>A hand that trembles feels a law\'s stiffness as vibration. What a law without a memory renders for a still hand it renders for a '
            'trembling one: all such laws lie on the solid line. One with a memory may lie below it, but where it is passive, Bode\'s integral '
            f'holds: each 10 dB below the line (the dashed one) cost {number(DEBT_DB, 2)} dB more between 7.5 and 30 Hz, more with damping. So how stiff a law is '
            'and how quiet are not two choices but one.</p>'
            f'<div class="plots"><figure><svg viewBox="0 0 {width} {height}" role="img" aria-label="{len(shown)} laws by the stiffness felt at rest and by a trembling '
            f'hand above 30 Hz, on the line that joins both"><path class=frame d="M{left} 12V{height - bottom}H{width - 12}"/>'
            f'<path class=frame d="{line(1)}"/><path class=frame stroke-dasharray="5 4" d="{line(quieter)}"/>'
            f'<text class=tick x="{end[0]:.1f}" y="{end[1] + 22:.1f}" text-anchor="end">10 dB quieter</text>'
            + "".join(f'<text class=tick x="{x}" y="{height - bottom + 14}" text-anchor="{anchor}">{number(value, 2)} N/m</text>'
                      for x, anchor, value in ((left, "start", low), (width - 12, "end", high)))
            + marks_at(shown, [at(row.tremor["rest"], row.tremor["high"]) for row in shown], said)
            + f'<text class=title x="{(left + width) / 2}" y="{height - 8}" text-anchor="middle">stiffness felt at rest</text>'
            f'<text class=title transform="translate(12 {height / 2 - 14}) rotate(-90)" text-anchor="middle">felt by tremor above 30 Hz</text></svg></figure></div>')


def radars(suite, rows):
    """For each law a polygon: on each axis 1 for the best of all laws, 0 for the worst, logarithmic between."""
    spans = []
    for i, axis in enumerate(suite.axes):
        logs = [math.log(row.scores[i].value) for row in rows]
        spans.append((min(logs), max(logs)))
    return ('<p>Outside: the best of all laws on this axis; in the middle: the worst; logarithmic between.</p><div class="radars">'
            + "".join(radar(suite, row, spans) for row in rows) + "</div>")


def radar(suite, row, spans):
    size, r0, count = 260, 72, len(suite.axes)
    points, spokes = [], []
    for i, one in enumerate(row.scores):
        low, high = spans[i]
        share = 0.5 if high == low else (math.log(one.value) - low) / (high - low)
        share = share if one.axis.more_is_better else 1 - share
        angle = 2 * math.pi * i / count - math.pi / 2
        c, s = math.cos(angle), math.sin(angle)
        points.append(f"{size / 2 + r0 * (0.06 + 0.94 * share) * c:.1f},{size / 2 + r0 * (0.06 + 0.94 * share) * s:.1f}")
        anchor = "middle" if abs(c) < 0.2 else "start" if c > 0 else "end"
        spokes.append(f'<path class=frame d="M{size / 2} {size / 2}L{size / 2 + r0 * c:.1f} {size / 2 + r0 * s:.1f}"/><text class=tick x="{size / 2 + (r0 + 5) * c:.1f}" '
                      f'y="{size / 2 + (r0 + 8) * s + 3:.1f}" text-anchor="{anchor}">{text(one.axis.name.replace("_", " "))}</text>')
    one, said = row.look(), f"{row.about['label']}: profile over {count} axes; the numbers are in the table of scores"
    return (f'<figure class=run-name style="--light:{one.colour};--dark:{one.dark}"><figcaption>{shown_name(row)}</figcaption><svg viewBox="0 0 {size} {size}" role="img" '
            f'aria-label="{text(said)}">{"".join(spokes)}<polygon points="{" ".join(points)}" fill="currentColor" fill-opacity=".18" stroke="currentColor" '
            'stroke-width="1.8"/></svg></figure>')


def failures_table(suite, rows):
    def replay(row, scene, seed, outcome):
        page = row.replays.get((scene, seed))
        return f'<a href="{text(page)}">{text(outcome)}</a>' if page else text(outcome)

    body = [[cell(shown_name(row), classes="name"), cell(named(scene)), cell(str(seed), seed, "number"), cell(replay(row, scene, seed, outcome.replace("_", " "))),
             cell(f"<code>{text(row.replay(suite, scene, seed))}</code>" if scene in suite.scenes else "")]
            for row in rows for scene, seed, outcome in row.failures]
    if not body:
        return "<p>None.</p>"
    headings = [heading_cell("Law"), heading_cell("Scene"), heading_cell("Seed", True), heading_cell("Outcome"), heading_cell("Command to replay it, with a page")]
    return table(headings, body, "<b>Runs that ended otherwise than their scene allows</b>", "sortable")


def repeats(rows):
    return "<p>The same hashes on any machine, with the commit that stands below:</p>" + command("\n".join(row.command() for row in rows))


def history(rows):
    headings = [heading_cell(name) for name in ("Law", "Suite", "hapbench", "Kind", "Licence", "SHA-256 of the law")]
    body = [[cell(shown_name(row), classes="name"), cell(text(row.about["suite"])), cell(text(row.about["commit"])), cell(text(row.about["kind"].replace("_", " "))),
             cell(text(row.about["licence"])), cell(f"<code>{text(row.about['law_sha256'][:16])}</code>")] for row in rows]
    return table(headings, body, "<b>With what each row was computed</b> A law may be there once for each version", "sortable")


def axes_table(suite):
    headings = [heading_cell("Axis"), heading_cell("Better"), heading_cell("Numbers", True), heading_cell("A failure counts as", True), heading_cell("Scenes and metrics")]
    body = []
    for axis in suite.axes:
        scenes = {}
        for place, metric in axis.values:
            scenes.setdefault(metric or "limit", []).append(place)
        said = "; ".join(f"<code>{text(metric)}</code> in {', '.join(map(named, places))}" for metric, places in scenes.items())
        body.append([cell(text(axis.title)), cell("more" if axis.more_is_better else "less"), cell(str(len(axis.values)), classes="number"),
                     cell(value_text(axis, axis.failed), classes="number"), cell(said)])
    return table(headings, body)
