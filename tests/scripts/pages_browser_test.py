"""Tests two pages in a headless Chromium: the page about a user's runs, and the page about the thesis. Each page must
fit, be legible in both themes and write no message to the console. Its replay, tables and figures must respond to
input."""
import unittest
from io import BytesIO

from PIL import Image

from fixture import hapbench, scratch_folder
from headless_chromium import Page
from report_test import make_claims, make_figures, make_results, report

PLAYING = "document.getElementById('replay-player').dataset.playing"


def setUpModule():
    root = scratch_folder(unittest)
    hapbench(
        "compare",
        "mesh_molar",
        "--algorithms",
        "original_averaging,shaped_stiffness,proxy,mean",
        "--set",
        "time.duration_s=0.5",
        "--set",
        "record.contacts=true",
        "--quiet",
        "--out",
        root / "molar",
    )
    hapbench("run", "springs_limited_mean", "--quiet", "--out", root / "springs")
    hapbench("report", root / "molar", root / "springs", "--quiet", "--out", root / "page.html")
    make_results(root / "results")
    make_figures(root / "figures")
    make_claims(root / "claims.json")
    done = report(
        root / "results",
        "--figures",
        root / "figures",
        "--claims",
        root / "claims.json",
        "--out",
        root / "report.html",
    )
    assert done.returncode == 0, done.stderr
    OwnPage.show(root / "page.html")
    OfThesis.url, OfThesis.driver = (root / "report.html").as_uri(), OwnPage.driver


class EveryPage:
    def test_it_fits_can_be_read_and_shows_something(self):
        self.check_every_page()
        for width in (400, 1400):
            for dark in (False, True):
                self.size(width, 900)
                self.dark(dark)
                self.assertLessEqual(self.js("document.documentElement.scrollWidth"), width)
                for part in self.PARTS:
                    self.js(f"document.getElementById('{part}').scrollIntoView()")
                    # An empty picture has few colours. A picture with text already has more than 20 shades of grey.
                    colours = Image.open(BytesIO(self.driver.get_screenshot_as_png())).getcolors(
                        20
                    )  # None means that there are more colours
                    self.assertIsNone(colours, part)
        self.assertEqual(
            self.js(
                "[...document.images].filter((i) => !(i.complete && i.naturalWidth > 0)).length"
            ),
            0,
        )


class OwnPage(EveryPage, Page):
    PARTS = ("summary", "replay", "curves", "pareto", "metrics")

    def time(self):
        return float(self.js("document.getElementById('replay-player').dataset.time"))

    def test_it_plays_with_sound(self):
        self.choose("#replay-views", "3")
        self.assertEqual(self.js("[...document.querySelectorAll('.side:not([hidden])')].length"), 3)
        self.choose("#replay-speed", "0.05")
        self.click("#replay-sound")
        self.wait_for("player.sound.grains > 5")
        self.click("#replay-play")
        self.wait_for(f"{PLAYING} === 'false'")
        self.assertGreater(self.time(), 0)

    def test_a_link_leads_back(self):
        self.choose("#replay-views", "1")
        self.choose(".side select", "2")
        self.js("player.seek(0.125)")
        self.click("#replay-link")
        hash_ = self.js("location.hash")
        self.open(hash_)
        self.assertEqual((hash_, self.time()), ("#replay=mesh_molar,t=0.125,runs=2", 0.125))
        self.open("#replay=nothing,t=x")
        self.assertEqual(self.time(), 0)


class OfThesis(EveryPage, Page):
    PARTS = ("summary", "ledger", "replay", "figures")

    def test_the_points_in_the_tool_are_the_recorded_ones(self):
        """Compares the recorded number of points in the tool with the points that the page finds in the tool, in every
        seventh row of all recordings. In the page, positions have rounding errors of up to half a quantisation step,
        and poses have single precision. Only points within three quantisation steps of the tool's surface are
        uncertain; they give a smallest and a largest number. If the page draws only a part of the points, the recorded
        number may exceed the largest number.
        """
        for scene in range(2):
            self.choose("#replay-scene", scene)
            self.assertEqual(
                self.js(
                    """(() => {
              const scene = player.scene, wrong = [], step = 3 * player.packed[%d].shellScale;
              for (const recording of scene.recordings) for (let row = 0; row < recording.length; row += 7) {
                const depths = scene.points.map((point) =>
                  scene.depthIn(point.at, recording.tip(row), recording.axis(row)));
                const least = depths.filter((d) => d >= step).length, most = depths.filter((d) => d >= -step).length;
                if (recording.colliding[row] < least || %s && recording.colliding[row] > most)
                  wrong.push([recording.algorithm, row]);
              }
              return wrong;
            })()"""
                    % (scene, "true" if scene else "false")
                ),
                [],
            )

    def test_the_ledger_sorts_and_filters(self):
        ids = (
            "[...document.querySelectorAll('#ledger-table tbody tr:not([hidden])')].map((r) => "
            "r.cells[0].textContent)"
        )
        for turned in (False, True):
            self.click("#ledger-table thead th:nth-child(1) button")
            self.assertEqual(self.js(ids), sorted((f"C{i}" for i in range(5)), reverse=turned))
        self.js("document.querySelector('[data-filters=ledger-table] input').focus()")
        self.call("Input.insertText", text="not_among_these")
        self.assertEqual(self.js(ids), ["C2"])

    def test_a_figure_enlarges(self):
        self.click(".enlarge")
        self.assertTrue(self.js("document.getElementById('enlarged').open"))
        self.wait_for("document.getElementById('enlarged').querySelector('img').naturalWidth > 0")
