"""Known answers for positions: the ideal trajectory in a hole, and the depth below a surface."""
import math

import numpy as np

from answers import EXACT, ROUNDING, Within, norms, profile, rms, scene

R, r, H = 1e-3, 0.5e-3, 5e-3  # radii of hole and tool, depth of the hole [m]


def depth_in_block(q):
    """Returns the depth [m] of points below the surface of the half space z < 0 with a hole; negative outside of the
    solid. `q`: points, with the coordinates in the last axis."""
    out, below = np.hypot(q[..., 0], q[..., 1]) - R, -H - q[..., 2]
    hole = np.where((out > 0) & (below > 0), np.hypot(out, below), np.maximum(out, below))
    return np.minimum(hole, -q[..., 2])


def interpenetration(tip, tilt):
    """Returns the largest depth [m] of the tool's solid. It is found on a coarse grid, and then on successively finer
    grids around the deepest points."""
    axis, e1, e2 = (
        -np.array([math.sin(tilt), 0, math.cos(tilt)]),
        np.array([math.cos(tilt), 0, -math.sin(tilt)]),
        np.array([0, 1.0, 0]),
    )

    # Depth of points on the side of the tool. Points inside the flat tip are never deeper than its edge.
    def depth(angle, up):
        turned = np.cos(angle)[..., None] * e1 + np.sin(angle)[..., None] * e2
        return depth_in_block(tip + r * turned - np.clip(up, 0, 0.01)[..., None] * axis)

    def zoomed(angle, up, wide, long):
        for _ in range(14):  # each grid is a fifth as wide as the previous grid
            grid = np.meshgrid(
                np.linspace(angle - wide, angle + wide, 41), np.linspace(up - long, up + long, 41)
            )
            found = depth(*grid)
            at = np.unravel_index(np.argmax(found), found.shape)
            angle, up, wide, long = grid[0][at], grid[1][at], wide / 5, long / 5
        return found[at]

    lines = np.linspace(0, 2 * np.pi, 181)
    grid = np.meshgrid(lines, np.linspace(0, 0.01, 1001))
    found = depth(*grid)
    along, deepest = found.argmax(axis=0), found.max(axis=0)
    hills = [i for i in range(181) if deepest[i] >= max(deepest[i - 1], deepest[(i + 1) % 181])]
    return max(0.0, *(zoomed(lines[i], grid[1][along[i], i], lines[1], 2e-5) for i in hills))


@scene
def beside_the_ideal(bench):
    """Checks the metrics of a drill that is offset by given distances from the ideal trajectory of section 3.6 of the
    thesis. In half of the rows, the hand is gentle. In some rows, the ideal trajectory does not exist.
    """
    n, dt = 24, 0.001
    tilt = np.r_[
        np.linspace(0.35, 0.95, 20), 1.10, 1.15, 1.2, 1.25
    ]  # contact with the wall ends at 60 degrees
    t, has = np.arange(n) * dt, tilt < math.pi / 3
    c, s = np.cos(tilt), np.sin(tilt)
    ideal = np.column_stack([-R + r * c, (r * (1 + c * c) - 2 * R * c) / s])
    has &= (ideal[:, 1] + r * s < 0) & (ideal[:, 1] - r * s > -H)
    off = np.column_stack(
        [2e-5 * np.sin(1.0 + np.arange(n)), 3e-5 * np.cos(2 * np.arange(n)) - 1.5e-5]
    )
    actual = ideal + off
    bench.write(
        "beside.csv",
        "time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z",
        np.column_stack([t, actual[:, 0], 0 * t, actual[:, 1], -s, 0 * t, -c]),
    )
    push = 1.2 + 80 * t
    run = bench.run(
        bench.scenario(
            "beside_the_ideal",
            time={"step_s": dt, "steps": n},
            record={"ideal_trajectory": True},
            environment={
                "type": "block_with_hole",
                "size_m": [0.006, 0.006, 0.006],
                "hole_diameter_m": 2 * R,
                "hole_depth_m": H,
                "grid_m": 0.0002,
                "density": "signed_distance",
            },
            tool={"diameter_m": 2 * r, "length_m": 0.01, "tip": "flat"},
            motion={"position": {"type": "file", "file": "beside.csv"}},
            hand={"type": "force", "x_N": {"type": "ramp", "start": 1.2, "rate_per_s": 80.0}},
            rendering={"algorithm": "mean", "stiffness_N_per_m": 1000},
        )
    )
    deep = np.array([interpenetration(np.array([p[0], 0, p[1]]), a) for p, a in zip(actual, tilt)])
    searched = Within(
        "a grid ends within 1e-10 of the deepest place, ours within 1e-8 rad of 0.5 mm",
        absolute=2e-11,
    )
    split = Within(
        "a row's place is the file's, whose axes are unit vectors to 1e-16",
        relative=1e-10,
        absolute=1e-16,
    )
    table = []
    for name, rows, wrong in (("gentle", has & (push < 2), has), ("firm", has & (push >= 2), has)):
        height, side = off[rows, 1], off[rows, 0]
        table += [
            (f"ideal_trajectory.{name}.{field}", known, how, within, naive, value)
            for field, known, how, within, naive, value in (
                (
                    "rows",
                    int(rows.sum()),
                    "tilts with an ideal, hand below and from 2 N",
                    EXACT,
                    "of both hands",
                    int(wrong.sum()),
                ),
                (
                    "height_error_mean_m",
                    height.mean(),
                    "the offset",
                    split,
                    "mean of |error|",
                    np.abs(height).mean(),
                ),
                (
                    "height_error_rms_m",
                    rms(height),
                    "the offset",
                    split,
                    "of both hands",
                    rms(off[wrong, 1]),
                ),
                (
                    "height_error_min_m",
                    height.min(),
                    "the offset",
                    split,
                    "least |error|",
                    np.abs(height).min(),
                ),
                (
                    "height_error_max_m",
                    height.max(),
                    "the offset",
                    split,
                    "largest |error|",
                    np.abs(height).max() + (height.max() == np.abs(height).max()),
                ),
                (
                    "lateral_error_mean_m",
                    side.mean(),
                    "the offset",
                    split,
                    "against the lean",
                    -side.mean(),
                ),
                (
                    "lateral_error_rms_m",
                    rms(side),
                    "the offset",
                    split,
                    "of both hands",
                    rms(off[wrong, 0]),
                ),
                (
                    "lateral_error_max_m",
                    np.abs(side).max(),
                    "largest |offset|",
                    split,
                    "signed",
                    side.max() - (side.max() == np.abs(side).max()),
                ),
                (
                    "interpenetration_mean_m",
                    deep[rows].mean(),
                    "search on the exact shapes",
                    searched,
                    "of both hands",
                    deep[wrong].mean(),
                ),
                (
                    "interpenetration_max_m",
                    deep[rows].max(),
                    "search on the exact shapes",
                    searched,
                    "the mean",
                    deep[rows].mean(),
                ),
            )
        ]
    bench.metrics(run, table)
    bench.metrics(
        run,
        [
            (
                "ideal_trajectory.rows_without_ideal",
                int((~has).sum()),
                "tilts beyond 60 degrees",
                EXACT,
                "none",
                0,
            )
        ],
    )
    k = np.flatnonzero(has)
    bench.columns(
        run.table("ideal_trajectory.csv"),
        [
            ("step", k, "rows with an ideal", EXACT, "counted anew", k + 1),
            ("time_s", t[k], "k dt", EXACT, "after the step", t[k] + dt),
            (
                "tilt_rad",
                tilt[k],
                "of the file",
                split,
                "from the horizontal",
                math.pi / 2 - tilt[k],
            ),
            ("height_m", actual[k, 1], "of the file", split, "ideal", ideal[k, 1]),
            ("ideal_height_m", ideal[k, 1], "3.6's formula", split, "actual", actual[k, 1]),
            ("lateral_m", actual[k, 0], "of the file", split, "ideal", ideal[k, 0]),
            ("ideal_lateral_m", ideal[k, 0], "-R + r cos a", split, "actual", actual[k, 0]),
            (
                "interpenetration_m",
                deep[k],
                "search on the exact shapes",
                searched,
                "height error",
                -off[k, 1],
            ),
            (
                "hand_force_N",
                push[k],
                "the ramp",
                ROUNDING,
                "capped at 2 N",
                np.minimum(2, push[k]),
            ),
        ],
    )


@scene
def pressed_ball(bench):
    """Checks the depth of a ball of 1 mm diameter that is pressed 3 mm into a plane. The depth of the ball is its
    radius minus the height of its centre, independent of the plane's width. In contrast, the depth of a contact is at
    most the radius."""
    n, dt, a = 600, 0.001, 0.5e-3
    height = {
        "type": "waypoints",
        "points": [[0, 1e-3], [0.1, 2e-4], [0.3, -3e-3 + a], [0.5, -1e-3], [0.6, 1e-3]],
    }
    z = profile(height, np.arange(n) * dt)
    run = bench.run(
        bench.scenario(
            "pressed_ball",
            time={"step_s": dt, "steps": n},
            environment={"type": "plane", "size_m": 0.008, "spacing_m": 0.0001},
            tool={"type": "bur", "family": "ball", "diameter_m": 2 * a},
            record={"inside": True},
            motion={"position": {"type": "prescribed", "x_m": 0, "y_m": 0, "z_m": height}},
            rendering={"algorithm": "mean", "stiffness_N_per_m": 1000},
        ),
        statuses=(0, 3),
    )
    inside = np.maximum(0, a - z)
    touching = run.table()["colliding"] > 0
    first = int(np.flatnonzero(touching)[0])
    settled = touching & (np.arange(n) >= first + 50)
    line = np.array(run.summary["tool"]["outline_m"])
    begin, along = line[:-1], np.diff(line, axis=0)
    share = np.clip(-np.sum(begin * along, axis=1) / np.sum(along**2, axis=1), 0, 1)
    chord = norms(begin + share[:, None] * along).min()
    half = Within("exact for a ball on a plane, but for rounding of 3 mm", absolute=1e-15)
    bench.metrics(
        run,
        [
            (
                "inside_max_m",
                inside.max(),
                "radius less height",
                half,
                "the half width, where a contact's depth ends",
                a,
            ),
            (
                "inside_settled_m",
                float(np.median(inside[settled])),
                "radius less height, median of settled rows",
                half,
                "median over all rows",
                float(np.median(inside)),
            ),
            (
                "centre_inside_share",
                np.mean(z < 0),
                "height below 0",
                ROUNDING,
                "rows in contact",
                touching.mean(),
            ),
            (
                "depth_max_m",
                chord,
                "from the grid's point in the ball's centre to the nearest chord of its outline",
                Within("a row's centre lies within " "1e-17 m of the plane", absolute=1e-15),
                "how deep the tool is",
                inside.max(),
            ),
        ],
    )
    two = "2 % of it and of the half width, the bound of the search"
    for name, exact in (
        ("inside_max_m", inside.max()),
        ("inside_settled_m", float(np.median(inside[settled]))),
    ):
        bench.tolerance(
            run, name, 0.02 * (exact + a), two, ROUNDING, ("2 % of it", 0.02 * exact), exact
        )
    few = bench.run(
        bench.folder / "pressed_ball.json",
        "--set",
        "record.inside=false",
        out="few",
        statuses=(0, 3),
    )
    bench.tolerance(
        few,
        "inside_max_m",
        0.02 * (inside.max() + a),
        two,
        Within("the deepest of the looked at rows for the deepest", relative=0.02),
        ("2 % of it", 0.02 * inside.max()),
        inside.max(),
    )
    bench.columns(
        run.table(),
        [
            (
                "inside_m",
                inside,
                "radius less height",
                half,
                "depth of the deepest contact",
                run.table()["depth_max_m"],
            ),
            (
                "centre_inside",
                (z < 0).astype(float),
                "height below 0",
                EXACT,
                "rows in contact",
                touching.astype(float),
            ),
        ],
    )


@scene
def counted(bench):
    """Checks the counters of the work of a run, with skips and without skips. Also checks the printed description of
    the tool. A ball touches a plane of 81 x 81 points in seven rows."""
    fields = dict(
        time={"step_s": 0.001, "steps": 600},
        environment={"type": "plane", "size_m": 0.008, "spacing_m": 0.0001},
        tool={"type": "bur", "family": "ball", "diameter_m": 0.001},
        motion={
            "position": {
                "type": "prescribed",
                "x_m": 0,
                "y_m": 0,
                "z_m": {"type": "waypoints", "points": [[0, 0.01], [0.3, 0.0004], [0.6, 0.01]]},
            }
        },
        rendering={"algorithm": "shaped_stiffness", "iterations": 4, "stiffness_N_per_m": 1000},
    )
    skipping = bench.run(bench.scenario("counted", **fields))
    full = bench.run(bench.scenario("counted", **fields), "--no-skip", out="full")
    work, fewest = full.summary["work"], skipping.summary["work"]
    rows = 2 * math.floor(0.0001 / 0.000032) + 1  # 0.032 mm per row; in contact below 0.5 mm
    for key, known, naive in (
        ("queries", 600, 600 * 81),
        ("points_tested", 600 * 81 * 81, fewest["points_tested"]),
        ("lists_rebuilt", 0, fewest["lists_rebuilt"]),
        ("steps_skipped", 0, fewest["steps_skipped"]),
        ("iterations", 4 * 600, 4 * rows),
    ):
        bench.add(
            f"run --json: {key}",
            work[key],
            known,
            "without skips every row tests every point and shapes",
            EXACT,
            ("with skips", naive),
        )
    bench.add(
        "run --json: iterations",
        fewest["iterations"],
        4 * rows,
        "with skips only rows in contact shape",
        EXACT,
        ("all rows", 2400),
    )
    bench.add(
        "run --json: state_hash",
        skipping.summary["state_hash"],
        full.summary["state_hash"],
        "skips change no bit",
        EXACT,
        (
            "another run's",
            bench.run(
                bench.scenario("counted", **fields),
                "--set",
                "rendering.stiffness_N_per_m=1001",
                out="x",
            ).summary["state_hash"],
        ),
    )
    tool, line = full.summary["tool"], np.array(full.summary["tool"]["outline_m"])
    corner = line[2:] - line[1:-1], line[1:-1] - line[:-2]
    turns = corner[0][:, 0] * corner[1][:, 1] - corner[0][:, 1] * corner[1][:, 0]
    ball = line[line[:, 0] > -0.0004]
    for key, printed, known, how, within, naive in (
        ("half_width_m", tool["half_width_m"], 0.0005, "radius of the ball", ROUNDING, 0.001),
        (
            "reach_m",
            tool["reach_m"],
            norms(line).max(),
            "furthest point of the outline",
            ROUNDING,
            -line[:, 0].min(),
        ),
        (
            "convex",
            tool["convex"],
            bool(np.all(turns <= 1e-15) or np.all(turns >= -1e-15)),
            "turns of the outline",
            EXACT,
            True,
        ),
        (
            "outline_m",
            norms(ball),
            np.full(len(ball), 0.0005),
            "a circle below the neck",
            ROUNDING,
            ball[:, 1],
        ),
    ):
        bench.add(f"run --json: {key}", printed, known, how, within, ("of another measure", naive))
    bench.add(
        "run --json: allocations",
        fewest["allocations"],
        0,
        "a step allocates nothing (tests/algorithms/allocation_test)",
        EXACT,
        ("one a row", 600),
    )
    bench.add(
        "run --json: warnings",
        full.summary["warnings"],
        [],
        "nothing is odd",
        EXACT,
        ("some", ["no expectation"]),
    )
    for word, test, accepted, rejected in (
        (
            "step_p50_s",
            "StepLatency.PercentilesAreThoseOfNearestRank",
            "thousand.p50, 500u",
            "seven.p50, 4u",
        ),
        (
            "step_p99_s",
            "StepLatency.PercentilesAreThoseOfNearestRank",
            "thousand.p99, 990u",
            "seven.p99_9, 7u",
        ),
    ):
        bench.proven(
            f"{word} (number of timing.json)",
            "tests/results/observe/step_times_test.cpp",
            test,
            accepted,
            rejected,
        )
    bench.proven(
        "run --json: steps_controlled",
        "tests/algorithms/stages/passivity_controller_test.cpp",
        "PassivityController.ChangesARunOnlyIfItWouldCreateEnergy",
        "EXPECT_GT(held.controlled, 0u)",
        "EXPECT_EQ(held.controlled, 0u)",
    )
