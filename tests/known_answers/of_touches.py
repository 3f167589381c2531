"""Known answers for the metrics of summary.json and the tables of a run: a tool moves along a given path on springs, so
that every row is known."""
import math

import numpy as np

from answers import EXACT, ROUNDING, Within, norms, profile, rms, scene
from physics import BINNED, FILTERED, STEPPED, Phases, high_pass, nearest_rank, settled_high_pass


# The first two springs are nearly parallel, and the reduction keeps only the deeper of them. The third spring is tilted
# by about 37 degrees from them. The last five springs are never reached.
NEAR = 0.03
DIRECTIONS = np.array(
    [
        [math.sin(NEAR), 0, -math.cos(NEAR)],
        [-math.sin(NEAR), 0, -math.cos(NEAR)],
        [0.48, 0.36, -0.8],
    ]
    + 5 * [[0, 1.0, 0]]
)
PATH = {
    "x_m": {"type": "sine", "mean": 0, "amplitude": 2e-4, "period_s": 0.01, "phase_rad": 0.3},
    "y_m": {"type": "ramp", "start": -1e-4, "rate_per_s": -1e-3},
    "z_m": {
        "type": "waypoints",
        "points": [
            [0, 1e-3],
            [0.0543, 1e-3],
            [0.0563, -2.4e-3],
            [0.2003, -2e-3],
            [0.2063, 5e-4],
            [0.2203, 5e-4],
            [0.2243, -1.5e-3],
            [0.35, -1.5e-3],
            [0.3543, 1e-3],
            [0.4543, 1e-3],
            [0.4603, -1.8e-3],
            [0.55, -1.2e-3],
            [0.555, 1e-3],
            [0.6, 1e-3],
        ],
    },
}
TOUCHES = {
    "time": {"step_s": 0.0005, "steps": 1200},
    "environment": {
        "type": "springs",
        "bilateral": False,
        "groups": [{"direction": list(u), "count": 1} for u in DIRECTIONS[:3]]
        + [{"direction": [0, 1, 0], "count": 5}],
    },
    "motion": {"position": {"type": "prescribed", **PATH}},
    "rendering": {
        "algorithm": "summation",
        "stiffness_N_per_m": 1000,
        "damping_ratio": 1,
        "mass_kg": 0.001,
        "friction": {"mu_s_N_s_per_m": 1, "mu_f_s_per_m": 1},
        "reduction": {"threshold": 0.995, "max_points": 100},
    },
    "record": {"contacts": True, "stiffness_tensor": True, "ratio_iterations": [0, 1, 3]},
    "expect": {"outcome": "completes"},
}


class Touches:
    """Every row of the run TOUCHES by the formulas of the rendering:
    f = -K sum d u - B S v - (mu_s + mu_f |f_spring|) (v - S v). The sum is over the springs in
    contact that the reduction keeps, with the depth d and the direction u of each spring. f_spring is this sum times
    -K, S is the sum of u u^T, and v is the velocity."""

    def __init__(self, dt=0.0005, K=1000.0, B=2.0, mu_s=1.0, mu_f=1.0):
        self.dt, self.t = dt, np.arange(1200) * dt
        self.p = np.column_stack([profile(PATH[axis], self.t) for axis in ("x_m", "y_m", "z_m")])
        self.v = np.diff(self.p, axis=0, prepend=[2 * self.p[0] - self.p[1]]) / dt
        self.d = self.p @ DIRECTIONS.T
        self.touched = self.d > 0
        self.kept = self.touched.copy()
        deeper = (
            self.d[:, 1] > self.d[:, 0]
        )  # of parallel springs, the reduction keeps the first, or the second if it is deeper
        both = self.touched[:, 0] & self.touched[:, 1]
        self.kept[both & deeper, 0] = self.kept[both & ~deeper, 1] = False
        self.S = np.einsum("kn,ni,nj->kij", self.kept.astype(float), DIRECTIONS, DIRECTIONS)
        self.spring = -K * (self.kept * self.d) @ DIRECTIONS
        normal = np.einsum("kij,kj->ki", self.S, self.v)
        self.contact = self.touched.any(axis=1)
        rub = ((mu_s + mu_f * norms(self.spring)) * self.contact)[:, None]
        self.f = self.spring - B * normal - rub * (self.v - normal)
        self.ratios = np.where(
            self.kept, np.einsum("ni,kij,nj->kn", DIRECTIONS, self.S, DIRECTIONS), np.nan
        )
        self.phases = Phases(self.contact, dt)
        self.steps = np.r_[0.0, norms(np.diff(self.f, axis=0))]
        self.reverses = np.r_[False, np.sum(self.f[1:] * self.f[:-1], axis=1) < 0]
        self.changes = np.r_[
            False,
            self.contact[1:] & self.contact[:-1] & (self.kept[1:] != self.kept[:-1]).any(axis=1),
        ]


@scene
def touches(bench):
    """Checks the metrics of a tool that moves onto springs three times and vibrates along x with 100 Hz. Two of the
    touches begin a landing, because they follow a sufficiently long time without contact.
    """
    run, r = bench.run(bench.scenario("touches", **TOUCHES)), Touches()
    F, settled, landing, touching = norms(r.f), r.phases.settled, r.phases.landing, r.contact
    last = int(np.flatnonzero(touching)[-1])
    behind, all_behind = settled_high_pass(r.f, r.phases, r.dt), high_pass(r.f, r.dt)
    v_behind, quarter = high_pass(r.v, r.dt), slice(900, 1200)
    onsets = int(np.sum(touching[1:] & ~touching[:-1]))
    rows = "the formula's rows"
    bench.metrics(
        run,
        [
            ("force_max_N", F.max(), rows, STEPPED, "settled contact only", F[settled].max()),
            (
                "force_step_max_N",
                r.steps.max(),
                rows,
                STEPPED,
                "settled contact only",
                r.steps[settled].max(),
            ),
            (
                "velocity_total_variation_m_per_s",
                norms(np.diff(r.v, axis=0)).sum(),
                rows,
                STEPPED,
                "variation of the speed",
                np.abs(np.diff(norms(r.v))).sum(),
            ),
            (
                "force_reversals",
                int(r.reverses.sum()),
                rows,
                EXACT,
                "changes of sign of f_x",
                int(np.sum(r.f[1:, 0] * r.f[:-1, 0] < 0)),
            ),
            (
                "vibration_power_above_30Hz_m2_per_s2",
                rms(v_behind) ** 2,
                "scipy's filter on the path's velocity",
                FILTERED,
                "mean square of v",
                rms(r.v) ** 2,
            ),
            (
                "depth_max_m",
                np.max(r.d),
                "largest <p, u>",
                STEPPED,
                "distance below z = 0",
                -r.p[:, 2].min(),
            ),
            (
                "ratio_min",
                np.nanmin(r.ratios),
                "u^T S u",
                ROUNDING,
                "least eigenvalue of S",
                np.linalg.eigvalsh(r.S[touching]).min(),
            ),
            (
                "ratio_max",
                np.nanmax(r.ratios),
                "u^T S u",
                ROUNDING,
                "largest eigenvalue of S",
                np.linalg.eigvalsh(r.S).max(),
            ),
            (
                "colliding_mean",
                r.touched.sum() / 1200,
                "springs with <p, u> > 0",
                ROUNDING,
                "mean over rows in contact",
                r.touched.sum() / touching.sum(),
            ),
            ("colliding_max", 3, "springs with <p, u> > 0", EXACT, "springs there are", 8),
            (
                "rendered_mean",
                r.kept.sum() / 1200,
                "those that the reduction keeps",
                ROUNDING,
                "colliding_mean",
                r.touched.sum() / 1200,
            ),
            ("rendered_max", 2, "those that the reduction keeps", EXACT, "colliding_max", 3),
            (
                "steps_in_contact",
                int(touching.sum()),
                "rows with <p, u> > 0",
                EXACT,
                "rows after the first touch",
                1200 - int(np.flatnonzero(touching)[0]),
            ),
            (
                "contact_share",
                touching.mean(),
                "rows with <p, u> > 0",
                ROUNDING,
                "settled share",
                settled.mean(),
            ),
            (
                "last_contact_s",
                r.t[last],
                "the path's crossing",
                ROUNDING,
                "the first row after",
                r.t[last + 1],
            ),
            (
                "speed_max_m_per_s",
                norms(r.v).max(),
                rows,
                STEPPED,
                "largest component",
                np.abs(r.v).max(),
            ),
            *[
                (
                    f"explicit_friction_{name}",
                    None,
                    "a prescribed motion is not integrated",
                    EXACT,
                    "(2 M / dt - mu_s) / mu_f",
                    3.0,
                )
                for name in ("limit_N", "rows_beyond", "first_step")
            ],
            ("landings", 2, "touches 50 ms or more after the last", EXACT, "all touches", onsets),
            (
                "landing_force_max_N",
                F[landing].max(),
                rows,
                STEPPED,
                "of settled contact",
                F[settled].max(),
            ),
            (
                "landing_force_step_max_N",
                r.steps[landing].max(),
                rows,
                STEPPED,
                "of settled contact",
                r.steps[settled].max(),
            ),
            (
                "settled_s",
                settled.sum() * r.dt,
                "rows in contact after a landing",
                ROUNDING,
                "all contact",
                touching.sum() * r.dt,
            ),
            (
                "force_mean_in_contact_N",
                F[settled].mean(),
                rows,
                STEPPED,
                "over all rows in contact",
                F[touching].mean(),
            ),
            ("settled_force_max_N", F[settled].max(), rows, STEPPED, "over all rows", F.max()),
            (
                "force_step_p99_N",
                nearest_rank(r.steps[settled], 0.99),
                "sorted steps of settled rows",
                BINNED,
                "over all rows",
                nearest_rank(r.steps, 0.99),
            ),
            (
                "settled_force_step_max_N",
                r.steps[settled].max(),
                rows,
                STEPPED,
                "over all rows",
                r.steps.max(),
            ),
            (
                "force_rms_above_30Hz_N",
                rms(behind[settled]),
                "scipy's filter from the end of each landing",
                FILTERED,
                "filtered from the start of the run",
                rms(all_behind[settled]),
            ),
            (
                "force_reversals_per_s",
                (r.reverses & settled).sum() / (settled.sum() * r.dt),
                rows,
                ROUNDING,
                "all over the run's time",
                r.reverses.sum() / 0.6,
            ),
            (
                "reduction_changes",
                int(r.changes.sum()),
                "crossings of the two depths",
                EXACT,
                "with touches and leaves",
                int((r.kept[1:] != r.kept[:-1]).any(axis=1).sum()),
            ),
            (
                "reduction_force_step_max_N",
                r.steps[r.changes & settled].max(),
                rows,
                STEPPED,
                "of all settled rows",
                r.steps[settled].max(),
            ),
            (
                "vibration_last_quarter_m_per_s",
                rms(v_behind[quarter]),
                "scipy's filter over the run, rms of its last quarter",
                FILTERED,
                "of v unfiltered",
                rms(r.v[quarter]),
            ),
            (
                "final_position_m.x",
                r.p[-1, 0],
                "the path's last row",
                STEPPED,
                "a row later",
                profile(PATH["x_m"], np.array([0.6]))[0],
            ),
            (
                "final_position_m.y",
                r.p[-1, 1],
                "the path",
                STEPPED,
                "a row later",
                -1e-4 - 1e-3 * 0.6,
            ),
            ("final_position_m.z", 1e-3, "the path", EXACT, "the deepest", r.p[:, 2].min()),
        ],
    )
    p99 = nearest_rank(r.steps[settled], 0.99)
    bench.tolerance(
        run,
        "force_step_p99_N",
        p99 * (math.sqrt(33 / 32) - 1) / 2,
        "half a bin of the histogram of squares",
        Within("the bin's middle for the number, and 0.00775 rounded to 0.0078", relative=0.02),
        ("a whole bin", p99 * (math.sqrt(33 / 32) - 1)),
        p99,
    )
    touch_tables(bench, run, r)
    full = bench.run(
        bench.folder / "touches.json",
        "--set",
        'rendering.reduction={"threshold":0.995,"max_points":1}',
        out="full",
    )
    bench.add(
        "run --json: points_dropped",
        full.summary["work"]["points_dropped"],
        int((r.touched[:, :2].any(axis=1) & r.touched[:, 2]).sum()),
        "the third spring where another is kept",
        EXACT,
        ("all but one", int(np.maximum(0, r.touched.sum(axis=1) - 1).sum())),
    )


def touch_tables(bench, run, r):
    """Checks columns of trajectory.csv, stiffness_tensor.csv, ratios.csv, contacts.csv and contact_trace.csv of the run
    TOUCHES."""
    rows, touching = "the formula", r.contact
    columns = [
        ("step", np.arange(1200.0), "0, 1, ...", EXACT, "from 1", np.arange(1200.0) + 1),
        ("time_s", r.t, "k dt", EXACT, "after the step", r.t + r.dt),
    ]
    for i, x in enumerate("xyz"):
        other = (i + 1) % 3
        columns += [
            (f"p{x}_m", r.p[:, i], "the path", STEPPED, "a row later", r.p[:, other]),
            (
                f"v{x}_m_per_s",
                r.v[:, i],
                "(p_k - p_(k-1)) / dt",
                STEPPED,
                "a row later",
                np.r_[r.v[1:, i], r.v[0, i] + 1],
            ),
            (
                f"axis_{x}",
                (0.0, -1.0, 0.0)[i],
                "down in the plane of springs",
                EXACT,
                "down in space",
                np.full(1200, (2.0, 0, -1)[i]),
            ),
            (f"f{x}_N", r.f[:, i], rows, STEPPED, "f_spring", r.spring[:, i]),
            (f"fspring_{x}_N", r.spring[:, i], rows, STEPPED, "f", r.f[:, i]),
            (
                f"h{x}_m",
                r.p[:, i],
                "an ideal device's handle is the tip",
                STEPPED,
                "a row late",
                np.r_[r.p[:1, i], r.p[:-1, i]],
            ),
            (
                f"hv{x}_m_per_s",
                r.v[:, i],
                "an ideal device's handle is the tip",
                STEPPED,
                "a row later",
                np.r_[r.v[1:, i], r.v[0, i] + 1],
            ),
        ]
    columns += [
        (
            "colliding",
            r.touched.sum(axis=1),
            "springs with <p, u> > 0",
            EXACT,
            "those kept",
            r.kept.sum(axis=1),
        ),
        (
            "rendered",
            r.kept.sum(axis=1),
            "those that the reduction keeps",
            EXACT,
            "colliding",
            r.touched.sum(axis=1),
        ),
        (
            "depth_max_m",
            np.maximum(0, r.d.max(axis=1)),
            "largest <p, u>",
            STEPPED,
            "-z",
            np.maximum(0, -r.p[:, 2]),
        ),
    ]
    smallest, largest = np.full(1200, np.nan), np.full(1200, np.nan)
    smallest[touching], largest[touching] = np.nanmin(r.ratios[touching], axis=1), np.nanmax(
        r.ratios[touching], axis=1
    )
    values = np.linalg.eigvalsh(r.S)
    columns += [
        (
            "ratio_min",
            smallest,
            "u^T S u",
            ROUNDING,
            "eigenvalue of S",
            np.where(touching, values[:, 0], np.nan),
        ),
        (
            "ratio_max",
            largest,
            "u^T S u",
            ROUNDING,
            "eigenvalue of S",
            np.where(touching, values[:, 2], np.nan),
        ),
    ]
    bench.columns(run.table(), columns)
    tensor = [
        (name, r.S[:, i, j], "sum u u^T", ROUNDING, "of all touched", 1 + r.S[:, i, j])
        for name, i, j in (
            ("sxx", 0, 0),
            ("sxy", 0, 1),
            ("sxz", 0, 2),
            ("syy", 1, 1),
            ("syz", 1, 2),
            ("szz", 2, 2),
        )
    ]
    bench.columns(
        run.table("stiffness_tensor.csv"),
        columns[:2]
        + tensor
        + [
            (
                "lambda_max",
                values[:, 2],
                "numpy's eigenvalue",
                ROUNDING,
                "trace of S",
                values.sum(axis=1),
            )
        ],
    )
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
                rows.append(
                    (
                        k,
                        r.t[k],
                        m,
                        len(U),
                        ratio.min(),
                        ratio.max(),
                        np.linalg.eigvalsh((U.T * c) @ U)[-1],
                    )
                )
            c = c / ratio
    known = np.array(rows).T
    first = np.repeat(known[:, ::3], 3, axis=1)
    how = "c <- c / (A c) on the matrix A_ij = <u_i, u_j>^2"
    bench.columns(
        run.table("ratios.csv"),
        [
            (
                name,
                known[i],
                how,
                ROUNDING,
                "before any iteration" if i > 3 else "the next row's",
                first[i] if i > 3 else known[i] + 1,
            )
            for i, name in enumerate(
                ("step", "time_s", "iteration", "rendered", "ratio_min", "ratio_max", "lambda_max")
            )
        ],
    )


def contact_table(bench, run, r):
    k, i = np.nonzero(r.kept)
    U = DIRECTIONS[i]
    rows = [
        ("step", k, "rows in contact", EXACT, "counted from 1", k + 1),
        ("time_s", r.t[k], "k dt", EXACT, "after the step", r.t[k] + r.dt),
        ("index", i, "of the spring", EXACT, "within the row", np.zeros(len(i))),
        ("depth_m", r.d[k, i], "<p, u>", STEPPED, "-z", -r.p[k, 2]),
        ("weight", np.ones(len(k)), "1 under summation", EXACT, "1 / n", 1 / r.kept.sum(axis=1)[k]),
    ]
    for j, x in enumerate("xyz"):
        rows += [
            (f"gradient_{x}", U[:, j], "u of the spring", ROUNDING, "-u", -U[:, j] - (x == "y"))
        ]
    bench.columns(run.table("contacts.csv"), rows)
    k, i = np.nonzero(r.touched)
    U = DIRECTIONS[i]
    bench.columns(
        run.table("contact_trace.csv"),
        [
            ("time_s", r.t[k], "k dt of what is touched", EXACT, "after the step", r.t[k] + r.dt),
            *[
                (
                    f"{x}_m",
                    r.p[k, j],
                    "the tip",
                    STEPPED,
                    "the row after",
                    r.p[np.minimum(k + 1, 1199), j],
                )
                for j, x in enumerate("xyz")
            ],
            *[
                (f"u{x}", U[:, j], "u of the spring", ROUNDING, "-u", -U[:, j] - (x == "y"))
                for j, x in enumerate("xyz")
            ],
            ("depth_m", r.d[k, i], "<p, u>", STEPPED, "-z", -r.p[k, 2]),
        ],
    )
