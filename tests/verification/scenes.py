"""Verifies the results of `limit` and `tune` on random scenes: hand x device x law x tip x damping x delay. The results
are compared with runs, and with eigenvalues of the loop that loop_models.py computes with numpy. In each scene, a tool
with one tip is pressed on a plane, so that depths, forces and slopes have closed forms.

    python3 tests/verification/scenes.py PROGRAM [--count N] [--first I] [--seed S] [--jobs J] [--tune] [--out FILE]

Checks of each scene:
- linear: at the reported linear limit, an eigenvalue of the loop leaves the unit circle;
- quote: a run at 0.9 times the quoted limit is stable; a run at 1.1 times the quoted limit is not stable, unless
  `limit` reports stable runs beyond the quoted limit; a run at the first unstable value is not stable;
- cause: the run that the reason names behaves as the reason states (out of contact, at rest, or vibrating);
- tune (--tune): the loop of the recommendation is stable at K and at 2 K; a run of the recommended scenario is stable
  and its diagnosis reports no rule of low vibration; a run or a loop confirms the constraint that `tune` names.

With --out FILE, each scene is appended as one line of JSON; scenes in the file are not repeated. The exit status is 1
if more than the fraction SHARE of the runs contradicts `limit`, or if any other check fails.
"""
import argparse
import csv
import json
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from scipy import signal
from scipy.optimize import brentq

from loop_models import MAPS, between, damping_of, radius, random_device, random_hand

# Largest fraction of runs that may contradict `limit`. `limit` itself states that up to 6 % of its stable interval may
# be unstable.
SHARE = 0.06
# Largest allowed relative difference between the linear limit that `limit` reports and the limit from the eigenvalues
# of loop_models.py. The derivative of a rendered force is a difference quotient with an error of 1e-7. The limit
# depends on the derivative about linearly. Newton's method finds an equilibrium to 1e-10 m, which changes the slope of
# a round tip by up to 1e-10 / 1e-5.
AGREE = 3e-5
# An eigenvalue within this distance of 1 belongs to a mode without restoring force. Rounding changes an eigenvalue of
# multiplicity two by the square root of the machine precision.
FREE = 1e-6
# DURATION_S: duration of a run [s]. CUTOFF_HZ: cutoff of the filter for vibration. MAX_M_PER_S: largest velocity of
# low vibration. UNSURE: factor around a threshold within which a run has no verdict.
DURATION_S = 0.8
CUTOFF_HZ, MAX_M_PER_S, UNSURE = 30.0, 1e-3, 1.3

# Weight c of each contact, as a function of the number n of contacts with parallel normals. With the depths d, the
# force is f = -K sum c d, and the stiffness ratio is S = sum c. None: only the deepest contact has a force.
LAWS = {
    "summation": lambda n: 1.0,
    "tandpasta": lambda n: 1.0,
    "mean": lambda n: 1.0 / n,
    "shaped_stiffness": lambda n: 1.0 / n,
    "normal_projection": lambda n: 1.0 / n,
    "exact_shaping": lambda n: 1.0 / (n + 1e-6),
    "least_squares": lambda n: 1.0 / (n + 0.01),
    "virtual_coupling": lambda n: 1.0 / (n + 1.0),
    "mcneely": lambda n: min(1.0, 10.0 / n),
    "highest_depth": None,
}
RULES_OF_LOW_VIBRATION = {"buzz", "pop", "shake", "bounces", "chatter", "energy"}


class Contact:
    """Contact between the points of a plane and a tip that is pressed into the plane by z [m]. Computes the depths, the
    rendered force, and the derivative of the force."""

    def __init__(self, scene):
        tool, plane = scene["tool"], scene["environment"]
        self.r = tool["diameter_m"] / 2
        self.is_round = tool["tip"] == "round"
        self.law = scene["rendering"]["algorithm"]
        self.projects = "normal_projection" in (
            self.law,
            scene["rendering"].get("depth_model", "surface_normal"),
        )
        n = round(plane["size_m"] / plane["spacing_m"])
        at = -plane["size_m"] / 2 + plane["size_m"] * np.arange(n + 1) / n
        x, y, _ = scene["initial"]["position_m"]
        rho = np.hypot(*np.meshgrid(at - x, at - y)).ravel()
        self.rho = np.sort(rho[rho <= self.r])
        # Depth of the tip [m] at which each point begins to be in contact.
        self.begins = (
            self.r - np.sqrt(self.r**2 - self.rho**2) if self.is_round else 0 * self.rho
        )

    def depths(self, z, n):
        """Returns the depths [m] of the n points nearest to the axis, and their derivatives with respect to z."""
        rho = self.rho[:n]
        if self.is_round:
            h = self.r - z
            if self.projects:
                return np.sqrt(self.r**2 - rho**2) - h, np.ones(n)
            away = np.hypot(rho, h)
            return self.r - away, h / away
        if self.projects:
            return np.full(n, z), np.ones(n)
        side = self.r - rho
        return np.minimum(z, side), (z < side).astype(float)

    def force(self, z, n):
        """Returns (force / K [m], derivative of force / K with respect to z, stiffness ratio) for contact with the n
        points nearest to the axis."""
        d, slope = self.depths(z, n)
        if LAWS[self.law] is None:
            i = d.argmax()
            return d[i], slope[i], 1.0
        c = LAWS[self.law](n)
        return c * d.sum(), c * slope.sum(), c * n

    def equilibria(self, K, push, deepest):
        """Returns (slope / K, stiffness ratio, number of contacts, depth [m]) of each equilibrium between rendered
        force and hand. The slope is the derivative of the force with respect to the depth. `push`: force of the hand
        [N] as a function of the depth. `deepest`: largest depth [m]."""
        edges = np.append(np.unique(self.begins), deepest)
        found = []
        for low, high in zip(edges, edges[1:]):
            if low >= deepest:
                break
            n = int(np.searchsorted(self.begins, low + 1e-15, side="right"))
            high = min(high, deepest)
            excess = lambda z: K * self.force(z, n)[0] - push(z)
            if excess(low) <= 0 <= excess(high):
                z = brentq(excess, low, high, xtol=1e-16)
                _, slope, ratio = self.force(z, n)
                found.append((slope, ratio, n, z))
        return found


def push_of(scene):
    """Returns the force of the hand [N] at the end of the run, as a function of the depth z [m] of the tip below the
    plane."""
    hand, tool = scene["hand"], scene["tool"]
    last = lambda value: value["points"][-1][1] if isinstance(value, dict) else value
    if hand["type"] == "force":
        return lambda z: -last(hand["z_N"])
    if hand["type"] in ("push", "drag"):
        return lambda z: last(hand["force_N"])
    target = last(hand["target"]["z_m"])
    # The position of a tool is the centre of its tip: for a round tip, the centre of the ball.
    lowest = target - (tool["diameter_m"] / 2 if tool["tip"] == "round" else 0.0)
    k = hand["stiffness_N_per_m"]
    if scene["device"]["type"] == "admittance":
        # The hand's spring is in series with the servo and the structure between virtual tool and handle.
        device = scene["device"]
        yielding = 1 / device["servo"]["stiffness_N_per_m"]
        yielding += 1 / device["mechanics"]["structure_stiffness_N_per_m"]
        k = k / (1 + k * yielding)
    return lambda z: k * (-lowest - z)


def loop_radius(scene, K, slope, ratio):
    """Returns the spectral radius of the loop along the normal, with the contact stiffness K * `slope` and the contact
    damping B * `ratio`, where B is the damping of the rendering."""
    return radius(MAPS[scene["device"]["type"]](scene, K * slope, damping_of(scene, K) * ratio))


def is_stable(scene, K, slope, ratio):
    return loop_radius(scene, K, slope, ratio) <= 1 + 1e-9


def random_scene(seed, i):
    """Returns the random scene with the number i of a seed."""
    random = np.random.default_rng([seed, i])
    kind = str(random.choice(["ideal", "admittance", "impedance", "impedance"]))
    hands = ["force", "push", "impedance", "drag"] + ["mass_spring_damper"] * (kind == "impedance")
    hand_kind = str(random.choice(hands))
    law = str(random.choice(list(LAWS)))
    tip = str(random.choice(["flat", "round"]))
    diameter = between(random, 0.002, 0.008)
    spacing = diameter / between(random, 3, 9)
    r, F = diameter / 2, between(random, 0.3, 1.5)
    centre = r if tip == "round" else 0.0
    step = float(random.choice([0.0005, 0.001]))
    start = centre + between(random, 1e-5, 2e-4)
    device = random_device(random, kind)
    if kind == "impedance":
        device["handle_mass_kg"] = between(random, 0.08, 0.4)
        device["viscous_N_s_per_m"] = between(random, 0.5, 4)
        device["delay_samples"] = float(random.choice([0, 0, 0.25, 0.5, 1, 1.5, 2.3]))
        if random.random() < 0.4:
            device["coulomb_N"] = between(random, 0.01, 0.3)
        if random.random() < 0.3:
            device["encoder_step_m"] = between(random, 1e-6, 3e-5)

    def over_time(first, last):
        """Returns either the constant `last`, or waypoints that move from `first` to `last` in the first quarter of the
        run. The choice is random."""
        points = [[0, first], [DURATION_S / 4, last]]
        moves = {"type": "waypoints", "points": points, "interpolation": "cosine"}
        return moves if random.random() < 0.7 else last

    if hand_kind == "force":
        hand = {"type": "force", "z_N": over_time(-0.1 * F, -F)}
    elif hand_kind == "push":
        hand = {"type": "push", "force_N": over_time(0.1 * F, F)}
    elif hand_kind == "drag":
        hand = {
            "type": "drag",
            "force_N": F,
            "path_m": [[-0.004, 0, 0], [0.004, 0, 0]],
            "speed_m_per_s": 0.008,
            "stiffness_N_per_m": between(random, 100, 600),
            "damping_N_s_per_m": between(random, 2, 8),
            "normal_damping_N_s_per_m": between(random, 10, 50),
        }
    else:
        hand = random_hand(random, hand_kind)
        hand["stiffness_N_per_m"] = between(random, 100, 1000)
        end = centre - F / hand["stiffness_N_per_m"]
        hand["target"] = {"x_m": 0, "y_m": 0, "z_m": over_time(start, end)}
    half = 0.007 if hand_kind == "drag" else 1.2 * r + spacing
    n = 2 * int(np.ceil(half / spacing))
    x = -0.004 if hand_kind == "drag" else float(random.uniform(-0.5, 0.5)) * spacing
    y = 0.0 if hand_kind == "drag" else float(random.uniform(-0.5, 0.5)) * spacing
    if hand_kind in ("impedance", "mass_spring_damper"):
        hand["target"].update(x_m=x, y_m=y)
    rendering = {
        "algorithm": law,
        "stiffness_N_per_m": between(random, 1000, 20000),
        "mass_kg": between(random, 0.05, 0.3),
        "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0},
    }
    if hand_kind == "drag" or random.random() < 0.4:
        rendering["depth_model"] = "normal_projection"
    if random.random() < 0.5:
        rendering["damping_ratio"] = between(random, 0.05, 1.0)
    else:
        rendering["damping_N_s_per_m"] = between(random, 0.2, 15)
    return {
        "name": f"scene_{i}",
        "time": {"step_s": step, "duration_s": DURATION_S},
        "environment": {"type": "plane", "size_m": n * spacing, "spacing_m": spacing},
        "initial": {"position_m": [x, y, start]},
        "tool": {"diameter_m": diameter, "length_m": 0.02, "tip": tip},
        "hand": hand,
        "device": device,
        "rendering": rendering,
    }


class Bench:
    """Runs commands of the program on one scene. Files are in the folder of this scene."""

    def __init__(self, program, folder, scene):
        self.program, self.folder, self.scene = program, folder, scene
        self.file = folder / "scene.json"
        self.file.write_text(json.dumps(scene), encoding="utf-8")

    def json(self, *words, out):
        done = subprocess.run(
            [self.program, *map(str, words), "--json", "--out", self.folder / out],
            capture_output=True,
            text=True,
            check=False,
        )
        if not done.stdout:
            raise RuntimeError(f"{' '.join(map(str, words))}\n{done.stderr}")
        return json.loads(done.stdout)

    def rows(self, K, file=None, overrides=()):
        """Returns (rows of trajectory.csv, summary) of a run at the stiffness K [N/m]; None keeps the stiffness of the
        file."""
        words = ["run", file or self.file, "--set", "record.trajectory=true", "--set", "expect={}"]
        if K is not None:
            words += ["--set", f"rendering.stiffness_N_per_m={K!r}"]
        for override in overrides:
            words += ["--set", override]
        summary = self.json(*words, out="run")
        table = next((self.folder / "run").rglob("trajectory.csv"))
        return np.genfromtxt(table, delimiter=",", names=True), summary


class Motion:
    """Motion of a run, from the rows of trajectory.csv: of the handle on an impedance device, of the virtual tool on
    any other device."""

    def __init__(self, scene, rows):
        self.T = scene["time"]["step_s"]
        self.planned = round(scene["time"]["duration_s"] / self.T)
        who = "hv" if scene["device"]["type"] == "impedance" else "v"
        self.v = np.column_stack([rows[f"{who}{axis}_m_per_s"] for axis in "xyz"])
        self.handle = np.column_stack([rows[f"hv{axis}_m_per_s"] for axis in "xyz"])
        self.touches = rows["colliding"] > 0
        self.is_scripted = self.is_led(scene)
        self.completes = len(self.v) == self.planned and bool(np.isfinite(self.v).all())

    @staticmethod
    def is_led(scene):
        """Returns True if a script moves the tool: for a drag, or a hand whose target or force changes over time. By
        default, the vibration of the handle then decides on stability."""
        hand = scene["hand"]
        led = (hand.get("target", {}).get("z_m"), hand.get("z_N"), hand.get("force_N"))
        return hand["type"] == "drag" or any(isinstance(value, dict) for value in led)

    def quarter(self, i):
        n = len(self.v)
        return slice(n * i // 4, n * (i + 1) // 4)

    def fast_part(self, v):
        """Returns the part of a velocity above 30 Hz, by the high-pass filter that the manual defines."""
        high = signal.butter(4, CUTOFF_HZ, "highpass", fs=1 / self.T, output="sos")
        return signal.sosfilt(high, v - v[0], axis=0)

    def vibration(self):
        """Returns the rms of the handle's velocity above 30 Hz [m/s], computed from the handle's positions. The first
        quarter of the time after the first touch is excluded."""
        begins = int(np.argmax(self.touches))
        moved = self.fast_part(self.handle)
        judged = moved[begins + (len(moved) - begins) // 4 :]
        return float(np.sqrt((judged**2).sum(axis=1).mean()))

    def grows(self):
        """Returns True if the amplitude of the velocity above 30 Hz grows from each quarter of the run to the next, to
        more than 1 mm/s."""
        speed = np.linalg.norm(self.fast_part(self.v), axis=1)
        amplitude = [speed[self.quarter(i)].max() for i in range(4)]
        return amplitude[3] > MAX_M_PER_S and bool(np.all(np.diff(amplitude) > 0))

    def is_stable(self):
        """Returns True or False by the rule with which `limit` judges stability. Returns None if the motion is near a
        threshold of the rule."""
        if not self.completes or not self.touches.any():
            return False
        if self.is_scripted:
            if self.grows():
                return False
            much = self.vibration() / MAX_M_PER_S
            return None if 1 / UNSURE < much < UNSURE else much < 1
        amplitude = [np.linalg.norm(self.v[self.quarter(i)], axis=1).max() for i in range(4)]
        turns = [np.diff(np.sign(axis[axis != 0])) for axis in self.v[self.quarter(3)].T]
        if (
            max(np.count_nonzero(t) for t in turns) < 2
            or amplitude[3] < 0.01 * amplitude[0] / UNSURE
        ):
            return True
        falls = max(amplitude[2] / amplitude[1], amplitude[3] / amplitude[2])
        if falls < 0.9 / 1.03:
            return True
        return None if amplitude[3] < 0.01 * UNSURE * amplitude[0] or falls < 0.9 * 1.03 else False

    def share_away(self):
        return 1 - float(self.touches[self.quarter(3)].mean())

    def rests(self):
        """Returns True if the tool is at rest up to rounding in the last 200 steps."""
        last = np.linalg.norm(self.v[-200:], axis=1).max()
        return bool(last <= 1e-9 * np.linalg.norm(self.v, axis=1).max())


def loops_of(scene, contact, push, K):
    """Returns (slope / K, stiffness ratio, number of contacts, depth [m]) of each equilibrium at the stiffness K [N/m].
    For a drag, returns one entry for each possible number of contacts."""
    if scene["hand"]["type"] != "drag":
        return contact.equilibria(K, push, 0.999 * contact.r)
    # During a drag, the number of contacts changes. All points have the same slope, so that only the number of contacts
    # matters.
    z = push(0) / K
    if LAWS[contact.law] is None:
        return [(1.0, 1.0, 1, z)]
    return [(n * LAWS[contact.law](n), n * LAWS[contact.law](n), n, z) for n in range(1, 300)]


def check_linear(scene, row):
    """Compares a linear limit with eigenvalues. Returns (fault or None, note)."""
    printed = row["linear_limit"]
    contact, push = Contact(scene), push_of(scene)
    if radius(MAPS[scene["device"]["type"]](scene, 0.0, 0.0, False)) > 1 + FREE:
        fault = f"linear limit {printed}, unstable along the surface" if printed else None
        return fault, "unstable along the surface"
    if printed is None:
        return None, f"none: {row['no_linear_reason'] or row['quoted_reason']}"
    at_limit = loops_of(scene, contact, push, printed)
    if not at_limit:
        return None, "no equilibrium at the limit"
    within = AGREE
    if not contact.is_round and not contact.projects:
        # The slope of a flat tip jumps if its depth equals the distance of a point to the side. Differences over 1e-8 m
        # mix the slopes on both sides of the jump.
        within += 2e-8 / min(z for *_, z in at_limit)
    below, above = (
        loops_of(scene, contact, push, printed * (1 + sign * within)) for sign in (-1, 1)
    )
    after = {n: (slope, ratio) for slope, ratio, n, _ in above}
    for slope, ratio, n, _ in below:
        if is_stable(scene, printed * (1 - within), slope, ratio) and not is_stable(
            scene, printed * (1 + within), *after.get(n, (slope, ratio))
        ):
            return None, "agrees"
    # At the limit, the set of contacts at the equilibrium may change.
    stable = [is_stable(scene, printed * (1 - within), s, q) for s, q, *_ in below]
    unstable = [not is_stable(scene, printed * (1 + within), s, q) for s, q, *_ in above]
    if any(stable) and any(unstable) and {n for *_, n, _ in below} != after.keys():
        return None, "agrees, where the contacts change"
    known = {n: round(loop_radius(scene, printed, s, q) - 1, 9) for s, q, n, _ in at_limit}
    return f"linear limit {printed:.8g}: largest eigenvalue - 1 by number of contacts {known}", ""


def check_cause(scene, bench, row):
    """Checks the statement about a run in the reason of the quoted limit. Returns (fault or None, kind of the
    cause)."""
    reason = row["quoted_reason"]
    compared = r"(?:it is \w+ than the [^:;]+, and )?"
    if next_run := re.search(rf"simulated limit: {compared}the run at [0-9.e+-]+ is (\w+)", reason):
        # check_quote() checks the run at this value.
        return None, f"simulated limit: {next_run[1]}"
    found = re.search(r"the run at ([0-9.e+-]+) (.*)", reason)
    if not found:
        kind = re.split(r"[;,:(]", reason)[0].strip()
        return None, kind
    K, behaviour = float(found[1]), found[2]
    exact = row["stable_high"]
    rows, _ = bench.rows(exact if abs(exact / K - 1) < 1e-5 else K)
    motion = Motion(scene, rows)
    if away := re.search(r"out of contact in ([0-9.e+-]+) %", behaviour):
        seen, share = 100 * motion.share_away(), float(away[1])
        return (
            None if abs(seen - share) < 0.06 * share + 0.3 else f"{reason}: {seen:.3g} %"
        ), "out of contact"
    if "dry friction acts" in behaviour:
        is_held = scene["device"].get("coulomb_N", 0) > 0 and motion.rests()
        return (None if is_held else f"{reason}: is not held"), "friction holds"
    if "comes to rest" in behaviour:
        return (None if motion.rests() else f"{reason}: moves"), "comes to rest"
    if vibrates := re.search(r"vibrates by ([0-9.e+-]+)", behaviour):
        seen = motion.vibration()
        return (
            None if abs(seen / float(vibrates[1]) - 1) < 0.1 else f"{reason}: {seen:.3g}"
        ), "vibrates"
    if "gains and loses" in behaviour:
        points = rows["colliding"][motion.quarter(3)]
        return None, f"contact points change ({'count' if np.ptp(points) else 'not the count'})"
    # A run that "shows no growth in its duration" is stable by the rule although it is not at rest. It must not lose
    # contact.
    return (f"{reason}: out of contact" if motion.share_away() > 0 else None), "no growth"


def check_quote(scene, bench, row):
    """Checks runs near the quoted limit. Returns (texts about contradictions, number of runs)."""
    quoted, faults, runs = row["quoted_limit"], [], 0
    if quoted is None:
        return faults, runs
    claims = []
    if 0.9 * quoted > (row["stable_low"] or 0):
        claims.append((0.9 * quoted, True, "0.9 of the quoted value"))
    if (row["stable_high"] or 0) >= 1.1 * quoted:
        claims.append((1.1 * quoted, True, "1.1 of the quoted value"))
    elif "beyond it are stable" not in row["quoted_reason"]:
        claims.append((1.1 * quoted, False, "1.1 of the quoted value"))
    if row["first_unstable"] is not None:
        claims.append((row["first_unstable"], False, "the first unstable value"))
    for K, is_stable, name in claims:
        rows, summary = bench.rows(K)
        completes = summary[0]["outcome"] == "completes"
        seen = Motion(scene, rows).is_stable() if completes else False
        runs += 1
        if seen is not None and seen != is_stable:
            faults.append(f"the run at {name}, {K:.6g}, is {'' if seen else 'not '}stable")
    return faults, runs


def check_tune(scene, bench):
    """Checks the recommendation of `tune`. Returns (faults, note)."""
    answer = bench.json("tune", bench.file, "--damping-ratio", "0.1:1", "--jobs", 1, out="tune")
    law = answer["algorithms"][0]
    if not law["feasible"]:
        return [], f"none: {law['binding']}: {law['why']}; {law['relax']}"
    tuned = json.loads(Path(answer["scenario"]).read_text(encoding="utf-8"))
    K, zeta, faults = law["stiffness_N_per_m"], law["damping_ratio"], []
    chosen = json.loads(json.dumps(scene))
    chosen["rendering"].pop("damping_N_s_per_m", None)
    mass = tuned["rendering"]["mass_kg"]  # on an admittance device, `tune` also searches the mass
    chosen["rendering"].update(stiffness_N_per_m=K, damping_ratio=zeta, mass_kg=mass)
    contact, push = Contact(chosen), push_of(chosen)
    at_K = loops_of(chosen, contact, push, K)
    for gain in (1, 2):
        # `tune` requires a stable loop up to 2 K, with the contacts of the equilibrium at K.
        stable = [is_stable(chosen, gain * K, s, q) for s, q, *_ in at_K]
        if law["linear_limit_N_per_m"] is not None and stable and not any(stable):
            faults.append(
                f"recommends K = {K:.6g}, zeta = {zeta:.4g}: unstable eigenvalues at {gain} K"
            )
    rows, summary = bench.rows(None, answer["scenario"])
    if tuned["rendering"]["stiffness_N_per_m"] != K:
        faults.append("the tuned scenario has another K")
    if Motion(chosen, rows).is_stable() is False:
        faults.append(f"the run of the recommendation K = {K:.6g}, zeta = {zeta:.4g} is not stable")
    rules = {finding["rule"] for finding in summary[0]["diagnosis"]}
    (bench.folder / "tuned.json").write_text(json.dumps(tuned), encoding="utf-8")
    if fault := check_binding(chosen, bench, law, zeta):
        faults.append(fault)
    if rules & RULES_OF_LOW_VIBRATION:
        faults.append(f"run condemns the recommendation: {sorted(rules)}")
    return faults, f"{law['binding']}: {law['why']}; findings {sorted(rules)}"


def hand_in(text):
    """Returns the --set options for the hand in a text of `tune`, such as "a hand of 0.1 kg and 100 N/m". Returns an
    empty list if the text names no hand."""
    found = re.search(r"a hand of (?:([0-9.]+) kg and )?([0-9.]+) N/m", text)
    if not found:
        return []
    mass = [f"hand.mass_kg={found[1]}"] if found[1] else []
    return [*mass, f"hand.stiffness_N_per_m={found[2]}"]


def check_binding(scene, bench, law, zeta):
    """Checks, by a run or by eigenvalues of the loop, the constraint with which `tune` explains its recommendation.
    Returns a fault or None. `law`: answer of `tune` for the law. `zeta`: damping ratio."""
    why, binding = law["why"], law["binding"]
    with (bench.folder / "tune" / "tune_trials.csv").open(encoding="utf-8") as file:
        trials = [
            float(row["stiffness_N_per_m"])
            for row in csv.DictReader(file)
            if row["why"] == why and abs(float(row["rendering.damping_ratio"]) / zeta - 1) < 1e-9
        ]
    above = [K for K in trials if K > law["stiffness_N_per_m"]]
    if re.search(r"^at [0-9.e+]+ N/m", why):
        return None  # the text concerns another zeta and K, and rounds them to a few digits
    if not above or binding == "range":
        return None
    K = min(above)
    if "contact loop is unstable" in why:
        contact, push = Contact(scene), push_of(scene)
        hand = hand_in(why)
        if hand or "no hand" in why or "friction" in why:
            return None  # loops.py checks the loops of other hands
        stable = [
            is_stable(scene, gain * K, s, q)
            for gain in (1, 1.25, 1.6, 2)
            for s, q, *_ in loops_of(scene, contact, push, K)
        ]
        return None if not stable or not all(stable) else f"{binding}, {why}: stable eigenvalues"
    if binding in ("margin", "settled"):
        gain = 2 if why.startswith("at 2 K") else 1
        rows, _ = bench.rows(gain * K, bench.folder / "tuned.json", hand_in(why))
        return None if Motion(scene, rows).is_stable() is not True else f"{binding}, {why}: stable"
    _, summary = bench.rows(K, bench.folder / "tuned.json")
    rules = {finding["rule"] for finding in summary[0]["diagnosis"]}
    return None if binding in rules else f"{binding}, {why}: run at {K:.6g} reports {sorted(rules)}"


def check_scene(program, seed, i, tunes):
    scene = random_scene(seed, i)
    result = {"seed": seed, "i": i, "scene": scene, "faults": [], "runs": 0, "contradictions": []}
    with tempfile.TemporaryDirectory(prefix="hapbench-scenes-") as folder:
        bench = Bench(program, Path(folder), scene)
        words = ["limit", bench.file, "--vary", "rendering.stiffness_N_per_m", "--jobs", 1]
        answer = bench.json(*words, "--resolution", 0.01, out="limit")
        row = answer["limits"][0]
        if Motion.is_led(scene) != ("rms above 30 Hz" in answer["rule"]):
            result["faults"].append(f"rule: {answer['rule']}")
        keep = ("quoted_limit", "quoted_reason", "limit", "linear_limit", "no_linear_reason")
        keep += ("stable_low", "stable_high", "first_unstable", "first_unstable_class")
        result["limit"] = {name: row[name] for name in keep}
        fault, result["linear"] = check_linear(scene, row)
        result["faults"] += [fault] if fault else []
        fault, result["cause"] = check_cause(scene, bench, row)
        result["faults"] += [fault] if fault else []
        result["contradictions"], result["runs"] = check_quote(scene, bench, row)
        if tunes:
            faults, result["tune"] = check_tune(scene, bench)
            result["faults"] += faults
    return result


def known_results(file):
    if file is None or not file.exists():
        return {}
    lines = file.read_text(encoding="utf-8").splitlines()
    return {(r["seed"], r["i"]): r for r in map(json.loads, lines)}


def summary_of(results):
    """Prints the results of all checks with their faults. Returns the exit status."""
    runs = sum(r["runs"] for r in results)
    contradictions = [(r["i"], text) for r in results for text in r["contradictions"]]
    faults = [(r["i"], text) for r in results for text in r["faults"]]
    for name in ("linear", "cause"):
        kinds = {}
        for r in results:
            kinds[r[name]] = kinds.get(r[name], 0) + 1
        for kind, times in sorted(kinds.items(), key=lambda entry: -entry[1]):
            print(f"  {name}: {times:3} {kind}")
    for i, text in contradictions:
        print(f"contradiction in scene {i}: {text}")
    for i, text in faults:
        print(f"FAIL scene {i}: {text}")
    print(
        f"{len(results)} scenes, {runs} runs beside the quoted limit, {len(contradictions)} contradict it, "
        f"{len(faults)} other faults"
    )
    return 1 if faults or len(contradictions) > SHARE * runs else 0


def main():
    line = argparse.ArgumentParser()
    line.add_argument("program", type=Path)
    line.add_argument("--count", type=int, default=8)
    line.add_argument("--first", type=int, default=0)
    line.add_argument("--seed", type=int, default=85)
    line.add_argument("--jobs", type=int, default=2)
    line.add_argument("--tune", action="store_true")
    line.add_argument("--out", type=Path)
    options = line.parse_args()
    known = known_results(options.out)
    numbers = range(options.first, options.first + options.count)
    missing = [i for i in numbers if (options.seed, i) not in known]
    program = options.program.resolve()
    with ThreadPoolExecutor(options.jobs) as pool:
        for result in pool.map(
            lambda i: check_scene(program, options.seed, i, options.tune), missing
        ):
            known[options.seed, result["i"]] = result
            if options.out:
                with options.out.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(result) + "\n")
    sys.exit(summary_of([known[options.seed, i] for i in numbers]))


if __name__ == "__main__":
    main()
