"""What is left when writing fails: for each command, each call that changes a file fails in turn, once (EIO) or from then on
(ENOSPC). Afterwards the folder has the results that were there before or those that were asked for, none of them torn, and the
status says which."""
import errno
import os
import shutil
import sys
import unittest
from pathlib import Path

from fixture import PROGRAM, main, must, ran, scratch_folder

FAILING_WRITES = Path(sys.argv[2])
SHORT = ["--set", "time.duration_s=0.02", "--set", "expect.outcome=[\"completes\",\"no_contact\",\"lost_contact\"]"]
RUN = ["run", "tap_wall", *SHORT, "--quiet"]
# Each command as it made the results that are there, and as it is to replace them.
COMMANDS = {
    "run": (RUN, [*RUN, "--set", "rendering.algorithm=mean"]),
    "run_more": ([*RUN, "--set", "record.contacts=true"], RUN),
    "compare": (["compare", "tap_wall", *SHORT, "--quiet", "--algorithms", "mean,proxy"],
                ["compare", "tap_wall", *SHORT, "--quiet", "--algorithms", "mean,summation"]),
    "sweep": (["sweep", "tap_wall", *SHORT, "--quiet", "--vary", "seed=1,2"],
              ["sweep", "tap_wall", *SHORT, "--quiet", "--jobs", "1", "--vary", "seed=1,2,3"]),
    "limit": (["limit", "single_spring", "--vary", "rendering.stiffness_N_per_m", "--quiet"],
              ["limit", "single_spring", "--vary", "rendering.stiffness_N_per_m", "--quiet", "--resolution", "0.1"]),
}
# Those that write one file, of inputs that are made first, each in a folder of its name.
SHARD = ["sweep", "tap_wall", *SHORT, "--quiet", "--shard", "0/1", "--vary"]
INPUTS = {"run": RUN, "mean": [*RUN, "--set", "rendering.algorithm=mean"], "few": [*SHARD, "seed=1,2"], "more": [*SHARD, "seed=1,2,3"]}
FILES = {"merge": "sweep.csv", "report": "page.html"}
COMMANDS |= {
    "merge": [["merge", f"{{folder}}/{name}/sweep_shard_0_of_1.csv", "--quiet"] for name in ("few", "more")],
    "report": [["report", f"{{folder}}/{name}", "--quiet"] for name in ("run", "mean")],
}
# Times differ from run to run; a sweep's journal is what --resume goes on from.
NOT_COMPARED = {"timing.json", "sweep.journal"}


def tree(folder):
    return {str(file.relative_to(folder)): file.read_bytes() for file in sorted(folder.rglob("*"))
            if file.is_file() and file.name not in NOT_COMPARED}


class FullDisk(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = scratch_folder(cls)
        for name, words in INPUTS.items():
            must(PROGRAM, *words, "--out", cls.folder / name)

    def words(self, command, which, out):
        """Those of a command as it made the results that are there (0) or as it replaces them (1)."""
        words = [word.replace("{folder}", str(self.folder)) for word in COMMANDS[command][which]]
        return [*words, "--out", out / FILES.get(command, "")]

    def with_failure(self, command, old_folder, at, error, how):
        """The finished process, whose call `at` failed, in a copy of the folder, `out`, and how many calls there were."""
        out, counted = self.folder / "out", self.folder / "counted"
        shutil.rmtree(out, ignore_errors=True)
        shutil.copytree(old_folder, out)
        # LD_PRELOAD is a list between spaces, LD_LIBRARY_PATH is not.
        done = ran(PROGRAM, *self.words(command, 1, out), LD_PRELOAD=FAILING_WRITES.name, LD_LIBRARY_PATH=str(FAILING_WRITES.parent),
                   FAIL_BELOW=str(out), FAIL_AT=str(at), FAIL_WITH=str(error), FAIL_ON=how, FAIL_COUNT=str(counted))
        return done, int(counted.read_text(encoding="utf-8"))

    def check(self, command, error, how):
        old_folder = self.folder / f"{command}-old"
        must(PROGRAM, *self.words(command, 0, old_folder))
        old = tree(old_folder)
        new_folder = self.folder / f"{command}-new"
        if not new_folder.exists():
            shutil.copytree(old_folder, new_folder)
            must(PROGRAM, *self.words(command, 1, new_folder))
        new = tree(new_folder)
        self.assertNotEqual(old, new)
        calls, faults = self.with_failure(command, old_folder, 0, 0, how)[1], []
        for at in range(1, calls + 1):
            done, out = self.with_failure(command, old_folder, at, error, how)[0], self.folder / "out"
            left = tree(out)
            if done.returncode == 0 and left == new:
                continue  # a call whose failure harms nothing
            faults += [f"call {at}: status {done.returncode}, {fault}" for fault in self.faults(command, done, left, old, new)]
        if "ENDURE_COUNT" in os.environ:  # scripts/endure adds them up
            with open(os.environ["ENDURE_COUNT"], "a", encoding="utf-8") as count:
                count.write(f"{calls}\n")
        self.assertGreater(calls, 2)
        self.assertFalse(faults, f"{len(faults)} of {calls} calls\n" + "\n".join(faults))

    def faults(self, command, done, left, old, new):
        if done.returncode not in (1, 2) or "cannot" not in done.stderr:  # 2: --out cannot be created
            yield f"says {done.stderr.strip()[:300]}"
        if command != "compare":
            torn = sorted(name for name in {*left, *old} if left.get(name) != old.get(name))
            if torn:
                yield f"torn: {torn}"
            return
        # Runs of a comparison are whole one by one; its table is there only with all of them.
        if left != old and "comparison.csv" in left:
            yield "has a table"
        for folder in {Path(name).parent for name in {*left, *old, *new} if "/" in name}:
            run, earlier, later = ({name: files[name] for name in files if Path(name).parent == folder} for files in (left, old, new))
            if run not in (earlier, later) and f"{folder}/summary.json" in run:
                yield f"torn: {folder}"


def add(command, error, how):
    setattr(FullDisk, f"test_{command}_{errno.errorcode[error].lower()}", lambda self: self.check(command, error, how))


for command in COMMANDS:
    add(command, errno.ENOSPC, "ever")
    add(command, errno.EIO, "once")

if __name__ == "__main__":
    main()
