"""Runs of a comparison by scene and law, with mean, spread, error and rank of each metric. The rules are those of
scenarios/batch/ranking.hpp, so that pictures and pages agree with ranking.csv."""
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from hapbench.columns import read_records
from hapbench.results import at, number_or_none

from .given import field_entries, plain, seed_of

FAILURES = ("not_dragged", "stuck", "no_contact", "lost_contact", "went_through", "diverges")
FREE = (None, "free")
RESOLUTION = 1e-3  # means with a smaller relative difference share a rank
RANKING = "ranking.csv"
USUAL = ("force_rms_above_30Hz_N", "force_step_p99_N", "inside_max_m")


def failed(run):
    """Returns True if the metrics of a run say nothing about its law: the outcome is a failure, or not an expected
    outcome. A tool on a prescribed path that went through the surface has not failed."""
    wanted = at(run.scenario, "/expect/outcome")
    wanted = [wanted] if isinstance(wanted, str) else wanted
    led = run.outcome == "went_through" and at(run.scenario, "/motion/position/type") not in FREE
    return not led and (run.outcome in FAILURES or bool(wanted) and run.outcome not in wanted)


def value_of(run, metric):
    """Returns a metric of the section "metrics", or of another section if `metric` is SECTION.NAME; None if it is not
    a finite number."""
    section, _, name = metric.rpartition(".")
    values = run.summary.get(section or "metrics")
    return number_or_none(values.get(name)) if isinstance(values, dict) else None


def tolerance_of(run, metric):
    section, _, name = metric.rpartition(".")
    return run.tolerance(section or "metrics", name)


@dataclass
class Entry:
    """One law in one scene for one metric."""

    values: dict  # value by number of the repetition (seed), without failed runs
    others: dict  # part of `values` that is not in the mean, because another law failed in the repetition
    mean: float | None = None  # mean over the common repetitions
    spread: float | None = (
        None  # standard deviation; None for one repetition, or if the seed changes nothing
    )
    tolerance: float | None = None  # bound of the error of the mean: mean of the runs' error bounds
    rank: int | None = None

    @property
    def error(self):
        return self.tolerance or 0.0

    @property
    def shown_error(self):
        """Error that determines the number of digits of the mean, as in the ranking that `compare` prints. It is the
        largest of three values: the error of the mean, the standard error over seeds, and a tenth of RESOLUTION times
        the mean. If the entry has no spread, the tolerance is returned instead."""
        if self.spread is None or self.mean is None:
            return self.tolerance
        of_seeds = self.spread / np.sqrt(len(self.values) - len(self.others))
        return max(self.error, of_seeds, 0.1 * RESOLUTION * abs(self.mean))

    @property
    def bound(self):
        """Largest magnitude that the metric may have: the magnitude of the mean plus its error."""
        return abs(self.mean) + self.error

    @property
    def seeds_agree(self):
        """True if the spread over the seeds is at most the fraction RESOLUTION of the mean."""
        return self.spread is not None and self.spread <= RESOLUTION * abs(self.mean or 0.0)

    @property
    def is_unknown(self):
        """True if the error is at least the magnitude of the mean, so that only a bound of the metric is known."""
        return self.mean is not None and self.error > 0 and self.error >= abs(self.mean)


@dataclass
class Law:
    """Runs of one law in one scene that differ only in the seed."""

    label: str
    algorithm: str
    runs: dict = field(default_factory=dict)  # run by number of the repetition (seed)

    @cached_property
    def failures(self):
        """Outcomes of the failed runs, by number of the repetition."""
        return {seed: run.outcome for seed, run in self.runs.items() if failed(run)}

    def values(self, metric):
        found = {
            seed: value_of(run, metric)
            for seed, run in self.runs.items()
            if seed not in self.failures
        }
        return {seed: value for seed, value in found.items() if value is not None}


class Scene:
    """The laws of one scene."""

    def __init__(self, name, laws, better=None):
        self.name, self.laws = name, laws
        self.better = better or {}  # for each metric with a better direction: "less" or "more"

    @cached_property
    def seeds(self):
        """Repetitions (seeds) over which means are computed. Laws that failed in all repetitions are ignored. The
        result has the repetitions in which every other law has a run that did not fail. If there is no such repetition,
        it has the repetitions that all laws without any failure have in common. If these laws have no common
        repetition, it has all repetitions."""
        succeeding = [law for law in self.laws if len(law.failures) < len(law.runs)]
        for laws in (succeeding, [law for law in self.laws if not law.failures]):
            shared = [set(law.runs) - set(law.failures) for law in laws]
            common = set.intersection(*shared) if shared else set()
            if common:
                return common
        return set().union(*(law.runs for law in self.laws))

    @cached_property
    def lacks_common_seeds(self):
        """True if the means of different laws are over different repetitions, because in every repetition a law failed
        that succeeded in another repetition."""
        has_failures = any(0 < len(law.failures) < len(law.runs) for law in self.laws)
        return has_failures and self.seeds == set().union(*(law.runs for law in self.laws))

    @cached_property
    def depends_on_seed(self):
        return any(len({run.state_hash for run in law.runs.values()}) > 1 for law in self.laws)

    def entries(self, metric):
        """Returns the Entry of each law by label, in the order of the laws."""
        found = {law.label: self.entry(law, metric) for law in self.laws}
        direction = self.better.get(metric)
        if direction and any(of.mean is not None for of in found.values()):
            ranked = [(len(law.failures), found[law.label]) for law in self.laws]
            for pair in ranked:
                pair[1].rank = 1 + sum(is_better(*other, *pair, direction) for other in ranked)
            for failures, entry in ranked:
                if entry.is_unknown and not failures:
                    entry.rank = None
            if len({entry.rank for _, entry in ranked} - {None}) < 2:
                for _, entry in ranked:
                    entry.rank = None
        return found

    def ranks(self, metric):
        """Returns the rank of each law by label. All ranks are None if the metric has no better direction, or if all
        laws would have the same rank. The rank of a law without failures is None if only a bound of its mean is known.
        """
        return {label: of.rank for label, of in self.entries(metric).items()}

    def entry(self, law, metric):
        values = law.values(metric)
        common = [value for seed, value in values.items() if seed in self.seeds]
        errors = [
            tolerance
            for seed, run in law.runs.items()
            if seed in self.seeds and seed not in law.failures
            for tolerance in [tolerance_of(run, metric)]
            if tolerance is not None
        ]
        return Entry(
            values,
            {seed: value for seed, value in values.items() if seed not in self.seeds},
            float(np.mean(common)) if common else None,
            float(np.std(common, ddof=1)) if len(common) > 1 and self.depends_on_seed else None,
            float(np.mean(errors)) if errors else None,
        )

    def sorted_laws(self, metric):
        """Returns the laws, sorted by the number of failures. Laws with the same number of failures are sorted by the
        mean, best first; laws without a mean follow."""
        found, sign = self.entries(metric), -1 if self.better.get(metric) == "more" else 1

        def key(law):
            mean = found[law.label].mean
            return len(law.failures), mean is None, sign * (mean or 0.0)

        return sorted(self.laws, key=key)


def is_better(failures, entry, other_failures, other, direction):
    """Returns True if the first law ranks before the other law."""
    if failures != other_failures:
        return failures < other_failures
    if failures or entry.mean is None:
        return False
    if other.mean is None:
        return True
    sign = -1 if direction == "more" else 1
    more = sign * (other.mean - entry.mean)
    return more > entry.error + other.error and more > RESOLUTION * max(
        abs(entry.mean), abs(other.mean)
    )


def scenes_of(runs, words=()):
    """Returns the Scene objects of these runs, each with its laws. `words`: the given folders; their ranking.csv states
    the better direction of each metric."""
    scenes, better = {}, directions(words)
    for run, fields in zip(runs, field_entries(runs)):
        laws = scenes.setdefault(run.name, {})
        label = ", ".join([plain(run), *fields])
        law = laws.setdefault(label, Law(label, run.algorithm))
        seed = seed_of(run)
        law.runs[seed if seed not in law.runs else f"{seed}, {run.path}"] = run
    return [Scene(name, list(laws.values()), better) for name, laws in scenes.items()]


def directions(words):
    """Returns the better direction ("less" or "more") by metric, from the files ranking.csv in these folders."""
    return {
        row["metric"]: row["better"]
        for word in words
        for file in [word / RANKING]
        if file.is_file()
        for row in read_records(file)
        if row["better"]
    }


def has_repetitions(scenes):
    """Returns True if some law has several runs with different seeds. Returns False if the same run is in several
    folders."""
    laws = [law for scene in scenes for law in scene.laws]
    is_copied = any(isinstance(seed, str) for law in laws for seed in law.runs)
    return not is_copied and any(len(law.runs) > 1 for law in laws)
