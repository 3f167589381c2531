"""The pages of `hapbench report`."""
import functools
import html
import json
import os
import re
import shlex

import numpy as np
from scipy import stats

from fixture import PROGRAM, hapbench, main, ran
from pictures_fixture import Given, drawn, make_runs

from hapbench_pictures.differences import are_equal, differences

setUpModule = make_runs


class Page(Given):
    @staticmethod
    @functools.cache
    def page(*words):
        out = Given.root / "page.html"
        hapbench("report", *words, "--out", out)
        return out.read_text(encoding="utf-8")

    def test_refers_to_nothing_outside_itself(self):
        page = self.page(self.root / "mesh")
        for reference in re.findall(r'(?:src|href)="([^"]*)"', page):
            self.assertRegex(reference, r"^(#|data:)")
        names = re.findall(r'\bid="([^"]+)"', page)
        self.assertEqual(len(names), len(set(names)))
        self.assertLessEqual(set(re.findall(r'href="#([^"]+)"', page)), set(names))

    def test_holds_nothing_of_the_thesis(self):
        for name in ("mesh", "springs", "peg"):
            page = self.page(self.root / name)
            # A bundled scenario names its source itself.
            page = re.sub(r"<(style|script|details)\b.*?</\1>|<p class=lead>.*?</p>", "", page, flags=re.S)
            self.assertEqual(re.findall(r"(?i)thesis|ledger|T\. C\. Lee|not reproduced", page), [])

    def test_sections_are_there_when_they_have_content(self):
        page = self.page(self.root / "mesh")
        self.assertEqual(re.findall(r'<section id="(\w+)"', page), ["summary", "replay", "curves", "metrics", "scenario", "rerun", "provenance"])
        run = self.copy("mesh")
        (run / "trajectory.csv").unlink()
        summary = json.loads((run / "summary.json").read_text())
        summary["warnings"] = ["in contact 4.9 % of the run <b>"]
        summary["diagnosis"] = [{"says": "it buzzes", "try": "less <K>"}]
        summary["metrics"] |= {"landing_force_max_N": 7.25, "force_rms_above_30Hz_N": 0.125}
        (run / "summary.json").write_text(json.dumps(summary))
        page = self.page(run)
        self.assertEqual(re.findall(r'<section id="(\w+)"', page), ["summary", "warnings", "diagnosis", "metrics", "scenario", "rerun", "provenance"])
        for text in ("in contact 4.9 % of the run &lt;b&gt;", "landing force max<br><span class=unit>N</span>", "7.25", "force rms above 30Hz", "0.125"):
            self.assertTrue(text in page, text)

    def test_what_differs_between_two_runs_comes_first(self):
        page = self.page(self.root / "mesh", self.root / "springs")
        self.assertEqual(re.findall(r'<section id="(\w+)"', page)[0], "differences")

    def test_a_comparison_over_seeds_says_what_lies_between_laws(self):
        out = self.root / "seeds"
        hapbench("compare", "peg_in_hole_2d_shaped_stiffness", "--algorithms", "mean,shaped_stiffness,summation", "--set", "time.steps=200", "--seeds", "4",
                 "--jitter", "1e-6", "--by", "force_max_N", "--out", out, "--quiet")
        page = self.page(out)
        said = re.findall(r"<code>force_max_N</code>: (\w+) has (\S+) ± (\S+) more than (\w+) over 4 seeds, which (\w+)",
                          re.search(r'<section id="seeds".*?</section>', page, re.S)[0])
        self.assertEqual(len(said), 2)
        value = lambda law: np.array([json.loads((out / law / f"seed_{k}" / "summary.json").read_text())["metrics"]["force_max_N"] for k in range(4)])
        for law, mean, within, least, word in said:
            more = value(law) - value(least)
            low, high = stats.t.interval(0.95, 3, more.mean(), stats.sem(more))
            self.assertAlmostEqual(float(mean) / more.mean(), 1, delta=0.006)
            self.assertAlmostEqual(float(within) / (0.5 * (high - low)), 1, delta=0.06)
            self.assertEqual(word, "chance" if low > 0 else "may")
        self.assertNotIn('id="seeds"', self.page(self.root / "peg"))

    def test_the_commands_repeat_the_run(self):
        page = self.page(self.root / "springs")
        command = re.search(r"hapbench (run [^\n<]*scenario.effective.json\S*) --out", page)[1]
        again = self.root / "again"
        hapbench(*shlex.split(html.unescape(command)), "--out", again, "--quiet")
        self.assertEqual((again / "trajectory.csv").read_bytes(), (self.root / "springs" / "trajectory.csv").read_bytes())

    def test_the_replay_has_every_run(self):
        scene, = self.scenes(self.root / "peg")
        self.assertEqual([r["label"] for r in scene["recordings"]], ["mean", "proxy", "summation"])
        self.assertTrue(scene["planar"])
        self.assertTrue(scene["shell"])
        self.assertIsNotNone(scene["recordings"][0]["sound"])

    def test_runs_of_several_scenes_are_several_replays(self):
        scenes = self.scenes(self.root / "mesh", self.root / "springs")
        self.assertEqual([scene["id"] for scene in scenes], ["mesh_molar", "springs_limited_mean-2"])
        self.assertFalse(scenes[0]["planar"])
        self.assertEqual((scenes[1]["tool"], scenes[1]["shell"]), (None, ""))
        self.assertTrue(scenes[1]["springs"])

    def scenes(self, *words):
        data = re.search(r'<script type="application/json" id="replay-data">(.*?)</script>', self.page(*words), re.S)[1]
        return json.loads(data)

    def test_markup_in_the_input_is_text_in_the_page(self):
        run = self.copy("springs")
        hostile = '</script><script>alert(1)</script><img src="https://example.org/x">'
        summary = json.loads((run / "summary.json").read_text())
        summary |= {"name": hostile, "algorithm": hostile, "outcome": hostile, "warnings": [hostile]}
        (run / "summary.json").write_text(json.dumps(summary))
        page = self.page(run)
        self.assertFalse("<script>alert" in page or '<img src="https' in page)

    def test_of_a_folder_whose_name_is_no_text(self):
        page = self.page(self.copy("mesh").rename(self.root / os.fsdecode(b"na\xffme")))
        self.assertIn("<title>", page)

    def test_bad_input(self):
        for words, said in (((self.root / "sweep",), "is a sweep"), ((self.root / "mesh", "--out", "x.pdf"), "allowed: .html"),
                            ((self.root / "none",), "no such folder")):
            error = drawn("report", *words, expected=2)
            self.assertTrue(said in error and error.count("\n") == 1, error)


class Regression(Given):
    """report A B --tolerance."""

    @staticmethod
    def told(a, b, tolerance="0", expected=0):
        done = ran(PROGRAM, "report", a, b, "--tolerance", tolerance)
        assert done.returncode == expected, done
        return done.stdout + done.stderr

    def repeated(self, name, *more):
        hapbench("run", "peg_in_hole_2d_shaped_stiffness", "--set", "time.steps=300", *more, "--out", self.root / name, "--quiet")
        return self.root / name

    def test_a_repeated_run_is_equal(self):
        self.assertIn("the results are equal\n", self.told(self.repeated("once"), self.repeated("again")))

    def test_fields_results_and_columns_are_named(self):
        a, b = self.repeated("once"), self.repeated("stiffer", "--set", "rendering.stiffness_N_per_m=20002")
        said = self.told(a, b, expected=3)
        for text in ("rendering.stiffness_N_per_m  20000  20002", "force_max_N", "trajectory.csv: 300 rows, first different in row 0", "not equal"):
            self.assertIn(text, said)
        self.assertIn("equal within", self.told(a, b, "0.5"))

    def test_columns_are_measured_as_numpy_does(self):
        a, b = self.repeated("once"), self.repeated("nudged", "--set", f"rendering.stiffness_N_per_m={np.nextafter(20000, 30000)!r}")
        found = differences(a, b)
        self.assertEqual([are_equal(found, tolerance) for tolerance in (0.0, 1e-9)], [False, True])
        x, y = (np.genfromtxt(folder / "trajectory.csv", delimiter=",", names=True) for folder in (a, b))
        table = found["runs"]["."]["trajectory"]
        differs = {name: np.flatnonzero((x[name] != y[name]) & ~(np.isnan(x[name]) & np.isnan(y[name]))) for name in x.dtype.names}
        self.assertEqual(list(table["columns"]), [name for name, rows in differs.items() if rows.size])
        self.assertEqual(table["first"]["row"], min(rows[0] for rows in differs.values() if rows.size))
        for name, of in table["columns"].items():
            off = np.abs(x[name] - y[name])
            self.assertEqual((of["largest"], of["row"]), (np.nanmax(off), np.nanargmax(off)))
            self.assertEqual(of["relative"], np.nanmax(off) / max(np.nanmax(np.abs(x[name])), np.nanmax(np.abs(y[name]))))

    def test_runs_and_sweeps_are_paired_by_their_paths(self):
        a, b = self.root / "pairs_a", self.root / "pairs_b"
        for out, law, start in ((a, "summation", "0.005"), (b, "proxy", "0.006")):
            hapbench("compare", "peg_in_hole_2d_shaped_stiffness", "--algorithms", f"mean,{law}", "--set", "time.steps=50", "--out", out, "--quiet")
            hapbench("sweep", "single_spring", "--vary", "rendering.stiffness_N_per_m=100,200", "--set", f"initial.position_m=[{start},0,0]", "--out", out / "sweep",
                     "--quiet")
        found = differences(a, b)
        self.assertEqual((list(found["runs"]), found["only_in_a"], found["only_in_b"]), (["mean"], ["summation/summary.json"], ["proxy/summary.json"]))
        self.assertEqual(found["runs"]["mean"]["results"], {})
        self.assertIn("force_max_N", found["sweeps"]["sweep/sweep.csv"]["columns"])
        self.assertIn("in A alone: summation/summary.json", self.told(a, b, expected=3))

    def test_what_is_no_result_is_refused(self):
        run = self.repeated("once")
        for other, tolerance in ((self.root / "none", "0"), (run / "summary.json", "0"), (run, "-1"), (run, "nan")):
            self.assertEqual(self.told(run, other, tolerance, 2).count("\n"), 1)


if __name__ == "__main__":
    main()
