"""The rendered force above 30 Hz as a sound: what a hand feels as vibration."""
import base64
import math
import sys
from array import array

import numpy as np
from scipy import signal

CUTOFF_HZ = 30.0
# Two minutes at 2 kHz; half a megabyte in the page.
LONGEST = 1 << 18


def base64_of(code, values):
    """Numbers as text for a page: little endian, base64. Raises OverflowError for one that the type of array cannot hold."""
    packed = array(code, values)
    if sys.byteorder == "big":
        packed.byteswap()
    return base64.b64encode(packed.tobytes()).decode()


def sound(columns):
    """Samples for the page, None where too few rows a second were recorded. One direction is heard, that in which the
    force above 30 Hz is strongest: its size alone would hide a force that turns round."""
    times = columns["time_s"][:LONGEST]
    if len(times) < 3 or not times[-1] > times[0]:
        return None
    rate = (len(times) - 1) / (times[-1] - times[0])
    if rate < 4 * CUTOFF_HZ:
        return None
    filtered = np.array([high_passed(columns[f"f{axis}_N"][:LONGEST], rate) for axis in "xyz"])
    if not (np.abs(filtered) < 1e30).all():
        return None
    heard = strongest(filtered) @ filtered
    peak = np.abs(heard).max()
    if peak == 0:
        return None
    touching = heard[columns["colliding"][:LONGEST] > 0]
    return {"rate": rate, "scale": peak / 32767, "start": times[0],
            "rms": math.sqrt(np.mean(touching**2)) if touching.size else 0.0,
            "samples": base64_of("h", map(round, (heard / peak * 32767).tolist()))}


def high_passed(samples, rate):
    """Butterworth of fourth order, as in results/observe/contact_forces.hpp, at rest at the first sample."""
    sections = signal.butter(4, CUTOFF_HZ, "high", fs=rate, output="sos")
    return signal.sosfilt(sections, samples, zi=signal.sosfilt_zi(sections) * samples[0])[0]


def strongest(signals):
    """Unit vector along which the three signals have most power: the last eigenvector of their covariance."""
    return np.linalg.eigh(signals @ signals.T)[1][:, -1]
