"""Recomputes every metric of twelve runs with numpy from the files of the run. It uses only the definitions that
`hapbench describe metrics` prints."""
import csv
import json
import math
import unittest

import numpy as np
from fixture import hapbench, scratch_folder

# Scenes, each with settings in addition to RECORDED.
ALL, TORQUE, INSIDE = "record.contacts=true", "record.torque=true", "record.inside=true"
ENERGY = "record.energy=true"
RECORDED = ("record.every=1", "record.trajectory=true", "expect={}", ALL, ENERGY, TORQUE)
SCENES = {
    "poke_plane": (INSIDE,),
    "plane_wiped_round": (INSIDE, "metrics.from_s=0.1", "record.force_reference=true"),
    "impedance_at_wall": (INSIDE,),
    "impedance_in_hole": (INSIDE, "time.duration_s=0.3"),
    "device_at_wall": (INSIDE, "time.duration_s=0.3"),
    "tap_corner": (INSIDE,),
    "bounce_plane": (INSIDE, "metrics.from_s=0.05"),
    "springs_limited_mean": (),
    "springs_oscillation": (),
    "recorded_stroke": (INSIDE,),
    "drill_in_hole": ("record.ideal_trajectory=true", "time.duration_s=0.5"),
    "incline_dry": (INSIDE,),
}
ROUNDING = (
    1e-9  # rounding of sums of some thousand terms, and of a filter over some hundred samples
)
BIN = 0.0079  # half a bin of the histogram of force_step_p99_N, by its definition
IN_NO_FILE = "written to no file"


def table(file):
    """Returns the columns of a table by name; NaN for empty cells."""
    with open(file, encoding="utf-8", newline="") as lines:
        rows = list(csv.reader(lines))
    cells = [[float(cell) if cell else math.nan for cell in row] for row in rows[1:]]
    return dict(zip(rows[0], np.array(cells).reshape(-1, len(rows[0])).T))


def vectors(columns, pattern):
    return np.column_stack([columns[pattern.replace("*", axis)] for axis in "xyz"])


def norms(vectors_):
    return np.sqrt(np.sum(vectors_**2, axis=-1))


def flat(value, name=""):
    """Yields (name, value) of each metric in summary.json."""
    if isinstance(value, dict):
        for key, part in value.items():
            yield from flat(part, f"{name}.{key}" if name else key)
    elif isinstance(value, list) and len(value) == 3:
        for axis, part in zip("xyz", value):
            yield f"{name}.{axis}", part
    elif not isinstance(value, list):
        yield name, value


class HighPass:
    """Fourth-order Butterworth high-pass at 30 Hz, by the bilinear transform with prewarped cutoff. It has two
    second-order sections, one for each pair of poles."""

    def __init__(self, dt):
        k = math.tan(math.pi * 30.0 * dt)
        self.sections = []
        for angle in (math.pi / 8, 3 * math.pi / 8):
            n = 1.0 / (1.0 + 2.0 * math.cos(angle) * k + k * k)
            self.sections.append(
                (n, 2 * n * (k * k - 1), n * (1 - 2 * math.cos(angle) * k + k * k))
            )

    def start(self, x):
        """Sets the state of the filter to the steady state for the constant input x."""
        self.inputs = [[x, x], [0.0 * x, 0.0 * x]]
        self.outputs = [[0.0 * x, 0.0 * x], [0.0 * x, 0.0 * x]]

    def __call__(self, x):
        for (n, a1, a2), last, before in zip(self.sections, self.inputs, self.outputs):
            y = n * (x - 2 * last[0] + last[1]) - a1 * before[0] - a2 * before[1]
            last[:], before[:] = [x, last[0]], [y, before[0]]
            x = y
        return x


def high_passed(signal, dt):
    """Returns the high-passed signal. The filter starts in the steady state for the first sample. Returns None if the
    sampling rate is too low for the filter."""
    if 1.0 / dt <= 60.0:
        return None
    high_pass = HighPass(dt)
    high_pass.start(signal[0])
    return np.array([high_pass(x) for x in signal])


class Recomputed:
    """Metrics of one run, recomputed from its files. `known`: value by name of the metric."""

    def __init__(self, folder):
        self.folder, self.known = folder, {}
        self.scenario = json.loads((folder / "scenario.effective.json").read_text("utf-8"))
        self.rows = table(folder / "trajectory.csv")
        self.t, self.dt = self.rows["time_s"], self.scenario["time"]["step_s"]
        self.f, self.v, self.p, self.spring, self.handle = (
            vectors(self.rows, name)
            for name in ("f*_N", "v*_m_per_s", "p*_m", "fspring_*_N", "hv*_m_per_s")
        )
        self.touching = self.rows["colliding"] > 0
        self.prescribed = self.scenario["motion"]["position"]["type"] != "free"
        self.handle_moves = not self.prescribed and self.scenario["device"]["type"] == "impedance"
        self.body = self.handle if self.handle_moves else self.v
        self.phases()
        self.motion_and_force()
        self.contacts()
        self.settled_contact()
        self.reduction()
        self.inside()
        self.energy()
        self.torque()
        for name, part in (
            ("force_reference.csv", self.fidelity),
            ("ideal_trajectory.csv", self.ideal_trajectory),
        ):
            if (folder / name).exists():
                part(table(folder / name))

    def phases(self):
        """Finds the rows of landings and of settled contact."""
        rule = self.scenario["metrics"]
        rows, away = round(rule["settling_s"] / self.dt), math.inf
        self.landing, self.restarts = np.zeros(len(self.t), bool), np.zeros(len(self.t), bool)
        self.landings = 0
        for k, touching in enumerate(self.touching):
            if touching and away >= max(rows, 1):
                self.landings += 1
                self.landing[k : k + rows] = True
            away = 0 if touching else away + 1
            self.restarts[k] = away > rows
        if rule.get("from_s") is not None:
            self.landing = np.arange(len(self.t)) < round(rule["from_s"] / self.dt)
        self.settled = self.touching & ~self.landing
        self.settled_s = self.settled.sum() * self.dt

    def motion_and_force(self):
        F, changes = norms(self.f), norms(np.diff(self.f, axis=0))
        self.steps = np.concatenate([[0.0], changes])
        self.reverses = np.concatenate([[False], np.sum(self.f[1:] * self.f[:-1], axis=1) < 0.0])
        fast, shaking = high_passed(self.body, self.dt), high_passed(self.handle, self.dt)
        n = len(self.t)
        self.known |= {
            "force_max_N": F.max(),
            "force_step_max_N": self.steps.max(),
            "velocity_total_variation_m_per_s": norms(np.diff(self.body, axis=0)).sum(),
            "force_reversals": self.reverses.sum(),
            "speed_max_m_per_s": norms(self.body).max(),
            "vibration_power_above_30Hz_m2_per_s2": None
            if fast is None
            else np.mean(norms(fast) ** 2),
            "vibration_last_quarter_m_per_s": None
            if shaking is None
            else math.sqrt(np.mean(norms(shaking[-(n // 4) :]) ** 2)),
            **{f"final_position_m.{axis}": x for axis, x in zip("xyz", self.p[-1])},
        }
        rendering, integrator = self.scenario["rendering"], self.scenario["integrator"]["type"]
        friction = rendering.get("friction") or {}
        mu_s, mu_f = (friction.get(f"mu_{x}", 0.0) for x in ("s_N_s_per_m", "f_s_per_m"))
        factor = {"leapfrog": 2.0, "velocity_verlet": 4.0}.get(integrator)
        limit = None
        if factor and not self.prescribed and not self.handle_moves and mu_f > 0.0:
            limit = max(0.0, (factor * rendering["mass_kg"] / self.dt - mu_s) / mu_f)
        beyond = None if limit is None else norms(self.spring) > limit
        self.known |= {
            "explicit_friction_limit_N": limit,
            "explicit_friction_rows_beyond": None if beyond is None else beyond.sum(),
            "explicit_friction_first_step": np.argmax(beyond)
            if beyond is not None and beyond.any()
            else None,
        }

    def contacts(self):
        any_contact = (self.rows["rendered"] > 0).any()
        self.known |= {
            "depth_max_m": self.rows["depth_max_m"].max(),
            "ratio_min": np.nanmin(self.rows["ratio_min"]) if any_contact else None,
            "ratio_max": np.nanmax(self.rows["ratio_max"]) if any_contact else None,
            "steps_in_contact": self.touching.sum(),
            "contact_share": self.touching.mean(),
            "last_contact_s": self.t[self.touching][-1] if self.touching.any() else None,
        }
        for name in ("colliding", "rendered"):
            self.known |= {
                f"{name}_mean": self.rows[name].mean(),
                f"{name}_max": self.rows[name].max(),
            }

    def settled_contact(self):
        F, landed, enough = norms(self.f), self.landing.any(), self.settled_s >= 1.0 / 30.0
        self.enough = enough
        settled = self.settled
        self.known |= {
            "landings": self.landings,
            "settled_s": self.settled_s,
            "landing_force_max_N": F[self.landing].max() if landed else None,
            "landing_force_step_max_N": self.steps[self.landing].max() if landed else None,
            "force_mean_in_contact_N": F[settled].mean() if enough else None,
            "settled_force_max_N": F[settled].max() if enough else None,
            "settled_force_step_max_N": self.steps[settled].max() if enough else None,
            "force_step_p99_N": np.sort(self.steps[settled])[math.ceil(0.99 * settled.sum()) - 1]
            if enough
            else None,
            "force_reversals_per_s": (self.reverses & settled).sum() / self.settled_s
            if enough
            else None,
            "force_rms_above_30Hz_N": self.vibration_of_force() if enough else None,
        }

    def vibration_of_force(self):
        if 1.0 / self.dt <= 60.0:
            return None
        high_pass, squares, runs = HighPass(self.dt), 0.0, False
        for k, force in enumerate(self.f):
            if self.landing[k]:
                runs = False
                continue
            if self.settled[k] and not runs:
                high_pass.start(force)
                runs = True
            if not runs:
                continue
            if self.restarts[k]:
                high_pass.start(0.0 * force)
                continue
            x = high_pass(force)
            squares += self.settled[k] * np.sum(x**2)
        return math.sqrt(squares / self.settled.sum())

    def reduction(self):
        if self.scenario["rendering"].get("reduction") is None:
            self.known |= {"reduction_changes": None, "reduction_force_step_max_N": None}
            return
        contacts = table(self.folder / "contacts.csv")
        kept = [set() for _ in self.t]
        for step, index in zip(contacts["step"].astype(int), contacts["index"].astype(int)):
            kept[step].add(index)
        changed = np.array([False] + [bool(a and b and a != b) for a, b in zip(kept, kept[1:])])
        both = changed & self.settled
        self.known |= {
            "reduction_changes": changed.sum(),
            "reduction_force_step_max_N": self.steps[both].max() if both.any() else None,
        }

    def inside(self):
        if "inside_m" not in self.rows:
            return
        depth, centre = self.rows["inside_m"], self.rows["centre_inside"]
        some = np.isfinite(depth).any()
        self.known |= {
            "inside_max_m": np.nanmax(depth) if some else None,
            "inside_settled_m": np.nanmedian(depth[self.settled]) if some and self.enough else None,
            "centre_inside_share": np.nanmean(centre) if np.isfinite(centre).any() else None,
        }

    def energy(self):
        rows = table(self.folder / "energy.csv")
        created = np.diff(rows["created_J"], prepend=0.0)
        self.known |= {
            f"energy.{name}_J": rows[f"{name}_J"][-1]
            for name in "created input spring damping rotation integration script hand actuator".split()
        } | {
            "energy.created_sum_J": created[created > 0.0].sum(),
            "energy.created_max_J": max(0.0, created.max()),
            "energy.residual_max_J": np.abs(rows["residual_J"]).max(),
        }
        self.energy_scale = max(np.abs(rows["spring_J"]).max(), np.abs(rows["stored_J"]).max())
        moved = np.diff(self.p, axis=0)
        if self.prescribed:
            works = np.sum(0.5 * (self.f[1:] + self.f[:-1]) * moved, axis=1)
        elif self.handle_moves:
            works = np.sum(self.f[:-1] * moved, axis=1)
        else:
            works = np.sum(self.f[:-1] * 0.5 * (self.v[1:] + self.v[:-1]), axis=1) * self.dt
        held = rows["stored_J"][0] + np.concatenate(
            [[0.0], np.cumsum(np.diff(rows["rotation_J"]) - works)]
        )
        self.known |= {
            "passivity.energy_min_J": held.min(),
            "passivity.time_of_min_s": self.t[np.argmin(held)],
            "passivity.energy_end_J": held[-1],
            "passivity.net_created_J": max(0.0, -held.min()),
        }
        self.held = held

    def torque(self):
        torque, touching = norms(vectors(self.rows, "t*_Nm")), self.touching
        self.known |= {
            "torque.lost_mean_Nm": torque[touching].mean() if touching.any() else None,
            "torque.lost_max_Nm": torque.max() if touching.any() else None,
        }

    def fidelity(self, rows):
        reference, error = vectors(rows, "mf*_N"), vectors(rows, "force_error_*_N")
        some = np.isfinite(reference[:, 0])
        m, e, f, spring = reference[some], error[some], self.f[some], self.spring[some]
        rms = lambda x: math.sqrt(np.mean(norms(x) ** 2))
        unit = lambda x: x / np.where(norms(x) > 0.0, norms(x), 1.0)[:, None]
        dot = lambda a, b: np.sum(a * b, axis=1)[:, None]
        n = np.where(norms(spring)[:, None] > 0.0, unit(spring), unit(m))
        load = np.maximum(0.0, dot(n, m))
        both = (norms(f) > 0.1) & (norms(m) > 0.1)
        angles = np.arctan2(norms(np.cross(m, f)), dot(m, f)[:, 0])
        self.known |= {
            "fidelity.rows": some.sum(),
            "fidelity.reference_force_rms_N": rms(m),
            "fidelity.force_error_rms_N": rms(e),
            "fidelity.force_error_relative": rms(e) / rms(m),
            "fidelity.force_error_normal_rms_N": rms(dot(n, e) * n),
            "fidelity.force_error_tangential_rms_N": rms(e - dot(n, e) * n),
            "fidelity.reference_mu": np.sum(load[:, 0] * norms(m - load * n)) / np.sum(load**2),
            "fidelity.force_artefact_share": rms(f - dot(unit(m), f) * unit(m)) / rms(f),
            "fidelity.displacement_rms_m": None,  # no hand with a target moves the tool of these scenes
            "fidelity.direction_rows": both.sum(),
            "fidelity.force_direction_error_rad": angles[both].mean() if both.any() else None,
        }
        self.lag(m, f)

    def lag(self, first, second):
        """Computes the lag by comparing shifts by whole steps. The tolerance of the printed metric covers the effect of
        the sample spacing."""
        max_shift = round(0.1 / self.dt)
        scores = []
        for shift in range(-max_shift, max_shift + 1):
            a = first[max(0, -shift) : len(first) - max(0, shift)]
            b = second[max(0, shift) : len(second) - max(0, -shift)]
            a, b = a - a.mean(axis=0), b - b.mean(axis=0)
            scores.append(np.sum(a * b) / math.sqrt(np.sum(a**2) * np.sum(b**2)))
        best = int(np.argmax(scores))
        ends = best in (0, len(scores) - 1)
        self.known["fidelity.force_lag_s"] = None if ends else (best - max_shift) * self.dt
        self.scores = scores

    def ideal_trajectory(self, rows):
        recorded = len(self.t)
        self.known["ideal_trajectory.rows_without_ideal"] = recorded - len(rows["step"])
        for name, some in (
            ("gentle", rows["hand_force_N"] < 2.0),
            ("firm", rows["hand_force_N"] >= 2.0),
        ):
            height = (rows["height_m"] - rows["ideal_height_m"])[some]
            lateral = (rows["lateral_m"] - rows["ideal_lateral_m"])[some]
            inter = rows["interpenetration_m"][some]
            of = lambda make, values: make(values) if some.any() else None
            root = lambda values: math.sqrt(np.mean(values**2))
            largest = lambda values: np.abs(values).max()
            self.known |= {
                f"ideal_trajectory.{name}.{metric}": value
                for metric, value in {
                    "rows": some.sum(),
                    "height_error_mean_m": of(np.mean, height),
                    "height_error_rms_m": of(root, height),
                    "height_error_min_m": of(np.min, height),
                    "height_error_max_m": of(np.max, height),
                    "lateral_error_mean_m": of(np.mean, lateral),
                    "lateral_error_rms_m": of(root, lateral),
                    "lateral_error_max_m": of(largest, lateral),
                    "interpenetration_mean_m": of(np.mean, inter),
                    "interpenetration_max_m": of(np.max, inter),
                }.items()
            }


class Metrics(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.root = scratch_folder(cls)
        printed = json.loads(hapbench("describe", "metrics", "--json"))
        cls.meanings = {one["name"]: one["meaning"] for one in printed[0]["metrics"]}

    def test_all_are_those_of_the_files(self):
        recomputed = set()
        for scene, words in SCENES.items():
            with self.subTest(scene=scene):
                folder = self.root / scene
                settings = [word for one in (*RECORDED, *words) for word in ("--set", one)]
                hapbench("run", scene, "--out", folder, "--quiet", *settings)
                summary = json.loads((folder / "summary.json").read_text("utf-8"))
                printed = dict(flat(summary["metrics"]))
                for section in (
                    "passivity",
                    "energy",
                    "ideal_trajectory",
                    "fidelity",
                    "torque",
                    "friction",
                ):
                    printed |= dict(flat(summary.get(section, {}), section))
                found = Recomputed(folder)
                for name, value in printed.items():
                    if name not in self.meanings or IN_NO_FILE in self.meanings[name]:
                        continue
                    with self.subTest(metric=name):
                        self.compare(name, value, found, summary)
                        recomputed.add(name)
        self.assertGreater(len(recomputed), 80)

    def compare(self, name, value, found, summary):
        if name == "fidelity.force_lag_period_s" or (
            name == "inside_max_m" and "inside_m" not in found.rows
        ):
            self.assertTrue(value is None or value > 0.0)
            return
        if name in ("inside_settled_m", "centre_inside_share") and "inside_m" not in found.rows:
            return
        self.assertTrue(name in found.known, "not computed from a column")
        known = found.known[name]
        if value is None or known is None:
            self.assertIsNone(known)
            self.assertIsNone(value)
            return
        allowed = ROUNDING * abs(known)
        if name == "force_step_p99_N":
            allowed += BIN * abs(known)
        if name.startswith(("energy", "passivity")):
            # Energies are sums that the program adds in another order.
            allowed += 1e-9 * found.energy_scale
        if name == "passivity.time_of_min_s":
            # If several minima are equal, rounding decides which one the program reports.
            k = round(value / found.dt)
            self.assertAlmostEqual(found.held[k], found.held.min(), delta=1e-9 * found.energy_scale)
            return
        allowed += summary.get("tolerances", {}).get(name, 0.0) if "lag" in name else 0.0
        self.assertLessEqual(abs(value - known), allowed + 1e-15, f"printed {value}, known {known}")

    def test_every_definition_names_a_column_or_another_metric(self):
        files = json.loads(hapbench("describe", "columns", "--json"))
        columns = {column["name"] for one in files for column in one["columns"]}
        names = {name.rpartition(".")[2] for name in self.meanings} | set(self.meanings)
        for name, meaning in self.meanings.items():
            words = {word.strip(",;()|.-") for word in meaning.replace("|", " ").split()}
            own = name.rpartition(".")[2]
            refers = any(
                word in columns or (word in names and word not in (name, own)) for word in words
            )
            derived = any(
                text in meaning
                for text in (IN_NO_FILE, "||f", "B_max", "f_m", "settled", "subjects")
            )
            with self.subTest(metric=name):
                self.assertTrue(refers or derived, meaning)


if __name__ == "__main__":
    unittest.main()
