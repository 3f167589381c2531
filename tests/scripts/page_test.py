"""The pages of `hapbench report`, and what it says of two results with --tolerance."""
import functools
import html
import json
import re
import shlex

import numpy as np
from scipy import stats

from fixture import assert_whole, hapbench
from pictures_test import Given, drawn, made, make_runs

from hapbench_pictures.differences import are_equal, differences

setUpModule = make_runs
SECTIONS = ["summary", "replay", "curves", "metrics", "scenario", "rerun", "provenance"]


class Page(Given):
    @staticmethod
    @functools.cache
    def page(*words):
        out = Given.root / "page.html"
        hapbench("report", *words, "--out", out)
        return out.read_text(encoding="utf-8")

    def sections(self, *words):
        return re.findall(r'<section id="(\w+)"', self.page(*words))

    def scenes(self, *words):
        return json.loads(re.search(r'<script type="application/json" id="replay-data">(.*?)</script>', self.page(*words), re.S)[1])

    def test_sections_are_there_when_they_have_content(self):
        self.assertEqual(self.sections(self.root / "mesh"), SECTIONS)
        self.assertEqual(self.sections(self.root / "mesh", self.root / "springs"), ["differences", "summary", "diagnosis", *SECTIONS[1:]])
        self.assertIn("pareto", self.sections(self.root / "peg"))
        run = self.copy("mesh")
        (run / "trajectory.csv").unlink()
        summary = json.loads((run / "summary.json").read_text()) | {"warnings": ["one"], "diagnosis": [{"says": "this", "try": "that"}]}
        (run / "summary.json").write_text(json.dumps(summary))
        self.assertEqual(self.sections(run), ["summary", "warnings", "diagnosis", *SECTIONS[3:]])

    def test_refers_to_nothing_outside_itself(self):
        assert_whole(self, self.page(self.root / "mesh"))

    def test_a_comparison_over_seeds_says_what_lies_between_laws(self):
        out = made("seeds", "compare", "peg_in_hole_2d_shaped_stiffness", "--algorithms", "mean,shaped_stiffness,summation", "--set", "time.steps=200",
                   "--seeds", "4", "--jitter", "1e-6", "--by", "force_max_N")
        said = re.findall(r"<code>force_max_N</code>: (\w+) has (\S+) ± (\S+) more than (\w+) over 4 seeds, which (\w+)",
                          re.search(r'<section id="seeds".*?</section>', self.page(out), re.S)[0])
        self.assertEqual(len(said), 2)
        value = lambda law: np.array([json.loads((out / law / f"seed_{k}" / "summary.json").read_text())["metrics"]["force_max_N"] for k in range(4)])
        for law, mean, within, least, word in said:
            more = value(law) - value(least)
            low, high = stats.t.interval(0.95, 3, more.mean(), stats.sem(more))
            self.assertAlmostEqual(float(mean) / more.mean(), 1, delta=0.006)
            self.assertAlmostEqual(float(within) / (0.5 * (high - low)), 1, delta=0.06)
            self.assertEqual(word, "chance" if low > 0 else "may")

    def test_the_commands_repeat_the_run(self):
        command = re.search(r"hapbench (run [^\n<]*scenario.effective.json\S*) --out", self.page(self.root / "springs"))[1]
        again = made("again", *shlex.split(html.unescape(command)))
        self.assertEqual((again / "trajectory.csv").read_bytes(), (self.root / "springs" / "trajectory.csv").read_bytes())

    def test_the_replay_has_every_run_and_a_scene_for_each_surface(self):
        scene, = self.scenes(self.root / "peg")
        self.assertEqual([r["label"] for r in scene["recordings"]], ["mean", "proxy", "shaped stiffness", "summation"])
        self.assertTrue(scene["planar"] and scene["shell"] and scene["recordings"][0]["sound"])
        scenes = self.scenes(self.root / "mesh", self.root / "springs")
        self.assertEqual([(scene["id"], bool(scene["tool"]), bool(scene["springs"])) for scene in scenes],
                         [("mesh_molar", True, False), ("springs_limited_mean-2", False, True)])

    def test_bad_input(self):
        for words, said in (((self.root / "sweep",), "is a sweep"), ((self.root / "mesh", "--out", "x.pdf"), "allowed: .html")):
            error = drawn("report", *words, expected=2)
            self.assertTrue(said in error and error.count("\n") == 1, error)


class Regression(Given):
    """report A B --tolerance."""

    @staticmethod
    def told(a, b, tolerance="0", expected=0):
        return drawn("report", a, b, "--tolerance", tolerance, expected=expected)

    def repeated(self, name, *more):
        return made(name, "run", "peg_in_hole_2d_shaped_stiffness", "--set", "time.steps=300", *more)

    def test_what_differs_is_named_and_measured_as_numpy_does(self):
        a, b = self.repeated("once"), self.repeated("nudged", "--set", f"rendering.stiffness_N_per_m={np.nextafter(20000, 30000)!r}")
        self.assertIn("the results are equal\n", self.told(a, self.repeated("again")))
        found = differences(a, b)
        self.assertEqual([are_equal(found, tolerance) for tolerance in (0.0, 1e-9)], [False, True])
        x, y = (np.genfromtxt(folder / "trajectory.csv", delimiter=",", names=True) for folder in (a, b))
        differs = {name: np.flatnonzero((x[name] != y[name]) & ~(np.isnan(x[name]) & np.isnan(y[name]))) for name in x.dtype.names}
        expected = []
        for name, rows in differs.items():
            if rows.size:
                off = np.abs(x[name] - y[name])
                expected.append((f"{name}, row {np.nanargmax(off)} (first {rows[0]})", np.nanmax(off),
                                 np.nanmax(off) / max(np.nanmax(np.abs(x[name])), np.nanmax(np.abs(y[name])))))
        self.assertEqual([(name, size, relative) for name, _, _, size, relative in found["summary.json"]["trajectory.csv"]], expected)
        said = self.told(a, self.repeated("stiffer", "--set", "rendering.stiffness_N_per_m=20002"), expected=3)
        self.assertRegex(said, r"field +rendering.stiffness_N_per_m +20000 +20002")
        self.assertTrue("force_max_N" in said and "not equal" in said, said)

    def test_runs_and_sweeps_are_paired_by_their_paths(self):
        for out, law, start in (("a", "summation", "0.005"), ("b", "proxy", "0.006")):
            made(out, "compare", "peg_in_hole_2d_shaped_stiffness", "--algorithms", f"mean,{law}", "--set", "time.steps=50")
            made(f"{out}/sweep", "sweep", "single_spring", "--vary", "rendering.stiffness_N_per_m=100,200", "--set", f"initial.position_m=[{start},0,0]")
        found = differences(self.root / "a", self.root / "b")
        self.assertEqual(list(found), ["mean/summary.json", "sweep/sweep.csv", ""])
        self.assertEqual([found["mean/summary.json"][kind] for kind in ("result", "state hash", "trajectory.csv")], [[], [], []])
        self.assertIn("force_max_N, row", " ".join(name for name, *_ in found["sweep/sweep.csv"]["sweep.csv"]))
        self.assertEqual([entry[:3] for entry in found[""]["in one of them alone"]], [("summation/summary.json", "there", "-"), ("proxy/summary.json", "-", "there")])
        self.assertFalse(are_equal(found, 1e9))

    def test_what_is_no_result_is_refused(self):
        run = self.repeated("once")
        for other, tolerance in ((self.root / "none", "0"), (run / "summary.json", "0"), (run, "-1"), (run, "nan")):
            self.assertEqual(self.told(run, other, tolerance, 2).count("\n"), 1)
