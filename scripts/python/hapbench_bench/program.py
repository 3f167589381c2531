"""Builds and runs the programs that are timed: of this tree, and of another commit beside it."""
import contextlib
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
# Told by the program to have taken another number of iterations than one asked for.
SUFFIX = re.compile(r"/iterations:\d+$")
UNITS = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}


class BenchError(Exception):
    """An error that the user is told in one line."""


def say(text):
    print(f"bench: {text}", file=sys.stderr, flush=True)


def build(source, folder, *targets, environment=None):
    """Builds targets of a source tree as the preset `release` does; what CMake says goes to standard error."""
    configure = ["cmake", "-S", source, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DHAPBENCH_BUILD_TESTS=ON",
                 "--log-level=WARNING"]
    for command in (configure, ["cmake", "--build", folder, "--target", *targets]):
        done = subprocess.run(command, stdout=sys.stderr, env={**os.environ, **(environment or {})})
        if done.returncode:
            raise BenchError(f"{' '.join(map(str, command))}: exit status {done.returncode}")
    return Path(folder) / "bin"


def exactly(names):
    """A filter that lets these benchmarks through and no others."""
    return f"^({'|'.join(map(re.escape, names))})(/iterations:[0-9]+)?$"


def listed(program, *options):
    """The names of its benchmarks."""
    lines = run(program, "--benchmark_list_tests", *options).splitlines()
    return [SUFFIX.sub("", line) for line in lines]


def run(program, *options):
    done = subprocess.run([program, *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode < 0 or not done.stdout:
        last = done.stderr.strip().splitlines()[-1:] or [f"exit status {done.returncode}"]
        raise BenchError(f"{program} {' '.join(options)}: {last[0]}")
    return done.stdout


def measured(program, names, *options, seconds=0.02, repetitions=1, interleaved=True):
    """Runs benchmarks in one process, their repetitions interleaved at random: its context, and for each name the entries
    of its repetitions in order, times in seconds. Raises BenchError when one of them refutes its own answer."""
    words = [f"--benchmark_filter={exactly(names)}", "--benchmark_format=json", f"--benchmark_min_time={seconds}",
             f"--benchmark_repetitions={repetitions}", "--benchmark_report_aggregates_only=false", *options]
    if repetitions > 1 and interleaved:
        words.append("--benchmark_enable_random_interleaving=true")
    output = json.loads(run(program, *words))
    found = {name: [] for name in names}
    for entry in output["benchmarks"]:
        if entry.get("run_type") == "aggregate":
            continue
        name = SUFFIX.sub("", entry["run_name"])
        if entry.get("error_occurred"):
            raise BenchError(f"{program}: {name}: {entry['error_message']}")
        scale = UNITS[entry["time_unit"]]
        found[name].append({**entry, "cpu_s": scale * entry["cpu_time"], "wall_s": scale * entry["real_time"]})
    missing = [name for name, entries in found.items() if len(entries) != repetitions]
    if missing:
        raise BenchError(f"{program}: {missing[0]}: not among its benchmarks")
    for entries in found.values():
        entries.sort(key=lambda entry: entry.get("repetition_index", 0))
    return output["context"], found


def git(*words):
    return subprocess.run(["git", "-C", ROOT, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def resolved(name):
    found = git("rev-parse", "--verify", "--quiet", f"{name}^{{commit}}")
    if found.returncode:
        raise BenchError(f"--against {name}: no commit of that name in {ROOT}")
    return found.stdout.decode().strip()


@contextlib.contextmanager
def built(name):
    """Its hapbench_bench, in build/against/COMMIT, which stays for the next time; its sources are there only as long as
    the program runs, which reads the scenarios in them. Files have the commit's date, so that nothing is built twice."""
    commit = resolved(name)
    folder = ROOT / "build" / "against" / commit[:12]
    source = folder / "source"
    archive = git("archive", "--format=tar", commit)
    if archive.returncode:
        raise BenchError(f"--against {name}: {archive.stderr.decode().strip()}")
    shutil.rmtree(source, ignore_errors=True)  # of a run that was killed
    try:
        with tarfile.open(fileobj=io.BytesIO(archive.stdout)) as files:
            files.extractall(source)
        say(f"building {commit[:12]} in {os.path.relpath(folder)} (minutes, the first time)")
        # Its build asks git for a commit: let it not find ours.
        alone = {"GIT_CEILING_DIRECTORIES": str(folder)}
        yield build(source, folder / "build", "bin/hapbench_bench", environment=alone) / "hapbench_bench"
    finally:
        shutil.rmtree(source, ignore_errors=True)
