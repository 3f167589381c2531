"""Compares the numbers of an audit with bounds (option --expect), for checks in continuous integration."""
import math

from hapbench_command import fail, finite_number, quoted, require_name


def metrics_of(audit):
    """Returns all numbers of an audit by name. The value is None if the log does not determine the number."""
    found = {
        name: value
        for section in ("clock", "metrics", "energy")
        for name, value in audit[section].items()
        if value is None or isinstance(value, (int, float)) and not isinstance(value, bool)
    }
    created = audit["energy"]["net_created_J"]
    spring, device = audit["stiffness"] or {}, audit["device"] or {}
    buzz = audit["buzz"][0] if audit["buzz"] else {"frequency_Hz": None, "amplitude_N": 0.0}
    return found | {
        "energy_mJ": None if created is None else 1e3 * created,
        "stiffness_N_per_m": spring.get("stiffness_N_per_m"),
        "damping_N_s_per_m": spring.get("damping_N_s_per_m"),
        "delay_s": spring.get("delay_s"),
        "stiffness_of_limit": device.get("ratio"),
        "buzz_frequency_Hz": buzz["frequency_Hz"],
        "buzz_amplitude_N": buzz["amplitude_N"],
    }


def expectations(words, audit):
    """Returns a dict for each of `words`: the metric, its value, the bounds, and True if the value is within the
    bounds. Each word is "metric=max" or "metric=min:max". A missing value is not within the bounds.
    """
    metrics, found = metrics_of(audit), []
    for word in words:
        name, equals, bound = word.partition("=")
        if not equals:
            fail(f"--expect: got {quoted(word)}; allowed: METRIC=MAX or METRIC=MIN:MAX")
        require_name("--expect: got", name, list(metrics))
        low, _, high = bound.rpartition(":")
        minimum = _number(word, low) if low else -math.inf
        maximum = _number(word, high)
        if minimum > maximum:
            fail(f"--expect: got {quoted(word)}, a minimum above the maximum; allowed: MIN:MAX")
        value = metrics[name]
        found.append(
            {
                "metric": name,
                "value": value,
                "min": minimum if low else None,
                "max": maximum,
                "met": value is not None and minimum <= value <= maximum,
            }
        )
    return found


def _number(word, text):
    value = finite_number(text.encode("utf-8", "surrogateescape"))
    if math.isnan(value):
        fail(f"--expect: got {quoted(word)}; allowed: METRIC=MAX or METRIC=MIN:MAX, of numbers")
    return value


def unmet_text(one):
    value = "no value" if one["value"] is None else f"{one['value']:.6g}"
    low = "" if one["min"] is None else f"{one['min']:g} to "
    return f"expected {one['metric']} of {low}{'at most ' if not low else ''}{one['max']:g}, got {value}"
