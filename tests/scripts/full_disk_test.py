"""What is left when writing fails: for each command, each call that changes a file fails in turn, once (EIO) or from then on
(ENOSPC). Afterwards the folder has the results that were there before or those that were asked for, none of them torn, and the
status says which."""
import errno
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
# Times differ from run to run; a sweep's journal is what --resume goes on from.
NOT_COMPARED = {"timing.json", "sweep.journal"}


def tree(folder):
    return {str(file.relative_to(folder)): file.read_bytes() for file in sorted(folder.rglob("*"))
            if file.is_file() and file.name not in NOT_COMPARED}


class FullDisk(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = scratch_folder(cls)

    def results(self, name, words):
        out = self.folder / name
        must(PROGRAM, *words, "--out", out)
        return out

    def with_failure(self, words, old_folder, at, error, how):
        """The finished process, whose call `at` failed, in a copy of the folder, `out`, and how many calls there were."""
        out, counted = self.folder / "out", self.folder / "counted"
        shutil.rmtree(out, ignore_errors=True)
        shutil.copytree(old_folder, out)
        done = ran(PROGRAM, *words, "--out", out, LD_PRELOAD=str(FAILING_WRITES), FAIL_BELOW=str(out), FAIL_AT=str(at),
                   FAIL_WITH=str(error), FAIL_ON=how, FAIL_COUNT=str(counted))
        return done, int(counted.read_text(encoding="utf-8"))

    def check(self, command, error, how):
        before, now = COMMANDS[command]
        old_folder = self.results(f"{command}-old", before)
        old = tree(old_folder)
        new_folder = self.folder / f"{command}-new"
        if not new_folder.exists():
            shutil.copytree(old_folder, new_folder)
            must(PROGRAM, *now, "--out", new_folder)
        new = tree(new_folder)
        self.assertNotEqual(old, new)
        calls, faults = self.with_failure(now, old_folder, 0, 0, how)[1], []
        for at in range(1, calls + 1):
            done, out = self.with_failure(now, old_folder, at, error, how)[0], self.folder / "out"
            left = tree(out)
            if done.returncode == 0 and left == new:
                continue  # a call whose failure harms nothing
            faults += [f"call {at}: status {done.returncode}, {fault}" for fault in self.faults(command, done, left, old, new)]
        self.assertGreater(calls, 3)
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
