"""The handle of an impedance device under held forces that come late: m x'' = u(t - delay) + offset - b x' - c sign(x'),
integrated exactly, stops included."""
import math

import numpy as np

NAMES = ("handle_mass_kg", "viscous_N_s_per_m", "coulomb_N", "delay_s", "offset_N", "start_m", "start_m_per_s")


def motion_factors(rate, h):
    """S and P of x = v S + a P after the time h for x'' = a - rate x', h an array or a number."""
    z = rate * np.asarray(h, float)
    small = z < 1e-4
    safe = np.where(small, 1.0, z)
    # Truncated after z^3, which is 1e-16 of the sum.
    S = h * np.where(small, 1.0 - z / 2.0 + z * z / 6.0, -np.expm1(-safe) / safe)
    P = h * h * np.where(small, 0.5 - z / 6.0 + z * z / 24.0, (safe + np.expm1(-safe)) / (safe * safe))
    return S, P


def positions(time, force, parameters):
    """The positions at `time` of a handle with `parameters` (NAMES); no force of the motors comes before the first one's."""
    mass, viscous, dry, delay, offset, x, v = parameters
    arrivals = time + delay
    edges = np.unique(np.concatenate([time, arrivals[arrivals < time[-1]]]))
    which = np.searchsorted(arrivals, edges[:-1], side="right") - 1
    pushes = (np.where(which < 0, 0.0, force[which]) + offset) / mass
    rate, grip, spans = viscous / mass, dry / mass, np.diff(edges)
    S, P = motion_factors(rate, spans)
    places = [x]
    for h, a, s, p in zip(spans.tolist(), pushes.tolist(), S.tolist(), P.tolist()):
        if v == 0.0 and grip > 0.0:
            x, v = _from_rest(x, h, a, rate, grip)
        else:
            net = a - math.copysign(grip, v)
            after = v + (net - rate * v) * s
            if grip > 0.0 and after * v < 0.0:
                # The velocity falls to zero where the share v / (rate v - net) of `rate` has gone by.
                share = v / (rate * v - net)
                stops = -math.log1p(-rate * share) / rate if rate * share > 1e-9 else share
                s, p = map(float, motion_factors(rate, stops))
                x, v = _from_rest(x + v * s + net * p, h - stops, a, rate, grip)
            else:
                x, v = x + v * s + net * p, after
        places.append(x)
    return np.array(places)[np.searchsorted(edges, time)]


def _from_rest(x, h, a, rate, grip):
    """Place and velocity after the time h from rest."""
    if abs(a) <= grip or h <= 0.0:
        return x, 0.0
    net = a - math.copysign(grip, a)
    s, p = map(float, motion_factors(rate, h))
    return x + net * p, net * s
