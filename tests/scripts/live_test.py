"""Tests the live page in a real Chromium. For the same motion of the hand, page and program must compute the same
results."""
import json
import re
import time
import unittest

from fixture import PROGRAM, SOURCE, hapbench, must, ran, scratch_folder
from headless_chromium import Page

SCENES = ("peg", "hole", "task2", "wedge", "molar", "friction")
READY = "window.live && live.begun && live.shown ? true : false"

folder = page = None


def setUpModule():
    global folder, page
    folder = scratch_folder(unittest)
    page = folder / "live.html"
    made = ran(SOURCE / "scripts" / "live" / "make", "--out", page)
    if "could not" in made.stderr:
        # A package is not available on this machine.
        raise unittest.SkipTest(made.stderr.strip())
    assert made.returncode == 0, made.stderr
    Live.show(page)


class Live(Page):
    def open(self, hash_=""):
        super().open(hash_)
        self.wait_for(READY)

    def choose(self, selector, value):
        self.js(
            f"(async () => {{ const menu = document.querySelector('{selector}'); menu.value = '{value}';"
            "live.begun = null; menu.dispatchEvent(new Event('change')); })()"
        )
        self.wait_for(READY)

    def move(self, displacement, rows):
        """Moves the hand by the given displacement [m] and rotation [rad] during `rows` time steps."""
        self.js(
            f"(async () => {{ const p = live.pointer; live.aim(p.map((x, i) => x + "
            f"{list(displacement)}[i])); await live.stepRows({rows}); }})()"
        )

    def assert_program_agrees(self, view=0, **files):
        """Asserts that the program computes the state hash of the page for the motion that the page recorded."""
        kept = self.js(f"live.kept({view})")
        file = folder / f"{kept['name']}.json"
        file.write_text(json.dumps(kept["scenario"]), encoding="utf-8")
        for name, content in files.items():
            (folder / name.replace("__", ".")).write_text(content, encoding="utf-8")
        # A tool that went through the surface ends the run with status 3, because this outcome is not expected by
        # default.
        [run] = json.loads(
            must(PROGRAM, "run", file, "--json", "--out", folder / "runs", statuses=(0, 3))
        )
        self.assertEqual(run["state_hash"], kept["state_hash"], kept["name"])
        return run["metrics"]

    def test_every_scene_is_the_program_s(self):
        for scene in SCENES:
            self.open(f"#scene={scene}")
            down = -1e-3
            planar = self.js("live.viewed.planar")
            self.move((9e-4, down if planar else 1e-4, 0 if planar else down, 0.2, 0.1), 700)
            self.move((-5e-4, 0, 0, -0.3, 0), 300)
            touched = [self.assert_program_agrees(view)["steps_in_contact"] for view in (0, 1)]
            self.assertTrue(all(touched), scene)

    def test_a_drag_pushes_the_peg(self):
        before = self.js("live.pointer")
        x, y = self.centre(".view")
        self.mouse("mousePressed", x, y, button="left", clickCount=1)
        for offset in (30, 60):
            self.mouse("mouseMoved", x + 10, y + offset, button="left", buttons=1)
            time.sleep(0.05)
        self.mouse("mouseReleased", x + 10, y + offset, button="left", clickCount=1)
        self.wait_for("live.shown.rows > 1000")
        self.assertTrue(self.js("live.running"))
        self.assertLess(self.js("live.pointer")[1], before[1])
        self.js("live.toggle(false)")
        self.assertGreater(self.assert_program_agrees()["force_max_N"], 0.01)

    def test_an_own_mesh_is_dropped(self):
        cube = (SOURCE / "tests" / "data" / "cube.obj").read_text(encoding="utf-8")
        self.js("document.getElementById('scale').value = '1'")
        self.js(
            f"(() => {{ live.begun = null; const given = new DataTransfer(); given.items.add(new "
            f"File([{json.dumps(cube)}], 'own.obj'));"
            "document.getElementById('live').dispatchEvent(new DragEvent('drop', {dataTransfer: "
            "given, bubbles: true, cancelable: true})); })()"
        )
        self.wait_for("live.begun && live.scene.id === 'own_obj' ? true : false")
        depth = self.js("2 * live.begun[0].half_width_m")
        self.move((0, 0, -2 * depth, 0, 0), 800)
        self.assertGreater(self.assert_program_agrees(own__obj=cube)["steps_in_contact"], 0)

    def test_faults_are_reported_and_left(self):
        self.js(
            'live.takeScenario(\'wrong.json\', \'{"extends": "tap_wall", "tool": {"diameter_m": -1}}\')'
        )
        self.wait_for("document.getElementById('said').classList.contains('failed')")
        self.assertIn("diameter_m", self.js("document.getElementById('said').textContent"))
        self.choose("#scene", "0")
        self.move((0, -1e-4, 0, 0, 0), 50)
        self.assert_program_agrees()

    def test_back_is_the_same_path(self):
        self.move((2e-4, -1e-3, 0, 0.25, 0), 400)
        self.js("live.stepRows(1)")
        before = self.js("live.kept().then((kept) => kept.state_hash)")
        self.js("live.stepRows(199)")
        self.js("live.back(200 * live.begun[0].step_s)")
        self.assertEqual(self.js("live.kept().then((kept) => kept.state_hash)"), before)
        self.assert_program_agrees()

    def test_a_report_leads_to_its_scene(self):
        run, own = folder / "press", folder / "own.html"
        hapbench("run", "press_into_hole", "--set", "time.duration_s=0.1", "--out", run, "--quiet")
        must(PROGRAM, "report", run, "--out", own, "--quiet", HAPBENCH_LIVE=str(page))
        [href] = re.findall(r'<a href="(live.html#[^"]*)">', own.read_text(encoding="utf-8"))
        self.open(href.removeprefix("live.html"))
        self.assertEqual(self.js("live.begun[0].algorithm"), "shaped_stiffness")
        self.move((0, 0, -1e-3, 0, 0), 400)
        self.assertGreater(self.assert_program_agrees()["steps_in_contact"], 0)

    def test_every_law_and_stage_is_the_program_s(self):
        self.choose("#views", "1")
        for menu, values in (
            (".side select", "PACKED.laws"),
            ("#stage", "PACKED.stages.map((_, i) => String(i))"),
            ("#device", "PACKED.devices.map((_, i) => String(i))"),
        ):
            for value in self.js(values):
                self.choose(menu, value)
                self.move((2e-4, -6e-4, 0, 0.2, 0), 250)
                self.assert_program_agrees()
            self.choose(menu, "shaped_stiffness" if "select" in menu else "0")

    def test_every_bundled_scene_is_the_program_s(self):
        """Checks a thousand time steps of each bundled scene. WebAssembly must compute the same bits as the program."""
        short = "time.steps=1000"
        names = {}
        scenarios = SOURCE / "scenarios" / "library"
        for file in sorted(scenarios.glob("*/*.json")):
            if {"environment", "extends"} & json.loads(file.read_text(encoding="utf-8")).keys():
                names[f"/scenarios/{file.relative_to(scenarios)}"] = file
        for data in [*scenarios.glob("*/data/*.csv"), *scenarios.glob("*/data/*.obj")]:
            self.js(
                f"live.files.set('/scenarios/{data.relative_to(scenarios)}', new "
                f"TextEncoder().encode({json.dumps(data.read_text(encoding='utf-8'))}))"
            )
        runs = json.loads(
            must(
                PROGRAM,
                "run",
                *names.values(),
                "--set",
                short,
                "--json",
                "--out",
                folder / "bundled",
                statuses=(0, 3),
            )
        )
        # Skips scenes with several trials, whose steps add up to more than 1000.
        single = {
            name: run["state_hash"]
            for name, run in zip(names, runs, strict=True)
            if run["steps"] <= 1000
        }
        self.assertGreater(len(single), 100)
        found = self.js(
            f"""{json.dumps(list(single))}.map((name) => {{
          try {{
            const engine = new Engine(live.module, live.files, name, ["{short}"], false);
            engine.advance(1000);
            return [name, engine.state.state_hash];
          }} catch (error) {{
            return [name, error.message];
          }}
        }})"""
        )
        self.assertEqual({name: value for name, value in found if single[name] != value}, {})
