"""Tests commands that write the same files into one folder at the same time: one command succeeds, and the others are
refused."""
import fcntl
import os
import struct
import subprocess
import tempfile
import unittest
from pathlib import Path

from fixture import ENVIRONMENT, PROGRAM

# For each command: its arguments on a small scene, the name of its lock, and a file of its results. OUT stands for the
# output folder.
COMMANDS = {
    "run": (["run", "poke_plane", "--out", "OUT"], "run", "summary.json"),
    "compare": (
        ["compare", "poke_plane", "--algorithms", "mean,proxy", "--out", "OUT"],
        "compare",
        "comparison.csv",
    ),
    "sweep": (
        [
            "sweep",
            "poke_plane",
            "--vary",
            "rendering.stiffness_N_per_m=20000,30000",
            "--out",
            "OUT",
        ],
        "sweep.csv",
        "sweep.csv",
    ),
    "limit": (
        ["limit", "tap_wall", "--between", "100:10000", "--resolution", "0.5", "--out", "OUT"],
        "limit",
        "limit.csv",
    ),
    "tune": (["tune", "tap_wall", "--out", "OUT"], "tune", "tune.csv"),
    "converge": (
        ["converge", "poke_plane", "--levels", "3", "--out", "OUT"],
        "converge",
        "converge.csv",
    ),
    "stress": (["stress", "--count", "1000", "--out", "OUT"], "stress", "stress.csv"),
    "reproduce": (
        ["reproduce", "--only", "A2", "--ledger", "OUT/ledger.json", "--out", "OUT"],
        "reproduce",
        "ledger.json",
    ),
    "new": (["new", "drag", "--out", "OUT/mine.json"], "mine.json", "mine.json"),
    "validate": (
        ["validate", "poke_plane", "--points", "OUT/points.csv"],
        "points.csv",
        "points.csv",
    ),
}


class Folders(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="hapbench-test-")
        self.addCleanup(scratch.cleanup)
        self.root = Path(scratch.name).resolve()

    def start(self, name, folder):
        words = [word.replace("OUT", str(folder)) for word in COMMANDS[name][0]]
        return subprocess.Popen(
            [str(PROGRAM), *words],
            cwd=self.root,
            env=ENVIRONMENT,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )

    def ends_of(self, processes):
        errors = [process.communicate()[1] for process in processes]
        return [(process.returncode, text) for process, text in zip(processes, errors)]

    def refused(self, text, folder):
        return (
            "because another" in text and str(folder) in text
        ) or "exists; choose another" in text

    def test_a_locked_folder_is_refused_and_unchanged(self):
        for name, (_, lock, _) in COMMANDS.items():
            folder = self.root / f"held_{name}"
            folder.mkdir()
            (folder / "mine.txt").write_text("mine")
            descriptor = os.open(folder / f".{lock}.lock", os.O_RDWR | os.O_CREAT)
            fcntl.fcntl(
                descriptor, fcntl.F_OFD_SETLK, struct.pack("hhqqi4x", fcntl.F_WRLCK, 0, 0, 0, 0)
            )
            before = sorted(os.listdir(folder))
            ((status, text),) = self.ends_of([self.start(name, folder)])
            os.close(descriptor)
            self.assertEqual(status, 1, (name, text))
            self.assertTrue(self.refused(text, folder), (name, text))
            self.assertEqual(sorted(os.listdir(folder)), before, name)

    def test_of_commands_begun_together_one_succeeds(self):
        for name, (_, _, result) in COMMANDS.items():
            for attempt in range(3):
                folder = self.root / f"race_{name}_{attempt}"
                ends = self.ends_of([self.start(name, folder) for _ in range(3)])
                # Short commands may happen to run one after the other. In that case several succeed.
                self.assertIn(0, [status for status, _ in ends], (name, ends))
                for status, text in ends:
                    self.assertTrue(status == 0 or self.refused(text, folder), (name, text))
                self.assertTrue((folder / result).is_file(), name)
                hidden = [file for file in folder.rglob(".*")]
                self.assertEqual(hidden, [], name)

    def test_shards_go_on_side_by_side(self):
        folder = self.root / "shards"
        words = ["sweep", "poke_plane", "--vary", "rendering.stiffness_N_per_m=20000:27000:8"]
        shards = [
            subprocess.Popen(
                [str(PROGRAM), *words, "--shard", f"{i}/8", "--out", str(folder)],
                cwd=self.root,
                env=ENVIRONMENT,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
            )
            for i in range(8)
        ]
        for status, text in self.ends_of(shards):
            self.assertEqual(status, 0, text)
        subprocess.run([str(PROGRAM), "sweep", str(folder)], check=True, stdout=subprocess.DEVNULL)
        self.assertEqual(len((folder / "sweep.csv").read_text().splitlines()), 9)

    def test_a_killed_command_leaves_no_lock(self):
        folder = self.root / "killed"
        long = self.start("tune", folder)
        while not (folder / ".tune.lock").exists() and long.poll() is None:
            pass
        long.kill()
        self.ends_of([long])
        self.assertEqual(self.ends_of([self.start("tune", folder)])[0][0], 0)
        self.assertFalse((folder / ".tune.lock").exists())

    def test_a_run_inside_a_comparison_is_refused(self):
        folder = self.root / "outer"
        comparison = subprocess.Popen(
            [str(PROGRAM), "compare", "drag_molar", "--algorithms", "mean,proxy", "--out", folder],
            cwd=self.root,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        while not (folder / ".compare.lock").exists() and comparison.poll() is None:
            pass
        run = subprocess.run(
            [str(PROGRAM), "run", "poke_plane", "--out", folder / "mean"],
            capture_output=True,
            text=True,
        )
        self.assertEqual(run.returncode, 1, run.stderr)
        self.assertIn("because another compare writes to", run.stderr)
        self.assertEqual(self.ends_of([comparison])[0][0], 0)

    def test_beside_reproduce_only_its_own_runs_are_refused(self):
        """Checks two runs that write below the output folder of a running `reproduce`. A run into the subfolder study,
        which `reproduce` does not use, succeeds. A run into the subfolder thesis, which `reproduce` uses, is refused.
        scripts/reproduce relies on this, because it writes studies into subfolders that `reproduce` does not use.
        """
        folder = self.root / "both"
        reproduce = subprocess.Popen(
            [str(PROGRAM), "reproduce", "--jobs", "1", "--out", folder],
            cwd=self.root,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        try:
            while not (folder / ".reproduce.lock").exists() and reproduce.poll() is None:
                pass
            for inner, status in (("study/poke_plane", 0), ("thesis/poke_plane", 1)):
                run = subprocess.run(
                    [str(PROGRAM), "run", "poke_plane", "--out", folder / inner],
                    capture_output=True,
                    text=True,
                )
                self.assertEqual(run.returncode, status, run.stderr)
            self.assertIn("because another reproduce writes to", run.stderr)
        finally:
            reproduce.kill()
            reproduce.wait()


if __name__ == "__main__":
    unittest.main()
