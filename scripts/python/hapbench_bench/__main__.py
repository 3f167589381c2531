"""The command line of scripts/bench."""
import json
import re
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from hapbench_command import BAD_INPUT, INTERRUPTED, SUCCESS, Arguments, say_error, write

from . import peers
from .measure import performance
from .program import ROOT, BenchError, build, built, listed
from .table import BEGIN, END, MANUAL, RECORD, aligned, markdown, spliced

DESCRIPTION = """Builds the program and its benchmarks and prints what they take as ratios, each to a benchmark that ran in the
same process, its repetitions interleaved with theirs, beside its target (about two minutes). With --against compares every
benchmark with that of another commit. Times mean something on a quiet machine only; ratios drift less."""
TOO_SLOW = 1


def arguments(words):
    parser = Arguments(prog="scripts/bench", description=DESCRIPTION,
                                     epilog="Options of Google Benchmark run the benchmarks themselves, for example "
                                     "scripts/bench --benchmark_filter='search/.*'")
    parser.add_argument("--full", action="store_true", help="also shells of up to 7 million points (minutes, gigabytes)")
    parser.add_argument("--record", action="store_true",
                        help="as --full, and renews results/reference/performance.json, its table in tests/README.md and its figure")
    parser.add_argument("--peers", action="store_true",
                        help="other collision libraries instead, at the poses of our searches, as far as they are installed "
                        f"({peers.PACKAGES}); writes peers.json; with --record also results/reference/peers.json and its table")
    parser.add_argument("--out", type=Path, default=ROOT / "results" / "out", metavar="DIR",
                        help="gets performance.json; in a folder of results figures and report take it from there; "
                        "default: results/out")
    parser.add_argument("--against", metavar="COMMIT", help="compare with this commit, built in build/against")
    parser.add_argument("--filter", metavar="REGEX", help="of --against: the benchmarks whose names match; default: all but "
                        "growth and latency")
    parser.add_argument("--rounds", type=int, default=10, metavar="N", help="of --against; default: 10")
    parser.add_argument("--fail-above", type=float, metavar="PERCENT",
                        help="of --against: exit status 1 when a benchmark has become slower by more")
    chosen = parser.parse_args(words)
    if not chosen.against and (chosen.filter or chosen.fail_above is not None):
        parser.error("--filter and --fail-above belong to --against")
    if chosen.against and (chosen.full or chosen.record):
        parser.error("--full and --record are not for --against")
    if chosen.peers and (chosen.against or chosen.full):
        parser.error("--peers is not for --against and --full")
    if chosen.rounds < 3:
        parser.error(f"--rounds: got {chosen.rounds}; allowed: at least 3")
    try:
        chosen.filter = re.compile(chosen.filter or "^(?!growth/|latency/)")
    except re.error as error:
        parser.error(f"--filter {chosen.filter}: {error}")
    return chosen


def save(chosen, record, found, text, begin, end):
    """Writes what was found, and with --record also the file on record and its table, `text`, in the manual."""
    content = json.dumps(found, indent=1, ensure_ascii=False) + "\n"
    files = {chosen.out / record.name: content}
    if chosen.record:
        files |= {record: content, MANUAL: spliced(MANUAL.read_text(encoding="utf-8"), text, begin, end)}
    for file, written in files.items():
        write(file, written)


def measure(chosen):
    programs = build(ROOT, ROOT / "build" / "release", "bin/hapbench", "bin/hapbench_bench")
    options = ["--full"] if chosen.full or chosen.record else []
    bench = programs / "hapbench_bench"
    growing = [name for name in listed(bench, *options) if name.startswith("growth/")]
    found = performance(bench, programs / "hapbench", growing, options)
    save(chosen, RECORD, found, markdown(found), BEGIN, END)
    if chosen.record:
        redraw()
    print(aligned(markdown(found)), end="")
    return SUCCESS


def measure_peers(chosen):
    program = build(ROOT, ROOT / "build" / "release", "bin/hapbench_bench_peers") / "hapbench_bench_peers"
    found = peers.measure(program)
    save(chosen, peers.RECORD, found, peers.markdown(found), peers.BEGIN, peers.END)
    print(aligned(peers.markdown(found)), end="")
    return SUCCESS


def redraw():
    """The figure of what has just been recorded."""
    name = "figure_growth.svg"
    with tempfile.TemporaryDirectory(prefix="hapbench-bench-") as scratch:
        words = [ROOT / "scripts" / "figures", RECORD.parent, "--out", scratch, "--only", "growth"]
        if subprocess.run(words, stdout=subprocess.DEVNULL).returncode:
            raise BenchError(f"{name}: not drawn")
        write(RECORD.parent / "figures" / name, (Path(scratch) / name).read_text(encoding="utf-8"))


def compare(chosen):
    # Only here: numpy and scipy would count as memory of the programs that `measure` starts.
    from . import against

    with built(chosen.against) as old:
        new = build(ROOT, ROOT / "build" / "release", "bin/hapbench_bench") / "hapbench_bench"
        by_group, only_old, only_new = against.groups(old, new, chosen.filter.search)
        found = against.comparisons(old, new, by_group, chosen.rounds)
    print(against.report(found, only_old, only_new, chosen.rounds))
    limit = chosen.fail_above
    late = [n for n, c in found.items() if limit is not None and c.verdict == "slower" and c.ratio > 1 + limit / 100]
    for name in late:
        print(f"bench: {name} has become slower by more than {limit:g} %", file=sys.stderr)
    return TOO_SLOW if late else SUCCESS


def main(words=None):
    chosen = arguments(words)
    # On SIGTERM, too, temporary files are removed by the code that made them.
    signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(128 + number))
    try:
        return (compare if chosen.against else measure_peers if chosen.peers else measure)(chosen)
    except (BenchError, OSError) as error:
        say_error(error)
        return BAD_INPUT
    except KeyboardInterrupt:
        return INTERRUPTED


if __name__ == "__main__":
    sys.exit(main())
