"""Verification: a random third of a submission is computed again and compared by its hashes, and seeds that nobody could know beforehand
are judged against its scores."""
import hashlib
import json
import math
import random
import secrets
from pathlib import Path

from .law import Law
from .scores import agrees, row_of, score
from .submission import FILE, SCORES, TREMOR, compute, places, read_parts, scores_csv
from .suite import Suite, SuiteError

HELD_BACK = 3  # seeds
GREATEST_SEED = 2**31 - 1


def law_of(folder, about):
    """The law as the submission keeps it."""
    law = Law(about["kind"], about["law"], None, about["overrides"])
    for name, expected in about["files"].items():
        file = folder / "law" / name
        if not file.is_file() or hashlib.sha256(file.read_bytes()).hexdigest() != expected:
            raise SuiteError(f"{file}: is not the file that was submitted; allowed: one with sha256 {expected}")
        if expected == about["law_sha256"]:
            law.file = file
    return law.find_name()


def verify(folder, jobs, draw, say):
    """What differs, as a list of sentences; `draw` repeats an earlier verification. `say(text)` is told what is done."""
    folder = Path(folder)
    if not (folder / FILE).is_file():
        raise SuiteError(f"{folder}: holds no {FILE}; allowed: a folder that \"hapbench suite run\" wrote")
    about = json.loads((folder / FILE).read_text(encoding="utf-8"))
    suite = Suite(about["suite"])
    suite.check()
    if suite.hash != about["suite_sha256"]:
        raise SuiteError(f"{folder}: is of another state of suite {suite.name}")
    law = law_of(folder, about)
    differs, parts = [], read_parts(suite, folder)
    version = law.reply("--version")
    if version["commit"] != about["hapbench"]["commit"]:
        differs.append(f"hapbench is commit {version['commit']} here, {about['hapbench']['commit']} there: numbers may differ by that alone")
    if scores_csv([score(axis, parts, suite.seeds) for axis in suite.axes]) != (folder / SCORES).read_text(encoding="utf-8"):
        differs.append(f"{SCORES}: are not the scores of its parts")
    draw = secrets.randbelow(2**32) if draw is None else draw
    chance = random.Random(draw)
    drawn = sorted(chance.sample(places(suite), math.ceil(len(places(suite)) / 3)))
    for place in drawn:
        say(f"{place} again")
        differs += differences(place, parts[place], compute(suite, law, place, jobs))
    others = dict(parts)
    for place in suite.scenes_run():
        if suite.seeds_of(place) > 1:
            say(f"{place} with other seeds")
            seed = chance.randint(10**6, GREATEST_SEED)
            found = law.compare(suite.file(place), HELD_BACK, suite.jitter_of(place), jobs, seed)
            others[place] = {"rows": [row_of(summary, k) for k, summary in enumerate(found)]}
    for axis in suite.axes:
        submitted, held_back = score(axis, parts, suite.seeds), score(axis, others, HELD_BACK)
        if not agrees(submitted, held_back):
            differs.append(f"{axis.name}: {held_back.value:.4g} with seeds held back, {submitted.value:.4g} in the submission, beyond what its "
                           "spread over seeds lets expect")
    return draw, drawn, differs


def differences(place, submitted, found):
    """Every run and number of a part that is not what it was."""
    if TREMOR in submitted:
        if submitted != found:
            yield f"{place}: {found[TREMOR]}, submitted {submitted[TREMOR]}"
        return
    if "limit" in submitted:
        if submitted["limit"] != found["limit"]:
            yield f"{place}: limit {found['limit']['limit']}, submitted {submitted['limit']['limit']}"
        return
    for old, new in zip(submitted["rows"], found["rows"], strict=True):
        if old["state_hash"] != new["state_hash"]:
            yield f"{place}, seed {old['seed']}: state hash {new['state_hash']}, submitted {old['state_hash']}"
        elif old != new:
            other = next((n for n in new["numbers"] if new["numbers"][n] != old["numbers"].get(n)), "outcome")
            yield f"{place}, seed {old['seed']}: {other} is {new['numbers'].get(other, new['outcome'])}, submitted {old['numbers'].get(other, old['outcome'])}"
