"""Scenes behind the metrics of summary.json and the tables of a run: tools led along paths on springs, whose every row is known."""
import math

import numpy as np
from scipy import signal

from answers import EXACT, ROUNDING, Within, norms, profile, rms, scene

STEPPED = Within("velocities are differences of positions, known to 1e-17 m, over steps of 0.5 ms", relative=1e-11, absolute=1e-15)
FILTERED = Within("scipy's second-order sections are ours in another order: rounding times the filter's memory of some hundred rows",
                  relative=1e-9, absolute=1e-15)
BINNED = Within("a bin of the histogram of squares is a 32nd of a factor of two: half of sqrt(33/32) - 1", relative=0.0078)


def high_pass(x, dt, cutoff=30.0, start=None):
    """Butterworth's of fourth order, at rest at `start` (the first sample, if not given) before the first sample."""
    sections = signal.butter(4, cutoff, "high", fs=1 / dt, output="sos")
    start = x[0] if start is None else start
    return signal.sosfilt(sections, x, axis=0, zi=signal.sosfilt_zi(sections)[:, :, None] * start[None, None, :])[0]


class Phases:
    """Rows of landings and of settled contact, by their definition."""

    def __init__(self, contact, dt, settling=0.05):
        rows = round(settling / dt)
        away, end, self.landings = rows, 0, 0
        self.landing, self.settled = np.zeros(len(contact), bool), np.zeros(len(contact), bool)
        for k, touches in enumerate(contact):
            if touches and away >= rows:
                self.landings, end = self.landings + 1, k + rows
            away = 0 if touches else away + 1
            self.landing[k] = k < end
            self.settled[k] = touches and k >= end


def settled_high_pass(f, phases, dt):
    """The force behind the high-pass, which starts at rest in the first settled row after each landing."""
    found, k = np.zeros_like(f), 0
    while k < len(f):
        if not phases.settled[k]:
            k += 1
            continue
        end = next((j for j in range(k, len(f)) if phases.landing[j]), len(f))
        found[k:end] = high_pass(f[k:end], dt)
        k = end
    return found


def nearest_rank(values, share):
    return np.sort(values)[math.ceil(share * len(values)) - 1]


# Two nearly parallel springs, of which the reduction keeps the deeper, one across, and five that are never reached.
NEAR = 0.03
DIRECTIONS = np.array([[math.sin(NEAR), 0, -math.cos(NEAR)], [-math.sin(NEAR), 0, -math.cos(NEAR)], [0.48, 0.36, -0.8]] + 5 * [[0, 1.0, 0]])
PATH = {"x_m": {"type": "sine", "mean": 0, "amplitude": 2e-4, "period_s": 0.01, "phase_rad": 0.3}, "y_m": {"type": "ramp", "start": -1e-4, "rate_per_s": -1e-3},
        "z_m": {"type": "waypoints", "points": [
            [0, 1e-3], [0.0543, 1e-3], [0.0563, -2.4e-3], [0.2003, -2e-3], [0.2063, 5e-4], [0.2203, 5e-4], [0.2243, -1.5e-3],
            [0.35, -1.5e-3], [0.3543, 1e-3], [0.4543, 1e-3], [0.4603, -1.8e-3], [0.55, -1.2e-3], [0.555, 1e-3], [0.6, 1e-3]]}}
TOUCHES = {
    "time": {"step_s": 0.0005, "steps": 1200},
    "environment": {"type": "springs", "bilateral": False,
                    "groups": [{"direction": list(u), "count": 1} for u in DIRECTIONS[:3]] + [{"direction": [0, 1, 0], "count": 5}]},
    "motion": {"position": {"type": "prescribed", **PATH}},
    "rendering": {"algorithm": "summation", "stiffness_N_per_m": 1000, "damping_ratio": 1, "mass_kg": 0.001,
                  "friction": {"mu_s_N_s_per_m": 1, "mu_f_s_per_m": 1}, "reduction": {"threshold": 0.995, "max_points": 100}},
    "record": {"contacts": True, "stiffness_tensor": True, "ratio_iterations": [0, 1, 3]},
    "expect": {"outcome": "completes"}}


class Touches:
    """Every row of TOUCHES by METHOD's formulas: f = -K sum d u - B S v - (mu_s + mu_f |f_spring|) (v - S v)."""

    def __init__(self, dt=0.0005, K=1000.0, B=2.0, mu_s=1.0, mu_f=1.0):
        self.dt, self.t = dt, np.arange(1200) * dt
        self.p = np.column_stack([profile(PATH[axis], self.t) for axis in ("x_m", "y_m", "z_m")])
        self.v = np.diff(self.p, axis=0, prepend=[2 * self.p[0] - self.p[1]]) / dt
        self.d = self.p @ DIRECTIONS.T
        self.touched = self.d > 0
        self.kept = self.touched.copy()
        deeper = self.d[:, 1] > self.d[:, 0]  # of those alike the first stays unless the second is deeper
        both = self.touched[:, 0] & self.touched[:, 1]
        self.kept[both & deeper, 0] = self.kept[both & ~deeper, 1] = False
        self.S = np.einsum("kn,ni,nj->kij", self.kept.astype(float), DIRECTIONS, DIRECTIONS)
        self.spring = -K * (self.kept * self.d) @ DIRECTIONS
        normal = np.einsum("kij,kj->ki", self.S, self.v)
        self.contact = self.touched.any(axis=1)
        rub = ((mu_s + mu_f * norms(self.spring)) * self.contact)[:, None]
        self.f = self.spring - B * normal - rub * (self.v - normal)
        self.ratios = np.where(self.kept, np.einsum("ni,kij,nj->kn", DIRECTIONS, self.S, DIRECTIONS), np.nan)
        self.phases = Phases(self.contact, dt)
        self.steps = np.r_[0.0, norms(np.diff(self.f, axis=0))]
        self.reverses = np.r_[False, np.sum(self.f[1:] * self.f[:-1], axis=1) < 0]
        self.changes = np.r_[False, self.contact[1:] & self.contact[:-1] & (self.kept[1:] != self.kept[:-1]).any(axis=1)]


@scene
def touches(bench):
    """A tool led three times onto springs, twice after a time away that counts, with a ripple of 100 Hz across."""
    run, r = bench.run(bench.scenario("touches", **TOUCHES)), Touches()
    F, settled, landing, touching = norms(r.f), r.phases.settled, r.phases.landing, r.contact
    last = int(np.flatnonzero(touching)[-1])
    behind, all_behind = settled_high_pass(r.f, r.phases, r.dt), high_pass(r.f, r.dt)
    v_behind, quarter = high_pass(r.v, r.dt), slice(900, 1200)
    onsets = int(np.sum(touching[1:] & ~touching[:-1]))
    rows = "the formula's rows"
    bench.metrics(run, [
        ("force_max_N", F.max(), rows, STEPPED, "settled contact only", F[settled].max()),
        ("force_step_max_N", r.steps.max(), rows, STEPPED, "settled contact only", r.steps[settled].max()),
        ("velocity_total_variation_m_per_s", norms(np.diff(r.v, axis=0)).sum(), rows, STEPPED, "variation of the speed",
         np.abs(np.diff(norms(r.v))).sum()),
        ("force_reversals", int(r.reverses.sum()), rows, EXACT, "changes of sign of f_x", int(np.sum(r.f[1:, 0] * r.f[:-1, 0] < 0))),
        ("vibration_power_above_30Hz_m2_per_s2", rms(v_behind) ** 2, "scipy's filter on the path's velocity", FILTERED,
         "mean square of v", rms(r.v) ** 2),
        ("depth_max_m", np.max(r.d), "largest <p, u>", STEPPED, "distance below z = 0", -r.p[:, 2].min()),
        ("ratio_min", np.nanmin(r.ratios), "u^T S u", ROUNDING, "least eigenvalue of S", np.linalg.eigvalsh(r.S[touching]).min()),
        ("ratio_max", np.nanmax(r.ratios), "u^T S u", ROUNDING, "largest eigenvalue of S", np.linalg.eigvalsh(r.S).max()),
        ("colliding_mean", r.touched.sum() / 1200, "springs with <p, u> > 0", ROUNDING, "mean over rows in contact",
         r.touched.sum() / touching.sum()),
        ("colliding_max", 3, "springs with <p, u> > 0", EXACT, "springs there are", 8),
        ("rendered_mean", r.kept.sum() / 1200, "those that the reduction keeps", ROUNDING, "colliding_mean", r.touched.sum() / 1200),
        ("rendered_max", 2, "those that the reduction keeps", EXACT, "colliding_max", 3),
        ("steps_in_contact", int(touching.sum()), "rows with <p, u> > 0", EXACT, "rows after the first touch", 1200 - int(np.flatnonzero(touching)[0])),
        ("contact_share", touching.mean(), "rows with <p, u> > 0", ROUNDING, "settled share", settled.mean()),
        ("last_contact_s", r.t[last], "the path's crossing", ROUNDING, "the first row after", r.t[last + 1]),
        ("speed_max_m_per_s", norms(r.v).max(), rows, STEPPED, "largest component", np.abs(r.v).max()),
        *[(f"explicit_friction_{name}", None, "a prescribed motion is not integrated", EXACT, "(2 M / dt - mu_s) / mu_f", 3.0)
          for name in ("limit_N", "rows_beyond", "first_step")],
        ("landings", 2, "touches 50 ms or more after the last", EXACT, "all touches", onsets),
        ("landing_force_max_N", F[landing].max(), rows, STEPPED, "of settled contact", F[settled].max()),
        ("landing_force_step_max_N", r.steps[landing].max(), rows, STEPPED, "of settled contact", r.steps[settled].max()),
        ("settled_s", settled.sum() * r.dt, "rows in contact after a landing", ROUNDING, "all contact", touching.sum() * r.dt),
        ("force_mean_in_contact_N", F[settled].mean(), rows, STEPPED, "over all rows in contact", F[touching].mean()),
        ("settled_force_max_N", F[settled].max(), rows, STEPPED, "over all rows", F.max()),
        ("force_step_p99_N", nearest_rank(r.steps[settled], 0.99), "sorted steps of settled rows", BINNED, "over all rows",
         nearest_rank(r.steps, 0.99)),
        ("settled_force_step_max_N", r.steps[settled].max(), rows, STEPPED, "over all rows", r.steps.max()),
        ("force_rms_above_30Hz_N", rms(behind[settled]), "scipy's filter from the end of each landing", FILTERED,
         "filtered from the start of the run", rms(all_behind[settled])),
        ("force_reversals_per_s", (r.reverses & settled).sum() / (settled.sum() * r.dt), rows, ROUNDING, "all over the run's time",
         r.reverses.sum() / 0.6),
        ("reduction_changes", int(r.changes.sum()), "crossings of the two depths", EXACT, "with touches and leaves",
         int((r.kept[1:] != r.kept[:-1]).any(axis=1).sum())),
        ("reduction_force_step_max_N", r.steps[r.changes & settled].max(), rows, STEPPED, "of all settled rows", r.steps[settled].max()),
        ("vibration_last_quarter_m_per_s", rms(v_behind[quarter]), "scipy's filter over the run, rms of its last quarter", FILTERED,
         "of v unfiltered", rms(r.v[quarter])),
        ("final_position_m.x", r.p[-1, 0], "the path's last row", STEPPED, "a row later", profile(PATH["x_m"], np.array([0.6]))[0]),
        ("final_position_m.y", r.p[-1, 1], "the path", STEPPED, "a row later", -1e-4 - 1e-3 * 0.6),
        ("final_position_m.z", 1e-3, "the path", EXACT, "the deepest", r.p[:, 2].min())])
    touch_tables(bench, run, r)
    full = bench.run(bench.folder / "touches.json", "--set", 'rendering.reduction={"threshold":0.995,"max_points":1}', out="full")
    bench.add("run --json: points_dropped", full.summary["work"]["points_dropped"], int((r.touched[:, :2].any(axis=1) & r.touched[:, 2]).sum()),
              "the third spring where another is kept", EXACT, ("all but one", int(np.maximum(0, r.touched.sum(axis=1) - 1).sum())))


def touch_tables(bench, run, r):
    """trajectory.csv, stiffness_tensor.csv, ratios.csv and contacts.csv of the same run."""
    table, rows, touching = run.table(), "the formula", r.contact
    columns = [("step", np.arange(1200.0), "0, 1, ...", EXACT, "from 1", np.arange(1200.0) + 1),
               ("time_s", r.t, "k dt", EXACT, "after the step", r.t + r.dt)]
    for i, x in enumerate("xyz"):
        other = (i + 1) % 3
        columns += [
            (f"p{x}_m", r.p[:, i], "the path", STEPPED, "a row later", r.p[:, other]),
            (f"v{x}_m_per_s", r.v[:, i], "(p_k - p_(k-1)) / dt", STEPPED, "a row later", np.r_[r.v[1:, i], r.v[0, i] + 1]),
            (f"axis_{x}", (0.0, -1.0, 0.0)[i], "down in the plane of springs", EXACT, "down in space", np.full(1200, (2.0, 0, -1)[i])),
            (f"f{x}_N", r.f[:, i], rows, STEPPED, "f_spring", r.spring[:, i]),
            (f"fspring_{x}_N", r.spring[:, i], rows, STEPPED, "f", r.f[:, i]),
            (f"h{x}_m", r.p[:, i], "an ideal device's handle is the tip", STEPPED, "a row late", np.r_[r.p[:1, i], r.p[:-1, i]])]
    columns += [("colliding", r.touched.sum(axis=1), "springs with <p, u> > 0", EXACT, "those kept", r.kept.sum(axis=1)),
                ("rendered", r.kept.sum(axis=1), "those that the reduction keeps", EXACT, "colliding", r.touched.sum(axis=1)),
                ("depth_max_m", np.maximum(0, r.d.max(axis=1)), "largest <p, u>", STEPPED, "-z", np.maximum(0, -r.p[:, 2]))]
    by_row = np.where(touching[:, None], r.ratios, np.nan)
    least, most = np.full(1200, np.nan), np.full(1200, np.nan)
    least[touching], most[touching] = np.nanmin(by_row[touching], axis=1), np.nanmax(by_row[touching], axis=1)
    values = np.linalg.eigvalsh(r.S)
    columns += [("ratio_min", least, "u^T S u", ROUNDING, "eigenvalue of S", np.where(touching, values[:, 0], np.nan)),
                ("ratio_max", most, "u^T S u", ROUNDING, "eigenvalue of S", np.where(touching, values[:, 2], np.nan))]
    bench.columns("trajectory.csv", table, columns)
    tensor = [(name, r.S[:, i, j], "sum u u^T", ROUNDING, "of all touched", 1 + r.S[:, i, j]) for name, i, j in
              (("sxx", 0, 0), ("sxy", 0, 1), ("sxz", 0, 2), ("syy", 1, 1), ("syz", 1, 2), ("szz", 2, 2))]
    bench.columns("stiffness_tensor.csv", run.table("stiffness_tensor.csv"),
                  columns[:2] + tensor + [("lambda_max", values[:, 2], "numpy's eigenvalue", ROUNDING, "trace of S", values.sum(axis=1))])
    shaping_table(bench, run, r)
    contact_table(bench, run, r)


def shaping_table(bench, run, r):
    rows = []
    for k in np.flatnonzero(r.contact):
        U = DIRECTIONS[r.kept[k]]
        c, A = np.ones(len(U)), (U @ U.T) ** 2
        for m in range(4):
            ratio = A @ c
            if m in (0, 1, 3):
                rows.append((k, r.t[k], m, len(U), ratio.min(), ratio.max(), np.linalg.eigvalsh((U.T * c) @ U)[-1]))
            c = c / ratio
    known = np.array(rows).T
    first = np.repeat(known[:, ::3], 3, axis=1)
    how = "c <- c / (A c) on the matrix A_ij = <u_i, u_j>^2"
    bench.columns("ratios.csv", run.table("ratios.csv"), [
        (name, known[i], how, ROUNDING, "before any iteration" if i > 3 else "the next row's", first[i] if i > 3 else known[i] + 1)
        for i, name in enumerate(("step", "time_s", "iteration", "rendered", "ratio_min", "ratio_max", "lambda_max"))])


def contact_table(bench, run, r):
    k, i = np.nonzero(r.kept)
    U = DIRECTIONS[i]
    table = run.table("contacts.csv")
    rows = [("step", k, "rows in contact", EXACT, "counted from 1", k + 1), ("time_s", r.t[k], "k dt", EXACT, "after the step", r.t[k] + r.dt),
            ("index", i, "of the spring", EXACT, "within the row", np.zeros(len(i))),
            ("depth_m", r.d[k, i], "<p, u>", STEPPED, "-z", -r.p[k, 2]), ("weight", np.ones(len(k)), "1 under summation", EXACT, "1 / n",
             1 / r.kept.sum(axis=1)[k])]
    for j, x in enumerate("xyz"):
        rows += [(f"gradient_{x}", U[:, j], "u of the spring", ROUNDING, "-u", -U[:, j] - (x == "y"))]
    bench.columns("contacts.csv", table, rows)


@scene
def mean_of_two(bench):
    """A tool led onto two springs, whose force `mean` halves, aside from one of them, and away from the other: energy is made."""
    K, dt, n = 1000.0, 0.001, 400
    U = np.array([[0, 0, -1.0], [0.8, 0, -0.6]])
    path = {"x_m": {"type": "ramp", "start": 5e-4, "rate_per_s": -0.02}, "y_m": 0, "z_m": {"type": "sine", "mean": -1e-3, "amplitude": 2.5e-3, "period_s": 0.4, "phase_rad": 2.0}}
    run = bench.run(bench.scenario(
        "mean_of_two", time={"step_s": dt, "steps": n}, record={"energy": True}, motion={"position": {"type": "prescribed", **path}},
        environment={"type": "springs", "bilateral": False, "groups": [{"direction": list(u), "count": 1} for u in U]},
        rendering={"algorithm": "mean", "stiffness_N_per_m": K, "damping_ratio": 0.02, "mass_kg": 0.01,
                   "friction": {"mu_s_N_s_per_m": 0.01, "mu_f_s_per_m": 0}}))
    t, B = np.arange(n) * dt, 0.04 * math.sqrt(K * 0.01)
    p = np.column_stack([profile(path[a], t) for a in ("x_m", "y_m", "z_m")])
    v = np.diff(p, axis=0, prepend=[2 * p[0] - p[1]]) / dt
    d = np.maximum(0, p @ U.T)
    count = np.sum(d > 0, axis=1)
    c = (d > 0) / np.maximum(1, count)[:, None]
    spring = -K * (c * d) @ U
    normal = np.einsum("kn,ni,nj,kj->ki", c, U, U, v)
    f = spring - B * normal - 0.01 * (v - normal) * (count > 0)[:, None]
    stored = 0.5 * K * np.sum(c * d ** 2, axis=1)
    moved, halves = np.diff(p, axis=0), lambda x: 0.5 * (x[1:] + x[:-1])
    onto = lambda force: np.r_[0, np.cumsum(np.sum(halves(force) * moved, axis=1))]  # trapezoidal rule
    held = lambda force: np.r_[0, np.cumsum(np.sum(force[:-1] * moved, axis=1))]
    created = np.diff(stored) + np.diff(onto(spring))
    kinetic = 0.5 * 0.01 * np.sum(v ** 2, axis=1)
    script = kinetic - kinetic[0] - onto(f)
    observed = stored[0] - onto(f)
    least = int(np.argmin(observed))
    by, rect = "trapezoidal rule along the path", "the row's force held over the step"
    bench.metrics(run, [
        ("energy.created_sum_J", created[created > 0].sum(), by, STEPPED, "net of what is destroyed", created.sum()),
        ("energy.created_max_J", created.max(), by, STEPPED, "largest of the absolute values", np.abs(created).max() + created.max()),
        ("energy.created_J", created.sum(), by, Within("twenty roundings of 1e-18 J a row", absolute=1e-17), rect,
         stored[-1] - stored[0] + held(spring)[-1]),
        ("energy.spring_J", onto(spring)[-1], by, STEPPED, rect, held(spring)[-1]),
        ("energy.damping_J", onto(f - spring)[-1], by, STEPPED, rect, held(f - spring)[-1]),
        ("energy.script_J", script[-1], "kinetic energy less the work of f", STEPPED, "without the kinetic energy", -onto(f)[-1]),
        ("energy.integration_J", 0.0, "nothing is integrated", Within("twenty roundings of 1e-18 J a row", absolute=1e-17), rect,
         held(spring)[-1] - onto(spring)[-1]),
        ("passivity.energy_min_J", observed[least], "E_k = E_0 - sum of the rule", STEPPED, rect, (stored[0] - held(f)).min()),
        ("passivity.time_of_min_s", t[least], "the row with that", EXACT, "the last row", t[-1]),
        ("passivity.energy_end_J", observed[-1], "E_k of the last row", STEPPED, rect, stored[0] - held(f)[-1]),
        ("passivity.net_created_J", max(0, -observed[least]), "max(0, -min E)", STEPPED, "all steps that created some", created[created > 0].sum())])
    events = [event for event in run.summary["energy"]["events"] if event["created_J"] > 1e-12]  # the others are rounding
    most = 1 + np.argsort(-created)[:len(events)]
    changes = np.diff((d > 0).astype(int), axis=0, prepend=0)
    pairs = [x for k in most for x in (count[k - 1], count[k])]
    for key, known, how, naive in (
            ("step", list(most), "rows that created most, in order", list(most - 1)), ("time_s", list(t[most]), "the same", list(t[most - 1])),
            ("created_J", list(created[most - 1]), by, list(-created[most - 1])), ("colliding", pairs, "springs before and after", pairs[::-1]),
            ("rendered", pairs, "springs before and after", pairs[::-1]), ("appeared", [int((changes[k] > 0).sum()) for k in most], "new springs", [9] * len(most)),
            ("vanished", [int((changes[k] < 0).sum()) for k in most], "springs that went", [9] * len(most))):
        printed = [x for event in events for x in (event[key] if isinstance(event[key], list) else [event[key]])]
        bench.add("energy.created_max_J" if key == "created_J" else f"run --json: {key}", printed, known, how, STEPPED, ("another order, or row", naive))
    rows = [("step", np.arange(n), "0, 1, ...", EXACT, "from 1", np.arange(n) + 1), ("time_s", t, "k dt", EXACT, "after the step", t + dt),
            ("kinetic_J", kinetic, "M v^2 / 2", STEPPED, "of the handle's speed squared", 2 * kinetic),
            ("stored_J", stored, "sum K c d^2 / 2", STEPPED, "of all springs in full", 0.5 * K * np.sum(d ** 2, axis=1)),
            ("spring_J", onto(spring), by, STEPPED, rect, held(spring)), ("damping_J", onto(f - spring), by, STEPPED, rect, held(f - spring)),
            ("created_J", np.r_[0, np.cumsum(created)], by, STEPPED, rect, stored - stored[0] + held(spring)),
            ("script_J", script, "kinetic energy less the work of f", STEPPED, "without the kinetic energy", -onto(f))]
    bench.columns("energy.csv", run.table("energy.csv"), rows)


@scene
def limited_hand(bench):
    """A free mass on a damped spring, pushed by a ramp of a hand whose force the device limits: a linear recurrence."""
    K, M, dt, n, limit = 2000.0, 0.2, 0.001, 300, 0.6
    B = 2 * 0.1 * math.sqrt(K * M)
    run = bench.run(bench.scenario(
        "limited_hand", time={"step_s": dt, "steps": n}, record={"energy": True}, initial={"position_m": [1e-3, 0, 0], "velocity_m_per_s": [0.02, 0, 0]},
        environment={"type": "springs", "groups": [{"direction": [1, 0, 0], "count": 1}]},
        hand={"type": "force", "x_N": {"type": "ramp", "start": 0.1, "rate_per_s": 3.0}}, device={"type": "ideal", "force_limit_N": limit},
        rendering={"algorithm": "summation", "stiffness_N_per_m": K, "damping_ratio": 0.1, "mass_kg": M,
                   "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0}}))
    x, v, t = np.zeros(n), np.zeros(n), np.arange(n) * dt
    hand = 0.1 + 3.0 * t
    given = np.minimum(hand, limit)
    x[0], v[0] = 1e-3, 0.02
    for k in range(n - 1):
        v[k + 1] = v[k] + (given[k] - K * x[k] - B * v[k]) * dt / M
        x[k + 1] = x[k] + v[k + 1] * dt
    held = Within("a recurrence of 300 steps, each rounded in another order", relative=1e-11, absolute=1e-17)
    total = lambda w: np.r_[0, np.cumsum(w)]
    mean_way = 0.5 * (v[1:] + v[:-1]) * dt  # what the held force works along
    along = lambda force: total(force[:-1] * mean_way)
    way = np.diff(x)
    spring = -K * x
    kinetic, stored = 0.5 * M * v ** 2, 0.5 * K * x ** 2
    integration = along(spring) - total(0.5 * (spring[1:] + spring[:-1]) * way)
    by, naive = "held force times mean velocity", "held force times the displacement"
    on = lambda force: total(force[:-1] * way)
    rows = [("input_J", along(given), by, held, naive, on(given)), ("spring_J", along(spring), by, held, naive, on(spring)),
            ("damping_J", along(-B * v), by, held, naive, on(-B * v)), ("hand_J", along(hand), "the same of the hand's force", held,
             "the limited force", along(given)),
            ("actuator_J", along(given - hand), "what the limiter takes away", held, "none", np.zeros(n)),
            ("integration_J", integration, "less the trapezoidal rule along the displacement", held, "none", np.zeros(n)),
            ("rotation_J", np.zeros(n), "nothing turns", EXACT)]
    bench.metrics(run, [(f"energy.{name}", series[-1], *rest[:2], *((rest[2], rest[3][-1]) if len(rest) > 2 else ()))
                        for name, series, *rest in rows if name not in ("spring_J", "damping_J")])
    rounded = Within("300 roundings of terms up to 2 mJ", absolute=300 * 2e-3 * 2.0 ** -52)
    bench.metrics(run, [("energy.residual_max_J", 0.0, "the terms explain everything", rounded, "with the works along the displacement",
                         float(np.max(np.abs(kinetic - kinetic[0] - on(given - K * x - B * v)))))])
    table = run.table("energy.csv")
    bench.columns("energy.csv", table, [
        *rows, ("kinetic_J", kinetic, "M v^2 / 2", held, "of the next row", np.r_[kinetic[1:], 0]),
        ("stored_J", stored, "K x^2 / 2", held, "of the next row", np.r_[stored[1:], 0]),
        ("created_J", np.zeros(n), "a linear spring", rounded, naive, stored - stored[0] + on(spring)),
        ("residual_J", np.zeros(n), "the terms explain everything", rounded, "with the works along the displacement",
         kinetic - kinetic[0] - on(given - K * x - B * v))])
    bench.columns("trajectory.csv", run.table(), [
        ("px_m", x, "recurrence", held, "explicit Euler's", x - v * dt), ("vx_m_per_s", v, "recurrence", held, "of the next row", np.r_[v[1:], 0]),
        ("fmeas_x_N", hand, "the ramp", ROUNDING, "the limited force", given), ("fin_x_N", given, "cut at 0.6 N", ROUNDING, "uncut", hand),
        *[(f"{name}_{y}_N", np.zeros(n), "the hand pushes along x", EXACT, "the same as along x", hand) for name in ("fmeas", "fin")
          for y in "yz"]])


@scene
def handle_on_spring(bench):
    """The handle of an impedance device on a spring, the force held and a sample late: exact by the matrix exponential."""
    m, b, K, dt, n, push = 0.3, 2.0, 800.0, 0.002, 400, 0.5
    run = bench.run(bench.scenario(
        "handle_on_spring", time={"step_s": dt, "steps": n}, record={"energy": True}, initial={"position_m": [1e-3, 0, 0]},
        environment={"type": "springs", "groups": [{"direction": [1, 0, 0], "count": 1}]}, hand={"type": "force", "x_N": push},
        device={"type": "impedance", "handle_mass_kg": m, "viscous_N_s_per_m": b, "delay_samples": 1},
        rendering={"algorithm": "summation", "stiffness_N_per_m": K, "damping_ratio": 0, "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0}}))
    decay = math.exp(-b * dt / m)
    x, v, motors = np.zeros(n), np.zeros(n), np.zeros(n)
    x[0] = 1e-3
    for k in range(n - 1):
        motors[k] = 0 if k == 0 else -K * x[k - 1]
        end = (motors[k] + push) / b  # speed it tends to
        v[k + 1] = end + (v[k] - end) * decay
        x[k + 1] = x[k] + end * dt + (v[k] - end) * (1 - decay) * m / b
    held = Within("400 steps of a decaying loop, each rounded in another order", relative=1e-11, absolute=1e-17)
    way, total = np.diff(x), lambda w: np.r_[0, np.cumsum(w)]
    hand, motor, kinetic = total(push * way), total(motors[:-1] * way), 0.5 * m * v ** 2
    lost = hand + motor - (kinetic - kinetic[0])
    shown_v = np.r_[0.0, np.diff(x) / dt]
    spring = -K * x
    work = total(spring[:-1] * way)
    zero = np.zeros(n)
    bench.columns("energy.csv", run.table("energy.csv"), [
        ("device_dissipated_J", -lost, "kinetic energy less the work of hand and motors", held, "-b v^2 dt", -total(b * v[:-1] ** 2 * dt)),
        ("device_stored_J", kinetic, "m v^2 / 2 of the exact speed", held, "of the measured speed", 0.5 * m * shown_v ** 2),
        ("hand_J", hand, "push times way", held, "with the measured speed a row late", total(push * shown_v[:-1] * dt)),
        ("actuator_J", motor, "held late force times way", held, "without the delay", work),
        ("spring_J", work, "row's force times the way to the next", held, "trapezoidal rule", total(0.5 * (spring[1:] + spring[:-1]) * way)),
        ("kinetic_J", zero, "there is no virtual mass", EXACT, "of the handle", kinetic)])
    bench.metrics(run, [
        ("energy.hand_J", hand[-1], "push times way", held, "with the force of the virtual tool", hand[-1] + work[-1]),
        ("energy.actuator_J", motor[-1], "held late force times way", held, "without the delay", work[-1]),
        ("energy.script_J", -work[-1], "work of the handle on the rendering", held, "none", 0.0),
        ("vibration_last_quarter_m_per_s", rms(high_pass(v[:, None], dt)[300:]), "scipy's filter on the exact speed", FILTERED,
         "on the measured speed", rms(high_pass(shown_v[:, None], dt)[300:])),
        ("speed_max_m_per_s", np.abs(v).max(), "the handle's own speed", held, "the measured one, difference of positions", np.abs(shown_v).max()),
        ("passivity.energy_end_J", 0.5 * K * x[0] ** 2 - work[-1], "E_0 less the held work", held, "the energy stored at the end",
         0.5 * K * x[-1] ** 2)])
    bench.columns("trajectory.csv", run.table(), [
        ("hx_m", x, "exact motion of the handle", held, "Euler's", x + v * dt), ("vx_m_per_s", shown_v, "difference of positions", held, "the handle's own", v),
        ("fx_N", spring, "-K x of the row", held, "a row late", motors)])


@scene
def turned_into_point(bench):
    """A cylinder that turns about its tip into one point: the depth is r - x cos(angle) + ..., and all its force is at that point."""
    K, r, n, dt, at = 1000.0, 0.5e-3, 200, 0.001, np.array([0.6e-3, 0.0, 4e-3])
    bench.write("one.csv", "x_m,y_m,z_m,nx,ny,nz", [(*at, -1, 0, 0)])
    turn = {"type": "ramp", "start": 0.0, "rate_per_s": 0.5}
    run = bench.run(bench.scenario(
        "turned_into_point", time={"step_s": dt, "steps": n}, environment={"type": "point_shell", "file": "one.csv"},
        tool={"diameter_m": 2 * r, "length_m": 0.01, "tip": "flat"}, record={"energy": True, "torque": True, "contacts": True, "pose": True},
        motion={"orientation": {"up": [0, 0, 1], "lean": [1, 0, 0], "tilt_rad": turn, "azimuth_rad": 0},
                "position": {"type": "prescribed", "x_m": 0, "y_m": 0, "z_m": 0}},
        rendering={"algorithm": "summation", "depth_model": "shortest_distance", "stiffness_N_per_m": K, "damping_ratio": 0,
                   "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0}, "mass_kg": 0.1}))
    t = np.arange(n) * dt
    tilt = 0.5 * t
    axis = -np.column_stack([np.sin(tilt), 0 * t, np.cos(tilt)])
    across = at - (axis @ at)[:, None] * axis
    d = np.maximum(0, r - norms(across))
    u = across / norms(across)[:, None]
    f = -K * d[:, None] * u
    torque = np.cross(at, f)
    touching = d > 0
    dragged = np.cross(0.5 * (torque[1:] + torque[:-1]), axis[1:])
    works = -0.5 * np.sum((torque[1:] + torque[:-1]) * np.array([0, 0.5 * dt, 0]), axis=1)
    shape = Within("depth is a difference of lengths of 0.5 mm, known to 1e-19 m", relative=1e-11, absolute=1e-15)
    wedge = 0.5 * K * d ** 2
    bench.metrics(run, [
        ("torque.lost_mean_Nm", norms(torque)[touching].mean(), "|at x f| of rows in contact", shape, "over all rows", norms(torque).mean()),
        ("torque.lost_max_Nm", norms(torque).max(), "|at x f|", shape, "arm along the axis in full", norms(at) * norms(f).max()),
        ("energy.rotation_J", works.sum(), "trapezoidal rule of the torque over the turn", shape, "the stored energy", wedge[-1]),
        ("energy.created_J", wedge[-1] - works.sum(), "stored less work", Within("two hundred roundings", absolute=1e-16),
         "none, as the force is conservative", 0.0),
        ("steps_in_contact", int(touching.sum()), "rows with r > distance to the axis", EXACT, "all rows", n)])
    bench.columns("energy.csv", run.table("energy.csv"), [("rotation_J", np.r_[0, np.cumsum(works)], "trapezoidal rule of the torque over the turn",
                                                           shape, "the stored energy", wedge)])
    k = np.flatnonzero(touching)
    sets = [(name, np.full(len(k), value), "the point of the file", ROUNDING, "seen from the tool", np.full(len(k), value) + axis[k, 0] * 1e-3 - 1e-5)
            for name, value in zip(("x_m", "y_m", "z_m", "nx", "ny", "nz"), (*at, -1.0, 0.0, 0.0))]
    bench.columns("contacts.csv", run.table("contacts.csv"), [
        *sets, ("depth_m", d[k], "r less the distance to the axis", shape, "r - x", np.full(len(k), r - at[0]))] + [
        (f"gradient_{x}", u[k, i], "from the axis to the point", ROUNDING, "minus the normal", np.full(len(k), float(x == "x")) + (x == "y"))
        for i, x in enumerate("xyz")])
    table = run.table()
    turned = rotated(table.vectors("qw", "qx", "qy", "qz"))
    bench.add("trajectory.csv:qw", table["qw"] ** 2 + table["qx"] ** 2 + table["qy"] ** 2 + table["qz"] ** 2, np.ones(n), "a unit quaternion",
              ROUNDING, ("without one component", np.full(n, 0.5)))
    for i, name in enumerate(("qx", "qy", "qz")):
        bench.add(f"trajectory.csv:{name}", turned[:, i], -axis[:, i], f"{'xyz'[i]} of where it turns the body's upward axis", ROUNDING,
                  ("the downward axis", axis[:, i] + (name == "qy")))
    bench.columns("trajectory.csv", table, [
        (f"axis_{x}", axis[:, i], "-(sin a, 0, cos a)", ROUNDING, "up", -axis[:, i] + (x == "y")) for i, x in enumerate("xyz")] + [
        (f"t{x}_Nm", torque[:, i], "at x f", shape, "f x at", -torque[:, i] + (x != "y") * 1e-3) for i, x in enumerate("xyz")] + [
        (f"f{x}_N", f[:, i], "-K d u", shape, "along the normal", K * d * (x == "x") + (x == "y")) for i, x in enumerate("xyz")])


def rotated(q):
    """Where unit quaternions (w, x, y, z) turn the third axis."""
    w, x, y, z = q.T
    return np.column_stack([2 * (x * z + w * y), 2 * (y * z - w * x), w * w - x * x - y * y + z * z])


# Not periodic: one lag alone fits.
STEPS = [[0, 0], [0.1, -1e-3], [0.18, -0.4e-3], [0.3, -1.6e-3], [0.36, -1.1e-3], [0.52, -2e-3], [0.6, -0.3e-3], [0.8, -0.9e-3], [1, -0.5e-3]]


@scene
def late_force(bench):
    """A force that follows the reference by 30 ms, with a part across it; perception's thresholds of the same run."""
    K, dt, n, late = 1000.0, 0.0005, 2000, 0.03
    reference = {"z_N": {"type": "waypoints", "points": [[max(0, s - late), -K * z] for s, z in STEPS[1:]]}, "x_N": 0.05}
    path = {"x_m": {"type": "sine", "mean": 0, "amplitude": 4e-5, "period_s": 0.01, "phase_rad": 0.4}, "y_m": 0,
            "z_m": {"type": "waypoints", "points": [[0, 0], *STEPS[1:]]}}
    run = bench.run(bench.scenario(
        "late_force", time={"step_s": dt, "steps": n}, motion={"position": {"type": "prescribed", **path}}, reference_force=reference,
        environment={"type": "springs", "groups": [{"direction": [0, 0, -1], "count": 1}, {"direction": [1, 0, 0], "count": 1}]},
        record={"force_reference": True}, perception={},
        rendering={"algorithm": "summation", "stiffness_N_per_m": K, "damping_ratio": 0.5, "mass_kg": 0.01,
                   "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0}}))
    t, B = np.arange(n) * dt, math.sqrt(K * 0.01)
    p = np.column_stack([profile(path[a], t) for a in ("x_m", "y_m", "z_m")])
    v = np.diff(p, axis=0, prepend=[2 * p[0] - p[1]]) / dt
    spring = -K * p
    f = spring - B * v
    m = np.column_stack([np.full(n, 0.05), np.zeros(n), profile(reference["z_N"], t)])
    error, size = f - m, norms(m)
    unit = spring / np.maximum(1e-300, norms(spring))[:, None]
    along = np.sum(error * unit, axis=1)
    line = m / size[:, None]
    across = f - np.sum(f * line, axis=1)[:, None] * line
    both = (size > 0.1) & (norms(f) > 0.1)
    angles = np.arccos(np.clip(np.sum(f * m, axis=1) / size / norms(f), -1, 1))
    shifts = np.arange(-200, 201)

    def fits(s):
        a, b = m[max(0, -s):n - max(0, s)], f[max(0, s):n - max(0, -s)]
        a, b = a - a.mean(axis=0), b - b.mean(axis=0)
        return np.sum(a * b) / math.sqrt(np.sum(a * a) * np.sum(b * b))

    lags = np.array([fits(s) for s in shifts])
    lag = shifts[np.argmax(lags)] * dt
    formula = "METHOD's f and the profile"
    fifth = Within("a lag is told to a row", absolute=0.5 * dt)
    bench.metrics(run, [
        ("fidelity.rows", n, "every row has a reference", EXACT, "rows of both above 0.1 N", int(both.sum())),
        ("fidelity.reference_force_rms_N", rms(m), formula, STEPPED, "of z alone", rms(m[:, 2])),
        ("fidelity.force_error_rms_N", rms(error), formula, STEPPED, "difference of the norms", rms(norms(f) - size)),
        ("fidelity.force_error_relative", rms(error) / rms(m), formula, STEPPED, "over the rendered force", rms(error) / rms(f)),
        ("fidelity.force_error_normal_rms_N", rms(along), "along f_spring", STEPPED, "along f",
         rms(np.sum(error * f, axis=1) / norms(f))),
        ("fidelity.force_error_tangential_rms_N", rms(error - along[:, None] * unit), "across f_spring", STEPPED, "across f_m",
         rms(error - np.sum(error * line, axis=1)[:, None] * line)),
        ("fidelity.force_artefact_share", rms(across) / rms(f), "across f_m over f", STEPPED, "over f_m", rms(across) / rms(m)),
        ("fidelity.direction_rows", int(both.sum()), "rows of both above 0.1 N", EXACT, "all rows", n),
        ("fidelity.force_direction_error_rad", angles[both].mean(), "mean angle, by the cosine", Within("a cosine loses half the digits near 0",
         relative=1e-7), "over all rows", angles.mean()),
        ("fidelity.force_lag_s", lag, "numpy's correlation at every shift", fifth, "with the other sign", -lag),
        ("fidelity.force_lag_period_s", None, "the path repeats nothing", EXACT, "the ripple's period", 0.01)])
    table = run.table("force_reference.csv")
    bench.columns("force_reference.csv", table, [
        ("step", np.arange(n), "0, 1, ...", EXACT, "from 1", np.arange(n) + 1), ("time_s", t, "k dt", EXACT, "after the step", t + dt)] + [
        (f"mf{x}_N", m[:, i], "the profile", ROUNDING, "f", f[:, i] + (x == "y")) for i, x in enumerate("xyz")] + [
        (f"force_error_{x}_N", error[:, i], formula, STEPPED, "f_m - f", -error[:, i] + (x == "y")) for i, x in enumerate("xyz")])
    perceived(bench, run, f, m, v, dt)


def perceived(bench, run, f, m, v, dt):
    """Thresholds by their sources: 10 % of a force or of 0.5 N; 0.15 um at 250 Hz."""
    jnd = lambda force: 0.1 * np.maximum(force, 0.5)
    noticed = norms(f - m) > jnd(norms(m))
    fast = high_pass(f, dt, start=np.zeros(3))
    square = signal.lfilter([-math.expm1(-30 * dt)], [1, -math.exp(-30 * dt)], np.sum(fast ** 2, axis=1))
    felt = np.sqrt(2 * square) > jnd(norms(f - fast))
    at_once = norms(fast) > jnd(norms(f - fast))
    acceleration = np.r_[np.zeros((1, 3)), np.diff(v, axis=0) / dt]
    band = lambda kind, cut, x: signal.sosfilt(signal.butter(4, cut, kind, fs=1 / dt, output="sos"), x, axis=0)
    low, high = 40.0, 400.0
    tactile = rms(band("low", high, band("high", low, acceleration)))
    threshold = 0.15e-6 * (2 * math.pi * 250) ** 2 / math.sqrt(2)
    bench.metrics(run, [
        ("perception.error_noticed_share", noticed.mean(), "10 % of f_m or of 0.5 N", ROUNDING, "10 % of f_m alone",
         np.mean(norms(f - m) > 0.1 * norms(m))),
        ("perception.vibration_noticed_share", felt.mean(), "amplitude by the mean square over 1/30 s", ROUNDING, "instants beyond it",
         at_once.mean()),
        ("perception.tactile_acceleration_rms_m_per_s2", tactile, "scipy's band of 40 to 400 Hz", FILTERED, "unfiltered", rms(acceleration)),
        ("perception.tactile_acceleration_over_threshold", tactile / threshold, "over 0.15 um (2 pi 250 Hz)^2 / sqrt 2", FILTERED,
         "over the amplitude, not its rms", tactile / threshold / math.sqrt(2))])


@scene
def periodic_force(bench):
    """A force in phase with a reference of 20 Hz: of many lags the nearest, and their spacing."""
    run = bench.run(bench.scenario(
        "periodic_force", time={"step_s": 0.0005, "steps": 2000}, reference_force={"z_N": {"type": "sine", "mean": 2, "amplitude": 1, "period_s": 0.05}},
        environment={"type": "springs", "groups": [{"direction": [0, 0, -1], "count": 1}]},
        motion={"position": {"type": "prescribed", "x_m": 0, "y_m": 0, "z_m": {"type": "sine", "mean": -2e-3, "amplitude": 1e-3, "period_s": 0.05,
                                                                              "phase_rad": math.pi - 0.4}}},
        rendering={"algorithm": "summation", "stiffness_N_per_m": 1000, "damping_ratio": 0,
                   "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0}}))
    # -z follows by 0.4 rad.
    lag = Within("a parabola through three rows of a cosine finds its top to (omega dt)^2 / 24 of a row", absolute=1e-6)
    bench.metrics(run, [
        ("fidelity.force_lag_s", 0.4 / (2 * math.pi) * 0.05, "phase over angular frequency", lag, "a period earlier", -0.05 + 0.4 / (2 * math.pi) * 0.05),
        ("fidelity.force_lag_period_s", 0.05, "the sine's", lag, "half of it", 0.025)])


@scene
def rubbed(bench):
    """A free mass pushed against a spring and along it: friction stronger than what leapfrog steps stably, from some row on."""
    K, M, dt, n, mu_s, mu_f = 5000.0, 0.1, 0.001, 120, 2.0, 20.0
    B = 2 * 0.3 * math.sqrt(K * M)
    push = {"type": "ramp", "start": 0.0, "rate_per_s": -150.0}
    run = bench.run(bench.scenario(
        "rubbed", time={"step_s": dt, "steps": n}, environment={"type": "springs", "groups": [{"direction": [0, 0, -1], "count": 1}]},
        initial={"position_m": [0, 0, 0], "velocity_m_per_s": [0.01, 0, 0]}, hand={"type": "force", "z_N": push, "x_N": 0.2},
        rendering={"algorithm": "summation", "stiffness_N_per_m": K, "damping_ratio": 0.3, "mass_kg": M,
                   "friction": {"mu_s_N_s_per_m": mu_s, "mu_f_s_per_m": mu_f}}))
    p, v, S = np.zeros((n, 3)), np.zeros((n, 3)), np.diag([0.0, 0, 1])
    f, spring = np.zeros((n, 3)), np.zeros((n, 3))
    v[0, 0] = 0.01
    for k in range(n):
        spring[k] = -K * S @ p[k] * (abs(p[k, 2]) > 0)
        f[k] = spring[k] - B * S @ v[k] - (mu_s + mu_f * np.linalg.norm(spring[k])) * (v[k] - S @ v[k])
        if k + 1 < n:
            v[k + 1] = v[k] + (f[k] + [0.2, 0, -150 * k * dt]) * dt / M
            p[k + 1] = p[k] + v[k + 1] * dt
    limit = (2 * M / dt - mu_s) / mu_f
    beyond, naive = norms(spring) > limit, norms(spring) > limit + mu_s / mu_f
    bench.metrics(run, [
        ("explicit_friction_limit_N", limit, "(2 M / dt - mu_s) / mu_f", ROUNDING, "without mu_s", 2 * M / dt / mu_f),
        ("explicit_friction_rows_beyond", int(beyond.sum()), "|f_spring| of the recurrence", EXACT, "|f| in place of |f_spring|",
         int((norms(f) > limit).sum())),
        ("explicit_friction_first_step", int(np.flatnonzero(beyond)[0]), "|f_spring| of the recurrence", EXACT, "|f| in place of |f_spring|",
         int(np.flatnonzero(norms(f) > limit)[0]))])
    held = Within("120 steps, of which the last enlarge rounding by up to |1 - (mu_s + mu_f |f|) dt / M| each", relative=1e-9, absolute=1e-15)
    bench.columns("trajectory.csv", run.table(), [
        (f"{name}{x}{unit}", series[:, i], "recurrence", held, *(("a row later", np.r_[series[1:, i], 0]) if x != "y" else ()))
        for name, unit, series in (("p", "_m", p), ("v", "_m_per_s", v), ("f", "_N", f)) for i, x in enumerate("xyz")])
