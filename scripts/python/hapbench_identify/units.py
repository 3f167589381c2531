"""Finds explanations for a log whose fit is implausible: the opposite sign of the force, or units other than s, N and
m."""
import dataclasses
import itertools
import math

import numpy as np

from .fit import MASS, MAX_TRAVEL, fit

TIMES = {1.0: "s", 1e-3: "ms", 1e-6: "us", 1e-9: "ns"}
POSITIONS = {1.0: "m", 1e-3: "mm", 1e-2: "cm", 1e-6: "um"}
FORCES = {1.0: "N", 1e-3: "mN", 1e3: "kN", 9.80665e-3: "gf", 9.80665: "kgf"}
# Usual ranges in logs of haptic devices: time step [s], travel [m], peak force [N] and handle mass [kg].
STEPS, TRAVELS, PEAKS, MASSES = (1e-5, 0.05), (1e-3, MAX_TRAVEL), (0.05, 60.0), (5e-3, 5.0)
LONGEST_STEP = 0.2  # largest median interval of a log that is fitted without --scale [s]
COARSEST = 1e-3  # largest plausible step of an encoder [m]
ACCEPTED = (1e-3, 20.0)  # masses of handles that are accepted without --scale [kg]
MAX_REPORTED = 3
FOLLOWS = 0.02  # largest rms residual of a fit that follows the motion, as a fraction of the travel


def is_likely(mass, encoder_step):
    return _within(mass, ACCEPTED) and encoder_step <= COARSEST


def turned_round(log, found):
    """Returns the fit with the opposite sign of the force if this fit is much better than the fit `found`, and `found`
    has a misfit or an implausible mass. Otherwise returns None."""
    if not found.misfit and _within(found.values[MASS], ACCEPTED):
        return None
    other = fit(_scaled(log, 1.0, 1.0, -1.0))
    is_good = not other.misfit and other.rms < 0.5 * found.rms
    # A misfit may be the better explanation if it follows the motion.
    is_good |= other.rms < min(0.1 * found.rms, FOLLOWS * _travel(log))
    return other if is_good else None


def is_usual(log, mass):
    """Returns True if mass, travel and force are in the usual ranges of a haptic device."""
    return _within(mass, MASSES) and _travel(log) <= TRAVELS[1] and _peak(log) <= PEAKS[1]


def may_be_exchanged(log):
    """Returns True if the column of the position may have forces, and the column of the force may have positions: the
    range of the positions is too large for a handle, and the values fit the other quantity."""
    return (
        _travel(log) > MAX_TRAVEL and _within(_travel(log), PEAKS) and _within(_peak(log), TRAVELS)
    )


def likely_units(log, found=None):
    """Returns at most MAX_REPORTED likely explanations of the log, each as (text, factors by quantity). With the
    factors, which change units and the sign of the force, the log describes a plausible handle. Only explanations that
    change the fewest units are returned, beginning with the mass that is closest to 0.1 kg. `found`: fit of the
    unscaled log, or None."""
    times = [one for one in TIMES if _within(one * log.step, STEPS)] or [1.0]
    positions = [
        one
        for one in POSITIONS
        if _within(one * _travel(log), TRAVELS) and one * log.encoder_step <= COARSEST
    ] or [1.0]
    forces = [one for one in FORCES if _within(one * _peak(log), PEAKS)]
    sign, unit_mass = _unit_mass(log, times[0], positions[0], found)
    likely = []
    for time, position, force in itertools.product(times, positions, forces):
        mass = unit_mass * force * time**2 / position
        if _within(mass, MASSES):
            changes = (time != 1.0) + (position != 1.0) + (force != 1.0)
            likely.append(
                (changes, abs(math.log10(mass / 0.1)), time, position, sign * force, mass)
            )
    return [
        _explanation(*one[2:]) for one in sorted(likely)[:MAX_REPORTED] if one[0] == min(likely)[0]
    ]


def _unit_mass(log, time, position, found):
    """Returns (sign of the force, mass of the handle [kg] if all numbers were in s, N and m). The mass is proportional
    to force * time^2 / position. If `found` is a Fit without a misfit, its mass is returned. Otherwise the log is
    fitted with the units `time` and `position` and with both signs of the force."""
    if found is not None and not found.misfit:
        return 1.0, found.values[MASS]
    signs = {sign: fit(_scaled(log, time, position, sign)) for sign in (1.0, -1.0)}
    sign = min(signs, key=lambda one: signs[one].rms * (1.0 if one > 0.0 else 1.5))
    return sign, signs[sign].values[MASS] / time**2 * position


def _travel(log):
    return float(np.nanmax(log.position) - np.nanmin(log.position))


def _peak(log):
    return float(np.abs(log.force).max())


def _explanation(time, position, force, mass):
    units = f"{TIMES[time]}, {FORCES[abs(force)]}, {POSITIONS[position]}"
    turned = ", the force with the other sign" if force < 0.0 else ""
    factors = {"time": time, "force": force, "position": position}
    return f"in {units}{turned} it is a handle of {mass:.3g} kg", {
        name: factor for name, factor in factors.items() if factor != 1.0
    }


def scale_option(factors, given):
    """Returns the option --scale with the `given` scales (numbers by quantity) multiplied by `factors`."""
    both = given | {name: factor * given.get(name, 1.0) for name, factor in factors.items()}
    return "--scale " + ",".join(f"{name}={factor:g}" for name, factor in both.items())


def _scaled(log, time, position, force):
    return dataclasses.replace(
        log,
        time=time * log.time,
        force=force * log.force,
        position=position * log.position,
        step=time * log.step,
        encoder_step=position * log.encoder_step,
        encoder_interval=[position * end for end in log.encoder_interval],
    )


def _within(value, ends):
    return ends[0] <= value <= ends[1]
