"""Leaves out rows whose position is a fault of the tracking."""
import numpy as np
from hapbench_import.samples import Samples
from hapbench_import.stroke import resolution_of
from hapbench_import.text_table import counted

# A position is a glitch if it moves away from both neighbouring rows by more than this factor times every other step of
# the NEAR rows before and after it, and by more than MIN_GLITCH.
GLITCH = 10.0
MIN_GLITCH = 1e-4  # [m]
NEAR = 10  # [rows]
MAX_GLITCHES = 0.01  # a larger fraction of rows that are glitches is the motion of the tool


def without_glitches(read):
    """Leaves out the rows whose position is a glitch, and adds a note about them. Returns the changed Read."""
    samples, recording = read.samples, read.recording
    found = glitches_of(samples.position)
    if not len(found):
        return read
    keep = np.delete(np.arange(len(read.kept)), found)
    first = found[0]
    away = samples.position[first] - samples.position[first - 1]
    read.notes.append(
        f"{counted(len(found), 'row')} left out, because the position jumps away for one row and returns, as in a "
        f"fault of the tracking; the first: {recording.row_word} {recording.row_numbers[read.kept[first]]}, by "
        f"{1e3 * np.linalg.norm(away):.3g} mm. If the tool really moved like this, check the engine there"
    )
    read.samples = Samples(
        samples.time[keep],
        samples.position[keep],
        samples.turn[keep],
        None if samples.force is None else samples.force[keep],
        samples.has_roll,
    )
    read.kept = read.kept[keep]
    return read


def glitches_of(position):
    """Returns the numbers of the rows whose position is a glitch (see GLITCH)."""
    steps = np.linalg.norm(np.diff(position, axis=0), axis=1)
    if len(steps) < 2:
        return np.zeros(0, int)
    away = np.minimum(steps[:-1], steps[1:])
    returned = np.linalg.norm(position[2:] - position[:-2], axis=1)
    padded = np.concatenate([np.zeros(NEAR), steps, np.zeros(NEAR)])
    largest = np.lib.stride_tricks.sliding_window_view(padded, NEAR).max(axis=1)
    usual = np.maximum(largest[: len(away)], largest[NEAR + 2 : NEAR + 2 + len(away)])
    threshold = np.maximum(GLITCH * np.maximum(usual, 0.5 * returned), MIN_GLITCH)
    found = np.flatnonzero(away > threshold) + 1
    if not 0 < len(found) <= max(MAX_GLITCHES * len(position), 1):
        return np.zeros(0, int)
    others = np.delete(position, found, axis=0)
    resolution = float(np.linalg.norm([resolution_of(column) or 0.0 for column in others.T]))
    return found[away[found - 1] > GLITCH * resolution]
