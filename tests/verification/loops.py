"""Verifies the linear limits that `limit` reports. Each limit is compared with eigenvalues of the loop of
hand, device and contact, and with runs near the limit. The eigenvalues are computed here with numpy from the
description of the devices in the manual. Shares no code with hapbench.

    python3 tests/verification/loops.py PROGRAM [COUNT]    # COUNT random loops per device and hand, default 2
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from loop_models import MAPS, between, limit_of, radius, random_device, random_hand

PROGRAM = Path(sys.argv[1]).resolve()
COUNT = int(sys.argv[2]) if len(sys.argv) > 2 else 2
RANDOM = np.random.default_rng(85)
# Largest allowed relative difference between the limit that `limit` reports and the limit from the eigenvalues here,
# for a contact with a spring. `limit` bisects eigenvalues to 1e-11. Rounding changes an eigenvalue of multiplicity two
# by the square root of the machine precision, 1e-8.
SPRINGS_AGREE = 1e-7
# Largest allowed relative difference between these two limits for a contact with a surface. The derivative of a
# rendered force is a difference quotient with an error of 1e-7. The limit depends on the derivative about linearly.
SURFACES_AGREE = 1e-5
# One run has a stiffness K below the limit by the fraction BESIDE, and another run above the limit by this fraction.
# Let n be the number of steps in which the amplitude changes by the factor GROWN, plus 100. A run has 3 n steps. If n
# exceeds MAX_STEPS, the run is skipped.
BESIDE, GROWN, MAX_STEPS = 0.05, 100.0, 200_000


def random_scene(device, hand):
    """Returns a scene with a bilateral spring along z, and with a random hand, device and rendering."""
    return {
        "name": f"{device}_{hand}",
        "time": {"step_s": float(RANDOM.choice([0.00025, 0.0005, 0.001])), "steps": 16},
        "environment": {"type": "springs", "groups": [{"direction": [0, 0, 1], "count": 1}]},
        "initial": {"position_m": [0, 0, 1e-4]},
        "hand": random_hand(RANDOM, hand),
        "device": random_device(RANDOM, device),
        "rendering": {
            "algorithm": "summation",
            "stiffness_N_per_m": 1000,
            "damping_N_s_per_m": between(RANDOM, 0.2, 8),
            "mass_kg": between(RANDOM, 0.05, 0.3),
            "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0},
        },
    }


def output_of(folder, *words):
    ran = subprocess.run(
        [PROGRAM, *map(str, words), "--json", "--out", folder / "out"],
        capture_output=True,
        text=True,
        check=False,
    )
    if not ran.stdout:
        raise RuntimeError(f"{' '.join(map(str, words))}\n{ran.stderr}")
    return json.loads(ran.stdout)


def limit(folder, scene, low, high, *words):
    file = folder / "scene.json"
    file.write_text(json.dumps(scene))
    return output_of(
        folder, "limit", file, "--between", f"{low:.6g}:{high:.6g}", "--stable", "settled", *words
    )["limits"][0]


def grows(folder, scene, A, K):
    """Returns True if the amplitude of a run at the stiffness K grows, and False if it decays. Returns None if the run
    would take too many steps. `A`: matrix of the loop at K, which gives the number of steps."""
    steps = int(np.log(GROWN) / abs(np.log(radius(A)))) + 100
    if steps > MAX_STEPS:
        return None
    scene = json.loads(json.dumps(scene))
    scene["time"]["steps"] = 3 * steps
    scene["rendering"]["stiffness_N_per_m"] = K
    scene["expect"] = {"outcome": ["completes", "diverges"]}
    file = folder / "run.json"
    file.write_text(json.dumps(scene))
    ends = output_of(folder, "run", file)
    if "diverges" in json.dumps(ends):
        return True
    rows = np.genfromtxt(folder / "out" / "trajectory.csv", delimiter=",", names=True)
    z = np.abs(rows["pz_m"])
    third = len(z) // 3
    return bool(z[2 * third :].max() > z[third : 2 * third].max())


def check(name, got, known, within, faults):
    wrong = got is None or abs(got / known - 1) > within
    print(f"{'FAIL' if wrong else 'ok  '} {name}: {got} for {known:.8g}")
    if wrong:
        faults.append(name)


def check_springs(folder, faults):
    """Checks the limit of each device with each hand on a spring. A run below the limit must decay, and a run above the
    limit must grow."""
    pairs = [(device, hand) for device in MAPS for hand in ("none", "force", "impedance")]
    pairs.append(("impedance", "mass_spring_damper"))
    for device, hand in pairs:
        made = 0
        while made < COUNT:
            scene = random_scene(device, hand)
            loop = lambda K: MAPS[device](scene, K)
            expected = limit_of(lambda K: radius(loop(K)) <= 1 + 1e-11)
            if expected is None:
                continue
            made += 1
            name = f"{device}, hand {hand}, {made}"
            row = limit(folder, scene, expected / 5, 5 * expected, "--resolution", 0.3)
            check(name, row["theoretical_limit"], expected, SPRINGS_AGREE, faults)
            if made > 2:
                continue
            for factor in (1 - BESIDE, 1 + BESIDE):
                K = factor * expected
                seen = grows(folder, scene, loop(K), K)
                if seen is not None and seen != (factor > 1):
                    print(
                        f"FAIL {name}: the run at {factor} of the limit {'grows' if seen else 'decays'}"
                    )
                    faults.append(f"{name}, run")


def pressed(device, hand, tip, diameter):
    """Returns a scene in which a hand presses a tool on a plane. `diameter` of the tool [m]."""
    scene = random_scene(device, "none")
    scene.update(
        time={"step_s": 0.001, "duration_s": 2},
        environment={"type": "plane", "size_m": 0.02, "spacing_m": 0.0005},
        initial={"position_m": [0, 0, 0.0001]},
        tool={"diameter_m": diameter, "length_m": 0.01, "tip": tip},
        hand=hand,
    )
    scene["rendering"]["algorithm"] = "mean"
    return scene


def sides_of_flat_tip(radius_of_tip, spacing=0.0005):
    """Returns the distance [m] from each point of a plane's grid below a flat tip to the side of the tip, r - rho."""
    at = spacing * np.arange(-50, 51)
    rho = np.hypot(*np.meshgrid(at, at)).ravel()
    return radius_of_tip - rho[rho <= radius_of_tip * (1 + 1e-12)]


def slope_of_flat_tip(K, F, radius_of_tip):
    """Returns dF/dz [N/m] of the mean force of all points under a flat tip, at the depth z [m] to which the force F [N]
    presses the tip. The depth of a point is the smaller of its distances to the bottom and to the side of the tip:
    min(z, r - rho), where rho is the point's distance from the axis and r is the radius of the tip.
    """
    side = sides_of_flat_tip(radius_of_tip)
    low, high = 0.0, radius_of_tip
    for _ in range(200):
        z = 0.5 * (low + high)
        low, high = (z, high) if K * np.minimum(z, side).mean() < F else (low, z)
    return K * (side > z).mean()


def check_surfaces(folder, faults):
    """Checks two kinds of limits. The first is for a flat tip, whose contact stiffness is smaller than K. The second is
    for a hand of type drag, whose damping along the normal is in the loop."""
    for F in (0.5, 0.8):
        scene = pressed("impedance", {"type": "force", "z_N": -F}, "flat", 0.004)
        scene["device"] = {
            "type": "impedance",
            "handle_mass_kg": 0.15,
            "viscous_N_s_per_m": 0.4,
            "delay_samples": 0.5,
            "velocity_filter": {"type": "difference"},
        }
        scene["rendering"]["damping_N_s_per_m"] = 1.5
        still = json.loads(json.dumps(scene))
        still["hand"] = {"type": "none"}
        # If K is smaller than `softest`, the force F presses the tip in without end: the slope is 0, and an eigenvalue
        # is 1.
        softest = F / sides_of_flat_tip(0.002).mean()
        expected = limit_of(
            lambda K: radius(MAPS["impedance"](still, slope_of_flat_tip(K, F, 0.002))) <= 1,
            low=1.2 * softest,
        )
        row = limit(folder, scene, expected / 4, 4 * expected, "--resolution", 0.05)
        check(f"flat tip, {F} N", row["linear_limit"], expected, SURFACES_AGREE, faults)
    for damping in (20, 60):
        drag = {
            "type": "drag",
            "force_N": 1,
            "path_m": [[-0.004, 0, 0], [0.004, 0, 0]],
            "speed_m_per_s": 0.004,
            "normal_damping_N_s_per_m": damping,
        }
        scene = pressed("impedance", drag, "round", 0.001)
        scene["initial"]["position_m"] = [-0.004, 0, 0.0006]
        scene["environment"]["spacing_m"] = 0.0002
        scene["rendering"][
            "depth_model"
        ] = "normal_projection"  # all points of a plane have the same depth
        scene["device"] = {
            "type": "impedance",
            "handle_mass_kg": 0.2,
            "viscous_N_s_per_m": 1.4,
            "delay_samples": 1.5,
            "velocity_filter": {"type": "difference"},
        }
        scene["rendering"]["damping_N_s_per_m"] = 10
        along = json.loads(json.dumps(scene))
        along["hand"] = {
            "type": "impedance",
            "stiffness_N_per_m": 0.0,
            "damping_N_s_per_m": damping,
        }
        expected = limit_of(lambda K: radius(MAPS["impedance"](along, K)) <= 1)
        row = limit(folder, scene, expected / 8, 2 * expected, "--resolution", 0.2)
        check(f"drag, b_n = {damping}", row["linear_limit"], expected, SURFACES_AGREE, faults)


def main():
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        check_springs(Path(folder), faults)
        check_surfaces(Path(folder), faults)
    if faults:
        sys.exit(f"{len(faults)} wrong: {', '.join(faults)}")


main()
