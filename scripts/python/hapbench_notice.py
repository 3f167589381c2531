"""Says on standard error what takes so long."""
import sys
import threading
import time

SILENCE = 2.0  # seconds


class Notice:
    """A line with the seconds, for work that takes longer than two; silent when standard error is no terminal."""

    def __init__(self, text):
        self._text = text
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._show, daemon=True) if sys.stderr.isatty() else None

    def say(self, text):
        """What is being done now."""
        self._text = text

    def __enter__(self):
        if self._thread:
            self._thread.start()
        return self

    def __exit__(self, *_):
        self._ended.set()
        if self._thread:
            self._thread.join()

    def _show(self):
        start = time.monotonic()
        if self._ended.wait(SILENCE):
            return
        while True:
            print(f"\r{self._text} ... {time.monotonic() - start:.0f} s\033[K", end="", file=sys.stderr, flush=True)
            if self._ended.wait(0.5):
                break
        print("\r\033[K", end="", file=sys.stderr, flush=True)
