"""The Debian package and the wheel run with the library for each level of the instruction set, with the results of a native build
to the byte. The package serves a project of its own; the wheel serves a virtual environment without a network. Arguments: the native
program, the package or the wheel. Of scripts/test --all: building them takes minutes."""
import hashlib
import json
import platform
import re
import shutil
import sys
import unittest
import zipfile
from pathlib import Path

from fixture import PROGRAM as NATIVE, SOURCE, main, must, scratch_folder

PACKAGE = Path(sys.argv[2]).resolve()
IS_WHEEL = PACKAGE.suffix == ".whl"
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
    """Hashes of the results of a run, without the scenario in full, which names files of each program, the commit, by which programs
    may differ, and timing.json."""
    return {str(file.relative_to(folder)): hashlib.sha256(re.sub(rb'"commit": "[^"]*"', b"", file.read_bytes())).hexdigest()
            for file in sorted(folder.rglob("*")) if file.is_file() and file.name not in ("scenario.effective.json", "timing.json")}


@unittest.skipUnless(platform.machine() == "x86_64", "levels are x86-64's")
class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = scratch_folder(cls)
        cls.usr = cls.folder / "root" / "usr"
        if IS_WHEEL:
            # Of other packages only those of the system, which has what the wheel requires.
            must("/usr/bin/python3", "-m", "venv", "--system-site-packages", cls.usr)
            must(cls.usr / "bin" / "pip", "install", "--no-index", PACKAGE)
        else:
            must("dpkg-deb", "-x", PACKAGE, cls.folder / "root")
        cls.library = min(cls.usr.glob("lib/**/libhapbench.so.*"), key=lambda file: len(file.parts)).parent
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
            must(NATIVE, "run", *words, "--out", out, statuses=(0, 3))  # 3: it did not end as expected
            wanted = contents(out)
            self.assertGreater(len(wanted), 1)
            for level in filter(has, LEVELS):
                with self.subTest(run=words, level=level):
                    out = self.folder / f"{Path(level).name}{number}"
                    must(self.program, "run", *words, "--out", out, statuses=(0, 3), LD_LIBRARY_PATH=self.alone(level))
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

    @unittest.skipIf(IS_WHEEL, "it has no headers")
    def test_a_project_of_its_own_runs_its_law_with_it(self):
        build = self.folder / "build"
        must("cmake", "-G", "Ninja", "-S", CONSUMER, "-B", build, f"-DCMAKE_PREFIX_PATH={self.usr}")
        must("cmake", "--build", build)
        file, _ = must(build / "own_law", LD_LIBRARY_PATH=str(self.library)).splitlines()
        self.assertTrue(Path(file).is_relative_to(self.usr / "share" / "hapbench"), file)


@unittest.skipUnless(IS_WHEEL, "of wheels")
class Wheel(unittest.TestCase):
    setUpClass = classmethod(Package.setUpClass.__func__)

    def test_nothing_in_it_names_the_source_tree(self):
        """So that what runs does not run by what lies there."""
        with zipfile.ZipFile(PACKAGE) as wheel:
            self.assertEqual([name for name in wheel.namelist() if bytes(SOURCE) in wheel.read(name)], [])

    def test_it_has_the_licence_of_every_library_that_comes_along(self):
        with zipfile.ZipFile(PACKAGE) as wheel:
            names = wheel.namelist()
            licences = {Path(name).name: wheel.read(name).decode() for name in names if "/licenses/" in name}
        libraries = {Path(name).name.split(".")[0] for name in names if ".data/data/lib/lib" in name}
        self.assertEqual(libraries, {"libhapbench", "libfmt", "libtbb", "libOpenMeshCore"})
        of = {"libhapbench": "hapbench", "libfmt": "libfmt", "libtbb": "libtbb", "libOpenMeshCore": "libopenmesh"}
        for library in libraries:
            texts = [text for name, text in licences.items() if name.startswith(of[library])]
            self.assertTrue(texts and all("opyright" in text for text in texts), library)

    def test_packed_twice_it_is_the_same_file(self):
        stage, again = PACKAGE.parent / "wheel", self.folder / "again"
        again.mkdir()
        file = must("/usr/bin/python3", SOURCE / ".cmake" / "wheel.py", stage, again, PACKAGE.name.split("-")[1]).strip()
        self.assertEqual(Path(file).read_bytes(), PACKAGE.read_bytes())

    def test_program_and_module_serve_the_environment(self):
        run, programs = self.folder / "run", f"{self.usr / 'bin'}:/usr/bin:/bin"
        at = {"cwd": self.folder, "PATH": programs, "HAPBENCH_PYTHON": ""}
        must("hapbench", "run", "drag_molar", "--out", run, **at)
        must("hapbench", "plot", run, **at)
        # Python that the program starts is the environment's, whose site-packages say so.
        mark = self.folder / "environment"
        (next(self.usr.glob("lib/python3*/site-packages")) / "mark.pth").write_text(f"import pathlib; pathlib.Path({str(mark)!r}).touch()")
        must("hapbench", "report", run, **at, PYTHONPATH="")
        self.assertTrue(mark.exists())
        self.assertGreater((run / "report.html").stat().st_size, 1e5)
        self.assertIn("drag_molar", must("hapbench", "list", "scenarios", **at))
        code = "import hapbench; run = hapbench.run('drag_molar'); print(hapbench.__file__); print(run.summary['state_hash'])"
        file, state = must("python3", "-c", code, **at).splitlines()
        self.assertTrue(Path(file).is_relative_to(self.usr), file)
        self.assertEqual(state, json.loads((run / "summary.json").read_text())["state_hash"])

    def test_the_module_has_its_own_scenarios_whatever_lies_beside_the_interpreter(self):
        other = self.folder / "other"
        (other / "share" / "hapbench" / "scenarios").mkdir(parents=True)
        (other / "bin").mkdir()
        shutil.copy(Path("/usr/bin/python3").resolve(), other / "bin" / "python3")
        site = next(self.usr.glob("lib/python3*/site-packages"))
        code = "import hapbench; print(hapbench.run('drag_molar').outcome)"
        at = {"cwd": self.folder, "PYTHONHOME": "/usr", "PYTHONPATH": str(site)}
        self.assertEqual(must(other / "bin" / "python3", "-c", code, **at).strip(), "completes")


if __name__ == "__main__":
    main()
