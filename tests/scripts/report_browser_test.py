"""The report in a real headless Chromium."""
import base64
import unittest

from fixture import main, scratch_folder
from headless_chromium import Page
from report_fixture import make_claims, make_figures, make_results, report

# The drawings that are shown.
CANVASES = "[...document.querySelectorAll('#replay .side:not([hidden]) canvas, #replay-chart')]"
# Decodes a screenshot in the page and counts its colours.
COUNT_COLOURS = """(async () => {
  const picture = new Image();
  picture.src = "data:image/png;base64,%s";
  await picture.decode();
  const canvas = Object.assign(document.createElement("canvas"), {width: picture.width, height: picture.height});
  const context = canvas.getContext("2d");
  context.drawImage(picture, 0, 0);
  return new Set(new Uint32Array(context.getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size;
})()"""
# Over all rows of a recording: how many points the page finds in the tool, at least and at most, against the number
# recorded. Places are rounded to half a step of the packing, the pose to single precision: both move a point by less than
# one step along each axis, so that only points within three steps of the surface may change sides.
COUNT_COLLIDING = """(() => {
  const scene = player.scene, wrong = [], step = 3 * player.packed[%d].shellScale;
  for (const recording of scene.recordings) for (let row = 0; row < recording.length; row += 7) {
    const tip = recording.tip(row), axis = recording.axis(row);
    const depths = scene.points.map((point) => scene.depthIn(point.at, tip, axis));
    const least = depths.filter((d) => d >= step).length, most = depths.filter((d) => d >= -step).length;
    if (recording.colliding[row] < least || recording.colliding[row] > most)
      wrong.push([recording.algorithm, row, recording.colliding[row], least, most]);
  }
  return wrong;
})()"""


def setUpModule():
    root = scratch_folder(unittest)
    make_results(root / "results")
    make_figures(root / "figures")
    make_claims(root / "claims.json")
    done = report(root / "results", "--figures", root / "figures", "--claims", root / "claims.json",
                  "--out", root / "report.html")
    assert done.returncode == 0, done.stderr
    InBrowser.show(root / "report.html")


class InBrowser(Page):
    def pictures(self):
        """The pixels of all drawings."""
        return self.js(CANVASES + ".map((c) => c.toDataURL())")

    def tips(self):
        return self.js("[...document.querySelectorAll('.side:not([hidden])')].map((side) => side.dataset.tip)")

    def choose_scene(self, index):
        self.choose("#replay-scene", index)

    def assert_all_differ(self, first, second):
        for a, b in zip(first, second, strict=True):
            self.assertNotEqual(a, b)

    def test_screenshot_is_not_blank(self):
        for part in ("summary", "replay", "figures", "runs"):
            self.js(f"document.getElementById('{part}').scrollIntoView()")
            picture = base64.b64encode(self.browser.screenshot()).decode()
            # Text alone has tens of shades of grey.
            self.assertGreater(self.js(COUNT_COLOURS % picture), 20, part)

    def test_every_figure_is_loaded(self):
        self.assertEqual(self.js("[...document.images].map((i) => i.complete && i.naturalWidth > 0)"), [True] * 5)

    def test_a_click_on_the_slider_moves_the_tools(self):
        for scene in range(2):
            self.choose_scene(scene)
            before, drawn = self.tips(), self.pictures()
            self.click("#replay-time")
            self.assertGreater(self.time(), 0)
            self.assert_all_differ(before, self.tips())
            self.assert_all_differ(drawn, self.pictures())

    def test_arrow_keys_move_the_tools_by_a_row(self):
        # A short run, of which every row is there.
        self.choose_scene(1)
        self.js("document.getElementById('replay-time').focus()")
        before = self.tips()
        self.browser.key("ArrowRight")
        self.assert_all_differ(before, self.tips())
        self.assertEqual(self.js("[...document.querySelectorAll('.side:not([hidden])')].map((side) => side.dataset.row)"), ["1", "1"])
        self.browser.key("Home")
        self.assertEqual(self.tips(), before)

    def test_space_plays_and_pauses(self):
        self.js("document.getElementById('replay-time').focus()")
        self.browser.key(" ", "Space", " ")
        self.browser.wait_for("Number(document.getElementById('replay-player').dataset.time) > 0.2")
        self.browser.key(" ", "Space", " ")
        paused = self.time()
        # Two frames later nothing has moved.
        self.js("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        self.assertEqual(self.time(), paused)

    def test_play_button_runs_to_the_end(self):
        self.choose_scene(1)
        self.js("document.getElementById('replay-speed').value = '2'")
        self.click("#replay-play")
        self.browser.wait_for("document.getElementById('replay-player').dataset.playing === 'false'")
        self.assertEqual(self.time(), self.js("player.duration"))
        self.assertIn("ended: leaves hole", self.js("document.querySelector('.side').textContent"))

    def test_dragging_turns_the_view_of_both_sides(self):
        drawn, (x, y) = self.pictures(), self.centre(".view")
        self.browser.mouse("mousePressed", x, y, button="left", clickCount=1)
        self.browser.mouse("mouseMoved", x + 60, y + 20, button="left", buttons=1)
        self.browser.mouse("mouseReleased", x + 60, y + 20, button="left", clickCount=1)
        views = [i for i, c in enumerate(self.js(CANVASES + ".map((c) => c.className)"))
                 if c == "view"]
        turned = self.pictures()
        self.assertEqual([i for i, (a, b) in enumerate(zip(drawn, turned)) if a != b], views)
        self.js("document.querySelector('.view').focus()")
        self.browser.mouse("mouseWheel", x, y, deltaX=0, deltaY=-200)
        self.browser.wait_for("player.camera.zoom > 1")

    def test_another_algorithm_is_another_run(self):
        self.choose_scene(1)
        self.js("(() => { const menu = document.querySelector('.side select'); menu.selectedIndex = 3;"
                "menu.dispatchEvent(new Event('change')); player.seek(0.1); })()")
        self.assertEqual(self.js("document.querySelector('.side').dataset.algorithm"), "mean")
        self.assertNotEqual(*self.tips())

    def test_the_points_in_the_tool_are_the_recorded_ones(self):
        for scene in range(2):
            self.choose_scene(scene)
            self.assertEqual(self.js(COUNT_COLLIDING % scene), [])

    def test_field_of_the_original_algorithm_is_one_direction(self):
        """u_r u_r^T has eigenvalues 1, 0, 0, in single precision."""
        trace = self.js("(() => { const r = player.scene.recordings[0], s = r.tensor(r.firstTouch); return s[0] + s[3] + s[5]; })()")
        self.assertAlmostEqual(trace, 1, delta=4 * 2.0 ** -24)

    def test_runs_sort_and_filter(self):
        column = "[...document.querySelectorAll('#runs-table tbody tr:not([hidden])')].map((r) => r.cells[5].dataset.sort)"
        heading = "#runs-table thead th:nth-child(6) button"
        for sign in (1, -1):
            self.click(heading)
            values = [float(value) for value in self.js(column)]
            self.assertEqual(values, sorted(values, key=lambda value: sign * value))
        self.js("document.querySelector('[data-filters=runs-table] input').focus()")
        self.browser.call("Input.insertText", text="poke")
        self.assertEqual(len(self.js(column)), 1)
        self.assertIn(f"1 of {len(values)}", self.js("document.querySelector('[data-filters=runs-table]').textContent"))

    def test_a_run_s_name_unfolds_its_scenario(self):
        self.click("#runs-table tbody a")
        self.browser.wait_for("document.querySelector('#parameters details[open]') !== null")

    def test_a_figure_enlarges(self):
        self.click(".enlarge")
        dialog = "document.getElementById('enlarged')"
        self.assertTrue(self.js(f"{dialog}.open"))
        first = self.js(f"{dialog}.querySelector('b').textContent")
        self.browser.key("ArrowRight")
        self.assertNotEqual(self.js(f"{dialog}.querySelector('b').textContent"), first)
        self.browser.wait_for(f"{dialog}.querySelector('img').naturalWidth > 0")
        self.click("#enlarged form button:last-child")
        self.browser.wait_for(f"!{dialog}.open")

    def test_commands_can_be_copied(self):
        self.assertEqual(self.js("document.querySelectorAll('.copy').length"), self.js("document.querySelectorAll('pre.command').length"))
        self.browser.call("Browser.grantPermissions", permissions=["clipboardReadWrite", "clipboardSanitizedWrite"])
        self.click("#figures .copy")
        self.browser.wait_for("/Copied|Selected/.test(document.querySelector('#figures .copy').textContent)")

    def test_a_link_to_a_run_unfolds_it(self):
        self.js("document.querySelectorAll('#ledger-table details').forEach((part) => { part.open = true; })")
        self.click('#ledger-table .links a[href^="#run-"]')
        self.browser.wait_for("document.querySelector('#parameters details details[open]') !== null")

    def test_a_telephone_shows_id_and_verdict_first_and_targets_to_hit(self):
        self.browser.size(420, 900, 2)
        ends = self.js("[...document.querySelectorAll('#ledger-table tbody tr')].map((row) => "
                       "row.cells[1].getBoundingClientRect().right)")
        self.assertLessEqual(max(ends), 420)
        low = self.js("[...document.querySelectorAll('main a, button, select, summary, input[type=search]')].filter((e) => "
                      "e.checkVisibility()).map((e) => [e.getBoundingClientRect().height, e.textContent.slice(0, 30)])"
                      ".filter(([height]) => height < 24)")
        self.assertEqual(low, [])

    def test_light_and_dark(self):
        background = "getComputedStyle(document.body).backgroundColor"
        light, drawn = self.js(background), self.pictures()
        self.browser.dark()
        dark = self.js(background)
        self.assertNotEqual(light, dark)
        self.browser.wait_for(f"document.querySelector('.view').toDataURL() !== '{drawn[0]}'")
        for theme, colour in (("light", light), ("dark", dark), ("system", dark)):
            self.choose("#theme", theme)
            self.assertEqual(self.js(background), colour)

    def test_prints(self):
        self.assertTrue(self.browser.pdf().startswith(b"%PDF-"))

    def test_what_every_page_keeps(self):
        self.check_every_page()


if __name__ == "__main__":
    main()
