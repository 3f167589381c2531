"""Scenes behind the tables of compare, sweep, diff, limit and stability: recomputed from single runs, or from the eigenvalues of a loop."""
import math

import numpy as np
from scipy import linalg, stats

from answers import EXACT, ROUNDING, Run, Table, Within, scene

UP = {"type": "springs", "groups": [{"direction": [0, 1, 0], "count": 2}]}
PLAIN = {"stiffness_N_per_m": 1000, "damping_ratio": 0, "mass_kg": 0.1, "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0}}
LAWS = ["mean", "virtual_coupling", "summation", "shaped_stiffness"]
BY = ["force_step_p99_N", "velocity_total_variation_m_per_s", "contact_share"]
SEEDS = 14


def rows_of(league, runs, scenes):
    """The league by the book: means over common seeds, ranks, ratios, paired t against the best."""
    for scene_name in scenes:
        failed = {law: [runs[scene_name, law, k].summary["outcome"] != "completes" for k in range(SEEDS)] for law in LAWS}
        some = [law for law in LAWS if not all(failed[law])]
        common = [k for k in range(SEEDS) if not any(failed[law][k] for law in some)]
        for law in LAWS:
            for metric in BY:
                values = {name: [None if failed[name][k] else runs[scene_name, name, k].metric(metric) for k in common] for name in LAWS}
                yield scene_name, law, metric, failed, common, values


@scene
def league(bench):
    """A mass on two parallel springs, soft, and so stiff that leapfrog amplifies every step: some starts leave the bounds in time."""
    start = {"position_m": [1e-4, -1e-3, 0]}
    bench.scenario("held", time={"step_s": 0.001, "steps": 500}, environment=UP, initial=start,
                   rendering={"algorithm": "mean", **PLAIN, "damping_ratio": 0.05})
    bench.scenario("thrown", time={"step_s": 0.001, "steps": 460}, environment=UP, initial=start, bounds={"position_m": 300},
                   rendering={"algorithm": "mean", **PLAIN, "stiffness_N_per_m": 400050.0})
    scenes = ["held", "thrown"]
    out = bench.folder / "league"
    printed = bench.json("compare", "held.json", "thrown.json", "--algorithms", ",".join(LAWS), "--seeds", SEEDS, "--jitter", "9e-4", "--by",
                         ",".join(BY), "--out", out, statuses=(0, 3))
    runs = {(s, law, k): Run(out / s / law / f"seed_{k}") for s in scenes for law in LAWS for k in range(SEEDS)}
    table = Table(out / "league.csv")
    known = {name: [] for name in table.names}
    naive = {name: [] for name in ("failed", "mean", "spread", "rank", "ratio_to_best", "beyond_spread", "common_seeds", "seeds")}
    ranks, ratios, wins = {law: [] for law in LAWS}, {law: [] for law in LAWS}, {law: [] for law in LAWS}
    for s, law, metric, failed, common, values in rows_of(table, runs, scenes):
        bad = {name: sum(failed[name]) for name in LAWS}
        means = {name: np.mean(v) for name, v in values.items() if not any(x is None for x in v)}
        sure = [name for name in means if bad[name] == 0]
        ranked = metric != "contact_share"
        best = min(sure, key=means.get)
        alike = lambda a, b: abs(means[a] - means[b]) <= 1e-3 * max(abs(means[a]), abs(means[b]))
        order = sorted(sure, key=means.get)
        leader, rank = {}, {}
        for i, name in enumerate(order):
            leader[i] = leader[i - 1] if i and alike(order[leader[i - 1]], name) else i
            rank[name] = 1 + leader[i]
        rank.update({name: 1 + sum(bad[other] < bad[name] for other in LAWS) for name in LAWS if bad[name]})
        t = beyond = None
        if ranked and law in sure and law != best:
            difference = np.subtract(values[law], values[best])
            t = difference.mean() / (difference.std(ddof=1) / math.sqrt(len(common)))
            beyond = bool(abs(t) > stats.t.ppf(0.975, len(common) - 1) and not alike(law, best))
            unpaired = stats.ttest_ind(values[law], values[best]).pvalue < 0.05
        outcomes = [runs[s, law, k].summary["outcome"] for k in range(SEEDS)]
        counts = [f"{name} {outcomes.count(name)}" for name in dict.fromkeys(outcomes)]
        ratio = means[law] / means[best] if ranked and law in sure else None
        number = lambda x: math.nan if x is None else float(x)
        for name, value in (
                ("scenario", s), ("algorithm", law), ("metric", metric), ("seeds", SEEDS), ("failed", bad[law]),
                ("outcome", outcomes[0] if len(counts) == 1 else "; ".join(counts)), ("mean", number(means.get(law))),
                ("spread", number(np.std(values[law], ddof=1) if law in means else None)), ("rank", number(rank.get(law) if ranked else None)),
                ("ratio_to_best", number(ratio)), ("beyond_spread", "" if beyond is None else str(beyond).lower()),
                ("common_seeds", len(common)), ("better", "less" if ranked else "")):
            known[name].append(value)
        own = [math.nan if runs[s, law, k].metric(metric) is None else runs[s, law, k].metric(metric) for k in range(SEEDS)]
        for name, value in (("failed", 0), ("mean", float(np.nanmean([*own, 0.0]))), ("spread", number(np.std(values[law]) if law in means else None)),
                            ("rank", 1 + LAWS.index(law)), ("ratio_to_best", number(means[law] / min(means.values()) if law in means else None)),
                            ("beyond_spread", "" if beyond is None else str(unpaired).lower()), ("common_seeds", SEEDS - bad[law]),
                            ("seeds", SEEDS - bad[law])):
            naive[name].append(value)
        if ranked:
            ranks[law].append((s, rank[law]))
            ratios[law] += [ratio] if ratio else []
    says = {"failed": "of runs that diverge", "mean": "over all seeds", "spread": "with n in place of n - 1", "rank": "in the order asked",
            "ratio_to_best": "to the best of those that fail, too", "beyond_spread": "unpaired t", "common_seeds": "seeds without failure",
            "seeds": "seeds without failure"}
    how = "from the runs' summaries, by the book"
    for name in table.names:
        wrong = (says[name], naive[name]) if name in naive else ("in another order", list(reversed(known[name])))
        bench.add(f"league.csv:{name}", table[name], known[name], how, ROUNDING if name in ("mean", "spread", "ratio_to_best") else EXACT, wrong)
    laws_of(bench, printed["laws"], ranks, ratios, scenes)


def laws_of(bench, laws, ranks, ratios, scenes):
    order = [law["algorithm"] for law in laws]
    fails = {law: [s for s in scenes if any(law_rank > 0 for name, law_rank in ranks[law] if name == s) and (law, s) in FAILS] for law in LAWS}
    mean_rank = {law: np.mean([r for _, r in ranks[law]]) for law in LAWS}
    in_scene = {(law, s): np.mean([r for name, r in ranks[law] if name == s]) for law in LAWS for s in scenes}
    wins = {law: [s for s in scenes if (law, s) not in FAILS and in_scene[law, s] == min(in_scene[o, s] for o in LAWS)] for law in LAWS}
    for key, known, naive in (
            ("mean_rank", [mean_rank[law] for law in order], ("place in the order", [1, 2, 3, 4])),
            ("mean_ratio_to_best", [None if fails[law] else stats.gmean(ratios[law]) for law in order],
             ("arithmetic mean", [None if fails[law] else np.mean(ratios[law]) + (law == order[0]) for law in order])),
            ("ratios", [len(ratios[law]) for law in order], ("scenes times metrics", [4] * len(order))),
            ("wins", [", ".join(wins[law]) for law in order], ("of those that fail, too", [""] * len(order))),
            ("fails", [", ".join(fails[law]) for law in order], ("none", [""] * len(order)))):
        printed = [", ".join(law[key]) if isinstance(law[key], list) else law[key] for law in laws]
        bench.add(f"compare --json: {key}", printed, known, "from ranks and ratios of both scenes", ROUNDING, naive)


# Stiffer than 4 M / dt^2 = 4e5 N/m, of which virtual coupling has two thirds.
FAILS = {("mean", "thrown"), ("summation", "thrown"), ("shaped_stiffness", "thrown")}


@scene
def swept(bench):
    """A sweep is its single runs, and `diff` tells them apart by a bit."""
    base = bench.scenario("swept", time={"step_s": 0.001, "steps": 300}, environment=UP, initial={"position_m": [1e-3, -1e-3, 0]},
                          hand={"type": "force", "y_N": -0.5}, rendering={"algorithm": "mean", **PLAIN, "damping_ratio": 0.1},
                          expect={"outcome": "completes"})
    field, values = "rendering.stiffness_N_per_m", [500.0, 1000.0, 2000.0, 4e6]
    bench.hapbench("sweep", base, "--vary", f"{field}=500,1000,2000,4e6", "--out", "sweep", statuses=(0, 3))
    table = Table(bench.folder / "sweep" / "sweep.csv")
    runs = [bench.run(base, "--set", f"{field}={value}", out=f"run_{i}", statuses=(0, 3)) for i, value in enumerate(values)]
    of = lambda key: [run.summary[key] for run in runs]
    bench.columns("sweep.csv", table, [("index", [0.0, 1, 2, 3], "order of the values", EXACT, "from 1", [1.0, 2, 3, 4])])
    for key, known, naive in (("outcome", of("outcome"), ("of the first", [of("outcome")[0]] * 4)),
                              ("expected", [str(x).lower() for x in of("expected")], ("all", ["true"] * 4)),
                              ("steps", of("steps"), ("asked", [300] * 4)), ("state_hash", of("state_hash"), ("of the first", [of("state_hash")[0]] * 4))):
        bench.add(f"sweep.csv:{key}", table[key], known, "single runs with --set", EXACT, naive)
    shared = [name for name in table.names if name in runs[0].summary["metrics"]]
    bench.add("sweep.csv:metrics", [table[name][1] for name in shared],
              [math.nan if runs[1].metric(name) is None else runs[1].metric(name) for name in shared], "a single run, the same digits", EXACT,
              ("the run before", [math.nan if runs[0].metric(name) is None else runs[0].metric(name) for name in shared]))
    swept_words(bench, base, runs)


def swept_words(bench, base, runs):
    again = bench.run(base, "--set", "rendering.stiffness_N_per_m=1000", out="again", statuses=(0, 3))
    nudged = bench.run(base, "--set", f"rendering.stiffness_N_per_m={np.nextafter(1000, 2000)!r}", out="nudged", statuses=(0, 3))
    diff = lambda a, b, *more: bench.json("diff", a.folder, b.folder, *more, statuses=(0, 3))
    same, other, within = diff(runs[1], again), diff(again, nudged), diff(again, nudged, "--tolerance", "1e-9")
    bench.add("diff --json: equal", [same["equal"], other["equal"], within["equal"]], [True, False, True],
              "the same run; a stiffness one bit larger; the same within 1e-9", EXACT, ("by six digits", [True, True, True]))
    a, b = again.table(), nudged.table()
    first = next(k for k in range(300) if any(x[name] != y[name] for x, y in [(a.rows[k], b.rows[k])] for name in a.names))
    told = other["runs"]["."]["trajectory"]
    bench.add("diff --json: row", told["first"]["row"], first, "first line that differs as text", EXACT, ("from 1", first + 1))
    largest = {name: float(np.nanmax(np.abs(a[name] - b[name]))) for name in told["columns"]}
    bench.add("diff --json: largest", [c["largest"] for c in told["columns"].values()], list(largest.values()), "numpy's", EXACT,
              ("in the first row that differs", [abs(a[name][first] - b[name][first]) for name in largest]))
    bench.add("diff --json: relative", [c["relative"] for c in told["columns"].values()],
              [largest[name] / max(np.nanmax(np.abs(a[name])), np.nanmax(np.abs(b[name]))) for name in largest],
              "over the column's largest", ROUNDING, ("over the value there", [1.0] * len(largest)))
    results = other["runs"]["."]["results"]
    for key, run in (("a", again), ("b", nudged)):
        bench.add(f"diff --json: {key}", [float(r[key]) for r in results.values()], [run.metric(name) for name in results], "of that run's summary",
                  EXACT, ("of the other", [(nudged if run is again else again).metric(name) for name in results]))
    for key in ("only_in_a", "only_in_b"):
        bench.add(f"diff --json: {key}", len(other[key]), 0, "both are one run", EXACT, ("what differs", len(results)))
    bench.add("diff --json: reordered", told["reordered"], False, "the same columns", EXACT, ("rows differ", True))
    bench.add("diff --json: column", told["first"]["column"], next(name for name in a.names if a.rows[first][name] != b.rows[first][name]),
              "first cell that differs", EXACT, ("the time", "time_s"))
    bench.add("diff --json: unshared", len(other["runs"]["."]["unshared"]), 0, "the same metrics", EXACT, ("what differs", len(results)))
    bench.add("diff --json: tolerance", [same["tolerance"], within["tolerance"]], [0.0, 1e-9], "as given", EXACT, ("a default", [1e-9, 1e-9]))


class HeldLoop:
    """The handle of an impedance device on a spring and damper that hold their force over each period: an exact linear map."""

    def __init__(self, m, b, T, K, B, delay=0):
        whole = int(delay)
        part = delay - whole
        A, size = np.array([[0, 1.0], [0, -b / m]]), 3 + whole + (part > 0)
        # State: x, v, x of the last sample, forces under way (the newest first).
        E = lambda t: linalg.expm(np.block([[A, np.array([[0], [1 / m]])], [np.zeros((1, 3))]]) * t)
        force = np.zeros(size)
        force[0], force[2] = -K - B / T, B / T
        forces = [force] + [np.eye(size)[3 + i] for i in range(size - 3)]
        first, rest = forces[-1] if part else forces[whole], forces[whole]  # until the newer one arrives, and after it
        step = np.eye(size)
        for t, held in ((part * T, first), ((1 - part) * T, rest)):
            if t > 0:
                X, moved = E(t), np.zeros((size, size))
                moved[:2] = X[:2, :2] @ step[:2] + np.outer(X[:2, 2], held)
                step = np.vstack([moved[:2], step[2:]])
        step[2] = np.eye(size)[0]
        for i in range(3, size):
            step[i] = forces[i - 3]
        self.matrix = step

    def radius(self):
        return np.abs(np.linalg.eigvals(self.matrix)).max()


@scene
def limit_of_handle(bench):
    """B of a wall that is stiffer than its handle allows without damping: an island of stable values, by the eigenvalues of the held loop."""
    from of_ends import bisected
    m, b, T, K = 0.1, 0.5, 0.001, 4000.0
    base = bench.scenario("limit_of_handle", time={"step_s": T, "steps": 8000}, initial={"position_m": [1e-3, 0, 0]},
                          environment={"type": "springs", "groups": [{"direction": [1, 0, 0], "count": 1}]},
                          device={"type": "impedance", "handle_mass_kg": m, "viscous_N_s_per_m": b},
                          rendering={**PLAIN, "algorithm": "summation", "stiffness_N_per_m": K})
    row = bench.json("limit", base, "--vary", "rendering.damping_N_s_per_m", "--between", "0.01:10000", "--resolution", "1e-4", "--out", "B")["limits"][0]
    rests = lambda B: HeldLoop(m, b, T, K, B).radius() < 0.9 ** (4 / 8000)
    bounded = lambda B: HeldLoop(m, b, T, K, B).radius() < 1
    inside = next(B for B in np.geomspace(0.01, 1e4, 400) if rests(B))
    low, high, theory = bisected(lambda B: not rests(B), 0.01, inside), bisected(rests, inside, 1e4), bisected(bounded, inside, 1e4)
    fine = Within("bisection ends at 1e-4; beside the edges motion decays by a tenth a quarter only once its slowest part is alone", relative=5e-4)
    for name, known, within, naive in (("limit", high, fine, 2 * m / T), ("low", low, fine, 0.01), ("high", high, fine, 2 * m / T),
                                       ("theory", theory, Within("bisected to 1e-12", relative=3e-12), 2 * m / T)):
        bench.add(f"limit.csv:{name}", row[name], known, "eigenvalues of the held loop", within, ("of leapfrog, or the end of the range", naive))


@scene
def limits_of_springs(bench):
    """The limits of one spring under leapfrog (thesis A.3), and its root locus."""
    M, dt, zeta = 0.1, 0.0005, 0.7
    base = bench.scenario("limits_of_springs", time={"step_s": dt, "steps": 400}, initial={"position_m": [1e-3, 0, 0]},
                          environment={"type": "springs", "groups": [{"direction": [1, 0, 0], "count": 2}]},
                          rendering={**PLAIN, "algorithm": "summation", "damping_ratio": zeta, "stiffness_N_per_m": 20000})
    bench.json("stability", base, "--out", "limits")
    table, locus = Table(bench.folder / "limits" / "limits.csv"), Table(bench.folder / "limits" / "root_locus.csv")
    lam, K = 2.0, 20000.0
    # 4 - 2 lam B dt / M - lam K dt^2 / M = 0 with B = 2 zeta sqrt(K M): a quadratic in s = sqrt(K) dt / sqrt(M).
    s = -2 * zeta + math.sqrt(4 * zeta ** 2 + 4 / lam)
    known = {"stiffness_undamped": (4 * M / (lam * dt ** 2), "N/m", 0.0), "damping_alone": (2 * M / (lam * dt), "N s/m", 2 * M / (lam * dt)),
             "stiffness_damped": (M * s * s / dt ** 2, "N/m", 2 * zeta * s * M / dt), "time_step": (s * math.sqrt(M / K), "s", 2 * zeta * math.sqrt(K * M))}
    cases = list(known)
    value = [known[c][0] for c in cases]
    exact, runs = Within("rounding of a quadratic's root", relative=1e-12), Within("bisection ends at 1e-3 of the value at most", relative=1e-3)
    single = [2 * value[0], 2 * value[1], 433731.0, 2 * value[3]]
    wrong = ("of a single spring", single)
    bench.columns("limits.csv", table, [
        ("analytic", value, "4 - 2 lam B dt / M - lam K dt^2 / M = 0", exact, *wrong), ("simulation", value, "the same", runs, *wrong),
        ("eigenvalue", value, "the same", Within("bisection on eigenvalues, ends at 1e-9", relative=1e-8), *wrong),
        ("damping_at_limit_N_s_per_m", [known[c][2] for c in cases], "B from zeta there", Within("as the limit", relative=1e-8), "of the scenario's K",
         [2 * zeta * math.sqrt(K * M)] * 4), ("lambda_max", np.full(4, lam), "two springs side by side", ROUNDING, "one", np.ones(4))])
    bench.add("limits.csv:case", table["case"], cases, "in this order", EXACT, ("the other way round", cases[::-1]))
    bench.add("limits.csv:unit", table["unit"], [known[c][1] for c in cases], "of what grows", EXACT, ("N/m", ["N/m"] * 4))
    at = [(c, v) for c, v in zip(locus["case"], locus["value"])]

    def matrix(case, v):
        k, B, t = {"stiffness_undamped": (v, 0, dt), "damping_alone": (0, v, dt), "stiffness_damped": (v, 2 * zeta * math.sqrt(v * M), dt),
                   "time_step": (K, 2 * zeta * math.sqrt(K * M), v)}[case]
        k, B = lam * k, lam * B
        return np.array([[1 - k * t * t / M, t - B * t * t / M], [-k * t / M, 1 - B * t / M]])

    known = [np.linalg.eigvals(matrix(c, v)) for c, v in at]
    near = Within("an eigenvalue near a double one is known to the root of rounding", absolute=5e-8)
    first, second = locus["first_real"] + 1j * locus["first_imaginary"], locus["second_real"] + 1j * locus["second_imaginary"]
    sums, products = np.array([k.sum().real for k in known]), np.array([k.prod().real for k in known])
    for name, ours, theirs, wrong in (("first_real", (first + second).real, sums, products), ("second_real", (first * second).real, products, sums),
                                      ("first_imaginary", np.abs(first.imag), [abs(k[0].imag) for k in known], np.full(len(at), 0.5)),
                                      ("second_imaginary", np.abs(second.imag), [abs(k[1].imag) for k in known], np.full(len(at), 0.5))):
        bench.add(f"root_locus.csv:{name}", ours, theirs, "trace, determinant and imaginary parts of numpy's", near, ("of another", wrong))
    bench.add("root_locus.csv:spectral_radius", locus["spectral_radius"], [np.abs(k).max() for k in known], "numpy's eigenvalues", near,
              ("least modulus", [np.abs(k).min() for k in known]))
    bench.add("root_locus.csv:case", list(dict.fromkeys(locus["case"])), cases, "as in limits.csv", EXACT, ("the other way round", cases[::-1]))
    ends = [max(v for c, v in at if c == case) for case in cases]
    bench.add("root_locus.csv:value", ends, [1.25 * v for v in value], "up to 1.25 of the limit", Within("as the limit", relative=1e-8),
              ("up to the limit", value))


@scene
def compared(bench):
    """comparison.csv is the runs' summaries, one of each law; a shell is what the file of a point shell says."""
    base = bench.scenario("compared", time={"step_s": 0.001, "steps": 400}, environment=UP, initial={"position_m": [1e-4, -1e-3, 0]},
                          rendering={"algorithm": "mean", **PLAIN, "damping_ratio": 0.02})
    laws = ["mean", "summation", "virtual_coupling"]
    printed = bench.json("compare", base, "--algorithms", ",".join(laws), "--out", "c")
    table, runs = Table(bench.folder / "c" / "comparison.csv"), [Run(bench.folder / "c" / law) for law in laws]
    bench.add("comparison.csv:algorithm", table["algorithm"], laws, "as asked", EXACT, ("by name", sorted(laws, reverse=True)))
    for key, wrong in (("outcome", ["diverges"] * 3), ("steps", [399] * 3)):
        bench.add(f"comparison.csv:{key}", table[key], [run.summary[key] for run in runs], "of the summary", EXACT, ("another", wrong))
    shared = [name for name in table.names if name in runs[0].summary["metrics"]]
    values = [[math.nan if run.metric(name) is None else float(run.metric(name)) for name in shared] for run in runs]
    bench.add("comparison.csv:metrics", [[table[name][i] for name in shared] for i in range(3)], values, "of the summaries, the same digits", EXACT,
              ("of the next law", values[1:] + values[:1]))
    seeded = bench.json("compare", base, "--algorithms", "mean", "--seeds", "3", "--out", "s")
    bench.add("compare --json: seed", [run["seed"] for run in seeded["runs"]], [0, 1, 2], "of the three", EXACT, ("all of the scenario", [0, 0, 0]))
    assert len(printed) == 3
    points = np.array([[1e-3, 2e-3, 3e-3, 0, 0, 1], [-4e-3, 5e-3, 0, 0.6, 0, 0.8], [7e-3, -8e-3, 9e-3, 0, -1, 0]])
    bench.write("points.csv", "x_m,y_m,z_m,nx,ny,nz", points)
    shell = bench.scenario("shell", time={"step_s": 0.001, "steps": 1}, environment={"type": "point_shell", "file": "points.csv"},
                           rendering={"algorithm": "mean", **PLAIN})
    bench.hapbench("shell", shell, "--out", "shell.csv")
    table = Table(bench.folder / "shell.csv")
    order = np.lexsort(points.T)
    found = np.lexsort(table.vectors(*table.names).T)
    for i, name in enumerate(("x_m", "y_m", "z_m", "nx", "ny", "nz")):
        bench.add(f"shell.csv:{name}", table[name][found], points[order, i], "of the file, in some order", EXACT, ("of another column", points[order, (i + 1) % 6]))
