"""Scenes behind the studies of precision: recurrences against the exact solution, contact sets shaped by numpy, and poses over a grid."""
import math

import numpy as np
from scipy import linalg, optimize

from answers import EXACT, ROUNDING, Table, Within, norms, rms, scene
from physics import PLAIN, SPRING, step_matrix


def study(bench, name, *words):
    """Rows of a study: its table, and what it prints."""
    printed = bench.json("precision", name, "--repetitions", "1", "--out", name, *words)
    return Table(bench.folder / name / f"precision_{name}.csv"), printed[0]


def column(bench, table, rows, name, known, how, within, *naive):
    printed = [float(table.rows[i][name]) if table.rows[i][name] else math.nan for i in rows]
    bench.add(f"precision_STUDY.csv:{name}", printed, known, how, within, naive or None)


def positions(K, B, M, dt, n, every=1):
    A, state, found = step_matrix(K, B, M, dt), np.array([1e-3, 0.0]), []
    for k in range(n):
        found += [state] if k % every == 0 else []
        state = A @ state
    return np.array(found)


def order_of(x, error):
    """Of the two finest, and how far that of the two before is off."""
    orders = [math.log(a / b) / math.log(u / v) for a, b, u, v in zip(error, error[1:], x, x[1:])]
    return orders[-1], abs(orders[-1] - orders[-2])


def add_order(bench, printed, series, x, error, naive):
    told = next(order for order in printed["orders"] if order["series"] == series)
    order, uncertainty = order_of(x, error)
    fine = Within("errors known to 1e-6 of themselves, over the logarithm of a factor of two", relative=1e-5)
    bench.add("precision --json: order", told["order"], order, "of the two finest", fine, ("by all", naive))
    bench.add("precision --json: uncertainty", told["uncertainty"], uncertainty, "change from the two before", Within(
        "the same, of a difference of orders", absolute=1e-5), ("none", 0.0))
    bench.add("precision --json: error", told["error"], "error_rms_m", "of which column", EXACT, ("the last", "error_max_m"))
    bench.add("precision --json: series", told["series"], series, "of which rows", EXACT, ("another", "rk4"))


@scene
def integrators(bench):
    """Leapfrog on one damped spring against the matrix exponential, and its energy without damping."""
    K, M, T, n = 4000.0, 0.2, 0.002, 60
    B = 2 * 0.1 * math.sqrt(K * M)
    base = bench.scenario("integrators", time={"step_s": T, "steps": n}, environment=SPRING, initial={"position_m": [1e-3, 0, 0]},
                          rendering={**PLAIN, "algorithm": "summation", "stiffness_N_per_m": K, "damping_ratio": 0.1, "mass_kg": M})
    table, printed = study(bench, "integrators", "--scenario", base)
    rows = [i for i, text in enumerate(table["setting"]) if text.startswith("leapfrog ")]
    dts = np.array([T / division for division in (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)])
    exact = np.array([linalg.expm(np.array([[0, 1], [-K / M, -B / M]]) * k * T)[0, 0] * 1e-3 for k in range(n)])
    errors = [positions(K, B, M, dt, n * round(T / dt), round(T / dt))[:, 0] - exact for dt in dts]
    energies = [0.5 * (M * s[:, 1] ** 2 + K * s[:, 0] ** 2) / (0.5 * K * 1e-6) - 1 for s in (positions(K, 0, M, dt, n * round(T / dt)) for dt in dts)]
    # Rounding of up to 60 000 steps of 1e-3 m, each kept to 1e-16 of it, against errors down to 1e-7 m.
    close, how = Within("rounding of up to 60 000 steps of 1 mm, 1e-19 m each", relative=1e-7, absolute=1e-14), "recurrence less matrix exponential"
    half = [errors[0] / 2] * 10
    for name, measure in (("error_final_m", lambda e: abs(e[-1])), ("error_rms_m", lambda e: rms(e)), ("error_max_m", lambda e: np.abs(e).max())):
        column(bench, table, rows, name, [measure(e) for e in errors], how, close, "of the first row, halved", [measure(e) for e in half])
    column(bench, table, rows, "step_s", dts, "the coarsest over 1, 2, 5 ...", ROUNDING, "halved each time", T / 2.0 ** np.arange(10))
    energy = Within("rounding of up to 60 000 steps", relative=1e-7, absolute=1e-11)
    column(bench, table, rows, "undamped_energy_gain_relative", [e[-1] for e in energies], "of the last row", energy, "largest", [np.abs(e).max() for e in energies])
    column(bench, table, rows, "undamped_energy_swing_relative", [np.abs(e).max() for e in energies], "largest |E - E_0| over E_0", energy,
           "least to largest", [e.max() - e.min() for e in energies])
    bench.add("precision_STUDY.csv:setting", [table["setting"][i] for i in rows[:1]], [f"leapfrog dt={T:g}"], "integrator and step", EXACT, ("another", ["leapfrog"]))
    bench.add("precision_STUDY.csv:outcome", [table["outcome"][i] for i in rows], ["completes"] * 10, "stable below 2 M / B", EXACT, ("diverges", ["diverges"] * 10))
    add_order(bench, printed, "leapfrog", dts, [rms(e) for e in errors], np.polyfit(np.log(dts), np.log([rms(e) for e in errors]), 1)[0])
    bench.add("precision --json: study", printed["study"], "integrators", "as asked", EXACT, ("all", "all"))
    timing = Table(bench.folder / "integrators" / "precision_integrators_timing.csv")
    for field, file in (("seconds_per_step", timing), ("seconds_per_call", Table(study(bench, "shaping")[0] and bench.folder / "shaping" / "precision_shaping_timing.csv"))):
        times = file[file.names[-1]]
        bench.add(f"precision_STUDY.csv:{field}", bool(np.all((times > 1e-9) & (times < 1e-3))), True,
                  "more than a few instructions, less than a millisecond", EXACT, ("of all steps", bool(np.all(times * 1e5 < 1e-3))))


@scene
def time_step(bench):
    """One damped spring against itself at a 128 times finer step; and the force of a prescribed motion, whose damping alone sees the step."""
    K, M, dt, n = 2000.0, 0.1, 0.002, 128
    B = 2 * 0.3 * math.sqrt(K * M)
    render = {**PLAIN, "algorithm": "summation", "stiffness_N_per_m": K, "damping_ratio": 0.3, "mass_kg": M}
    base = bench.scenario("time_step", time={"step_s": dt, "steps": n}, environment=SPRING, initial={"position_m": [1e-3, 0, 0]}, rendering=render)
    table, printed = study(bench, "time_step", "--scenario", base)
    factors = np.array([4, 2, 1, 0.5, 0.25, 0.125])
    runs = [positions(K, B, M, dt * f, round(n / f), round(4 / f))[:, 0] for f in (*factors, 1 / 128)]
    close, how = Within("rounding of 16 000 steps", relative=1e-8), "recurrence less that of the finest step"
    for name, measure in (("error_final_m", lambda e: abs(e[-1])), ("error_rms_m", lambda e: rms(e)), ("error_max_m", lambda e: np.abs(e).max())):
        exact = positions(K, B, M, dt / 1024, 1024 * n, 4096)[:, 0]
        column(bench, table, range(6), name, [measure(run - runs[-1]) for run in runs[:-1]], how, close, "against the exact solution",
               [measure(run - exact) for run in runs[:-1]])
    column(bench, table, range(6), "step_s", dt * factors, "the scene's times 4 to 1/8", ROUNDING, "from the scene's on", dt / 2.0 ** np.arange(6))
    # The reference's own error over the row's, at the order that is seen.
    order = order_of(dt * factors[1:], [rms(a - b) for a, b in zip(runs[:5], runs[1:6])])[0]
    bench.add("precision --json: error_tolerance_relative", [row["error_tolerance_relative"] for row in printed["rows"]],
              (128 * factors) ** -order, "(h_ref / h)^p", Within("as the order", relative=1e-4), ("of first order", 1 / (128 * factors)))
    differences = [rms(a - b) for a, b in zip(runs[:5], runs[1:6])]
    add_order(bench, printed, "leapfrog", dt * factors[1:], differences, order_of(dt * factors, [rms(run - runs[-1]) for run in runs[:-1]])[0])
    swing = {"type": "sine", "mean": 0, "amplitude": 1e-3, "period_s": 0.1}
    led = bench.scenario("led", time={"step_s": dt, "steps": n}, environment=SPRING, rendering=render,
                         motion={"position": {"type": "prescribed", "x_m": swing, "y_m": 0, "z_m": 0}})
    table, _ = study(bench, "time_step", "--scenario", led)
    x = lambda t: 1e-3 * np.sin(2 * np.pi * t / 0.1)

    def force(step):
        t = np.arange(0, n // 4) * 4 * dt
        v = (x(t) - x(t - step)) / step
        v[0] = (x(step) - x(0)) / step
        return -K * x(t) - B * v

    for name, measure in (("error_final_N", lambda e: abs(e[-1])), ("error_rms_N", lambda e: rms(e)), ("error_max_N", lambda e: np.abs(e).max())):
        column(bench, table, range(6), name, [measure(force(dt * f) - force(dt / 128)) for f in factors], "-K x - B (x_k - x_(k-1)) / dt", Within(
            "differences of 1 mm over 16 us, 1e-19 / 16e-6 of 0.06 m/s", relative=1e-8, absolute=1e-12), "against the exact speed",
               [measure(force(dt * f) - force(1e-9)) for f in factors])


def verdict_on(f):
    """Order, Richardson's value and its error of three results at steps that are halved, with Roache's factor."""
    p = math.log2((f[-3] - f[-2]) / (f[-2] - f[-1]))
    limit = f[-1] + (f[-1] - f[-2]) / (2**p - 1)
    return p, limit, 1.25 * np.abs(f - limit)


@scene
def convergence(bench):
    """Leapfrog on one damped spring at five steps, where it is after the same time: orders and limit by hand of a recurrence."""
    K, M, dt, n = 1500.0, 0.1, 0.002, 40
    B = 2 * 0.2 * math.sqrt(K * M)
    base = bench.scenario("convergence", time={"step_s": dt, "steps": n}, environment=SPRING, initial={"position_m": [1e-3, 0, 0]},
                          rendering={**PLAIN, "algorithm": "summation", "stiffness_N_per_m": K, "damping_ratio": 0.2, "mass_kg": M})
    metric, out = "final_position_m.x", bench.folder / "converged"
    printed = bench.json("converge", base, "--metric", metric, "--out", out)
    steps = dt / 2.0 ** np.arange(5)
    f = np.array([positions(K, B, M, h, n * 2**i, 2**i)[-1, 0] for i, h in enumerate(steps)])
    p, limit, errors = verdict_on(f)
    orders = [math.nan] * 2 + [verdict_on(f[i - 2:i + 1])[0] for i in range(2, 5)]
    ratio = abs((f[-3] - f[-4]) / f[-3]) / abs((f[-2] - f[-3]) / f[-2]) / 2**p  # of the three before the last, the more severe
    near = Within("positions of 1e-4 m known to 1e-18 m after 640 steps, over differences of 1e-6 m", relative=1e-9)
    fine = Within("the same, of differences of differences", relative=1e-8)
    exact = linalg.expm(np.array([[0, 1], [-K / M, -B / M]]) * (n - 1) * dt)[0, 0] * 1e-3
    assert abs(limit - exact) < errors[-1], "the index does not hold the exact solution"
    table, levels = Table(out / "converge.csv"), Table(out / "converge_levels.csv")
    known = {"metric": (metric, EXACT, "another", "final_position_m.y"), "field": ("time.step_s", EXACT, "another", "time.steps"),
             "formal_order": (1.0, EXACT, "without damping the same integrator's of two steps before", 2.0),
             "observed_order": (p, fine, "the formal one", 1.0), "reason": (None, EXACT, "some", "contacts switch"),
             "extrapolated": (limit, near, "the exact solution", exact), "gci": (errors[-1] / abs(f[-1]), fine, "without the factor of safety", errors[-1] / abs(f[-1]) / 1.25),
             "asymptotic": (abs(ratio - 1) <= 0.1, EXACT, "of the first differences", abs(ratio - 1) > 0.1),
             "low": (f[2:].min(), near, "of the first three", f[:3].min()), "high": (f[2:].max(), near, "of the first three", f[:3].max())}
    for name, (value, within, naive, wrong) in known.items():
        cell = table.rows[0][name]
        cell = {"true": True, "false": False}.get(cell, float(cell) if isinstance(value, float) else cell or None)
        bench.add(f"converge.csv:{name}", cell, value, "recurrence of leapfrog, formulas of Roache", within, (naive, wrong))
    bench.add("converge --json: order", printed["order"], p, "recurrence of leapfrog, formulas of Roache", fine, ("the formal one", 1.0))
    bench.add("converge --json: band", printed["band"], [f[2:].min(), f[2:].max()], "of the last three levels", near, ("of all", [f.min(), f.max()]))
    for name, (value, within, naive, wrong) in {
            "value": (steps, EXACT, "the coarsest over 1, 2, 3 ...", dt / np.arange(1, 6)), "result": (f, near, "of the last row of each run", np.append(f[1:], f[0])),
            "observed_order": (orders, fine, "the formal one", [math.nan] * 2 + [1.0] * 3), "error_estimate": (errors, fine, "from the finest level", np.abs(f - f[-1]))}.items():
        bench.add(f"converge_levels.csv:{name}", levels[name], value, "recurrence of leapfrog, formulas of Roache", within, (naive, wrong))
    for name, value, wrong in (("metric", metric, "x"), ("outcome", "completes", "diverges")):
        bench.add(f"converge_levels.csv:{name}", levels[name], [value] * 5, "as asked, and stable below 2 M / B", EXACT, ("another", [wrong] * 5))
    seconds = Table(out / "converge_levels_timing.csv")["seconds"]
    bench.add("converge_levels.csv:seconds", bool(np.all((seconds > 1e-6) & (seconds < 0.1))), True, "640 steps take more than a microsecond, less than 0.1 s",
              EXACT, ("of a step", bool(np.all(seconds / 640 > 1e-6))))
    error = verdict_on(f[:3])[2][0]
    said, = bench.json("compare", base, "--algorithms", "summation", "--by", metric, "--errors", "--out", bench.folder / "errors")["errors"]
    number = said["numbers"][0]
    assert number["value"] == printed["levels"][0]["result"] and number["error_estimate"] == number["error_of_step"]
    bench.add("compare --json: error_of_step", number["error_of_step"], error, "three levels of the same recurrence", fine,
              ("from the finest of three", abs(f[0] - f[2])))


@scene
def wedge(bench):
    """Three springs on either face of a wedge: S by its sum, and the weights of shaping by its iteration."""
    table, _ = study(bench, "stiffness")
    laws, angles = ["summation", "mean", "shaped_stiffness"], np.radians([5, 10, 20, 30, 45, 60, 80])
    rows = [i for law in laws for i, text in enumerate(table["setting"]) if text.startswith(f"{law} ")]
    tensors, ratios = [], []
    for law in laws:
        for w in angles:
            U = np.array(3 * [[math.cos(w), -math.sin(w), 0]] + 3 * [[-math.cos(w), -math.sin(w), 0]])
            c, A = np.ones(6), (U @ U.T) ** 2
            c = c / 6 if law == "mean" else c
            for _ in range(3 if law == "shaped_stiffness" else 0):
                c = c / (A @ c)
            tensors.append((U.T * c) @ U)
            ratios.append(A @ c)
    S = np.array(tensors)
    one = np.array([[math.sin(w) ** 2, math.cos(w) ** 2] for _ in laws for w in angles])
    for name, known, naive in (("half_angle_rad", np.tile(angles, 3), np.tile(2 * angles, 3)), ("ratio_min", np.min(ratios, axis=1), S[:, 0, 0]),
                               ("ratio_max", np.max(ratios, axis=1), S[:, 0, 0]), ("along_way_out", S[:, 1, 1], one[:, 0]), ("along_formula", S[:, 1, 1], one[:, 0]),
                               ("across", S[:, 0, 0], one[:, 1]), ("across_formula", S[:, 0, 0], one[:, 1]),
                               ("lambda_max", np.linalg.eigvalsh(S)[:, -1], np.trace(S, axis1=1, axis2=2))):
        column(bench, table, rows, name, known, "S = sum c u u^T", ROUNDING, "of one spring, or another entry", naive)


def optimum(U, epsilon=1e-6):
    """Weights of min |sum c u u^T - I|^2 / 2 + epsilon |c|^2 / 2, c >= 0, by non-negative least squares."""
    tensors = np.einsum("ni,nj->ijn", U, U).reshape(9, -1)
    return optimize.nnls(np.vstack([tensors, math.sqrt(epsilon) * np.eye(len(U))]), np.r_[np.eye(3).ravel(), np.zeros(len(U))], maxiter=50 * len(U))[0]


def shaped(U, iterations):
    c, A = np.ones(len(U)), (U @ U.T) ** 2
    for _ in range(iterations):
        c = c / (A @ c)
    return c


def reduced(U, d, threshold):
    """Kept places, in order: each point is taken up by the first one kept that points as it does, which it replaces if it is deeper."""
    kept = []
    for i in range(len(U)):
        alike = next((k for k, j in enumerate(kept) if U[i] @ U[j] > threshold), None)
        if alike is None:
            kept.append(i)
        elif d[i] > d[kept[alike]]:
            kept[alike] = i
    return kept


@scene
def shaping(bench):
    """The contacts of a drill turned in a hole, as a run records them: iterations, optimum and reduction by numpy and scipy."""
    grid = ("--set", "environment.grid_m=0.0002", "--set", "time.steps=6144")
    run = bench.run("rotate_in_hole", *grid, "--set", 'device={"type":"ideal","force_limit_N":2}', "--set", "rendering.reduction=null", "--set",
                    "record.every=64", "--set", "record.contacts=true", "--set", "expect={}", out="drill", statuses=(0, 3))
    contacts = run.table("contacts.csv")
    steps = contacts["step"]
    sets = [(contacts.vectors("gradient_x", "gradient_y", "gradient_z")[steps == k], contacts["depth_m"][steps == k]) for k in np.unique(steps)]
    best = [optimum(U) for U, _ in sets]
    tensor = lambda U, c: (U.T * c) @ U
    S = [tensor(U, c) for (U, _), c in zip(sets, best)]
    table, _ = study(bench, "shaping", "--scenario", "rotate_in_hole", *grid)
    counts = (0, 1, 2, 3, 4, 5, 10, 20)
    errors = [[np.linalg.norm(tensor(U, shaped(U, m)) - s) for (U, _), s in zip(sets, S)] for m in counts]
    ratio = [max(np.abs(np.einsum("ni,ij,nj->n", U, tensor(U, shaped(U, m)), U) - 1).max() for U, _ in sets) for m in counts]
    solved = Within("scipy's active sets and our Newton both end at the optimum to 1e-9", relative=1e-7, absolute=1e-8)
    how = "c <- c / (A c) and scipy's nnls on recorded contacts"
    column(bench, table, range(8), "tensor_error_rms", [rms(e) for e in errors], how, solved, "mean", [np.mean(e) for e in errors])
    column(bench, table, range(8), "tensor_error_max", [max(e) for e in errors], how, solved, "rms", [rms(e) for e in errors])
    column(bench, table, range(8), "ratio_error_max", ratio, how, solved, "of the tensors", [max(e) for e in errors])
    table, _ = study(bench, "reduction", "--scenario", "rotate_in_hole", *grid)
    exact = [d * c @ U for (U, d), c in zip(sets, best)]
    thresholds = (0.9, 0.95, 0.99, 0.995, 0.999, 0.9999)
    kept = [[reduced(U, d, threshold) for U, d in sets] for threshold in thresholds]
    forces = [[d[k] * shaped(U[k], 3) @ U[k] for k, (U, d) in zip(which, sets)] for which in kept]
    off = [norms(np.subtract(f, exact)) for f in forces]
    column(bench, table, range(6), "kept_mean", [np.mean([len(k) for k in which]) for which in kept], "the reduction's rule", ROUNDING, "of all",
           [np.mean([len(d) for _, d in sets])] * 6)
    column(bench, table, range(6), "force_error_relative", [rms(o) / rms(exact) for o in off], how, solved, "mean", [np.mean(o) / rms(exact) for o in off])
    column(bench, table, range(6), "depth_error_max_m", [max(o) for o in off], how, Within("as the weights, times depths of 0.1 mm", absolute=1e-11),
           "rms", [rms(o) for o in off])
    tests = "tests/scenarios/studies/precision/precision_test.cpp"
    for name, test, said, refused in (
            ("order_spread_relative", "PrecisionMerging.DependsOnTheOrderOfTheContactsOnlyWhereTheyAreReduced", "order_spread_relative", "EXPECT_"),
            ("contacts_mean", "PrecisionMerging.DependsOnTheOrderOfTheContactsOnlyWhereTheyAreReduced", "contacts_mean", "EXPECT_")):
        bench.proven(f"precision_STUDY.csv:{name}", tests, test, said, refused)
    drill_table(bench)


def drill_table(bench):
    """The columns of a drill against the ideal trajectory are the metrics of its run, which beside_the_ideal knows."""
    short = ("--set", "time.steps=4096")
    table, _ = study(bench, "spacing", "--scenario", "rotate_in_hole", *short)
    row = table["setting"].index("signed_distance 0.0002")
    run = bench.run("rotate_in_hole", *short, "--set", "environment.grid_m=0.0002", "--set", 'device={"type":"ideal","force_limit_N":2}', "--set",
                    "record.ideal_trajectory=true", "--set", "record.every=1", "--set", "expect={}", out="gentle", statuses=(0, 3))
    one = lambda name: run.metric(f"ideal_trajectory.gentle.{name}")
    how = "metrics of a run with these settings"
    highest = max(-one("height_error_min_m"), one("height_error_max_m"))
    for name, known, naive in (("ideal_height_error_rms_m", one("height_error_rms_m"), one("height_error_mean_m")),
                               ("ideal_height_error_max_m", highest, one("height_error_min_m")), ("ideal_lateral_error_rms_m", one("lateral_error_rms_m"),
                                                                                                   one("lateral_error_mean_m")),
                               ("interpenetration_max_m", one("interpenetration_max_m"), one("interpenetration_mean_m")),
                               ("force_step_max_N", run.metric("force_step_max_N"), run.metric("force_step_p99_N"))):
        column(bench, table, [row], name, [known], how, EXACT, "mean, signed, or 99 %", [naive])
    bench.hapbench("shell", "rotate_in_hole", "--set", "environment.grid_m=0.0002", "--out", "shell.csv")
    points = len(Table(bench.folder / "shell.csv").rows)
    column(bench, table, [row], "points", [points], "lines that shell writes", EXACT, "with the header", [points + 1])
    column(bench, table, [row], "spacing_m", [0.0002], "as the setting says", EXACT, "the scene's", [0.0001])
    column(bench, table, [row], "shell_bytes", [48 * points], "six doubles a point", Within("padded to the width of the widest vector, 64 of them at most",
           absolute=48 * 64), "four bytes a number", [24 * points])


@scene
def jumps_and_poses(bench):
    """A tool led past where a second spring begins, whose force `mean` halves there: a jump and a slope. And a ball's points on a grid."""
    K, dt, n, v = 1000.0, 0.001, 200, 0.02
    led = bench.scenario("led", time={"step_s": dt, "steps": n}, rendering={**PLAIN, "algorithm": "mean"}, environment={
        "type": "springs", "bilateral": False, "groups": [{"direction": [0, 0, -1], "count": 1}, {"direction": [1, 0, 0], "count": 1}]},
        motion={"position": {"type": "prescribed", "x_m": {"type": "ramp", "start": -2.003e-3, "rate_per_s": v}, "y_m": 0,
                             "z_m": {"type": "ramp", "start": 1e-4, "rate_per_s": -v}}})
    table, _ = study(bench, "force_jumps", "--scenario", led)

    def changes(law, step):
        t = np.arange(round(n * dt / step)) * step
        p = np.column_stack([-2.003e-3 + v * t, 1e-4 - v * t])
        d = np.maximum(0, p * [1, -1])
        f = -K * d * [1, -1] / (np.maximum(1, (d > 0).sum(axis=1))[:, None] if law == "mean" else 1)
        return norms(np.diff(f, axis=0)), norms(np.diff(p, axis=0))

    for law in ("summation", "mean"):
        (coarse, way), (fine, _) = changes(law, dt), changes(law, dt / 10)
        left = (10 * fine.max() - coarse.max()) / 9
        jump = left if left > 0.01 * fine.max() else 0.0
        row, per_way = [table["setting"].index(law)], (coarse / way).max()
        near = Within("differences of forces of 4 N, known to 1e-15 N, over ways of 28 um", relative=1e-10, absolute=1e-12)
        for name, known, naive in (("force_jump_max_N_per_um", 1e-6 * per_way, 1e-6 * K), ("force_change_max_N", coarse.max(), fine.max()),
                                   ("force_change_fine_max_N", fine.max(), coarse.max()), ("force_jump_max_N", jump, coarse.max()),
                                   ("stiffness_over_step", per_way / K, 1.0 if law == "mean" else 2.0)):
            naive = naive if not (law == "summation" and name in ("force_jump_max_N_per_um",)) else 2e-6 * K
            column(bench, table, row, name, [known], "forces of the formula, at both steps", near, "of the slope, or of the other step", [naive])
    table, _ = study(bench, "query_time")
    r, length, side = 0.0005, 0.01, np.linspace(-0.002, 0.002, 41)
    x, y = (c.ravel() for c in np.meshgrid(side, side))
    rho, pushed, deepest, count = np.hypot(x, y), [], [], []
    for level in range(10):
        z = 0.0005 - (np.arange(level * 256, level * 256 + 256) + 1) / 2560 * 5 * 0.0002
        s = z[:, None]  # how far a point of the plane lies below the tip's centre, along the axis
        depth = r - np.where(s > 0, np.hypot(rho, s), rho)
        depth = np.where(-s > length, -1, depth)
        inside = depth >= -1e-15  # a closed set: points on the surface are in it
        pushed.append(0.0005 - z[128])
        deepest.append(np.where(inside, depth, 0).max(axis=1).mean())
        count.append(inside.sum(axis=1).mean())
    edge = Within("points on the surface to rounding: of eight by symmetry in one of 256 poses", absolute=8 / 256)
    rows = range(10, 20)
    column(bench, table, rows, "pushed_m", pushed, "middle pose of a tenth of five strokes", ROUNDING, "of one stroke", np.array(pushed) / 5)
    column(bench, table, rows, "depth_max_mean_m", deepest, "radius less the distance to axis or centre", Within("rounding of 0.5 mm", absolute=1e-15),
           "r - z", np.array(pushed))
    column(bench, table, rows, "contacts_mean", count, "points of the grid within the tool", edge, "area over spacing squared", [math.pi * r * r / 1e-8] * 10)
    column(bench, table, rows, "points_tested_mean", [41.0 * 41] * 10, "every point", EXACT, "those in contact", count)
