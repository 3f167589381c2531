"""A headless Chromium for tests, driven over a pipe by the DevTools protocol, and what every page has to keep.
HAPBENCH_CHROMIUM names the browser."""
import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time
import unittest

PATIENCE_S = 300
UNNAMED = """[...document.querySelectorAll('button, select, input, canvas, img')].filter((e) =>
    !(e.getAttribute('aria-label') || e.getAttribute('alt') || e.textContent.trim() && e.tagName === 'BUTTON' ||
      [...(e.labels || [])].some((label) => label.textContent.trim()))).map((e) => e.outerHTML.slice(0, 80))"""

# Texts whose contrast to what is behind them is less than WCAG's level AA asks for, 4.5 to 1.
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
  return [...document.querySelectorAll('body *')].filter((e) => e.checkVisibility() && !e.closest('.visually-hidden, .skip, script, option') &&
      [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim())).filter((e) => {
    const style = getComputedStyle(e), [a, b] = [light(rgb(e.closest('svg') ? style.fill : style.color)), light(behind(e))];
    return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05) < 4.5;
  }).map((e) => e.outerHTML.slice(0, 100));
})()"""


class Chromium:
    """One browser with one page, without network."""

    def __init__(self, program):
        self.messages, self.buffer, self.last_id = [], b"", 0
        self.profile = tempfile.mkdtemp(prefix="hapbench-chromium-")
        to_browser, self.write_end = os.pipe()
        self.read_end, from_browser = os.pipe()
        options = ["--headless=new", "--remote-debugging-pipe", f"--user-data-dir={self.profile}", "--disable-gpu",
                   "--no-first-run", "--hide-scrollbars", "--disable-dev-shm-usage", "--window-size=1280,900"]
        # The sandbox does not start for root, and the page is our own.
        options += ["--no-sandbox"] if os.geteuid() == 0 else []
        # The browser reads from file descriptor 3 and writes to 4.
        self.process = subprocess.Popen(
            ["sh", "-c", f'exec "$@" 3<&{to_browser} 4>&{from_browser}', "sh", program, *options, "about:blank"],
            pass_fds=(to_browser, from_browser), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.session = None
        target = next(t for t in self.call("Target.getTargets")["targetInfos"] if t["type"] == "page")
        self.session = self.call("Target.attachToTarget", targetId=target["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        self.call("Network.emulateNetworkConditions", offline=True, latency=0, downloadThroughput=0, uploadThroughput=0)

    def close(self):
        self.process.kill()
        self.process.wait()
        os.close(self.write_end)
        os.close(self.read_end)
        shutil.rmtree(self.profile, ignore_errors=True)

    def call(self, method, **parameters):
        """The result of a DevTools method; what the browser reports meanwhile is kept in `messages`."""
        self.last_id += 1
        message = {"id": self.last_id, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.write_end, json.dumps(message).encode() + b"\0")
        while (answer := self.next_message()).get("id") != self.last_id:
            self.messages.append(answer)
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error']}")
        return answer["result"]

    def next_message(self):
        while b"\0" not in self.buffer:
            if not select.select([self.read_end], [], [], PATIENCE_S)[0]:
                raise TimeoutError("Chromium does not answer")
            part = os.read(self.read_end, 1 << 20)
            if not part:
                raise RuntimeError("Chromium has ended")
            self.buffer += part
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)

    def open(self, url):
        self.call("Page.navigate", url=url)
        self.wait_for(f"document.readyState === 'complete' && location.href === {json.dumps(url)}")

    def wait_for(self, expression):
        deadline = time.monotonic() + PATIENCE_S
        while not self.evaluate(expression):
            if time.monotonic() > deadline:
                raise TimeoutError(expression)
            time.sleep(0.05)

    def evaluate(self, expression):
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(result["exceptionDetails"])
        return result["result"].get("value")

    def complaints(self):
        """Errors and warnings of console and browser, uncaught exceptions, and requests for anything outside the file."""
        found = []
        self.evaluate("0")
        for message in self.messages:
            method, about = message.get("method"), message.get("params", {})
            if method == "Runtime.exceptionThrown" or (method == "Runtime.consoleAPICalled" and about["type"] != "log"):
                found.append(about)
            elif method == "Log.entryAdded" and about["entry"]["level"] != "verbose":
                found.append(about["entry"])
            elif method == "Network.requestWillBeSent" and not about["request"]["url"].startswith(("file:", "data:", "blob:")):
                found.append(about["request"]["url"])
        return found

    def size(self, width, height, scale=1):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale, mobile=False)

    def dark(self, dark=True):
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def screenshot(self):
        """The visible part, as PNG."""
        return base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])


class Page(unittest.TestCase):
    """Tests of one page, opened from its file without network."""

    @classmethod
    def show(cls, file):
        """Opens the file for the tests of a module, in its setUpModule."""
        cls.url, cls.browser = file.as_uri(), Chromium(os.environ["HAPBENCH_CHROMIUM"])
        unittest.addModuleCleanup(cls.browser.close)

    def setUp(self):
        self.browser.messages.clear()
        self.browser.size(1280, 900)
        self.browser.dark(False)
        self.open()

    def tearDown(self):
        self.assertEqual(self.browser.complaints(), [])

    def open(self, hash_=""):
        self.browser.open("about:blank")
        self.browser.open(self.url + hash_)
        self.js("document.documentElement.style.scrollBehavior = 'auto'")

    def js(self, expression):
        return self.browser.evaluate(expression)

    def centre(self, selector):
        return self.js(f"(() => {{ const e = document.querySelector('{selector}'); e.scrollIntoView({{block: 'center'}});"
                       "const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; })()")

    def click(self, selector):
        """Clicks by the mouse, because browsers allow sound only then."""
        x, y = self.centre(selector)
        for kind in ("mousePressed", "mouseReleased"):
            self.browser.mouse(kind, x, y, button="left", clickCount=1)

    def choose(self, selector, value):
        self.js(f"(() => {{ const menu = document.querySelector('{selector}'); menu.value = '{value}';"
                "menu.dispatchEvent(new Event('change')); })()")

    def time(self):
        return float(self.js("document.getElementById('replay-player').dataset.time"))

    def check_every_page(self):
        """It fits a telephone, every control has a name, and every text can be read in both themes."""
        self.assertEqual(self.js(UNNAMED), [])
        for dark in (True, False):
            self.browser.dark(dark)
            self.assertEqual(self.js(PALE), [], "dark" if dark else "light")
        self.browser.size(360, 740, 2)
        self.assertLessEqual(self.js("document.documentElement.scrollWidth"), 360)
