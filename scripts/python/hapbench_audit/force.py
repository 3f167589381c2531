"""Computes metrics of the force: steps, vibration and frequencies. The metrics have the names and definitions of the
metrics of `hapbench run`."""
import math

import numpy as np
from scipy.signal import sosfilt

from .contacts import SETTLING, after_landing

CUTOFF = 30.0  # cutoff of the high-pass filter [Hz]; equals kVibrationCutoff of the program
# Smallest total time of settled contact for which its metrics are computed [s].
MIN_SETTLED = 1.0 / CUTOFF
STEP_SHARE = 0.1  # force steps above this fraction of the mean force are counted
MAX_PEAKS = 3  # largest number of spectral peaks that are reported
# Smallest amplitude of a reported peak, as a fraction of the amplitude of the strongest peak.
SMALLEST_PEAK = 0.1
LOWEST_PEAK = 10.0  # lowest frequency of a reported peak [Hz]; voluntary motion of a hand is slower
# A frequency counts as a multiple of another frequency if its distance from the exact multiple is at most this fraction
# of the frequency.
HARMONIC = 0.02
# The n-th harmonic of a slow motion has at most OVERTONE / n times the amplitude of the motion. The force of a motion
# that presses and releases once per period with the range R has harmonics of at most 2 R / (pi n). Its first harmonic
# is 2 R / pi times sin(pi d), where d is the fraction of the period in which it presses. The value 2 thus covers d from
# 1/6 to 5/6.
OVERTONE = 2.0
# If the amplitude of the strongest peak is below this fraction of the mean force, no peak is reported.
MIN_PEAK = 0.01
SHORTEST_SPECTRUM = 64  # smallest number of rows from which a spectrum is computed
# Smallest number of periods of an oscillation in the rows of longest_stretch(). The middle third of these rows then
# contains two periods.
MIN_PERIODS = 6.0
# Smallest amplitude of an oscillation in the middle third of the rows of longest_stretch(), as a fraction of its
# amplitude in all these rows.
LASTING = 0.5
FALSE_ALARM = 0.01  # probability that noise alone causes a peak in a log


def high_pass(rate):
    """Returns the second-order sections of a Butterworth high-pass of order 4 with the cutoff frequency CUTOFF. The
    design is prewarped, like the class HighPass of the program. Returns None for a `rate` of 60 Hz or less.
    """
    if rate <= 2.0 * CUTOFF:
        return None
    k, sections = math.tan(math.pi * CUTOFF / rate), []
    for angle in (math.pi / 8.0, 3.0 * math.pi / 8.0):
        over_q = 2.0 * k * math.cos(angle)
        n = 1.0 / (1.0 + over_q + k * k)
        sections.append([n, -2.0 * n, n, 1.0, 2.0 * n * (k * k - 1.0), n * (1.0 - over_q + k * k)])
    return np.array(sections)


def filtered(sections, values):
    """Returns the filtered columns of `values`, with one row per sample. The filter starts in the steady state of the
    first row, so that a constant input gives zero."""
    state = np.zeros((2, 2, values.shape[1]))
    state[0, 0], state[0, 1] = -sections[0, 0] * values[0], sections[0, 0] * values[0]
    return sosfilt(sections, values, axis=0, zi=state)[0]


def even(log, contacts):
    """Returns (force [N], flags of settled contact, flags of landings) at equidistant times. If the clock is irregular
    or rows are missing, the force is interpolated linearly between rows."""
    interval, steps = log.interval, np.diff(log.time)
    if np.abs(steps - interval).max() <= 0.05 * interval:
        return log.force, contacts.settled, contacts.landing
    count = min(int((log.time[-1] - log.time[0]) / interval) + 1, 20_000_000)
    at = log.time[0] + np.arange(count) * interval
    row = np.clip(np.searchsorted(log.time, at + 0.5 * interval) - 1, 0, len(log.time) - 1)
    force = np.column_stack([np.interp(at, log.time, column) for column in log.force.T])
    return force, contacts.settled[row], contacts.landing[row]


def reversals(log):
    """Returns for each row True if the force has reversed since the row before it. The result is False if rows are
    missing in between."""
    reverses = np.einsum("ij,ij->i", log.force[1:], log.force[:-1]) < 0.0
    return np.append(False, reverses & (log.missing == 0))


def force_of(log, contacts):
    """Returns the metrics of the force for the JSON. Force steps and reversals across missing rows are not counted."""
    size = np.linalg.norm(log.force, axis=1)
    change = np.diff(log.force, axis=0, prepend=log.force[:1])
    step = np.linalg.norm(change, axis=1)
    step[1:][log.missing > 0] = 0.0
    reverses = reversals(log)
    settled, landing, seconds = contacts.settled, contacts.landing, log.seconds
    settled_s = float(seconds[settled].sum())
    enough = settled_s >= MIN_SETTLED * (1.0 - 1e-9)
    mean = float(np.average(size[settled], weights=seconds[settled])) if enough else None
    seen = seen_rows(log, contacts)
    seen_s = float(seen.sum() * log.interval)
    found = {
        "force_max_N": float(size.max()),
        "force_step_max_N": float(step.max()),
        "force_reversals": int(reverses.sum()),
        "steps_in_contact": int(contacts.in_contact.sum()),
        "contact_share": float(seconds[contacts.in_contact].sum() / seconds.sum()),
        "landings": len(contacts.landings),
        "landing_force_max_N": float(size[landing].max()) if landing.any() else None,
        "landing_force_step_max_N": float(step[landing].max()) if landing.any() else None,
        "settled_s": settled_s,
        "force_mean_in_contact_N": mean,
        "settled_force_max_N": float(size[settled].max()) if enough else None,
        "force_step_p99_N": nearest_rank(step[seen], 0.99) if enough and seen_s else None,
        "settled_force_step_max_N": float(step[seen].max()) if enough and seen_s else None,
        "force_rms_above_30Hz_N": rms_above_cutoff(log, contacts) if enough else None,
        "force_reversals_per_s": per_s(reverses[seen], seen_s) if enough else None,
        "steps_above_share_per_s": per_s(step[seen] > STEP_SHARE * mean, seen_s)
        if enough
        else None,
        "contacts": len(contacts.runs),
        "contacts_lost_per_s": lost_per_s(log, contacts),
        "contacts_lost_after_landing": contacts.lost_after_landing(0, len(size)),
        "contacts_lost_in_spectrum": contacts.lost_after_landing(
            *(longest_stretch(log, contacts) or (0, 0))
        ),
    }
    worst = int(np.argmax(np.where(settled, step, 0.0))) if enough else int(np.argmax(step))
    found["time_of_largest_step_s"] = float(log.time[worst])
    return found


def seen_rows(log, contacts):
    """Returns for each row True if it is in settled contact and no row is missing before it, so that the log shows the
    force step before the row."""
    return contacts.settled & np.append(True, log.missing == 0)


def per_s(flags, seconds):
    """Returns the number of true flags per second, or None if no time was observed."""
    return float(flags.sum() / seconds) if seconds else None


def nearest_rank(values, fraction):
    return float(np.sort(values)[max(math.ceil(fraction * len(values)) - 1, 0)])


def lost_per_s(log, contacts):
    """Returns the number of losses of contact that last less than SETTLING, per second. The time counts from the first
    touch to the last release of each sequence of contacts. Returns None without contact."""
    if not len(contacts.runs):
        return None
    seconds = sum(
        float(log.seconds[contacts.runs[first][0] : contacts.runs[after - 1][1]].sum())
        for first, after in contacts.stretches
    )
    return contacts.lost / seconds


def rms_above_cutoff(log, contacts):
    """Returns the root mean square of the force above 30 Hz [N] over all settled rows, or None if the rate is too low.
    The filter starts in the steady state of the first settled row after each landing."""
    sections = high_pass(1.0 / log.interval)
    if sections is None:
        return None
    force, settled, landing = even(log, contacts)
    starts = np.flatnonzero(settled & ~np.append(False, settled[:-1]))
    ends = np.append(np.flatnonzero(landing & ~np.append(False, landing[:-1])), len(force))
    total, after = 0.0, 0
    for start in starts.tolist():
        if start < after:
            continue
        after = int(ends[np.searchsorted(ends, start)])
        above = filtered(sections, force[start:after])
        total += float(np.sum(above[settled[start:after]] ** 2))
    return math.sqrt(total / max(int(settled.sum()), 1))


def longest_stretch(log, contacts):
    """Returns the first row, and the row after the last row, of the longest sequence of contacts (Contacts.stretches),
    or None without contact. The first SETTLING seconds are excluded if the sequence is longer than three times
    SETTLING."""
    if not contacts.stretches:
        return None
    spans = [
        (contacts.runs[first][0], contacts.runs[after - 1][1])
        for first, after in contacts.stretches
    ]
    first, after = max(spans, key=lambda span: log.seconds[span[0] : span[1]].sum())
    whole = round(SETTLING / log.interval) * log.interval
    is_long = log.seconds[first:after].sum() > 3.0 * whole + 0.5 * log.interval
    return (after_landing(log, first), after) if is_long else (first, after)


def spectrum_of(log, contacts):
    """Returns (frequencies [Hz], amplitudes [N], duration [s]) of the force minus its mean in the rows of
    longest_stretch(), with a Hann window. Returns None for fewer than SHORTEST_SPECTRUM rows."""
    span = longest_stretch(log, contacts)
    if span is None or span[1] - span[0] < SHORTEST_SPECTRUM:
        return None
    first, after = span
    times = log.time[first:after]
    even_times = np.linspace(times[0], times[-1], len(times))
    force = np.column_stack([np.interp(even_times, times, c) for c in log.force[first:after].T])
    force = force - force.mean(axis=0)
    window = np.hanning(len(force))
    padded = 1 << int(math.ceil(math.log2(4 * len(force))))
    transform = np.fft.rfft(force * window[:, None], padded, axis=0)
    # Largest magnitude of the vector of each oscillation over its period: the long half axis of its ellipse.
    total, linear = np.sum(np.abs(transform) ** 2, axis=1), np.abs(np.sum(transform**2, axis=1))
    amplitude = 2.0 * np.sqrt(0.5 * (total + linear)) / window.sum()
    rate = (len(times) - 1) / (times[-1] - times[0])
    return np.fft.rfftfreq(padded, 1.0 / rate), amplitude, float(times[-1] - times[0])


def is_same(frequency, other, resolution):
    """Returns True if a frequency equals the other frequency, or a multiple of the other frequency. The allowed
    difference is `resolution` [Hz] or HARMONIC times the frequency, whichever is larger."""
    times = max(round(frequency / other), 1)
    return abs(frequency - times * other) <= max(resolution, HARMONIC * frequency)


def is_overtone(spectrum, tops, i, resolution):
    """Returns True if the peak `i` can be a harmonic of a slower motion: its frequency is a multiple of the frequency
    of a stronger peak, and its amplitude is at most OVERTONE divided by this multiple, times the amplitude of the
    stronger peak. `tops`: indices of all local maxima of the spectrum."""
    frequency, amplitude, _ = spectrum
    for slow in tops[(tops < i) & (amplitude[tops] > amplitude[i])].tolist():
        times = round(frequency[i] / frequency[slow])
        if (
            times > 1
            and amplitude[i] <= OVERTONE / times * amplitude[slow]
            and is_same(frequency[i], frequency[slow], resolution)
        ):
            return True
    return False


def peaks_of(log, contacts, spectrum, mean):
    """Returns frequency [Hz] and amplitude [N] of the strongest oscillations above LOWEST_PEAK, strongest first. A peak
    is more than 4 times as large as the median amplitude of its neighbourhood, and so large that noise alone causes a
    peak in a log only with the probability FALSE_ALARM. Its frequency is no multiple of the frequency of a stronger
    oscillation, and it is no harmonic of a slower motion by is_overtone(). The oscillation persists in the middle third
    of longest_stretch(). `mean`: mean force in contact [N].
    """
    if spectrum is None or not mean:
        return []
    frequency, amplitude, seconds = spectrum
    resolution = 4.0 / seconds  # width of a peak of the Hann window
    above = frequency > max(LOWEST_PEAK, MIN_PERIODS / seconds)
    if log.held_force is not None:
        # Holding a force repeats its spectrum around multiples of the rate of the loop. Oscillations above half of this
        # rate are copies of lower frequencies.
        above &= frequency <= 0.5 / (log.interval * log.held_force.rows)
    # At each frequency, the amplitude of white noise exceeds r times its median with the probability 2^(-r^2).
    stands_out = math.sqrt(math.log2(seconds * frequency[-1] / FALSE_ALARM))
    top = np.r_[
        False, (amplitude[1:-1] > amplitude[:-2]) & (amplitude[1:-1] >= amplitude[2:]), False
    ]
    top[-1] = amplitude[-1] > amplitude[-2]
    tops = np.flatnonzero(top)
    first, after = longest_stretch(log, contacts)
    third = (after - first) // 3
    found = []
    for i in sorted(np.flatnonzero(top & above), key=lambda i: -amplitude[i]):
        threshold = SMALLEST_PEAK * found[0]["amplitude_N"] if found else MIN_PEAK * mean
        if amplitude[i] < threshold or len(found) == MAX_PEAKS:
            break
        near = np.abs(frequency - frequency[i]) < max(10.0 * resolution, 0.2 * frequency[i])
        is_peak = amplitude[i] > max(stands_out, 4.0) * np.median(amplitude[near])
        if not is_peak or is_overtone(spectrum, tops, i, resolution):
            continue
        if any(is_same(frequency[i], one["frequency_Hz"], resolution) for one in found):
            continue
        if i == len(frequency) - 1:
            # At half the sampling rate, the lines of the positive and the negative frequency coincide, which doubles
            # the amplitude.
            size = 0.5 * amplitude[i]
        else:
            size = amplitude_at(log, first, after, frequency[i])
            if amplitude_at(log, first + third, after - third, frequency[i]) < LASTING * size:
                continue
        found.append({"frequency_Hz": float(frequency[i]), "amplitude_N": float(size)})
    return found


def amplitude_at(log, first, after, frequency):
    """Returns the amplitude [N] of an oscillation at `frequency` [Hz] in the rows from `first` to before `after`: the
    largest magnitude of its vector over a period. It follows from a least-squares fit of a sine and a slow quadratic
    change of the force. The weights are a Hann window."""
    time = log.time[first:after] - log.time[first]
    angle = 2.0 * math.pi * frequency * time
    slow = time / time[-1] - 0.5
    columns = [np.cos(angle), np.sin(angle), np.ones(len(time)), slow, slow**2]
    weight = np.sqrt(np.hanning(len(time)))[:, None]
    found = np.linalg.lstsq(
        weight * np.column_stack(columns), weight * log.force[first:after], rcond=None
    )[0]
    # The long half axis of the ellipse a cos + b sin is the largest singular value of its coefficients.
    return float(np.linalg.norm(found[:2], 2))
