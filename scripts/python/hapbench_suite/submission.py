"""A submission: a folder with the law, a part for each scene and limit, and the scores of all of them. A part that is there is not
computed again, so that an interrupted run goes on, and shards that share the folder make one submission."""
import csv
import io
import json
import tempfile
from pathlib import Path

from hapbench_command import write

from .law import Law, set_words
from .scores import row_of, score
from .suite import SuiteError

FILE, PARTS, SCORES, RUNS = "submission.json", "parts", "scores.csv", "runs.csv"
TREMOR = "tremor"
REPEATS = 5  # of each timed run, of which the least counts


def places(suite):
    """Names of the parts: scenes that are run, limits, the tremor."""
    return [*suite.scenes_run(), *suite.limits, *([TREMOR] if suite.tremor else [])]


class Submission:
    def __init__(self, suite, law, folder, licence="", sources=()):
        self.suite, self.law, self.folder = suite, law, Path(folder)
        commit = law.reply("--version")
        self.about = {"suite": suite.name, "suite_sha256": suite.hash, "law": law.name, "label": law.label(), "kind": law.kind,
                      "division": "open" if law.overrides else "closed", "overrides": law.overrides, "licence": licence,
                      "law_sha256": law.hash(), "hapbench": commit, "seeds": suite.seeds}
        self.sources = sources

    def begin(self):
        """Takes the folder, or goes on in it. Raises SuiteError for one of another submission."""
        found = self.folder / FILE
        if found.is_file():
            old = json.loads(found.read_text(encoding="utf-8"))
            other = next((key for key in self.about if key != "licence" and old.get(key) != self.about[key]), None)
            if other:
                raise SuiteError(f"{self.folder}: holds another submission ({other}: {old.get(other)}); allowed: --out with another folder")
        kept = self.law.keep(self.folder / "law", self.sources)
        write(found, json.dumps(self.about | {"files": kept}, indent=1) + "\n")

    def part_file(self, place):
        return self.folder / PARTS / f"{place}.json"

    def missing(self, shard=(0, 1)):
        return [place for i, place in enumerate(places(self.suite)) if i % shard[1] == shard[0] and not self.part_file(place).is_file()]

    def compute(self, place, jobs):
        part = compute(self.suite, self.law, place, jobs)
        write(self.part_file(place), json.dumps(part, indent=1) + "\n")

    def finish(self):
        """Scores, tables and times, once all parts are there."""
        parts = read_parts(self.suite, self.folder)
        scores = [score(axis, parts, self.suite.seeds) for axis in self.suite.axes]
        cost = self.folder / "cost.json"
        if not cost.is_file():
            write(cost, json.dumps(timed(self.suite, self.law), indent=1) + "\n")
        write(self.folder / SCORES, scores_csv(scores))
        write(self.folder / RUNS, runs_csv(parts))
        return scores, json.loads(cost.read_text(encoding="utf-8")), parts


def compute(suite, law, place, jobs):
    """The part of a scene or limit, or of the tremor."""
    if place == TREMOR:
        one = suite.tremor
        return {TREMOR: law.tremor(suite.file(one["scene"]), one["vary"], [one["rest_Hz"], *one["low_Hz"], *one["high_Hz"]])}
    if place in suite.limits:
        limit = suite.limits[place]
        return {"limit": law.limit(suite.file(limit["scene"]), limit["vary"], limit["between"], limit["resolution"], limit.get("set", ()))}
    seeds = suite.seeds_of(place)
    summaries = law.compare(suite.file(place), seeds, suite.jitter_of(place), jobs)
    return {"rows": [row_of(summary, k) for k, summary in enumerate(summaries)]}


def read_parts(suite, folder):
    parts = {}
    for place in places(suite):
        file = Path(folder) / PARTS / f"{place}.json"
        if not file.is_file():
            raise SuiteError(f"{file}: is missing; allowed: a folder that \"hapbench suite run\" has finished")
        parts[place] = json.loads(file.read_text(encoding="utf-8"))
    return parts


def timed(suite, law):
    """Time of a step of each scene of the column of cost, over that of the law `summation` with every skip turned off, on this machine."""
    brute, rows = Law(name="summation"), []
    for scene in suite.cost:
        best = {}
        for _ in range(REPEATS):  # taking turns, so that a machine that slows down slows both
            for name, one, more in (("law", law, ()), ("brute_force", brute, ("--no-skip",))):
                words = ["run", suite.file(scene), *set_words([f"rendering.algorithm={one.name}", *one.overrides]), *more]
                best[name] = min(best.get(name, 1e300), _seconds(one, words))
        rows.append({"scene": scene, "over_brute_force": best["law"] / best["brute_force"], "us_per_step": 1e6 * best["law"]})
    return rows


def _seconds(law, words):
    with tempfile.TemporaryDirectory(prefix="hapbench-suite-") as scratch:
        law.reply(*words, "--set", "record.timing=true", "--out", scratch)
        timing = json.loads((Path(scratch) / "timing.json").read_text(encoding="utf-8"))
        return timing["loop_s"] / timing["steps"]


def scores_csv(scores):
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["axis", "unit", "score", "low", "high", "worst", "failed"])
    for one in scores:
        table.writerow([one.axis.name, one.axis.unit, *(repr(float(f"{x:.6g}")) for x in (one.value, one.low, one.high, one.worst)), one.failed])
    return text.getvalue()


def runs_csv(parts):
    """A row for each run, with its hash, and for each limit."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["place", "seed", "outcome", "state_hash", "limit"])
    for place, part in parts.items():
        for row in part.get("rows", ()):
            table.writerow([place, row["seed"], row["outcome"], row["state_hash"], ""])
        if "limit" in part:
            table.writerow([place, "", part["limit"]["class_above"], "", part["limit"]["limit"]])
    return text.getvalue()
