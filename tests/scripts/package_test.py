"""The Debian package runs with the library for each level of the instruction set, with the results of a native build to the
byte, and serves a project of its own. Arguments: the native program, the package. Of scripts/test --all: building the package
takes minutes."""
import hashlib
import platform
import sys
import unittest
from pathlib import Path

from fixture import PROGRAM as NATIVE, SOURCE, main, must, scratch_folder

PACKAGE = Path(sys.argv[2]).resolve()
CONSUMER = SOURCE / "tests" / "consumer"
# Every kind of tool, law with kernels, and the proxy.
RUNS = [["peg_in_hole_2d_shaped_stiffness"], ["peg_in_hole_2d_exact_shaping"], ["peg_in_hole_2d_tandpasta"],
        ["peg_in_hole_2d_original_averaging"], ["drag_molar"], ["explorer_on_bumps"], ["spring_1e9_implicit_euler"], ["task2_rotate_signed_distance"],
        ["peg_in_hole_2d_shaped_stiffness", "--set", "rendering.algorithm=proxy"],
        ["drag_molar", "--set", "rendering.algorithm=least_squares"],
        ["drag_molar", "--set", "rendering.algorithm=merged_shaping"]]
LEVELS = {"": "sse2", "glibc-hwcaps/x86-64-v3": "avx2", "glibc-hwcaps/x86-64-v4": "avx512f"}


def has(level):
    """Whether the machine has the instruction set, as the dynamic loader says."""
    loader = must("/lib64/ld-linux-x86-64.so.2", "--help")
    return not level or f"{Path(level).name} (supported" in loader


def contents(folder):
    """Hashes of the results of a run, without the scenario in full, which names files of each program, and timing.json."""
    return {str(file.relative_to(folder)): hashlib.sha256(file.read_bytes()).hexdigest() for file in sorted(folder.rglob("*"))
            if file.is_file() and file.name not in ("scenario.effective.json", "timing.json")}


@unittest.skipUnless(platform.machine() == "x86_64", "levels are x86-64's")
class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = scratch_folder(cls)
        must("dpkg-deb", "-x", PACKAGE, cls.folder / "root")
        cls.usr = cls.folder / "root" / "usr"
        cls.library = next(cls.usr.glob("lib/**/libhapbench.so")).parent
        cls.program = cls.usr / "bin" / "hapbench"

    def alone(self, level):
        """A folder with the library of one level, without those below its own that the loader would go on to."""
        folder = self.folder / "alone" / (Path(level).name or "base")
        if not folder.exists():
            folder.mkdir(parents=True)
            for file in (self.library / level).glob("libhapbench.so.*"):
                (folder / file.name).symlink_to(file.resolve())
        return str(folder)

    def test_every_level_gives_the_bytes_of_the_native_build(self):
        for number, words in enumerate(RUNS):
            out = self.folder / f"native{number}"
            must(NATIVE, "run", *words, "--out", out)
            wanted = contents(out)
            self.assertGreater(len(wanted), 1)
            for level in filter(has, LEVELS):
                with self.subTest(run=words, level=level):
                    out = self.folder / f"{Path(level).name}{number}"
                    must(self.program, "run", *words, "--out", out, LD_LIBRARY_PATH=self.alone(level))
                    self.assertEqual(contents(out), wanted)

    def test_each_level_is_what_its_folder_says(self):
        for level, widest in LEVELS.items():
            if has(level):
                version = must(self.program, "--version", "--json", LD_LIBRARY_PATH=self.alone(level))
                self.assertIn(f'"widest": "{widest}"', version)

    def test_the_loader_chooses_the_highest_level_of_the_machine(self):
        highest = [level for level in LEVELS if has(level)][-1]
        version = must(self.program, "--version", "--json", LD_LIBRARY_PATH=str(self.library))
        self.assertIn(f'"widest": "{LEVELS[highest]}"', version)

    def test_a_project_of_its_own_runs_its_law_with_it(self):
        build = self.folder / "build"
        must("cmake", "-G", "Ninja", "-S", CONSUMER, "-B", build, f"-DCMAKE_PREFIX_PATH={self.usr}")
        must("cmake", "--build", build)
        file, _ = must(build / "own_law", LD_LIBRARY_PATH=str(self.library)).splitlines()
        self.assertTrue(Path(file).is_relative_to(self.usr / "share" / "hapbench"), file)


if __name__ == "__main__":
    main()
