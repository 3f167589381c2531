"""Endurance, by parts: what ctest has a few of, by the thousand. See scripts/endure --help."""
import argparse
import contextlib
import errno
import json
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "scripts"))
from fixture import PROGRAM, must, ran  # noqa: E402
from random_scenes import Scenes  # noqa: E402

RECORD = ROOT / "tests" / "data" / "reliability.json"
FINE = (0, 2, 3)  # done, refused with a reason, a run that did not end as expected
# [s] for a command on a scene of some milliseconds. The longest are `stability` for hundreds of springs and an integrator without
# an edge, whose runs all go to their end, and `limit` for a tool so large that it holds every point of the shell: some minutes.
PATIENCE = 1200.0


class Findings(list):
    stopped = False  # by a signal: random scenes then end with what they have

    def note(self, what):
        self.append(what)
        print(f"finding: {what}", file=sys.stderr, flush=True)

    def of(self, words, *, statuses=FINE, **environment):
        """The finished process; a finding if it took too long, ended as it should not or said so in other words than an error."""
        try:
            done = subprocess.run([*map(str, words)], capture_output=True, text=True, encoding="utf-8", stdin=subprocess.DEVNULL,
                                  timeout=PATIENCE, env={**os.environ, **environment})
        except (subprocess.TimeoutExpired, UnicodeDecodeError) as error:
            self.note(f"{error}")
            return None
        said = done.returncode == 3 or (done.returncode != 0) == ("error:" in done.stderr)  # 3: perhaps in what it prints
        if done.returncode not in statuses or not said:
            self.note(f"{' '.join(map(str, words))}: status {done.returncode}: {done.stderr.strip()[-300:]}")
            return None
        return done


def hashes(done):
    return [run["state_hash"] for run in json.loads(done.stdout)] if done and done.stdout else None


def files_below(folder, but=("timing.json", "sweep.journal")):
    return {str(f.relative_to(folder)): f.read_bytes() for f in sorted(folder.rglob("*"))
            if f.is_file() and f.name not in but and not f.name.endswith(".tmp")} if folder.exists() else {}


# ---- Random scenes

def build_of(program):
    """The compiler of a program and the instructions it uses, such as "Clang 19.1.7 avx2"."""
    version = json.loads(must(program, "--version", "--json"))
    instructions = version["instruction_set"]
    return f"{version['compiler']} {instructions['widest'] if instructions['simd'] else 'scalar'}"


def commands_on(scene, folder):
    """Every command that takes one scene, of which few compute for longer than a run."""
    out = lambda name: ("--out", folder / name)
    yield "compare", scene, "--algorithms", "mean,proxy,shaped_stiffness", "--quiet", *out("compare")
    yield "limit", scene, "--vary", "rendering.stiffness_N_per_m", "--between", "100:1e5", "--resolution", "0.5", "--quiet", *out("limit")
    yield "converge", scene, "--metric", "force_max_N", "--levels", "3", "--quiet", *out("converge")
    yield "precision", "time_step", "--scenario", scene, "--quick", "--quiet", *out("precision")
    yield "stability", scene, "--quiet", *out("stability")
    yield "shell", scene, "--quiet", "--out", folder / "shell.ply"


def pictures_of(scene, folder):
    yield "run", scene, "--quiet", "--out", folder / "run"
    yield "run", scene, "--quiet", "--set", "seed=7", "--out", folder / "again"
    yield "diff", folder / "run", folder / "again", "--quiet"
    yield "plot", folder / "run", "--out", folder / "plot.svg"
    yield "report", folder / "run", "--out", folder / "page.html"


def random_scenes(count, seed, others, found, scratch):
    """Valid scenes from the schema: the same hashes from brute force, from any number of jobs and from `others`; every command
    ends as its manual says."""
    schema = json.loads(must(PROGRAM, "describe", "schema"))
    bundled = []
    for file in sorted((ROOT / "scenarios").glob("*/*.json")):
        scene = json.loads(file.read_text(encoding="utf-8"))
        if "environment" in scene and "file" not in json.dumps(scene):
            bundled.append(scene)
    data = ROOT / "tests" / "data"
    scenes = Scenes(schema, bundled, {"file": [str(data / name) for name in ("cube.obj", "shell.csv", "stroke.csv")]}, seed)
    valid = drawn = ran_commands = 0
    outcomes = {}
    while valid < count and not found.stopped:
        batch = []
        while len(batch) < min(20, count - valid):
            file = scratch / f"scene_{valid + len(batch)}.json"
            file.write_text(json.dumps(scenes.scene()), encoding="utf-8")
            drawn += 1
            done = found.of([PROGRAM, "--memory", "1G", "validate", file])
            if done and done.returncode == 0:
                batch.append(file)
        valid += len(batch)
        words = ["run", *batch, "--json", "--out", scratch / "runs"]
        first = found.of([PROGRAM, *words])
        if first is None or first.returncode == 2:
            continue
        ran_commands += 1 + len(others)
        for run in json.loads(first.stdout):
            outcomes[run["outcome"]] = outcomes.get(run["outcome"], 0) + 1
        for other in [[PROGRAM], *([other] for other in others)]:
            again = found.of([*other, *words, *(["--no-skip"] if other == [PROGRAM] else [])])
            if hashes(again) != hashes(first):
                found.note(f"{other[0]} has other hashes for {[str(f) for f in batch]}")
        for i, file in enumerate(batch):
            folder = scratch / "one"
            sweeps = []
            for jobs in (1, 2):
                found.of([PROGRAM, "sweep", file, "--vary", "seed=1,2,3", "--jobs", jobs, "--quiet", "--out", folder / f"sweep_{jobs}"])
                sweeps.append(files_below(folder / f"sweep_{jobs}").get("sweep.csv"))
            if sweeps[0] != sweeps[1]:
                found.note(f"another sweep with two jobs: {file}")
            with_pictures = (valid - len(batch) + i) % 100 == 0
            for command in [*commands_on(file, folder), *(pictures_of(file, folder) if with_pictures else ())]:
                found.of([PROGRAM, *command])
                ran_commands += 1
            ran_commands += 2
            shutil.rmtree(folder, ignore_errors=True)
        if not found:
            for file in batch:
                file.unlink()
        print(f"{valid} scenes, {len(found)} findings", file=sys.stderr, flush=True)
    return {"scenes": valid, "drawn": drawn, "commands": ran_commands, "by_other_build": {build_of(other): valid for other in others}, "outcomes": outcomes}


# ---- Kills

def killed_commands(scratch):
    """Name, the words of a command, and the files that it writes whole or not at all, one by one."""
    log = scratch / "log.csv"
    # A stroke that lasts while files are written.
    log.write_text("time_s,px_m,py_m,pz_m,qw,qx,qy,qz\n" + "".join(f"{0.01 * i},0,{1e-5 * i},0,1,0,0,0\n" for i in range(20000)), encoding="utf-8")
    short = ["--set", "time.duration_s=0.4"]
    return {"run": ["run", "drag_molar", *short], "sweep": ["sweep", "tap_wall", *short, "--vary", "seed=1:40:40"],
            "keep_runs": ["sweep", "tap_wall", *short, "--vary", "seed=1:20:20", "--keep-runs"],
            "compare": ["compare", "tap_wall", *short, "--algorithms", "mean,proxy,summation"],
            "reproduce": ["reproduce", "--only", "A1"], "import": ["import", log, "--columns", "time=1,position=2"]}


def kills(count, seed, found, scratch):
    """Commands killed at any time; afterwards no file is torn, and the next call makes the results that it makes undisturbed."""
    chance, killed, figures = random.Random(seed), 0, {}
    commands = killed_commands(scratch)
    for name, words in commands.items():
        out = scratch / f"{name}-killed"
        to = lambda folder: ["--out", folder / "stroke.csv" if name == "import" else folder]
        whole = scratch / f"{name}-whole"
        whole.mkdir()
        begin = time.monotonic()
        must(PROGRAM, *words, "--quiet", *to(whole), statuses=FINE)
        duration, expected = time.monotonic() - begin, files_below(whole)
        died = 0
        for _ in range(count // len(commands)):
            if chance.random() < 0.5:
                shutil.rmtree(out, ignore_errors=True)
            out.mkdir(exist_ok=True)
            process = subprocess.Popen([*map(str, [PROGRAM, *words, "--quiet", *to(out)])], stdin=subprocess.DEVNULL,
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(chance.uniform(0.0, 1.05 * duration))
            died += process.poll() is None
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)  # with the programs that it runs
            process.wait()
            torn = [f for f, bytes in files_below(out, ("timing.json", "sweep.journal", "sweep.csv")).items() if expected.get(f) != bytes]
            if torn:
                found.note(f"{name}: torn {torn}")
        more = ["--resume"] if words[0] == "sweep" else []
        must(PROGRAM, *words, *more, "--quiet", *to(out), statuses=FINE)
        left = files_below(out)
        if left != expected:
            found.note(f"{name}: the last call left {sorted(f for f in {*left, *expected} if left.get(f) != expected.get(f))}")
        figures[name] = died
        killed += died
    return {"kills": killed, "by_command": figures}


# ---- Many runs

def peak_memory(words):
    """Peak of resident memory [B] and CPU time [s] of a command."""
    process = subprocess.Popen([*map(str, words)], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode in FINE, (words, process.returncode)
    return 1024 * usage.ru_maxrss, usage.ru_utime + usage.ru_stime


def long_sweep(count, found, scratch):
    """A sweep of so many runs takes no more memory than one of a tenth, and little more time than its runs."""
    rows = 1000
    words = [PROGRAM, "sweep", "single_spring", "--set", "record.trajectory=false", "--quiet", "--jobs", "2"]
    sweep = lambda runs: peak_memory([*words, "--set", f"time.steps={rows}", "--vary", f"seed=1:{runs}:{runs}", "--out", scratch / f"sweep_{runs}"])
    small, large = sweep(count // 10), sweep(count)
    # The same rows in one run, whose start and summary count for nothing.
    alone = peak_memory([PROGRAM, "run", "single_spring", "--set", "record.trajectory=false", "--set", f"time.steps={min(rows * count, 100_000_000)}",
                         "--quiet", "--out", scratch / "alone"])[1] * max(1.0, rows * count / 1e8)
    if large[0] > 1.1 * small[0]:
        found.note(f"{count} runs take {large[0]} B, a tenth of them {small[0]} B")
    return {"runs": count, "peak_MB": round(large[0] / 1e6, 1), "peak_MB_of_a_tenth": round(small[0] / 1e6, 1), "CPU_s": round(large[1], 1),
            "over_simulation": round(large[1] / alone, 2)}


def shards(count, seed, found, scratch):
    """Shards of a sweep, some of which are killed and some stopped half way, are done again and merged: the table of the sweep in one."""
    chance, runs = random.Random(seed), 4 * count
    words = [PROGRAM, "sweep", "single_spring", "--set", "time.steps=200", "--vary", f"seed=1:{runs}:{runs}", "--quiet"]
    must(*words, "--out", scratch / "whole", statuses=FINE)
    ended = {"killed": 0, "stopped": 0}
    for i in range(count):
        shard = [*map(str, [*words, "--shard", f"{i}/{count}", "--out", scratch / "shards"])]
        if chance.random() < 0.1:
            end = chance.choice((("killed", signal.SIGKILL), ("stopped", signal.SIGTERM)))
            process = subprocess.Popen(shard, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(chance.uniform(0.0, 0.02))
            ended[end[0]] += process.poll() is None
            process.send_signal(end[1])
            process.wait()
        must(*shard, "--resume", statuses=FINE)
    merged = scratch / "merged.csv"
    must(PROGRAM, "merge", *sorted((scratch / "shards").glob("sweep_shard_*.csv")), "--out", merged, "--quiet")
    if merged.read_bytes() != (scratch / "whole" / "sweep.csv").read_bytes():
        found.note("merged shards differ from the sweep in one")
    return {"shards": count, **ended}


def in_process(count, found, scratch):
    """So many runs in one Python process, with a law of ours, of a plugin and of Python by turns: memory stays what it was."""
    sys.path[:] = [folder for folder in sys.path if folder != str(ROOT / "scripts" / "python")]  # whose package has no module
    import hapbench

    plugin = ROOT / "algorithms" / "plugin"
    must("cc", "-shared", "-fPIC", f"-I{plugin}", "-o", scratch / "law.so", plugin / "examples" / "depth_weighted.c", "-lm")
    hapbench.load_plugin(scratch / "law.so")
    hapbench.force_law("of_python")(lambda depths: 1.0 / len(depths))
    laws = ("mean", "depth_weighted", "of_python")

    def runs(n):
        for i in range(n):
            hapbench.run("single_spring", {"time.steps": 20, "seed": i + 1, "rendering.algorithm": laws[i % len(laws)]})
        return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    before, after = runs(count // 10), runs(count - count // 10)
    if after > 1.1 * before:
        found.note(f"{count} runs in a process: {before} B after a tenth, {after} B in the end")
    return {"runs": count, "peak_MB": round(after / 1e6, 1), "peak_MB_of_a_tenth": round(before / 1e6, 1)}


# ---- Command lines

# Values of every kind, those that an option takes and those that none takes.
VALUES = ("", "0", "-1", "1", "16", "1e6", "1e309", "1e-320", "nan", "0x10", "9" * 20, "-", "--", ",", ":", "=", "a=b", "1:2", "1:2:3", "1:0:5:log",
          "0/2", "3/1", "0/0", "1G", "64M", "x" * 300, "ü", "\x1b[31m", "\udcff", "%s%n", "{}", "[1", '{"a":1}', "out", "out/a.csv", "out/x.svg", ".",
          "/dev/null", "tap_wall", "poke_plane", "single_spring", "drag_molar", "mean", "proxy,mean", "force_max_N", "time_step", "A1",
          "rendering.stiffness_N_per_m", "rendering.stiffness_N_per_m=1e3:1e4:3", "seed=1:3:3", "environment.type=mesh", "tool=null", "hand={}")


def lines(count, seed, found, scratch):
    """Command lines of random words: carried out, or refused with a reason that is printable; a signal ends those that last."""
    chance, ended = random.Random(seed), {"done": 0, "refused": 0, "stopped": 0}
    commands = re.findall(r"^  ([a-z]+) ", must(PROGRAM, "--help").split("Commands:")[1], re.MULTILINE)
    options = {command: re.findall(r"--[a-z-]+", must(PROGRAM, command, "--help")) for command in commands}
    for _ in range(count):
        command = chance.choice(commands)
        words = [command, *chance.choices(VALUES, k=chance.randint(0, 2)), *(["--set", "time.steps=60"] if "--set" in options[command] else [])]
        for option in chance.choices(options[command], k=chance.randint(0, 4)):
            words += [option, *chance.choices(VALUES, k=chance.random() < 0.75)]
        process = subprocess.Popen([PROGRAM, *words], cwd=scratch, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        stopped = False
        try:
            _, said = process.communicate(timeout=5.0)
        except subprocess.TimeoutExpired:
            process.terminate()
            stopped = True
            try:
                _, said = process.communicate(timeout=20.0)  # 2 s are promised; the machine may be busy
            except subprocess.TimeoutExpired:
                process.kill()
                _, said = process.communicate()
        ended["stopped" if stopped else "done" if process.returncode != 2 else "refused"] += 1
        said = said.decode(errors="replace")
        fine = (*FINE, 128 + signal.SIGTERM, -signal.SIGTERM) if stopped else FINE
        if process.returncode not in fine or "Traceback" in said or any(c < " " and c != "\n" for c in said):
            found.note(f"{words}: status {process.returncode}: {said[-300:]!r}")
    return {"lines": count, **ended}


# ---- Recordings

def mutated(data, chance):
    """The bytes with some of them changed, doubled or gone."""
    data = bytearray(data)
    for _ in range(chance.randint(1, 6)):
        at = chance.randrange(len(data) + 1)
        kind = chance.randrange(4)
        if kind == 0 and at < len(data):
            data[at] = chance.choice(b"0123456789.eE+-,;nax\n\r \t\"{}[]:\xff\0")
        elif kind == 1:
            del data[at:at + chance.randint(1, 30)]
        elif kind == 2:
            data[at:at] = data[at:at + chance.randint(1, 30)] * chance.randint(1, 3)
        else:
            data[at:at] = chance.choice((b"nan", b"inf", b"1e999", b"-1e308", b"0x10", b"9" * 400, b"\xc3\x28", b"true", b"null"))
    return bytes(data)


def imports(count, seed, found, scratch):
    """Recordings and presets with bytes changed at random: each becomes a stroke or is refused with its faults."""
    sys.path.insert(0, str(ROOT / "scripts" / "python"))
    from hapbench_import.__main__ import run
    from hapbench_import.faults import Faults

    chance, accepted = random.Random(seed), 0
    presets = scratch / "presets"
    shutil.copytree(ROOT / "scenarios" / "import" / "presets", presets)
    kinds = {file.stem: file.read_bytes() for file in presets.glob("*.json")}
    recordings = [file for file in (ROOT / "scenarios" / "examples" / "data").iterdir() if file.suffix in (".csv", ".txt")]
    logs = [b"".join(file.read_bytes().splitlines(True)[:12]) for file in sorted(recordings)]
    log, preset = scratch / "log.csv", scratch / "presets" / "mutant.json"
    for i in range(count):
        with_preset = i % 2 == 0
        given = {} if with_preset else {"columns": ["time=1", "position=2", "orientation=5"], "orientation": [chance.choice(("axis", "quat_wxyz"))]}
        given |= {"file": [str(log)], "out": [str(scratch / "stroke.csv")], "presets": [str(presets)], "stiffness_N_per_m": ["1000"]}
        data = chance.choice(logs)
        log.write_bytes(data if with_preset and chance.random() < 0.5 else mutated(data, chance))
        if with_preset:
            preset.write_bytes(mutated(chance.choice(list(kinds.values())), chance))
            given["preset"] = ["mutant"]
        try:
            run(given)
            accepted += 1
        except Faults:
            pass
        except Exception as error:  # whatever else a reader throws is what is looked for
            keep = Path(tempfile.mkdtemp(prefix="hapbench-import-"))
            shutil.copy(log, keep)
            if with_preset:
                shutil.copy(preset, keep)
            found.note(f"{type(error).__name__}: {error} ({keep})")
    return {"mutants": count, "accepted": accepted}


# ---- Faults and fuzzing, which other programs do

def faults(found, scratch):
    """Every call that writes fails in turn, in every command that writes results (tests/scripts/full_disk_test.py)."""
    library = next((ROOT / "build").glob("*/tests/scripts/libfailing_writes.so"), None)
    done = ran(sys.executable, ROOT / "tests" / "scripts" / "full_disk_test.py", PROGRAM, library or "", ENDURE_COUNT=str(scratch / "calls"))
    if done.returncode:
        found.note(done.stderr[-1000:])
    lines = (scratch / "calls").read_text(encoding="utf-8").split() if (scratch / "calls").exists() else []
    return {"calls": sum(map(int, lines)), "errors": [errno.errorcode[errno.ENOSPC], errno.errorcode[errno.EIO]]}


RUNNING = ("run", "mesh_")  # targets that build meshes or run a scene


def fuzz(share, only, found, scratch):
    """Executions of libFuzzer on every reader (scripts/fuzz): ten million for those of text, a million for those that build meshes."""
    executions = {}
    listed = [target for target in ran(ROOT / "scripts" / "fuzz", "--list").stdout.split() if not only or target in only]
    for full, targets in ((1e6, [t for t in listed if t.startswith(RUNNING)]), (1e7, [t for t in listed if not t.startswith(RUNNING)])):
        if not targets:
            continue
        done = ran(ROOT / "scripts" / "fuzz", "600", "--runs", int(full * share), *(word for target in targets for word in ("--target", target)))
        for target, times in re.findall(r"^(\w+) +(\d+) executions", done.stdout, re.MULTILINE):
            executions[target] = int(times)
        if done.returncode or not executions.keys() >= set(targets):
            found.note(f"{done.stdout[-2000:]}{done.stderr[-500:]}")
    return {"executions": executions}


ADDED = {"scenes", "kills", "lines", "imports", "fuzz"}  # of the others, one call is the measurement


def added(old, new):
    """The counts of two calls of a part together; of what is no count, the later."""
    if isinstance(old, dict) and isinstance(new, dict):
        return old | {name: added(old.get(name), value) for name, value in new.items()}
    return old + new if isinstance(old, int) and isinstance(new, int) else new


def main():
    parser = argparse.ArgumentParser(prog="scripts/endure", description=__doc__)
    parser.add_argument("program", help=argparse.SUPPRESS)
    parser.add_argument("part", nargs="*", help="scenes, kills, faults, sweep, shards, lines, imports, python, fuzz; default: all but fuzz")
    parser.add_argument("--share", type=float, default=1.0, help="of the counts that the page of reliability asks for (default: 1)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--against", action="append", default=[], metavar="PROGRAM", help="another build, which must have the same hashes")
    parser.add_argument("--target", action="append", help="of fuzz: this one alone; scripts/fuzz --list names them")
    parser.add_argument("--record", action="store_true",
                        help="keep the figures in tests/data/reliability.json; SIGUSR1 ends the random scenes, which keep what they have done")
    parser.add_argument("--add", action="store_true",
                        help="with --record: add scenes, kills, imports and executions to those on record; give them a --seed of their own")
    given = parser.parse_args()
    count = lambda full: max(10, round(given.share * full))
    parts = {
        "scenes": lambda f, s: random_scenes(count(10_000), given.seed, given.against, f, s),
        "kills": lambda f, s: kills(count(1000), given.seed, f, s),
        "faults": faults,
        "sweep": lambda f, s: long_sweep(count(1_000_000), f, s),
        "shards": lambda f, s: shards(count(1000), given.seed, f, s),
        "lines": lambda f, s: lines(count(10_000), given.seed, f, s),
        "imports": lambda f, s: imports(count(1_000_000), given.seed, f, s),
        "python": lambda f, s: in_process(count(100_000), f, s),
        "fuzz": lambda f, s: fuzz(given.share, given.target, f, s),
    }
    wanted = given.part or [part for part in parts if part != "fuzz"]
    for part in wanted:
        if part not in parts:
            parser.error(f'unknown part "{part}"; allowed: {", ".join(parts)}')
    failed = False
    for part in wanted:
        found, begin = Findings(), time.monotonic()
        signal.signal(signal.SIGUSR1, lambda *_, found=found: setattr(found, "stopped", True))
        with tempfile.TemporaryDirectory(prefix="hapbench-endure-") as folder:
            figures = parts[part](found, Path(folder).resolve())
        figures.update(findings=len(found), seconds=round(time.monotonic() - begin))
        print(json.dumps({part: figures}), flush=True)
        failed |= bool(found)
        if given.record:
            record = json.loads(RECORD.read_text(encoding="utf-8"))  # now: other calls may run beside this one
            record[part] = added(record[part], figures) if given.add and part in ADDED and part in record else figures
            RECORD.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
