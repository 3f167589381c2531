"""Starts a headless Chromium for tests, and checks requirements that hold for every page. HAPBENCH_CHROMIUM names the
browser. chromedriver must be in PATH (scripts/setup --browser installs it)."""
import json
import os
import time
import unittest

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

PATIENCE_S = 300
UNNAMED = """[...document.querySelectorAll('button, select, input, canvas, img')].filter((e) =>
    !(e.getAttribute('aria-label') || e.getAttribute('alt') || e.textContent.trim() && e.tagName === 'BUTTON' ||
      [...(e.labels || [])].some((label) => label.textContent.trim()))).map((e) => e.outerHTML.slice(0, 80))"""

# Finds texts whose contrast to their background is below 4.5 to 1, which WCAG's level AA requires.
PALE = """(() => {
  const rgb = (text) => (text.match(/[\\d.]+/g) || []).map(Number);
  const light = ([r, g, b]) => [0.2126, 0.7152, 0.0722].reduce((sum, part, i) => {
    const c = [r, g, b][i] / 255;
    return sum + part * (c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
  }, 0);
  const behind = (e) => {
    for (; e; e = e.parentElement) {
      const colour = rgb(getComputedStyle(e).backgroundColor);
      if (colour.length === 3 || colour[3] === 1) return colour;
    }
    return [255, 255, 255];
  };
  return [...document.querySelectorAll('body *')].filter((e) => e.checkVisibility() &&
      !e.closest('.visually-hidden, .skip, script, option') &&
      [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim())).filter((e) => {
    const style = getComputedStyle(e);
    const [a, b] = [light(rgb(e.closest('svg') ? style.fill : style.color)), light(behind(e))];
    return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05) < 4.5;
  }).map((e) => e.outerHTML.slice(0, 100));
})()"""


def started(program):
    """Returns a browser without network access. `program`: file of the browser."""
    options = webdriver.ChromeOptions()
    options.binary_location = program
    # The sandbox does not start for root, and the page is trusted.
    sandbox = ["--no-sandbox"] if os.geteuid() == 0 else []
    for option in [
        "--headless=new",
        "--disable-gpu",
        "--hide-scrollbars",
        "--disable-dev-shm-usage",
        *sandbox,
    ]:
        options.add_argument(option)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(service=Service("chromedriver"), options=options)
    driver.set_script_timeout(PATIENCE_S)
    driver.set_network_conditions(offline=True, latency=0, throughput=0)
    return driver


class Page(unittest.TestCase):
    """Base class of the tests of one page, which is opened as a file without network access."""

    @classmethod
    def show(cls, file):
        """Starts a browser for all tests of a module, and sets the page that each test opens. setUpModule calls this
        function."""
        cls.url, cls.driver = file.as_uri(), started(os.environ["HAPBENCH_CHROMIUM"])
        unittest.addModuleCleanup(cls.driver.quit)

    def setUp(self):
        self.complaints()
        self.size(1280, 900)
        self.dark(False)
        self.open()

    def tearDown(self):
        self.assertEqual(self.complaints(), [])

    def call(self, method, **parameters):
        """Calls a method of the browser's DevTools protocol."""
        return self.driver.execute_cdp_cmd(method, parameters)

    def open(self, hash_=""):
        for url in ("about:blank", self.url + hash_):
            self.driver.get(url)
            self.wait_for(
                f"document.readyState === 'complete' && location.href === {json.dumps(url)}"
            )
        self.js("document.documentElement.style.scrollBehavior = 'auto'")

    def wait_for(self, expression):
        deadline = time.monotonic() + PATIENCE_S
        while not self.js(expression):
            if time.monotonic() > deadline:
                raise TimeoutError(expression)
            time.sleep(0.05)

    def js(self, expression):
        """Evaluates a JavaScript expression and returns its value. If the value is a promise, waits for its result."""
        return self.driver.execute_script(f"return ({expression})")

    def complaints(self):
        """Returns the messages since the last call: messages of console and browser except console.log, uncaught
        exceptions, and requests for other files."""
        # Ignores console.log (INFO, like console.info) and browser messages of the lowest level.
        found = [
            entry
            for entry in self.driver.get_log("browser")
            if entry["level"] != ("INFO" if entry["source"] == "console-api" else "DEBUG")
        ]
        messages = [
            json.loads(entry["message"])["message"] for entry in self.driver.get_log("performance")
        ]
        urls = [
            message["params"]["request"]["url"]
            for message in messages
            if message["method"] == "Network.requestWillBeSent"
        ]
        return found + [url for url in urls if not url.startswith(("file:", "data:", "blob:"))]

    def size(self, width, height, scale=1):
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=scale,
            mobile=False,
        )

    def dark(self, dark=True):
        self.call(
            "Emulation.setEmulatedMedia",
            features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}],
        )

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def centre(self, selector):
        return self.js(
            f"(() => {{ const e = document.querySelector('{selector}'); e.scrollIntoView({{block: 'center'}});"
            "const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; })()"
        )

    def click(self, selector):
        """Clicks an element with the mouse; browsers allow sound only after a click."""
        x, y = self.centre(selector)
        for kind in ("mousePressed", "mouseReleased"):
            self.mouse(kind, x, y, button="left", clickCount=1)

    def choose(self, selector, value):
        self.js(
            f"(() => {{ const menu = document.querySelector('{selector}'); menu.value = '{value}';"
            "menu.dispatchEvent(new Event('change')); })()"
        )

    def check_every_page(self):
        """Checks that the page fits on a telephone, that every control has a name, and that every text is legible in
        both themes."""
        self.assertEqual(self.js(UNNAMED), [])
        for dark in (True, False):
            self.dark(dark)
            self.assertEqual(self.js(PALE), [], "dark" if dark else "light")
        self.size(360, 740, 2)
        self.assertLessEqual(self.js("document.documentElement.scrollWidth"), 360)
