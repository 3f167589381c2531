"""Stiffness, damping and delay that a log determines, for each contact and combined over the contacts."""
import math
from dataclasses import dataclass, field

import numpy as np
from scipy.stats import t as student

from .models import Motion, fit_of, low_pass_of, neighbours_of, residual_of

FEWEST = 20  # smallest number of rows of a contact
# Smallest number of these rows with a new force above 0 and below the largest force.
FEWEST_NEW = 15
# Ratio of the rms residual in a landing to the residual elsewhere up to which the landing is no impact.
LANDING = 10.0
# Rms residual of a landing, relative to the range of the force, up to which the landing is no impact.
EXACT = 0.01
FEWEST_COUNTS = 10  # smallest travel, in steps of the position's resolution
EXPLAINED = 0.5  # smallest fraction of the variance that a spring must explain
WELL_KNOWN = 0.25  # largest relative half-width of the interval with which a value is stated
# Difference of log-likelihood within which a model counts as equally good as the best model.
UNLIKELY = 5.0
# Unexplained fraction of the variance below which the engine's law is exactly the model.
EXACTLY = 1e-9
SAMPLED = (
    # Relative change of a value by sampling that is allowed: (2 pi f T)^2 / 6 at 17 Hz and 1 kHz.
    2e-3
)
MOST_TRIED = 60  # largest number of models tried in the search for a model without negative damping
CERTAIN = 20.0  # largest log-likelihood difference that one contact contributes
# Relative difference below which two mean squares count as equal, because the residuals are not white noise.
SIMILAR = 0.1
# Largest factor, over the smallest mean square, that the sampling of the velocity may explain.
MOST_EXCUSED = 2.0
NEGLIGIBLE = 1e-12  # fraction of the variance that rounding may leave unexplained
TYPICAL = 10.0  # factor over the unexplained fraction of a typical contact
# Dry friction is reported if the sign of the velocity reduces the sum of squares below this fraction.
DRY_GAIN = 0.7
DRY_SHARE = 0.02  # and if it is at least this fraction of the mean force
AT_LIMIT = 0.999  # fraction of the largest force from which a row counts as saturated
TILTS = 8  # number of steps of the search for the normal
MOST_ROWS = 500  # largest number of rows in the search for the normal
# Kinds of velocity in the search for the normal.
SEARCHED = ("logged", "backward", "central", "low-pass 4")


@dataclass
class Evidence:
    """What one contact contributes to the choice of each model."""

    motion: object  # Motion along the fitted direction, or None
    found: dict  # numbers for the JSON
    # Difference of log-likelihood to the best model, by Model.
    likelihood: dict = field(default_factory=dict)
    place: np.ndarray | None = None  # positions of the rows along the direction [m]
    resolution: float = 0.0  # resolution of the position along the direction [m]
    rows: np.ndarray | None = None  # row numbers of the contact


def main_direction(force):
    """Returns the unit vector along which the forces are largest, with the sign of the forces."""
    _, vectors = np.linalg.eigh(force.T @ force)
    direction = vectors[:, -1]
    return direction if (force @ direction).sum() >= 0.0 else -direction


def evidence_of(log, rows, settled):
    """Returns the Evidence of the contact in these rows. `settled`: the rows after a landing. The rows of the landing
    are used only if the best model explains them nearly as well as the settled rows."""
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
    matrix, target = evidence.motion.columns(best)
    residual = target - matrix @ np.linalg.lstsq(matrix, target, rcond=None)[0]
    is_settled = np.isin(rows, settled)[evidence.motion.usable()]
    if is_settled.all() or not is_settled.any():
        return True
    landing, rest = np.mean(residual[~is_settled] ** 2), np.mean(residual[is_settled] ** 2)
    return landing <= LANDING**2 * rest or np.sqrt(landing) <= EXACT * np.ptp(target)


def unexplained(evidence):
    """Returns the fraction of the variance of the force that no model explains; 1 for a contact without a spring."""
    return 1.0 - evidence.found.get("explained", 0.0)


def pushing(log, rows):
    """Returns the rows whose force is new in this row, not zero, and not limited to the largest force of the log."""
    size = np.linalg.norm(log.force, axis=1)
    flat = np.append(np.abs(np.diff(size)) <= 1e-6 * size.max(), False)
    at_limit = (size >= AT_LIMIT * size.max()) & (flat | np.append(False, flat[:-1]))
    keep = (size > 0.0) & ~at_limit
    if log.held_force is not None:
        keep &= log.held_force.fresh
    return rows[keep[rows]]


def evidence_of_rows(log, rows, given=None):
    """Returns the Evidence of these rows along the normal of the surface, or along a `given` direction."""
    force = log.force[rows]
    direction = main_direction(force) if given is None else given
    motion, better = Motion(log, rows, direction), None
    if given is None and np.linalg.matrix_rank(log.position[rows] - log.position[rows[0]]) > 1:
        better = normal_of(log, rows, direction, motion)
    if better is not None:
        direction, motion = better
    sideways = np.linalg.norm(force - np.outer(force @ direction, direction)) / np.linalg.norm(
        force
    )
    place = log.position[rows] @ direction
    resolution, travel = float(np.abs(direction) @ log.quantum_m), float(np.ptp(place))
    found = {
        "direction": direction.tolist(),
        "off_direction_share": float(sideways),
        "travel_m": travel,
        "resolution_m": resolution,
        "start_s": float(log.time[rows[0]]),
        "end_s": float(log.time[rows[-1]]),
    }
    if travel <= FEWEST_COUNTS * resolution or travel <= 1e-12:
        counts = f", {travel / resolution:.3g} steps of its resolution" if resolution else ""
        why = f"the position along the force moves by {travel:.3g} m only{counts}"
        return Evidence(None, found | {"why": why}, rows=rows)
    if np.ptp(log.force[rows] @ direction) == 0.0:
        return Evidence(None, found | {"why": "the force is constant"})
    known, best = residuals(motion)
    if best is None:
        return Evidence(None, found | {"why": "position and velocity are not independent"})
    found["explained"] = 1.0 - known[best].mean_square / max(known[best].total, 1e-300)
    if found["explained"] < EXPLAINED:
        found["why"] = (
            f"a spring and a damper explain {100.0 * max(found['explained'], 0.0):.0f} % of the force's variance, as "
            "in a rigid contact, or with friction along the force"
        )
        return Evidence(None, found, rows=rows)
    return Evidence(motion, found, likelihoods(motion, known, best), place, resolution, rows)


def residuals(motion):
    """Returns (Residual by Model, Model with the smallest residual or None)."""
    found = {}
    for model in motion.models():
        residual = residual_of(motion, model)
        if residual is not None:
            found[model] = residual
    return found, min(found, key=lambda model: found[model].mean_square, default=None)


def likelihoods(motion, found, best):
    """Returns for each Model the log-likelihood of the best Model minus the log-likelihood of this Model.

    If rounding and sampling explain the residual of a model, the model counts as equally good as the best model,
    although its sum of squares may be larger. An engine that renders the rounded positions themselves leaves smaller
    residuals than rounding would: `share` is the measured fraction of the expected residuals.
    """
    least = found[best]
    floor = NEGLIGIBLE * least.total
    share = min(1.0, least.mean_square / max(least.rounding + least.sampling, 1e-300))
    independent = fit_of(motion, best).independent

    def below(one):
        # The effect of rounding is known exactly; the error of a sampled velocity is known only roughly.
        usual = least.mean_square + share * (one.sampling - least.sampling)
        usual = float(np.clip(usual, least.mean_square, MOST_EXCUSED * least.mean_square))
        usual += share * max(one.rounding - least.rounding, 0.0) + floor
        return max(math.log((one.mean_square + floor) / (1.0 + SIMILAR) / usual), 0.0)

    return {model: 0.5 * independent * below(one) for model, one in found.items()}


def normal_of(log, rows, direction, motion):
    """Returns (normal, Motion along it) of a surface on which the tool slides with friction; None if the main direction
    of the force explains the force equally well. The gradient of a force that depends on the depth points along the
    normal, and the force along the normal does not contain friction."""
    known, best = residuals(motion)
    if best is None:
        return None
    first, normal, model = known[best], direction, None
    if first.mean_square <= EXACTLY * first.total:
        return None
    space = [Motion(log, rows, axis) for axis in np.eye(3)]
    for _ in range(TILTS):
        gradient, model = gradient_of(log, rows, normal, space, model)
        if gradient is None:
            return None
        is_found = np.linalg.norm(np.cross(gradient, normal)) < 1e-7
        normal = gradient
        if is_found:
            break
    motion = Motion(log, rows, normal)
    known, best = residuals(motion)
    if best is None:
        return None
    is_better = known[best].mean_square * first.total < 0.5 * first.mean_square * known[best].total
    return (normal, motion) if is_better else None


def gradient_of(log, rows, normal, space, model):
    """Returns (direction in which the force along `normal` grows fastest, Model), or (None, None). `space`: Motion
    along each axis. `model`: None for the best model."""
    keep = space[0].usable()
    force = (log.force[rows] @ normal)[keep]
    some = np.linspace(0, keep.sum() - 1, min(keep.sum(), MOST_ROWS)).astype(int)
    force = force[some] - force[some].mean()
    moving = [
        i for i in range(3) if np.ptp(log.position[rows, i]) > FEWEST_COUNTS * log.quantum_m[i]
    ]
    if len(force) < FEWEST_NEW or not moving:
        return None, None
    best = (math.inf, None, None)
    tried = [one for one in space[0].models() if one.kind in SEARCHED] if model is None else [model]
    for one in tried:
        columns = np.hstack([space[i].columns(one)[0][some] for i in moving])
        sizes = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
        slopes = np.linalg.lstsq(columns / sizes, force, rcond=1e-6)[0]
        residual = force - columns / sizes @ slopes
        best = min(best, (float(residual @ residual), one, slopes / sizes), key=lambda it: it[0])
    _, model, slopes = best
    # Along axes in which the tool does not move, keep the components of the force's direction.
    gradient, size = normal.copy(), np.linalg.norm(slopes[::2])
    if not size > 0.0:
        return None, None
    gradient[moving] = -slopes[::2] / size * np.linalg.norm(normal[moving])
    gradient *= np.sign(gradient @ normal) or 1.0
    return gradient / np.linalg.norm(gradient), model


def as_good(evidences):
    """Returns the models that explain all contacts nearly as well as the best model, best first. If a contact is too
    short for a long delay, the score of its longest possible delay is used."""
    models = sorted({model for one in evidences for model in one.likelihood})
    if not models:
        return []

    def score(model):
        total = 0.0
        for one in evidences:
            while model not in one.likelihood and model.delay > 0:
                model = type(model)(model.delay - 1, model.kind)
            total += min(one.likelihood.get(model, CERTAIN), CERTAIN)
        return total

    scores = {model: score(model) for model in models}
    order = sorted(models, key=lambda model: (scores[model], model))
    least = scores[order[0]]
    found = [model for model in order if scores[model] <= least + UNLIKELY]
    calm = [model for model in found if not is_negative(evidences, model)]
    if calm:
        return calm
    # If no model fits well, neither negative damping nor the next model without negative damping is certain.
    near = [m for m in order if scores[m] <= least + 0.5 * CERTAIN * len(evidences)]
    best = next((m for m in near[:MOST_TRIED] if not is_negative(evidences, m)), None)
    return found if best is None else [*found, best]


def is_negative(evidences, model):
    """Returns True if the damping of a model is negative in most contacts. A delay d of a stiffness K has the effect of
    a damping of -K d; a negative damping smaller than a quarter of the effect of one row counts as zero.
    """
    fits = [(one, fit_of(one.motion, model)) for one in evidences if model in one.likelihood]
    signs = [
        fit.damping + fit.halves[1] < -0.25 * fit.stiffness * one.motion.interval < 0.0
        for one, fit in fits
        if fit is not None
    ]
    return 2 * sum(signs) > len(signs)


def well_explained(evidences):
    """Returns the contacts that a spring and a damper explain about as well as the median contact."""
    usual = float(np.median([unexplained(one) for one in evidences])) if evidences else 0.0
    return [one for one in evidences if unexplained(one) <= TYPICAL * usual + NEGLIGIBLE]


def with_shared_normal(log, evidences):
    """Returns the evidences. If a spring explains a contact worse than the best contact, and the direction of the best
    contact explains it better, this direction is used: most logs have one flat surface."""
    known = [one for one in evidences if one is not None and one.likelihood]
    if log.axes == 1 or len(known) < 2:
        return evidences
    best = min(known, key=unexplained)
    direction = np.array(best.found["direction"])

    def improved(one):
        if one is None or one.rows is None or unexplained(one) <= TYPICAL * unexplained(best):
            return one
        other = evidence_of_rows(log, one.rows, direction)
        return other if unexplained(other) < 0.5 * unexplained(one) else one

    return [improved(one) for one in evidences]


@dataclass
class Estimate:
    """A number with its 95 % interval over several models; the first model is the best."""

    value: float
    low: float
    high: float

    @property
    def half(self):
        return 0.5 * (self.high - self.low)


def numbers_of(log, evidence, models):
    """Returns the numbers of one contact for the JSON, with intervals over these models. `why`: the reason if it has no
    stiffness."""
    fits = [
        fit
        for model in models
        if model in evidence.likelihood and (fit := fit_of(evidence.motion, model)) is not None
    ]
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
    for fit in fits:
        widen(evidence.motion, fit, bool(friction))
    stiffness = spanned(
        best.stiffness, fits, lambda fit: (fit.stiffness, stiffness_half(evidence, fit))
    )
    damping = spanned(
        best.damping, fits, lambda fit: (fit.damping, damping_half(log, evidence, fit))
    )
    # Slow motion determines only B - K d.
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
        numbers["why"] = why_unknown(fits, stiffness, delays, interval)
    return numbers


def widen(motion, fit, with_sign):
    """Extends the intervals by the distance to the fits with neighbouring velocities."""
    near = [fit_of(motion, model, with_sign) for model in neighbours_of(fit.model, motion.speeds)]
    distances = [np.abs(one.values - fit.values) for one in near if one is not None]
    if fit.explained < 1.0 - EXACTLY:
        fit.halves = fit.halves + SAMPLED * np.abs(fit.values)
    if distances:
        # The time constant of a filter differs by at most half the distance to the next time constant.
        share = 0.5 if low_pass_of(fit.model.kind) else 1.0
        fit.halves = fit.halves + share * np.max(distances, axis=0)


def likely(fits):
    """Returns the first fit without negative damping, which is an effect of a delay; if there is none, the first
    fit."""
    return next(
        (fit for fit in fits if fit.stiffness > 0.0 and fit.damping + fit.halves[1] >= 0.0), fits[0]
    )


def why_unknown(fits, stiffness, delays, interval):
    text = f"stiffnesses of {stiffness.low:.3g} to {stiffness.high:.3g} N/m explain the force equally well"
    if len(delays) > 1:
        return (
            f"{text}, with delays of {1e3 * delays[0] * interval:.3g} to {1e3 * delays[-1] * interval:.3g} ms, as in a "
            "single oscillation or decay"
        )
    return text


def spanned(value, fits, ends):
    """Returns the Estimate whose interval contains the intervals of all fits."""
    pairs = [ends(fit) for fit in fits]
    return Estimate(
        float(value),
        float(min(one - half for one, half in pairs)),
        float(max(one + half for one, half in pairs)),
    )


def noise_share(evidence, fit, interval):
    """Returns the fraction of the residuals' variance that the resolution of the position may have caused, at most 1.
    An engine that renders the resolved position leaves no residuals."""
    q = evidence.resolution
    if q == 0.0:
        return 0.0
    rounding = (fit.stiffness * q) ** 2 / 12.0 + (fit.damping * q / interval) ** 2 / 6.0
    return min(1.0, fit.squares / fit.rows / max(rounding, 1e-300))


def stiffness_half(evidence, fit):
    # Rounding of the position reduces a slope by the ratio of the rounding's variance to the position's variance.
    shrink = evidence.resolution**2 / 12.0 / max(float(np.var(evidence.place)), 1e-300)
    return fit.halves[0] + (1e-6 + shrink) * abs(fit.stiffness)


def clock_error(log):
    """Returns the relative error of the mean interval, caused by the jitter of the first and the last row."""
    steps = np.diff(log.time)
    return (
        3.0 * float(np.std(steps[steps < 1.5 * log.interval])) / float(log.time[-1] - log.time[0])
    )


def damping_half(log, evidence, fit):
    interval, q = log.interval, evidence.resolution
    half = (
        fit.halves[1]
        + (1e-6 + clock_error(log)) * abs(fit.damping)
        + 1e-9 * abs(fit.stiffness) * interval
    )
    if log.velocity is not None or q == 0.0:
        return half
    # A difference of two rounded positions has the variance q^2/6 and the covariance q^2/12 with the position.
    bias = (
        abs(fit.damping) * (q / interval) ** 2 / 6.0 + abs(fit.stiffness) * q**2 / 12.0 / interval
    )
    return half + noise_share(evidence, fit, interval) * bias / max(fit.speed**2, 1e-300)


def dry_friction(motion, best):
    """Returns True if the sign of the velocity explains much of the residual of spring and damper."""
    if best.explained >= 1.0 - 1e-6:
        return False
    fit = fit_of(motion, best.model, True)
    return (
        fit is not None
        and fit.squares < DRY_GAIN * best.squares
        and abs(fit.values[2]) > max(fit.halves[2], DRY_SHARE * np.abs(motion.force).mean())
    )


def combined(estimates):
    """Returns the weighted median of the estimates, with weights of the inverse squared interval widths. The half-width
    of its interval is the larger of two values: the median half-width, and the value that follows from the scatter of
    the estimates."""
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


def linearity(motion, fit):
    """Returns the stiffness in the deeper half of the travel divided by the stiffness in the other half, or None. The
    value is 1 for a linear spring."""
    if fit.model.delay:
        return None
    keep = motion.usable()
    place = motion.place[motion.rows[keep]]
    force = motion.force[keep] + fit.damping * motion.speeds[fit.model.kind][motion.rows[keep]]
    middle = 0.5 * (place.min() + place.max())
    slopes = []
    for half in (place < middle, place >= middle):
        if half.sum() < FEWEST or np.ptp(place[half]) == 0.0:
            return None
        slopes.append(-np.polyfit(place[half] - middle, force[half], 1)[0])
    # The force points out of the surface, so the deeper half has the smaller positions.
    deep, shallow = slopes
    return float(deep / shallow) if shallow > 0.0 else None


def stated(log, numbers):
    """Returns the JSON of one contact's numbers_of()."""
    found = {key: numbers[key] for key in ("why", "apparent_stiffness_N_per_m") if key in numbers}
    if "stiffness" not in numbers or "why" in numbers:
        return found
    return found | values_of(
        log, numbers["stiffness"], numbers["damping"], numbers["slow_damping"], numbers
    )


def values_of(log, stiffness, damping, slow, numbers):
    """Returns the JSON of estimates. Delay and damping are None if the log does not determine them."""
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
    """Returns (JSON of each contact, JSON of the log or None). `evidences`: for each contact, None for a contact with
    too few rows. All contacts share one delay: if one contact excludes a delay, the delay is excluded for all.
    """
    evidences = with_shared_normal(log, evidences)
    known = [one for one in evidences if one is not None and one.likelihood]
    models = as_good(well_explained(known))
    numbers = [numbers_of(log, one, models) if one and one.likelihood else {} for one in evidences]
    each = [
        None if one is None else one.found | stated(log, its)
        for one, its in zip(evidences, numbers)
    ]
    good = [i for i, one in enumerate(each) if one and "stiffness_N_per_m" in one]
    if not good:
        return each, None
    stiffness, at = combined([numbers[i]["stiffness"] for i in good])
    damping, _ = combined([numbers[i]["damping"] for i in good])
    slow, _ = combined([numbers[i]["slow_damping"] for i in good])
    chosen = good[at]
    its = numbers[chosen]
    delays = sorted({fit.model.delay for i in good for fit in numbers[i]["fits"]})
    its = its | {"delay_rows_interval": [delays[0], delays[-1]]}
    main = evidences[chosen].found | values_of(log, stiffness, damping, slow, its)
    main |= {
        "contacts": len(good),
        "linearity": linearity(evidences[chosen].motion, its["best"]),
        "loops": loops_of(log, stiffness, [numbers[i] for i in good]),
    }
    return each, main


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
