"""Shared by the commands written in Python: error messages, hints at names, writing of files, and a notice while work takes
long."""
import argparse
import difflib
import errno
import os
import sys
import threading
import time

SUCCESS, FAILED, BAD_INPUT, DIFFERENT, INTERRUPTED = 0, 1, 2, 3, 130
SILENCE = 2.0  # before a notice [s]


def say_error(text):
    """One line on standard error, as the program writes it: control characters of names from outside are replaced."""
    line = "".join("?" if c < " " or c == "\x7f" else c for c in str(text))
    print(f"hapbench: error: {line}", file=sys.stderr)


class Arguments(argparse.ArgumentParser):
    """A parser whose errors are one line, without the usage before it."""

    def error(self, message):
        say_error(f"{message}; {self.prog} --help shows what there is")
        sys.exit(BAD_INPUT)


def nearest(name, names):
    """The end of a message about an unknown name, in the words of the program; empty when no name is near."""
    lower = {candidate.lower(): candidate for candidate in reversed(names)}
    # Half a name before one that merely looks alike.
    longer = sorted((n for n in lower if n.startswith(name.lower())), key=len) or [n for n in lower if name.lower() in n]
    close = longer or difflib.get_close_matches(name.lower(), lower, 1)
    return f"; nearest valid name: \"{lower[close[0]]}\"" if close else ""


def write(file, data):
    """Makes or replaces a file, complete or not at all. `data`: text or bytes. Raises OSError with the file's name."""
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        scratch = file.with_name(f".{file.name}.{os.getpid()}.tmp")
        try:
            with scratch.open("wb") as open_scratch:
                open_scratch.write(data if isinstance(data, bytes) else data.encode())
                open_scratch.flush()
                scratch.replace(file)
        finally:
            scratch.unlink(missing_ok=True)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(file)) from error


def unwritable(error):
    """Says why write() failed. Exit status: bad input where no file can be, a fault where the disk is full or broken."""
    if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EIO):
        say_error(f"cannot write {error.filename}: {error.strerror}")
        return FAILED
    say_error(f"--out {error.filename}: {error.strerror}")
    return BAD_INPUT


class Notice:
    """A line with the seconds, for work that takes longer than two; silent when standard error is no terminal."""

    def __init__(self, text):
        self._text = text
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._show, daemon=True) if sys.stderr.isatty() else None

    def say(self, text):
        """Changes the text."""
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
