"""A page of own runs in a real headless Chromium: what report_browser_test.py does not try of the replay."""
import time
import unittest

from fixture import hapbench, main, scratch_folder
from headless_chromium import Page, downloaded

# Text against the ground it stands on; inherited grounds are looked up. Returns what falls below 4.5 to 1.
POOR_CONTRAST = """(() => {
  const parse = (text) => (text.match(/[\\d.]+/g) || []).map(Number);
  const linear = (c) => (c /= 255) <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
  const luminance = ([r, g, b]) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
  const ground = (e) => { for (; e; e = e.parentElement) { const c = parse(getComputedStyle(e).backgroundColor); if (c.length === 3) return c; } };
  const poor = [];
  for (const e of document.querySelectorAll("main *")) {
    if (![...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim()) || !e.checkVisibility() || e.disabled) continue;
    const [a, b] = [luminance(parse(getComputedStyle(e).color)), luminance(ground(e))];
    if ((Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05) < 4.5) poor.push(e.outerHTML.slice(0, 90));
  }
  return poor;
})()"""


def setUpModule():
    OwnPage.root = root = scratch_folder(unittest)
    hapbench("compare", "mesh_molar", "--algorithms", "original_averaging,shaped_stiffness,proxy", "--set", "time.duration_s=0.5",
             "--set", "record.contacts=true", "--quiet", "--out", root / "molar")
    hapbench("run", "springs_limited_mean", "--quiet", "--out", root / "springs")
    hapbench("report", root / "molar", root / "springs", "--quiet", "--out", root / "page.html")
    OwnPage.show(root / "page.html")
    OwnPage.browser.call("Page.setDownloadBehavior", behavior="allow", downloadPath=str(root))


class OwnPage(Page):
    def test_three_views(self):
        self.choose("#replay-views", "3")
        shown = self.js("[...document.querySelectorAll('.side:not([hidden])')].map((side) => side.dataset.algorithm)")
        self.assertEqual(shown, ["original_averaging", "shaped_stiffness", "proxy"])
        self.assertEqual(self.js("document.getElementById('replay-key').children.length"), 3)

    def test_sound_follows_the_picture(self):
        grains = "player.sound.grains"
        self.choose("#replay-speed", "0.05")
        self.click("#replay-sound")
        self.browser.wait_for(f"{grains} > 5")
        self.assertEqual(self.js("player.sound.context.state"), "running")
        self.click("#replay-play")
        self.browser.wait_for("document.getElementById('replay-player').dataset.playing === 'false'")
        stopped = self.js(grains)
        time.sleep(0.3)
        self.assertEqual(self.js(grains), stopped)

    def test_sound_switches_between_runs(self):
        heard = "document.getElementById('replay-player').dataset.heard"
        self.assertEqual(self.js(heard), "0")
        self.click("#replay-sound-next")
        self.assertEqual(self.js(heard), "1")
        self.js("document.querySelector('.view').focus()")
        self.browser.key("a")
        self.assertEqual(self.js(heard), "0")

    def test_resampling_keeps_the_samples_and_the_tone(self):
        """At the given samples the same values; between them a sine far below the rate, to the sinc's error."""
        worst = self.js("""(() => {
          const n = 400, f = 0.05, given = Float32Array.from({length: n}, (_, i) => Math.sin(2 * Math.PI * f * i));
          const fine = resampled(given, 8);
          let at = 0, between = 0;
          for (let i = 8 * 20; i < 8 * (n - 20); ++i) {
            const off = Math.abs(fine[i] - Math.sin(2 * Math.PI * f * i / 8));
            if (i % 8) between = Math.max(between, off); else at = Math.max(at, off);
          }
          return [at, between];
        })()""")
        self.assertLess(worst[0], 1e-6)
        # A Hann-windowed sinc of eight samples to a side: its ripple is below 0.5 % in the pass band.
        self.assertLess(worst[1], 5e-3)

    def test_begins_with_numbers(self):
        first = self.js("[...document.querySelectorAll('#summary table tbody tr')].map((row) => [...row.cells].map((c) => c.textContent))")
        self.assertEqual(len(first), 4)
        self.assertRegex(" ".join(first[0]), r"^original averaging\b.* completes .*%.* \d")
        # No name goes on in another line within a word.
        broken = """[...document.querySelectorAll('#summary .name, #metrics .name')].flatMap((cell) =>
          [...cell.childNodes].filter((n) => n.nodeType === 3).flatMap((node) =>
            [...node.textContent.matchAll(/[^ _/]+/g)].filter((word) => {
              const range = document.createRange();
              range.setStart(node, word.index);
              range.setEnd(node, word.index + word[0].length);
              return range.getClientRects().length > 1;
            }).map((word) => word[0])))"""
        for width in (1280, 500):
            self.browser.size(width, 900)
            self.assertEqual(self.js(broken), [])

    def test_space_plays_what_fills_the_window(self):
        playing = "document.getElementById('replay-player').dataset.playing"
        scrolled = "Math.round(scrollY)"
        self.js("document.querySelector('.sides').scrollIntoView({block: 'center'})")
        before = self.js(scrolled)
        self.browser.key(" ", "Space", " ")
        self.assertEqual(self.js(playing), "true")
        self.browser.key(" ", "Space", " ")
        self.assertEqual((self.js(playing), self.js(scrolled)), ("false", before))
        # At the top of the page space scrolls, as anywhere.
        self.js("scrollTo(0, 0)")
        self.browser.key(" ", "Space", " ")
        self.browser.wait_for(f"{scrolled} > 0")
        self.assertEqual(self.js(playing), "false")

    def test_pages_go_on_and_back(self):
        self.js("document.querySelector('.view').focus()")
        self.js("player.seek(0)")
        row = "Number(document.querySelector('.side').dataset.row)"
        steps = []
        for key in ("ArrowRight", "PageDown", "PageUp", "ArrowLeft"):
            self.browser.key(key)
            steps.append(self.js("player.finest.rowAt(player.time)"))
        self.assertEqual(steps, [1, 51, 1, 0])
        self.assertEqual(self.js(row), 0)

    def test_a_link_leads_back(self):
        self.choose("#replay-views", "1")
        self.choose(".side select", "2")
        self.js("player.seek(0.125)")
        self.click("#replay-link")
        hash_ = self.js("location.hash")
        self.assertEqual(hash_, "#replay=mesh_molar,t=0.125,runs=2")
        self.open(hash_)
        self.assertEqual(self.time(), 0.125)
        self.assertEqual(self.js("player.shown.map((r) => r.algorithm)"), ["proxy"])
        self.open("#replay=nothing,t=x")
        self.assertEqual(self.time(), 0)

    def test_the_worst_moment(self):
        self.assertIn(" in view: ", self.js("document.querySelector('#replay-worst button').textContent"))
        self.click("#replay-worst button")
        row = self.js("Math.max(...player.shown.map((r) => r.worst[0].value))")
        at = self.js(f"player.shown.map((r) => r.worst[0]).find((m) => m.value === {row}).time")
        self.assertAlmostEqual(self.time(), at, places=9)

    def test_a_click_on_the_tracks_goes_there(self):
        self.click("#replay-chart")
        self.assertAlmostEqual(self.time() / self.js("player.duration"), 0.47, delta=0.03)

    def test_saves_a_picture(self):
        self.click("#replay-picture")
        self.assertTrue(downloaded(self.root, "*.png").read_bytes().startswith(b"\x89PNG"))

    def test_saves_a_clip(self):
        self.choose("#replay-speed", "2")
        self.click("#replay-clip")
        # The start of an EBML file, which WebM is.
        self.assertTrue(downloaded(self.root, "*.webm").read_bytes().startswith(b"\x1a\x45\xdf\xa3"))

    def test_springs_have_a_replay_too(self):
        self.js("player.openScene(1)")
        drawn = self.js("document.querySelector('.view').toDataURL()")
        self.js("player.seek(0.1)")
        self.assertNotEqual(drawn, self.js("document.querySelector('.view').toDataURL()"))

    def test_text_is_legible(self):
        for dark in (False, True):
            self.browser.dark(dark)
            self.assertEqual(self.js(POOR_CONTRAST), [])

    def test_what_every_page_keeps(self):
        self.check_every_page()
        low = "[...document.querySelectorAll('#replay-player button, #replay-player select')].filter((e) => e.checkVisibility() && e.clientHeight < 24).length"
        self.assertEqual(self.js(low), 0)


if __name__ == "__main__":
    main()
