"""A headless Firefox for tests, driven by the Marionette protocol. HAPBENCH_FIREFOX names the browser."""
import base64
import json
import shutil
import socket
import subprocess
import tempfile
import time
from pathlib import Path

from headless_chromium import PATIENCE_S, Browser


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Firefox(Browser):
    """One browser with one page. Use it in a with statement."""

    def __init__(self, program, width=1280, height=900):
        self.last_id, self.buffer, port = 0, b"", free_port()
        self.profile = tempfile.mkdtemp(prefix="hapbench-firefox-")
        settings = {"marionette.port": port, "media.autoplay.default": 0, "media.autoplay.blocking_policy": 0,
                    "browser.shell.checkDefaultBrowser": False, "datareporting.policy.dataSubmissionEnabled": False,
                    "network.proxy.type": 0, "app.update.enabled": False}
        Path(self.profile, "user.js").write_text("".join(
            f"user_pref({json.dumps(name)}, {json.dumps(value)});\n" for name, value in settings.items()), encoding="utf-8")
        self.process = subprocess.Popen([program, "--headless", "--marionette", "--no-remote", "--profile", self.profile,
                                         f"--width={width}", f"--height={height}", "about:blank"],
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.socket = self.connected(port)
        self.message()  # its greeting
        self.call("WebDriver:NewSession")
        self.call("WebDriver:SetTimeouts", script=1000 * PATIENCE_S)

    def connected(self, port):
        deadline = time.monotonic() + PATIENCE_S
        while True:
            try:
                return socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S)
            except OSError:
                if self.process.poll() is not None or time.monotonic() > deadline:
                    raise
                time.sleep(0.1)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        self.socket.close()
        shutil.rmtree(self.profile, ignore_errors=True)

    def read(self):
        part = self.socket.recv(1 << 16)
        if not part:
            raise RuntimeError("Firefox has ended")
        self.buffer += part

    def message(self):
        """The next one: its length, a colon, JSON."""
        while b":" not in self.buffer:
            self.read()
        length, self.buffer = self.buffer.split(b":", 1)
        while len(self.buffer) < int(length):
            self.read()
        text, self.buffer = self.buffer[:int(length)], self.buffer[int(length):]
        return json.loads(text)

    def call(self, command, **parameters):
        self.last_id += 1
        text = json.dumps([0, self.last_id, command, parameters]).encode()
        self.socket.sendall(b"%d:%s" % (len(text), text))
        _, number, error, result = self.message()
        assert number == self.last_id
        if error:
            raise RuntimeError(f"{command}: {error['message']}")
        return result

    def open(self, url):
        self.call("WebDriver:Navigate", url=url)

    def evaluate(self, expression):
        """The value of an expression, awaited."""
        script = ("const done = arguments[arguments.length - 1];"
                  f"(async () => ({expression}))().then((value) => done([value]), (error) => done([null, String(error)]));")
        value, *error = self.call("WebDriver:ExecuteAsyncScript", script=script, args=[])["value"]
        if error:
            raise RuntimeError(error[0])
        return value

    def drag(self, places):
        """The left button goes down at the first place of the window, moves by the others and up at the last."""
        moves = [{"type": "pointerMove", "x": round(x), "y": round(y), "duration": 50} for x, y in places]
        actions = [moves[0], {"type": "pointerDown", "button": 0}, *moves[1:], {"type": "pointerUp", "button": 0}]
        self.call("WebDriver:PerformActions", actions=[{"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": actions}])

    def click(self, x, y):
        self.drag([(x, y)])

    def size(self, width, height):
        self.call("WebDriver:SetWindowRect", width=width, height=height)

    def screenshot(self):
        return base64.b64decode(self.call("WebDriver:TakeScreenshot", full=False)["value"])
