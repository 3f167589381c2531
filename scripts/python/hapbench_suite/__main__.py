"""`hapbench suite`: run, verify, page and freeze."""
import os
import sys
from pathlib import Path

from hapbench_command import BAD_INPUT, FAILED, INTERRUPTED, SUCCESS, Arguments, Notice, say_error, unwritable, write

from .law import Law
from .submission import Submission
from .suite import Suite, SuiteError
from .verify import verify

UNEXPECTED = 3  # a submission that is not what it says


def arguments(words):
    parser = Arguments(prog="hapbench suite")
    parser.add_argument("what")
    parser.add_argument("--name", action="append", default=[], dest="names")
    parser.add_argument("--algorithm", default="")
    parser.add_argument("--plugin", type=Path)
    parser.add_argument("--python", type=Path)
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--division", default="closed")
    parser.add_argument("--licence", default="")
    parser.add_argument("--source", type=Path, action="append", default=[])
    parser.add_argument("--shard", default="0/1")
    parser.add_argument("--begin", action="store_true")  # makes the folder and says where it is
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--draw", type=int)
    parser.add_argument("--replays", action="store_true")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--quiet", action="store_true")
    return parser.parse_args(words)


def asked_law(given):
    """The law of the options."""
    if given.plugin and given.python:
        raise SuiteError("--plugin and --python: allowed: one of them")
    for file in [f for f in (given.plugin, given.python, *given.source) if f]:
        if not file.is_file():
            raise SuiteError(f"{file}: no such file")
    if given.set and given.division != "open":
        raise SuiteError("--set: fields are set in the open division only; allowed: --division open")
    other = next((one for one in given.set if not one.startswith("rendering.")), None)
    if other:
        raise SuiteError(f"--set {other}: a suite's scenes are frozen; allowed: fields of rendering")
    file = given.plugin or given.python
    law = Law("plugin" if given.plugin else "python" if given.python else "built_in", given.algorithm, file and file.resolve(), given.set)
    return law.find_name()


def shard_of(word):
    own, _, of = word.partition("/")
    if not (own.isdigit() and of.isdigit() and int(own) < int(of)):
        raise SuiteError(f"--shard {word}: allowed: i/n with i from 0 to n - 1")
    return int(own), int(of)


def one_name(given, what):
    if len(given.names) != 1:
        raise SuiteError(f"suite {given.what}: takes {what}; got {len(given.names)}")
    return given.names[0]


def run(given):
    suite, law = Suite(one_name(given, "a suite, as 1")), asked_law(given)
    suite.check()
    folder = given.out or Path("results/out") / f"suite_{suite.name}_{'_'.join(law.label().split())}".replace('"', "").replace("/", "_")
    submission = Submission(suite, law, folder, given.licence, given.source)
    submission.begin()
    if given.begin:
        print(folder.resolve())
        return SUCCESS
    shard = shard_of(given.shard)
    todo = submission.missing(shard)
    with Notice(f"suite {suite.name}") as notice:
        for i, place in enumerate(todo):
            notice.say(f"{place}, {i + 1} of {len(todo)}")
            submission.compute(place, given.jobs)
        if submission.missing():
            if not given.quiet:
                print(f"{len(submission.missing())} parts are left to other shards; \"hapbench suite run {suite.name}\" with this --out finishes\n{folder}")
            return SUCCESS
        notice.say("times")
        scores, cost, _ = submission.finish()
    if not given.quiet:
        print(table_of(law, scores, cost, folder))
    return SUCCESS


def table_of(law, scores, cost, folder):
    lines = [f"{law.label()}, geometric means over scenes and seeds", "",
             f"{'axis':<38} {'unit':<6} {'score':>10} {'95 % from':>10} {'to':>10} {'worst seed':>10} {'failed':>6}"]
    for one in scores:
        better = "more" if one.axis.more_is_better else "less"
        lines.append(f"{one.axis.title + ' (' + better + ')':<38} {one.axis.unit:<6} {one.value:>10.4g} {one.low:>10.4g} {one.high:>10.4g} "
                     f"{one.worst:>10.4g} {one.failed:>6}")
    ratios = ", ".join(f"{row['over_brute_force']:.3g} in {row['scene']}" for row in cost)
    return "\n".join([*lines, "", f"time of a step over brute force: {ratios}", f"results in {folder}", f"next: hapbench suite verify {folder}"])


def check(given):
    folder = one_name(given, "the folder of a submission")
    with Notice("verifying") as notice:
        draw, drawn, differs = verify(folder, given.jobs, given.draw, notice.say)
    if not given.quiet:
        print(f"computed again: {', '.join(drawn)}; and other seeds of every scene (--draw {draw} repeats it)")
        print("\n".join(differs) if differs else f"{folder}: verified, every hash and number the same")
    return UNEXPECTED if differs else SUCCESS


def page(given):
    from .page import arena_csv, arena_page, read_rows, write_replays
    if not given.names:
        raise SuiteError("suite page: takes folders of submissions, or a CSV file of this command; got none")
    file = given.out or Path("results/out/arena.html")
    suite, rows = read_rows([Path(name) for name in given.names])
    if given.replays:
        with Notice("replays") as notice:
            write_replays(suite, rows, file.resolve().parent / f"{file.stem}_replays", notice.say)
    write(file, arena_page(suite, rows))
    write(file.with_suffix(".csv"), arena_csv(rows))
    if not given.quiet:
        print(f"page of {len(rows)} submissions in {file}, its numbers in {file.with_suffix('.csv')}")
    return SUCCESS


def freeze(given):
    Suite(one_name(given, "the folder of a suite")).freeze()
    return SUCCESS


COMMANDS = {"run": run, "verify": check, "page": page, "freeze": freeze}


def main(words):
    given = arguments(words)
    try:
        if given.what not in COMMANDS:
            raise SuiteError(f"suite {given.what}: allowed: {', '.join(COMMANDS)}")
        return COMMANDS[given.what](given)
    except SuiteError as error:
        say_error(error)
        return BAD_INPUT
    except OSError as error:
        return unwritable(error) if error.filename else FAILED
    except KeyboardInterrupt:
        return INTERRUPTED


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
