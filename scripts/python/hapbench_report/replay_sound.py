"""The rendered force above 30 Hz as a sound: what a hand feels as vibration."""
import math

from .binary import base64_of

CUTOFF_HZ = 30.0
# Two minutes at 2 kHz; half a megabyte in the page.
LONGEST = 1 << 18


def sound(columns):
    """Samples for the page, None where too few rows a second were recorded. One direction is heard, that in which the
    force above 30 Hz is strongest: its size alone would hide a force that turns round."""
    times = columns["time_s"][:LONGEST]
    if len(times) < 3 or not times[-1] > times[0]:
        return None
    rate = (len(times) - 1) / (times[-1] - times[0])
    if rate < 4 * CUTOFF_HZ:
        return None
    filtered = [high_passed(columns[f"f{axis}_N"][:LONGEST], rate) for axis in "xyz"]
    direction = strongest(filtered)
    heard = [sum(d * f for d, f in zip(direction, sample)) for sample in zip(*filtered)]
    peak = max(map(abs, heard))
    touching = [x for x, colliding in zip(heard, columns["colliding"]) if colliding > 0]
    if not 0 < peak < 1e30:
        return None
    return {"rate": rate, "scale": peak / 32767, "start": times[0],
            "rms": math.sqrt(sum(x * x for x in touching) / len(touching)) if touching else 0.0,
            "samples": base64_of("h", (round(x / peak * 32767) for x in heard))}


def high_passed(samples, rate):
    """Butterworth of fourth order, as in results/observe/butterworth.hpp, at rest at the first sample."""
    k = math.tan(math.pi * CUTOFF_HZ / rate)
    for i, angle in enumerate((math.pi / 8, 3 * math.pi / 8)):
        k_over_q = k * 2 * math.cos(angle)
        n = 1 / (1 + k_over_q + k * k)
        a1, a2 = 2 * n * (k * k - 1), n * (1 - k_over_q + k * k)
        s1, s2 = (-n * samples[0], n * samples[0]) if i == 0 else (0.0, 0.0)
        out = []
        for x in samples:
            bx = n * x
            y = bx + s1
            s1, s2 = s2 - 2 * bx - a1 * y, bx - a2 * y
            out.append(y)
        samples = out
    return samples


def strongest(parts):
    """Unit vector along which the three signals have most power: the first eigenvector of their covariance, by power
    iteration, which needs no more than to hear the right one of two that are nearly equal."""
    power = [[math.fsum(a * b for a, b in zip(p, q)) for q in parts] for p in parts]
    v = [1.0 if i == max(range(3), key=lambda j: power[j][j]) else 0.1 for i in range(3)]
    for _ in range(100):
        v = [sum(a * x for a, x in zip(row, v)) for row in power]
        length = math.hypot(*v)
        if not length > 0:
            return [1.0, 0.0, 0.0]
        v = [x / length for x in v]
    return v
