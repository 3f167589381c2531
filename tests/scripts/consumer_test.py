"""Tests hapbench as a library. Another project uses the installed library, or includes the source folder. The library
must not take elementary functions from the C library. Arguments: the program, cmake, nm, the build tree."""
import json
import re
import shutil
import sys
import unittest
from functools import partial
from pathlib import Path

from fixture import ENVIRONMENT, PROGRAM, SOURCE, must, ran, scratch_folder

CMAKE, NM, BUILD = sys.argv[2:5]
CONSUMER = SOURCE / "tests" / "consumer"
SCENARIO = "peg_in_hole_2d_mean"
# Environment without the compiler flags of the test's caller, which CMake would use.
BARE = {
    key: value
    for key, value in ENVIRONMENT.items()
    if key not in ("CXXFLAGS", "LDFLAGS", "CMAKE_BUILD_TYPE")
}
must = partial(must, env=BARE)
C_FUNCTIONS = re.compile(
    r" U (a?(?:sin|cos|tan)h?|atan2|sincos|exp2?|expm1|log(?:1p|2|10)?|pow|hypot|cbrt|"
    r"c(?:abs|arg|exp|log|pow|sqrt))[fl]?$",
    re.M,
)
# Calls that are allowed. OpenMesh uses the cosine in virtual functions for feature edges, which hapbench does not call.
OPENMESH = {
    ("libhapbench_sim_mesh", "cos"),
    ("libhapbench_scenarios_input", "cos"),
    ("libhapbench_scenarios_scene", "cos"),
}


def ascii_pyramid():
    """Returns an STL file of a closed pyramid, 3 mm high, on a square of 4 mm."""
    a, b, c, d, top = (
        (-2e-3, -2e-3, 0),
        (2e-3, -2e-3, 0),
        (2e-3, 2e-3, 0),
        (-2e-3, 2e-3, 0),
        (0, 0, 3e-3),
    )
    faces = ((a, b, top), (b, c, top), (c, d, top), (d, a, top), (b, a, c), (a, d, c))
    text = "solid pyramid\n"
    for face in faces:
        corners = "".join("vertex {} {} {}\n".format(*corner) for corner in face)
        text += f"facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n"
    return text + "endsolid pyramid\n"


class Consumer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = scratch_folder(cls)
        cls.prefix = cls.folder / "prefix"
        must(CMAKE, "--install", BUILD, "--prefix", cls.prefix)

    def test_an_installed_library_runs_a_law_of_another_project(self):
        build = self.folder / "found"
        must(
            CMAKE,
            "-G",
            "Ninja",
            "-S",
            CONSUMER,
            "-B",
            build,
            f"-DCMAKE_PREFIX_PATH={self.prefix}",
            "-DCMAKE_BUILD_TYPE=Debug",
        )
        must(CMAKE, "--build", build)
        file, state_hash = must(build / "own_law", cwd=self.folder).splitlines()
        self.assertTrue(
            Path(file).is_relative_to(self.prefix / "share" / "hapbench" / "scenarios"), file
        )
        out = self.folder / "out"
        must(PROGRAM, "run", SCENARIO, "--out", out)
        self.assertEqual(state_hash, json.loads((out / "summary.json").read_text())["state_hash"])

    def test_an_installed_renderer_renders_in_a_loop_of_another_project(self):
        """Tests a program in C that finds the installed library by CMake. hapbench must replay the log of this program
        bit for bit."""
        project = CONSUMER / "loop"
        build = self.folder / "loop"
        must(CMAKE, "-G", "Ninja", "-S", project, "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}")
        must(CMAKE, "--build", build)
        program = build / "own_renderer"
        exported = {
            line.split()[-1].split("@")[0]
            for line in must(NM, "-D", "--defined-only", self.library()).splitlines()
            if " T " in line
        }
        self.assertTrue(all(name.startswith("hapbench_renderer_") for name in exported), exported)
        self.assertEqual(len(exported), 8, exported)
        # Renders the molar of the scene drag_molar, and a pyramid.
        pyramid = self.folder / "pyramid.stl"
        pyramid.write_text(ascii_pyramid())
        pyramid_scene = self.folder / "own.json"
        pyramid_scene.write_text(
            json.dumps(
                {
                    "time": {"step_s": 0.001, "steps": 10},
                    "environment": {
                        "type": "mesh",
                        "file": "pyramid.stl",
                        "scale": 1,
                        "spacing_m": 0.0002,
                    },
                    "initial": {"position_m": [0, 0, 0.003]},
                    "tool": {"diameter_m": 0.001, "length_m": 0.01, "tip": "round"},
                    "rendering": {"algorithm": "shaped_stiffness", "stiffness_N_per_m": 2000},
                }
            )
        )
        for scenario, top, deep in (
            ("drag_molar", 0.006, 0.004),
            (str(pyramid_scene), 0.0035, 0.002),
        ):
            motion, log, out = (
                self.folder / name for name in ("motion.csv", "log.csv", "replayed")
            )
            steps = [i / 1500 for i in range(1500)]
            motion.write_text(
                "".join(f"{1e-4 * t!s},{2e-4 * t!s},{top + (deep - top) * t!s}\n" for t in steps)
            )
            largest = float(must(program, scenario, motion, log, cwd=self.folder))
            self.assertGreater(largest, 0.1, scenario)
            replay = json.loads(
                must(PROGRAM, "run", scenario, "--replay", log, "--out", out, "--json")
            )
            self.assertEqual((replay["calls"], replay["equal_calls"]), (1500, 1500), scenario)
            self.assertTrue(replay["is_recorded_scenario"])
            self.assertEqual((out / "replay.csv").read_bytes(), log.read_bytes())
        run = ran(program, "no_such_scenario", "-", "-", cwd=self.folder, env=BARE)
        self.assertEqual(run.returncode, 2)
        self.assertIn("no_such_scenario: no such file and no bundled scenario", run.stderr)

    @unittest.skipUnless(shutil.which("pkg-config"), "no pkg-config")
    def test_the_example_of_a_loop_is_built_by_pkg_config(self):
        example = next(self.prefix.rglob("own_loop.c"))
        libraries = self.library().parent
        flags = must(
            "pkg-config",
            "--cflags",
            "--libs",
            "hapbench_renderer",
            env={**BARE, "PKG_CONFIG_PATH": str(libraries / "pkgconfig")},
        ).split()
        program = self.folder / "own_loop"
        must("cc", "-std=c11", example, "-o", program, *flags, "-lm", "-lpthread")
        text = must(
            program,
            "drag_molar",
            "0.2",
            cwd=self.folder,
            env={**BARE, "LD_LIBRARY_PATH": str(libraries)},
        )
        self.assertIn("missed deadlines", text)

    def library(self):
        return next(self.prefix.rglob("libhapbench_renderer.so"))

    def test_headers_without_the_flags_that_lay_out_their_types_do_not_compile(self):
        source = self.folder / "bare.cpp"
        for header, complaint in (
            ("sim/core/types.hpp", "EIGEN_DONT_VECTORIZE"),
            ("sim/core/simd.hpp", "hapbench's own"),
        ):
            source.write_text(f"#include <{header}>\n")
            run = ran(
                "c++",
                "-std=c++20",
                "-fsyntax-only",
                "-isystem",
                "/usr/include/eigen3",
                "-I",
                self.prefix / "include" / "hapbench",
                source,
            )
            self.assertNotEqual(run.returncode, 0, header)
            self.assertIn(complaint, run.stderr)

    def test_a_folder_of_another_project_leaves_that_alone(self):
        build = self.folder / "parent"
        must(CMAKE, "-S", CONSUMER, "-B", build, "-G", "Ninja", f"-DHAPBENCH_SOURCE={SOURCE}")
        self.assertIn(
            "HAPBENCH_BUILD_TESTS:BOOL=OFF", (build / "CMakeCache.txt").read_text().splitlines()
        )
        all_of_parent = must("ninja", "-C", build, "-t", "commands", "all")
        self.assertNotIn(
            "scenarios/analysis", all_of_parent, "nothing is built that the parent does not link"
        )
        command = next(
            line
            for line in all_of_parent.splitlines()
            if line.rstrip("\"'").endswith("own_law.cpp")
        )
        for word in ("-ffp-contract=off", "-DEIGEN_DONT_VECTORIZE"):
            self.assertIn(word, command)
        for word in ("-Wconversion", "-march", "-Werror", "HAPBENCH_SIMD"):
            self.assertNotIn(word, command)

    def test_it_computes_elementary_functions_itself(self):
        """Checks that no library of hapbench calls an elementary function of the C library, because the last digits of
        its results differ between versions of the C library. Calls by Eigen and by the C++ standard library are also
        detected."""
        archives = sorted(
            p for p in Path(BUILD).rglob("libhapbench_*.a") if "test_support" not in p.name
        )
        self.assertTrue(archives, f"no libraries in {BUILD}")
        found = {
            (archive.stem.removesuffix("_scalar"), name)
            for archive in archives
            for name in C_FUNCTIONS.findall(must(NM, "-u", archive))
        }
        self.assertEqual(found - OPENMESH, set(), "take these from sim/core/math.hpp")
