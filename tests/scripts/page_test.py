"""Tests the pages of `hapbench report`."""
import functools
import html
import json
import re
import shlex

from fixture import assert_whole, hapbench
from pictures_test import Given, made, make_runs

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
        return json.loads(
            re.search(
                r'<script type="application/json" id="replay-data">(.*?)</script>',
                self.page(*words),
                re.S,
            )[1]
        )

    def test_sections_are_there_when_they_have_content(self):
        self.assertEqual(self.sections(self.root / "mesh"), SECTIONS)
        self.assertEqual(
            self.sections(self.root / "mesh", self.root / "springs"),
            ["differences", "summary", "diagnosis", *SECTIONS[1:]],
        )
        self.assertIn("pareto", self.sections(self.root / "peg"))
        run = self.copy("mesh")
        (run / "trajectory.csv").unlink()
        summary = json.loads((run / "summary.json").read_text()) | {
            "warnings": ["one"],
            "diagnosis": [{"says": "this", "try": "that"}],
        }
        (run / "summary.json").write_text(json.dumps(summary))
        self.assertEqual(self.sections(run), ["summary", "warnings", "diagnosis", *SECTIONS[3:]])

    def test_refers_to_nothing_outside_itself(self):
        assert_whole(self, self.page(self.root / "mesh"))

    def test_the_commands_repeat_the_run(self):
        command = re.search(
            r"hapbench (run [^\n<]*scenario.effective.json\S*) --out",
            self.page(self.root / "springs"),
        )[1]
        again = made("again", *shlex.split(html.unescape(command)))
        self.assertEqual(
            (again / "trajectory.csv").read_bytes(),
            (self.root / "springs" / "trajectory.csv").read_bytes(),
        )

    def test_the_commands_load_the_modules(self):
        """Checks that the command that repeats a run loads the module of the run, and that the page says that the
        module is recorded without its path."""
        run = self.copy("mesh")
        summary = json.loads((run / "summary.json").read_text())
        summary["provenance"]["plugin"] = {"file": "mine.so", "hash": "0"}
        (run / "summary.json").write_text(json.dumps(summary))
        page = self.page(run, self.root / "springs")
        self.assertEqual(
            re.findall(r"scenario.effective.json( --module \S+)? --out", page),
            [" --module mine.so", ""],
        )
        self.assertIn("replace mine.so by the path on this machine", page)
        self.assertNotIn("on this machine.</p>", self.page(self.root / "springs"))

    def test_the_replay_has_every_run_and_a_scene_for_each_surface(self):
        (scene,) = self.scenes(self.root / "peg")
        self.assertEqual(
            [r["label"] for r in scene["recordings"]],
            ["mean", "proxy", "shaped stiffness", "summation"],
        )
        self.assertTrue(scene["planar"] and scene["shell"] and scene["recordings"][0]["sound"])
        scenes = self.scenes(self.root / "mesh", self.root / "springs")
        self.assertEqual(
            [(scene["id"], bool(scene["tool"]), bool(scene["springs"])) for scene in scenes],
            [("mesh_molar", True, False), ("springs_limited_mean-2", False, True)],
        )
