"""Draws figures, several at a time."""
import gc
import multiprocessing
import os
import signal
import threading
from concurrent.futures import ProcessPoolExecutor, as_completed

import hapbench_style as style
from hapbench.errors import ResultError
from hapbench_command import write

from . import catalogue
from .results import MissingResult

FORMATS = ("svg", "pdf", "png")


def draw(figure, results, directory):
    """Draws and saves one figure; returns its entry in figures.json."""
    results.start()
    drawing, caption = figure.draw(results)
    files = [f"{figure.stem}.{kind}" for kind in FORMATS]
    for kind, name in zip(FORMATS, files):
        write(directory / name, style.picture(drawing, kind, salt=figure.stem))
    style.plt.close(drawing)
    return {
        "id": figure.id,
        "title": figure.title,
        "thesis_figure": figure.thesis,
        "caption": caption,
        "files": files,
        "sources": sorted(results.sources),
    }


def attempt(number, results, directory):
    """Draws a figure of the catalogue; returns its number, its entry, why it was skipped, and what is wrong with its
    data, two of the three None."""
    figure = catalogue.FIGURES[number]
    try:
        return number, draw(figure, results, directory), None, None
    except MissingResult as missing:
        return number, None, f"{figure.id} ({missing})", None
    except ResultError as error:
        return number, None, None, str(error)
    except (KeyError, IndexError, TypeError, ValueError) as error:
        # A file that can be read but has not the columns, rows or members of hapbench's.
        sources = ", ".join(sorted(results.sources))
        return number, None, None, f"figure {figure.id}: {sources}: {type(error).__name__}: {error}"
    finally:
        gc.collect()


def attempts(figures, results, directory, jobs):
    """Yields what `attempt` returns of each figure as they are finished, `jobs` at a time. Raises OSError when a file
    cannot be written, BrokenProcessPool when a process was killed."""
    numbers = [catalogue.FIGURES.index(figure) for figure in figures]
    # Forked, the processes need not import matplotlib again.
    fork = multiprocessing.get_context("fork")
    pool = ProcessPoolExecutor(min(jobs, len(numbers)), fork, _begin, (results, directory))
    try:
        for future in as_completed([pool.submit(_attempt_here, number) for number in numbers]):
            yield future.result()
    finally:
        pool.shutdown(cancel_futures=True)


def _begin(results, directory):
    """In each process: what `_attempt_here` draws from and to."""
    global _here
    _here = results, directory
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent, which ends the others
    threading.Thread(target=_end_with_parent, daemon=True).start()
    gc.disable()  # a figure makes many objects and leaves few: it took a sixth of the time; `attempt` collects


def _attempt_here(number):
    return attempt(number, *_here)


def _end_with_parent():
    """Killed, the parent can end no one; its processes would wait for work for ever."""
    multiprocessing.parent_process().join()
    os._exit(1)
