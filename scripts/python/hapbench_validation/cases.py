"""The cases: what was measured, with which inputs, and the inputs that nobody published, as ranges to draw from."""
import json
import math
from dataclasses import dataclass
from pathlib import Path

from scipy.stats import qmc

ROOT = Path(__file__).resolve().parents[3]
FOLDER = ROOT / "scenarios" / "validation"
START, REACHED = -0.0015, 0.4  # where a finger starts [m], and when it presses fully [s]
LEAST, MOST = 0.02, 40.0  # range of K that is looked at, in the case's unit


@dataclass
class Case:
    name: str
    device: str
    scene: str
    role: str        # "fitted" or "judged"
    fit: str         # the case whose samples are kept; its own name for one that is fitted
    title: str
    source: str
    set: dict        # published fields
    unit: float      # N/m in a unit of K, N s/m in one of B
    unit_name: str
    reading: float   # step in which K was written down
    B: list
    K: list
    more: dict       # unpublished inputs of this case alone
    quantity: str    # "stiffness", or "period" of what vibrates just beyond the edge; K is that then
    scatter: float   # factor, one standard deviation of the logarithm of repeated sessions


def read_cases():
    """(all of cases.json, the cases by name)."""
    data = json.loads((FOLDER / "data" / "cases.json").read_text(encoding="utf-8"))
    cases = [Case(c["name"], c["device"], c["scene"], c["role"], c.get("fit", c["name"]), c["title"], c["source"],
                  data["devices"][c["device"]].get("set", {}) | c["set"], c["unit_N_per_m"], c["unit"], c["reading"], c["B"], c["K"],
                  c.get("unpublished", {}), c.get("quantity", "stiffness"), c.get("scatter", data["scatter"])) for c in data["cases"]]
    return data, {case.name: case for case in cases}


def units_of(space, samples, seed=1):
    """A Latin hypercube: a row of numbers from 0 to 1 for each sample."""
    return qmc.LatinHypercube(len(space), seed=seed).random(samples)


def samples_of(space, units):
    """The samples of the ranges in `space` at such numbers."""
    return [{name: _between(space[name], u) for name, u in zip(space, row)} for row in units.tolist()]


def drawn(space, samples, seed=1):
    return samples_of(space, units_of(space, samples, seed))


def _between(given, u):
    low, high, kind = given[:3]
    if kind == "either":
        return low if u < 0.5 else high
    if kind == "whole":
        return low + math.floor(u * (high - low + 1))
    return low * (high / low)**u if kind == "log" else low + (high - low) * u


def overrides(case, sample, B, scene):
    """The words of --set for a sample at a damping B, in the case's unit."""
    fields = dict(case.set) | {"rendering.damping_N_s_per_m": B * case.unit, "rendering.stiffness_N_per_m": LEAST * case.unit}
    for name, value in sample.items():
        if name.startswith("device.") or name.startswith("hand.") and "hand" in scene:
            fields[name] = value
    fields["device.coulomb_N"] = fields.get("device.coulomb_N", 0.0) * sample.get("friction_left", 1.0)
    if "transmission_zeta" in sample:  # of the two masses on the spring
        share, mass = fields["device.transmission.motor_share"], sample["device.handle_mass_kg"]
        fields["device.transmission.damping_N_s_per_m"] = 2.0 * sample["transmission_zeta"] * math.sqrt(
            sample["device.transmission.stiffness_N_per_m"] * share * (1.0 - share) * mass)
    if "hand" in scene:
        fields["hand.damping_N_s_per_m"] = 2.0 * sample["hand_zeta"] * math.sqrt(sample["hand.stiffness_N_per_m"] * sample["hand.mass_kg"])
        deep = sample["press_N"] / sample["hand.stiffness_N_per_m"]  # where its spring presses with press_N
        fields["hand.target.x_m"] = json.dumps(
            {"type": "waypoints", "points": [[0, START], [REACHED, deep]], "interpolation": "cosine"})
        fields["hand.tremor.rms_m"] = json.dumps([sample["tremor_m"], 0, 0])
        fields["seed"] = sample["seed"]
    return [f"{name}={value}" for name, value in fields.items()]
