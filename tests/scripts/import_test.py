"""`hapbench import` and the metrics of fidelity against numpy and scipy. Arguments: the built program, the source tree."""
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
from scipy import signal
from scipy.spatial.transform import Rotation, Slerp

PROGRAM, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
DATA = SOURCE / "scenarios" / "examples" / "data"
LOG = DATA / "wipe.hapi.txt"
Y_UP = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float)  # x, -z, y


def hapbench(*words):
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, stdin=subprocess.DEVNULL,
                          env={**os.environ, "HAPBENCH_PYTHON": sys.executable})
    assert done.returncode == 0, (words, done.stderr)
    return done.stdout


def columns(file):
    with file.open() as text:
        names = text.readline().strip().split(",")
    return names, np.genfromtxt(file, delimiter=",", skip_header=1)


class Given(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="hapbench-import-")
        self.addCleanup(scratch.cleanup)
        self.root = Path(scratch.name)

    def imported(self, *words):
        report = json.loads(hapbench("import", LOG, "--preset", "hapi", "--out", self.root / "stroke.csv", "--json", *words))
        return report, *columns(self.root / "stroke.csv")


class Import(Given):
    def test_resamples_and_smooths_as_scipy_does(self):
        log = np.loadtxt(LOG, skiprows=1)
        time = log[:, 0] - log[0, 0]
        turns = Rotation.from_matrix(Y_UP) * Rotation.from_rotvec(
            log[:, 4:7] / np.linalg.norm(log[:, 4:7], axis=1, keepdims=True) * log[:, 7:8])
        for rate, window, order in ((150, 9, 3), (333, 21, 2)):
            report, names, stroke = self.imported("--rate", rate, "--smooth", f"window={window},order={order}")
            self.assertEqual(names, "time_s px_m py_m pz_m qw qx qy qz mfx_N mfy_N mfz_N".split())
            grid = np.arange(len(stroke)) / rate
            np.testing.assert_allclose(stroke[:, 0], grid, atol=1e-12)
            place = np.column_stack([np.interp(grid, time, part) for part in (log[:, 1:4] @ Y_UP.T).T])
            force = np.column_stack([np.interp(grid, time, part) for part in (log[:, 8:11] @ Y_UP.T).T])
            smooth = signal.savgol_filter(place, window, order, axis=0, mode="interp")
            np.testing.assert_allclose(stroke[:, 1:4], smooth, atol=1e-13)
            np.testing.assert_allclose(stroke[:, 8:], force, atol=1e-12)
            moved = np.linalg.norm(smooth - place, axis=1)
            self.assertAlmostEqual(report["smoothing"]["position_largest_m"], moved.max(), delta=1e-13)
            self.assertAlmostEqual(report["smoothing"]["position_rms_m"], np.sqrt(np.mean(moved**2)), delta=1e-13)
            # Their components, of one sign, are smoothed and normalised again.
            quaternions = Slerp(time, turns)(np.minimum(grid, time[-1])).as_quat()
            signs = np.cumprod(np.sign(np.concatenate([[1], np.sum(quaternions[1:] * quaternions[:-1], axis=1)])))
            smooth = Rotation.from_quat(signal.savgol_filter(quaternions * signs[:, None], window, order, axis=0, mode="interp"))
            written = Rotation.from_quat(stroke[:, [5, 6, 7, 4]])
            self.assertLess((smooth.inv() * written).magnitude().max(), 1e-7)

    def test_finds_what_the_recording_was_made_of(self):
        report, _, stroke = self.imported()
        self.assertAlmostEqual(report["force_max_N"], np.linalg.norm(stroke[:, 8:], axis=1).max(), delta=1e-12)
        np.testing.assert_allclose(report["quantum_m"], 1e-5, rtol=1e-6)
        pressed = np.maximum(0, 2000 * (0.001 - stroke[:, 3]))
        # Rounding to 10 um alone may be off by 5 um, that is 10 mN, and the sensor by three of its 5 mN, five for all.
        self.assertLess(np.abs(stroke[:, 10] - pressed).max(), 0.01 + 0.025)


class Fidelity(Given):
    def test_metrics_are_those_of_the_recorded_rows(self):
        run = self.root / "run"
        summary = json.loads(hapbench("run", "recorded_wipe", "--out", run, "--json"))[0]
        found = summary["fidelity"]
        names, rows = columns(run / "trajectory.csv")
        f, spring, time = (rows[:, [names.index(n) for n in group]] for group in (
            ("fx_N", "fy_N", "fz_N"), ("fspring_x_N", "fspring_y_N", "fspring_z_N"), ("time_s",)))
        _, reference = columns(run / "force_reference.csv")
        _, stroke = columns(DATA / "wipe.csv")
        measured = np.column_stack([np.interp(time[:, 0], stroke[:, 0], part) for part in stroke[:, 8:].T])
        inside = time[:, 0] <= stroke[-1, 0]
        f, spring, measured = f[inside], spring[inside], measured[inside]
        np.testing.assert_allclose(reference[inside, 2:5], measured, atol=1e-13)
        np.testing.assert_allclose(reference[inside, 5:8], f - measured, atol=1e-13)

        def rms(v):
            return np.sqrt(np.mean(np.sum(v**2, axis=1)))

        def norms(v):
            return np.linalg.norm(v, axis=1, keepdims=True)

        error = f - measured
        normal = np.where(norms(spring) > 0, spring, measured)
        normal /= norms(normal)
        along = np.sum(error * normal, axis=1, keepdims=True) * normal
        both = (norms(f)[:, 0] > 0.1) & (norms(measured)[:, 0] > 0.1)
        cosine = np.sum(f * measured, axis=1)[both] / (norms(f) * norms(measured))[both, 0]
        for name, expected in (("rows", len(f)), ("reference_force_rms_N", rms(measured)), ("force_error_rms_N", rms(error)),
                               ("force_error_relative", rms(error) / rms(measured)), ("force_error_normal_rms_N", rms(along)),
                               ("force_error_tangential_rms_N", rms(error - along)), ("direction_rows", both.sum()),
                               ("force_direction_error_rad", np.arccos(np.clip(cosine, -1, 1)).mean())):
            self.assertAlmostEqual(found[name], expected, delta=1e-9 * max(1, abs(expected)), msg=name)
        self.assertAlmostEqual(found["force_lag_s"], lag(measured, f, 0.0005), delta=1e-9)

    def test_a_late_force_has_that_lag(self):
        names, stroke = columns(DATA / "wipe.csv")
        for delay in (-0.02, 0.0137):
            late = stroke.copy()
            late[:, 8:] = np.column_stack([np.interp(stroke[:, 0] + delay, stroke[:, 0], part) for part in stroke[:, 8:].T])
            np.savetxt(self.root / "late.csv", late, delimiter=",", header=",".join(names), comments="", fmt="%.17g")
            lags = [json.loads(hapbench("run", "recorded_wipe", "--set", f"motion.position.file={file}", "--set",
                                        "record.trajectory=false", "--out", self.root / "run", "--json"))[0]["fidelity"]
                    ["force_lag_s"] for file in (DATA / "wipe.csv", self.root / "late.csv")]
            # Noise of 1 % of the force moves the top of a correlation over 4 s by less than a recorded sample.
            self.assertAlmostEqual(lags[1] - lags[0], delay, delta=0.01)


class Pictures(Given):
    def test_a_page_and_a_picture_show_both_forces(self):
        run = self.root / "run"
        hapbench("run", "recorded_wipe", "--out", run, "--quiet")
        hapbench("report", run, "--quiet")
        page = (run / "report.html").read_text(encoding="utf-8")
        for words in ("Against the measured force", "Tangential, N", "Rendered and measured force [N] over time"):
            self.assertIn(words, page)
        hapbench("plot", run, "--y", "reference,force_error", "--quiet")
        self.assertIn("force of the stroke", (run / "plot.svg").read_text(encoding="utf-8"))
        hapbench("run", "recorded_wipe", "--set", "record.force_reference=false", "--out", run, "--quiet")
        hapbench("report", run, "--quiet")
        self.assertIn("record.force_reference=true", (run / "report.html").read_text(encoding="utf-8"))


def lag(early, late, dt, most=0.1):
    """By brute force: Pearson's coefficient at every shift, its top by a parabola."""
    shifts = np.arange(-round(most / dt), round(most / dt) + 1)
    found = []
    for shift in shifts:
        n = len(early) - abs(shift)
        a, b = early[max(0, -shift):][:n], late[max(0, shift):][:n]
        a, b = a - a.mean(axis=0), b - b.mean(axis=0)
        found.append(np.sum(a * b) / np.sqrt(np.sum(a * a) * np.sum(b * b)))
    top = int(np.argmax(found))
    below, peak, above = found[top - 1:top + 2]
    return (shifts[top] + 0.5 * (below - above) / (below - 2 * peak + above)) * dt


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
