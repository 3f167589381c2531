"""Estimates stiffness, damping and delay from a log, for each contact and combined over the contacts."""
import math
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.stats import t as student

from .linearity import median_linearity
from .models import Motion, fit_of, low_pass_of, neighbours_of, residuals
from .normal import (
    AS_GOOD,
    EXACTLY,
    FEWEST_COUNTS,
    FEWEST_NEW,
    main_direction,
    normal_by_friction,
    normal_of,
)
from .reasons import no_travel_text, why_unknown

FEWEST = 20  # smallest number of rows of a contact for which a stiffness is estimated
# A model explains a landing if the rms residual of the landing is at most this factor times the rms residual of the
# settled contact. An impact has a larger ratio.
LANDING = 10.0
# A model also explains a landing if the rms residual of the landing is at most this fraction of the range of the force.
EXACT = 0.01
EXPLAINED = 0.5  # smallest fraction of the variance of the force that a spring must explain
UNSURE = 0.05  # fraction of 95 % intervals that do not contain the true value
# Largest half-width of an interval, as a fraction of the value. Values with wider intervals are not reported.
WELL_KNOWN = 0.25
# Another model counts as equally good as the best model if their log-likelihoods differ by at most this value.
UNLIKELY = 5.0
# Relative change of a coefficient that the sampling of the motion may cause: (2 pi f T)^2 / 6 for a motion of f = 17 Hz
# at the sampling period T = 1 ms.
SAMPLED = 2e-3
MAX_TRIED = 60  # largest number of models in the search for a model without negative damping
# Largest log-likelihood difference that one contact contributes to the comparison of a model with the best model.
CERTAIN = 20.0
# Two models count as equally good if their mean square residuals differ by at most this fraction, because residuals are
# not white noise.
SIMILAR = 0.1
# The sampling error of a velocity can explain at most a mean square residual of this factor times the mean square
# residual of the best model.
MAX_EXCUSED = 2.0
NEGLIGIBLE = (
    1e-12  # fraction of the variance of the force that counts as rounding error of the computation
)
# A contact is well explained if its unexplained fraction is at most this factor times the median unexplained fraction
# of all contacts.
TYPICAL = 10.0
DRY_GAIN = 0.7  # dry friction must reduce the sum of squared residuals below this fraction
DRY_SHARE = 0.02  # smallest dry friction, as a fraction of the mean force
# Smallest force that may be cut off by a limit, as a fraction of the largest force of the log.
AT_LIMIT = 0.999


@dataclass
class Evidence:
    """Results of one contact that are needed to select the models of the log."""

    motion: object  # Motion along the fitted direction, or None
    found: dict  # numbers of the contact for the JSON
    # Dict from Model to the log-likelihood of the best Model minus the log-likelihood of this Model.
    likelihood: dict = field(default_factory=dict)
    dampings: dict = field(default_factory=dict)  # least-squares damping by Model [N s/m]
    # Fraction of the best model's squared residuals that is not white noise.
    systematic: float = 0.0
    position: np.ndarray | None = None  # positions of the rows along the direction [m]
    resolution: float = 0.0  # resolution of the position along the direction [m]
    rows: np.ndarray | None = None  # numbers of the rows in the log
    # Motion along another normal that explains the force about as well, or None.
    other: object = None


def evidence_of(log, rows, settled):
    """Returns the Evidence of the contact in these rows. `settled`: the rows after a landing. The rows of the landing
    are used if explains_landing() is true, or if there are too few settled rows."""
    rows, settled = pushing(log, rows), pushing(log, settled)
    if len(rows) < FEWEST_NEW:
        return Evidence(
            None, {"why": f"{len(rows)} rows with a new force, {FEWEST_NEW} are needed"}
        )
    every = evidence_of_rows(log, rows)
    if len(settled) < max(FEWEST_NEW, len(rows) // 2) or len(settled) == len(rows):
        return every
    return every if explains_landing(every, rows, settled) else evidence_of_rows(log, settled)


def explains_landing(evidence, rows, settled):
    """Returns True if the best model explains the landing nearly as well as the settled rows."""
    if not evidence.likelihood:
        return False
    best = min(evidence.likelihood, key=evidence.likelihood.get)
    residual, target = residual_of(evidence.motion, best), evidence.motion.force
    is_settled = np.isin(rows, settled)[evidence.motion.known(best.delay)]
    if is_settled.all() or not is_settled.any():
        return True
    landing, rest = np.mean(residual[~is_settled] ** 2), np.mean(residual[is_settled] ** 2)
    return landing <= LANDING**2 * rest or np.sqrt(landing) <= EXACT * np.ptp(target)


def unexplained(evidence):
    """Returns the fraction of the variance of the force that no model explains; 1 if a spring was not fitted."""
    return 1.0 - evidence.found.get("explained", 0.0)


def pushing(log, rows):
    """Returns the rows whose force is new, not zero, and not limited to the largest force of the log."""
    size = np.linalg.norm(log.force, axis=1)
    flat = np.append(np.abs(np.diff(size)) <= 1e-6 * size.max(), False)
    at_limit = (size >= AT_LIMIT * size.max()) & (flat | np.append(False, flat[:-1]))
    keep = (size > 0.0) & ~at_limit
    if log.held_force is not None:
        keep &= log.held_force.fresh
    return rows[keep[rows]]


def evidence_of_rows(log, rows, given=None):
    """Returns the Evidence of `rows` along the direction `given`. If `given` is None, the direction is the normal of
    the surface."""
    force = log.force[rows]
    direction = main_direction(force) if given is None else given
    motion, other = Motion(log, rows, direction), None
    if given is None and np.linalg.matrix_rank(log.position[rows] - log.position[rows[0]]) > 1:
        direction, motion, other = normal_of(log, rows, direction, motion)
    sideways = np.linalg.norm(force - np.outer(force @ direction, direction)) / np.linalg.norm(
        force
    )
    position = log.position[rows] @ direction
    resolution, travel = float(np.abs(direction) @ log.quantum_m), float(np.ptp(position))
    # The noise of the force is the part that neither the model nor neighbouring rows explain. 1.4826 times the median
    # absolute value is the standard deviation of normal errors. Second differences of white noise have 6 times its
    # variance.
    changes = np.diff(force @ direction, 2) / math.sqrt(6.0)
    found = {
        "direction": direction.tolist(),
        "direction_is_known": other is None,
        "off_direction_share": float(sideways),
        "travel_m": travel,
        "resolution_m": resolution,
        "noise_N": 1.4826 * float(np.median(np.abs(changes))),
        "start_s": float(log.time[rows[0]]),
        "end_s": float(log.time[rows[-1]]),
    }
    if travel <= FEWEST_COUNTS * resolution or travel <= 1e-12:
        return Evidence(
            None,
            found | {"why": no_travel_text(travel, resolution, force, found["noise_N"])},
            rows=rows,
        )
    if np.ptp(log.force[rows] @ direction) == 0.0:
        return Evidence(None, found | {"why": "the force is constant"})
    known, best = residuals(motion)
    if best is None:
        return Evidence(None, found | {"why": "position and velocity are not independent"})
    rest = residual_of(motion, best)
    unexplained_N = 1.4826 * float(np.median(np.abs(rest)))
    found["noise_N"] = min(found["noise_N"], unexplained_N)
    found["explained"] = 1.0 - known[best].mean_square / max(known[best].total, 1e-300)
    if found["explained"] < EXPLAINED:
        found["why"] = (
            f"a spring and a damper explain {100.0 * max(found['explained'], 0.0):.0f} % of the force's variance, as "
            "in a rigid contact, or with friction along the force"
        )
        return Evidence(None, found, rows=rows)
    return Evidence(
        motion,
        found,
        likelihoods(motion, known, best),
        {model: one.damping for model, one in known.items()},
        systematic_share(motion, rest),
        position,
        resolution,
        rows,
        other,
    )


def likelihoods(motion, found, best):
    """Returns for each Model the log-likelihood of the best Model minus the log-likelihood of this Model.

    If rounding and sampling explain the residual of a model, the model counts as equally good as the best model,
    although its residual may be larger than the residual of the best model. If the engine itself renders the rounded
    positions, rounding causes no residual. The effects of rounding and sampling are therefore multiplied by `share`:
    the mean square residual of the best model, divided by the mean square that rounding and sampling can cause; at
    most 1.
    """
    smallest = found[best]
    floor = NEGLIGIBLE * smallest.total
    share = min(1.0, smallest.mean_square / max(smallest.rounding + smallest.sampling, 1e-300))
    independent = fit_of(motion, best).independent

    def below(one):
        # The effect of rounding is known exactly. The error of a sampled velocity is known only roughly, so that its
        # effect is limited to MAX_EXCUSED.
        usual = smallest.mean_square + share * (one.sampling - smallest.sampling)
        usual = min(max(usual, smallest.mean_square), MAX_EXCUSED * smallest.mean_square)
        usual += share * max(one.rounding - smallest.rounding, 0.0) + floor
        return max(math.log((one.mean_square + floor) / (1.0 + SIMILAR) / usual), 0.0)

    return {model: 0.5 * independent * below(one) for model, one in found.items()}


def systematic_share(motion, residual):
    """Returns the fraction of the squared residuals that is not white noise. Second differences of white noise have 6
    times its variance."""
    power = float(residual @ residual) / len(residual)
    if len(residual) < 3 or power <= NEGLIGIBLE * float(np.var(motion.force)):
        return 0.0
    return max(1.0 - float(np.mean(np.diff(residual, 2) ** 2)) / 6.0 / power, 0.0)


def residual_of(motion, model):
    """Returns the force minus the force of a model [N], for the rows known() at the delay of the model."""
    matrix, target = motion.columns(model)
    return target - matrix @ np.linalg.lstsq(matrix, target, rcond=None)[0]


def as_good(log, evidences):
    """Returns the models that explain all contacts about as well as the best model, best model first. If a contact is
    too short for the delay of a model, the longest possible delay in this contact is used. Models with negative damping
    are omitted if other models are as good."""
    models = sorted({model for one in evidences for model in one.likelihood})
    if not models:
        return []

    # If the law of the engine is not a spring and a damper, all contacts have similar residuals and are not
    # independent. With a correlation s between contacts, n contacts count as n / (1 + (n - 1) s) independent contacts.
    alike = float(np.mean([one.systematic for one in evidences]))
    weight = 1.0 / (1.0 + (len(evidences) - 1) * alike)

    def score(model):
        total = 0.0
        for one in evidences:
            while model not in one.likelihood and model.delay > 0:
                model = type(model)(model.delay - 1, model.kind)
            total += weight * min(one.likelihood.get(model, CERTAIN), CERTAIN)
        return total

    scores = {model: score(model) for model in models}
    order = sorted(models, key=lambda model: (scores[model], model))
    lowest = scores[order[0]]
    found = [model for model in order if scores[model] <= lowest + UNLIKELY]
    non_negative = [model for model in found if not is_negative(log, evidences, model)]
    if non_negative:
        return non_negative
    # All models in `found` have negative damping. If no model fits well, the sign of the damping can be wrong. The best
    # model without negative damping is therefore added.
    near = [m for m in order if scores[m] <= lowest + 0.5 * CERTAIN * len(evidences)]
    best = next((m for m in near[:MAX_TRIED] if not is_negative(log, evidences, m)), None)
    return found if best is None else [*found, best]


def is_negative(log, evidences, model):
    """Returns True if the damping of a model is negative in most contacts, at the 95 % level. Dampings between -K T / 4
    and 0 count as zero, with the stiffness K and the sampling period T of the position. A delay d that the model lacks
    changes its damping by -K d."""

    def negative(one):
        if one.dampings[model] >= 0.0:
            return False
        fit = fit_of(one.motion, model)
        if fit is None:
            return False
        half = damping_half(log, one, widened(one.motion, fit, False))
        return fit.damping + half < -0.25 * fit.stiffness * one.motion.interval < 0.0

    having = [one for one in evidences if model in one.likelihood]
    negatives = 0
    for number, one in enumerate(having, start=1):
        negatives += negative(one)
        # Stops if the remaining contacts cannot change the result.
        if 2 * negatives > len(having) or 2 * (negatives + len(having) - number) <= len(having):
            break
    return 2 * negatives > len(having)


def well_explained(evidences):
    """Returns the contacts whose force a spring and a damper explain at least about as well as the force of the median
    contact."""
    usual = float(np.median([unexplained(one) for one in evidences])) if evidences else 0.0
    return [one for one in evidences if unexplained(one) <= TYPICAL * usual + NEGLIGIBLE]


def with_shared_normal(log, evidences):
    """Returns the evidences after a search for a normal that several contacts share, because most logs have one flat
    surface. Two normals are candidates for all contacts: the normal of the contact whose force a spring explains best,
    and the normal that follows from the friction in all contacts. A contact uses a candidate if this candidate leaves
    less of the contact's force unexplained than the contact's own normal does."""
    known = [one for one in evidences if one is not None and one.likelihood]
    if log.axes == 1 or len(known) < 2:
        return evidences
    best = min(known, key=unexplained)
    direction = np.array(best.found["direction"])
    rubbed = normal_by_friction(log, np.concatenate([one.rows for one in known]), direction)

    def improved(one):
        if one is None or one.rows is None:
            return one
        shared = [] if rubbed is None or unexplained(one) <= EXACTLY else [rubbed]
        if unexplained(one) > TYPICAL * unexplained(best):
            shared.append(direction)
        others = [evidence_of_rows(log, one.rows, normal) for normal in shared]
        other = min(others, key=unexplained, default=one)
        return other if unexplained(other) < AS_GOOD * unexplained(one) else one

    return [improved(one) for one in evidences]


@dataclass
class Estimate:
    """A value with its interval. For one contact, the value belongs to the best model, and the interval contains the
    95 % intervals of all models of as_good(). For the whole log, combined() computes both."""

    value: float
    low: float
    high: float

    @property
    def half(self):
        return 0.5 * (self.high - self.low)


def numbers_of(log, evidence, models):
    """Returns a dict with the estimates of one contact. Their intervals cover all `models`. If the contact does not
    determine a stiffness, the entry `why` of the dict is the reason."""
    usable = [model for model in models if model in evidence.likelihood]
    unbounded = unbounded_by(evidence, usable)
    if unbounded is not None:
        delays = sorted({model.delay for model in usable})
        return {"why": why_unknown(unbounded, None, delays, log.interval)}
    fits = [fit for model in usable if (fit := fit_of(evidence.motion, model)) is not None]
    if not fits:
        return {"why": "the contact is too short for the delay of the force"}
    nearest = min(fits, key=lambda fit: fit.model.delay)
    if nearest.stiffness + nearest.halves[0] <= 0.0:
        return {
            "why": f"the force grows along its own direction, by {-nearest.stiffness:.4g} N/m",
            "apparent_stiffness_N_per_m": nearest.stiffness,
        }
    best = likely(fits)
    friction = dry_friction(evidence.motion, best)
    if friction:
        again = [fit_of(evidence.motion, fit.model, True) for fit in fits]
        fits = [fit for fit in again if fit is not None]
        best = next(fit for fit in fits if fit.model == best.model)
    interval = log.interval
    fits = [widened(evidence.motion, fit, bool(friction)) for fit in fits]
    fits += along_other_normal(evidence, fits)
    stiffness = spanned(
        best.stiffness, fits, lambda fit: (fit.stiffness, stiffness_half(evidence, fit))
    )
    damping = spanned(
        best.damping, fits, lambda fit: (fit.damping, damping_half(log, evidence, fit))
    )
    # Slow motion determines only B - K d, with the damping B, the stiffness K and the delay d.
    slow = spanned(
        best.damping - best.stiffness * best.model.delay * interval,
        fits,
        lambda fit: (
            fit.damping - fit.stiffness * fit.model.delay * interval,
            damping_half(log, evidence, fit)
            + fit.model.delay * interval * stiffness_half(evidence, fit),
        ),
    )
    delays = sorted({fit.model.delay for fit in fits})
    numbers = {
        "explained": best.explained,
        "delay_rows_interval": [delays[0], delays[-1]],
        "dry_friction_N": -float(best.values[2]) if friction else 0.0,
        "stiffness": stiffness,
        "damping": damping,
        "slow_damping": slow,
        "best": best,
        "fits": fits,
    }
    if stiffness.low <= 0.0 or stiffness.half > WELL_KNOWN * stiffness.value:
        numbers["why"] = why_unknown(best, stiffness, delays, interval)
    return numbers


def unbounded_by(evidence, models):
    """If one of the models allows a stiffness of zero, returns the Fit of the best model; otherwise None. The search
    ends at the first model that allows a stiffness of zero, because further models cannot narrow the interval. Returns
    None if the contact has dry friction. `models`: best model first."""
    best = None
    for model in models:
        fit = fit_of(evidence.motion, model)
        if fit is None:
            continue
        if best is None:
            best = fit
            if dry_friction(evidence.motion, best):
                return None
        if abs(fit.stiffness) <= fit.halves[0]:
            return best
    return None


def along_other_normal(evidence, fits):
    """Returns the fits of the same models along the other normal, or an empty list without another normal."""
    if evidence.other is None:
        return []
    found = [fit_of(evidence.other, fit.model) for fit in fits]
    return [widened(evidence.other, fit, False) for fit in found if fit is not None]


def widened(motion, fit, with_sign):
    """Returns the fit with wider intervals. The wider intervals also contain the sampling error and the distance to the
    fits of neighbours_of()."""
    halves = fit.halves
    near = [fit_of(motion, model, with_sign) for model in neighbours_of(fit.model, motion.speeds)]
    distances = [np.abs(one.values - fit.values) for one in near if one is not None]
    if fit.explained < 1.0 - EXACTLY:
        halves = halves + SAMPLED * np.abs(fit.values)
    if distances:
        # The time constant of the engine differs from the modelled time constant by at most half the distance to the
        # next modelled time constant.
        share = 0.5 if low_pass_of(fit.model.kind) else 1.0
        halves = halves + share * np.max(distances, axis=0)
    return replace(fit, halves=halves)


def likely(fits):
    """Returns the first fit with a positive stiffness and without a significantly negative damping. If no fit meets
    both conditions, returns the first fit. A delay that the model lacks causes a negative damping.
    """
    return next(
        (fit for fit in fits if fit.stiffness > 0.0 and fit.damping + fit.halves[1] >= 0.0), fits[0]
    )


def spanned(value, fits, ends):
    """Returns the Estimate whose interval contains the intervals of all fits. `ends`: function that returns (value,
    half-width of the interval) of a fit."""
    pairs = [ends(fit) for fit in fits]
    return Estimate(
        float(value),
        float(min(one - half for one, half in pairs)),
        float(max(one + half for one, half in pairs)),
    )


def noise_share(evidence, fit, interval):
    """Returns the variance of the residuals divided by the variance that the resolution of the position causes, at most
    1. The ratio is 0 for an engine that renders the rounded position, because the residuals are then zero.
    """
    q = evidence.resolution
    if q == 0.0:
        return 0.0
    rounding = (fit.stiffness * q) ** 2 / 12.0 + (fit.damping * q / interval) ** 2 / 6.0
    return min(1.0, fit.squares / fit.rows / max(rounding, 1e-300))


def stiffness_half(evidence, fit):
    # Rounding of the position reduces a slope by the ratio of the rounding's variance to the position's variance.
    shrink = evidence.resolution**2 / 12.0 / max(float(np.var(evidence.position)), 1e-300)
    return fit.halves[0] + (1e-6 + shrink) * abs(fit.stiffness)


def damping_half(log, evidence, fit):
    interval, q = log.interval, evidence.resolution
    half = (
        fit.halves[1]
        + (1e-6 + log.interval_error) * abs(fit.damping)
        + 1e-9 * abs(fit.stiffness) * interval
    )
    if log.velocity is not None or q == 0.0:
        return half
    # With the resolution q, the rounding error of a difference of two positions has the variance q^2/6, and the
    # covariance q^2/12 with the rounding error of the position.
    bias = (
        abs(fit.damping) * (q / interval) ** 2 / 6.0 + abs(fit.stiffness) * q**2 / 12.0 / interval
    )
    return half + noise_share(evidence, fit, interval) * bias / max(fit.speed**2, 1e-300)


def dry_friction(motion, best):
    """Returns True if the sign of the velocity explains much of the residual of spring and damper. `best`: Fit without
    dry friction."""
    if best.explained >= 1.0 - 1e-6:
        return False
    fit = fit_of(motion, best.model, True)
    return (
        fit is not None
        and fit.squares < DRY_GAIN * best.squares
        and abs(fit.values[2]) > max(fit.halves[2], DRY_SHARE * np.abs(motion.force).mean())
    )


def combined(estimates):
    """Returns (combined Estimate, index of the estimate with the nearest value). The combined value is the weighted
    median of the estimates, with the inverse squared half-widths of the intervals as weights. The half-width of the
    combined interval is the larger of two values: the weighted median half-width, and the value that follows from the
    scatter of the estimates. The combined interval is widened to contain the interval of the nearest estimate.
    """
    values = np.array([one.value for one in estimates])
    halves = np.array([max(one.half, 1e-9 * abs(one.value), 1e-300) for one in estimates])
    weights = halves**-2.0
    middle = weighted_median(values, weights)
    share = weights / weights.sum()
    count = 1.0 / float(np.sum(share**2))  # effective number of contacts with equal weights
    scatter = 0.0
    if len(values) > 1:
        # The median distance times 1.4826 is the standard deviation of normal errors.
        deviation = 1.4826 * weighted_median(np.abs(values - middle), weights)
        scatter = student.ppf(0.975, max(count - 1.0, 1.0)) * deviation / math.sqrt(count)
    index = int(np.argmin(np.abs(values - middle)))
    low, high = estimates[index].low, estimates[index].high
    half = max(weighted_median(halves, weights), scatter)
    return Estimate(middle, min(low, middle - half), max(high, middle + half)), index


def weighted_median(values, weights):
    order = np.argsort(values, kind="stable")
    total = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(total, 0.5 * total[-1])])


def stated(log, numbers):
    """Returns the JSON of one contact. `numbers`: result of numbers_of()."""
    found = {key: numbers[key] for key in ("why", "apparent_stiffness_N_per_m") if key in numbers}
    if "stiffness" not in numbers or "why" in numbers:
        return found
    return found | values_of(
        log, numbers["stiffness"], numbers["damping"], numbers["slow_damping"], numbers
    )


def values_of(log, stiffness, damping, slow, numbers):
    """Returns the JSON of the estimates. Delay and damping are None if the log does not determine them. `slow`:
    Estimate of damping minus stiffness times delay [N s/m]."""
    first, last = numbers["delay_rows_interval"]
    is_known = first == last
    found = {
        "stiffness_N_per_m": stiffness.value,
        "stiffness_interval": [stiffness.low, stiffness.high],
        "delay_rows": first if is_known else None,
        "delay_s": first * log.interval if is_known else None,
        "delay_interval_s": [first * log.interval, last * log.interval],
        "slow_damping_N_s_per_m": slow.value,
        "slow_damping_interval": [slow.low, slow.high],
        "explained": numbers["explained"],
        "dry_friction_N": numbers["dry_friction_N"],
    }
    # An error of the damping below K T / 2, with the sampling period T, does not matter to the sampled loop.
    enough = max(WELL_KNOWN * abs(damping.value), 0.5 * stiffness.value * log.interval)
    if damping.half <= enough:
        return found | {
            "damping_N_s_per_m": damping.value,
            "damping_interval": [damping.low, damping.high],
        }
    why = "the log does not determine it"
    if not is_known:
        why = "the log does not separate damping from delay"
    return found | {
        "damping_N_s_per_m": None,
        "damping_interval": [damping.low, damping.high],
        "why_no_damping": why,
    }


def springs_of(log, evidences):
    """Returns (JSON of each contact, JSON of the log or None). `evidences`: the Evidence of each contact, or None for a
    contact with too few rows. All contacts share one set of models: as_good() excludes a delay for all contacts by the
    sum of their log-likelihoods."""
    evidences = with_shared_normal(log, evidences)
    known = [one for one in evidences if one is not None and one.likelihood]
    models = as_good(log, well_explained(known))
    numbers = [numbers_of(log, one, models) if one and one.likelihood else {} for one in evidences]
    each = [
        None if one is None else one.found | stated(log, its)
        for one, its in zip(evidences, numbers)
    ]
    good = [i for i, one in enumerate(each) if one and "stiffness_N_per_m" in one]
    if not good or shows_no_spring(each):
        return each, None
    stiffness, at = combined([numbers[i]["stiffness"] for i in good])
    if stiffness.half > WELL_KNOWN * stiffness.value:
        return each, None
    damping, _ = combined([numbers[i]["damping"] for i in good])
    slow, _ = combined([numbers[i]["slow_damping"] for i in good])
    chosen = good[at]
    its = numbers[chosen]
    delays = sorted({fit.model.delay for i in good for fit in numbers[i]["fits"]})
    its = its | {"delay_rows_interval": [delays[0], delays[-1]]}
    main = evidences[chosen].found | values_of(log, stiffness, damping, slow, its)
    main |= {
        "contacts": len(good),
        "linearity": median_linearity([(evidences[i].motion, numbers[i]["best"]) for i in good]),
        "loops": loops_of(log, stiffness, [numbers[i] for i in good]),
    }
    return each, main


def has_stiffness(spring):
    return bool(spring) and "stiffness_N_per_m" in spring


def shows_no_spring(each):
    """Returns True if more contacts contradict a spring than have a stiffness. Also returns True if at most the
    fraction UNSURE of the contacts has a stiffness: so few values can be errors of 95 % intervals.
    """
    known = [one for one in each if one]
    good = sum("stiffness_N_per_m" in one for one in known)
    return contradicting(each) > good or good <= UNSURE * len(known)


def contradicting(each):
    """Returns the number of contacts that contradict a spring: most of the force does not follow the motion, the force
    grows when the tool moves in the direction of the force, or the tool does not move."""
    return sum(
        one.get("explained", 1.0) < EXPLAINED
        or "apparent_stiffness_N_per_m" in one
        or one["travel_m"] <= FEWEST_COUNTS * one["resolution_m"]
        for one in each
        if one and "travel_m" in one
    )


def loops_of(log, stiffness, numbers):
    """Returns (delay [s], damping [N s/m]) for each delay that the log allows, at both ends of the interval of the
    damping."""
    found = []
    for delay in sorted({fit.model.delay for its in numbers for fit in its["fits"]}):
        dampings = [
            fit.damping + sign * min(fit.halves[1], abs(fit.damping))
            for its in numbers
            for fit in its["fits"]
            if fit.model.delay == delay
            for sign in (-1.0, 1.0)
        ]
        found += [[delay * log.interval, max(one, 0.0)] for one in (min(dampings), max(dampings))]
    return found
