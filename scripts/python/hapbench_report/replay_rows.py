"""Which recorded rows the replay shows, and the moments it jumps to."""
import math

SPANS = 500  # of a run; each keeps up to five rows
SETTLING_S = 0.05
LEAST_SETTLED_S = 1 / 30  # less tells nothing: the run hammers, and the metrics of settled contact are left out, too


def sizes(columns):
    """Size of the rendered force in every row [N]."""
    return [math.hypot(*f) for f in zip(*(columns[f"f{axis}_N"] for axis in "xyz"))]


def steps(columns):
    """Size of the change of the rendered force from the row before [N]; zero in the first."""
    forces = list(zip(*(columns[f"f{axis}_N"] for axis in "xyz")))
    return [0.0] + [math.dist(a, b) for a, b in zip(forces, forces[1:])]


def rows_to_show(columns):
    """All rows of a short run. Of a long one, in equal spans of rows, those of the least and the greatest force, of the
    greatest depth, and both ends of the largest step of the force: no peak is lost."""
    n = len(columns["time_s"])
    if n <= 4 * SPANS:
        return list(range(n))
    size, step, depth = sizes(columns), steps(columns), columns["depth_max_m"]
    kept = {0, n - 1}
    for i in range(SPANS):
        rows = range(n * i // SPANS, n * (i + 1) // SPANS)
        jump = max(rows, key=step.__getitem__)
        kept.update((min(rows, key=size.__getitem__), max(rows, key=size.__getitem__), max(rows, key=depth.__getitem__),
                     jump, max(0, jump - 1)))
    return sorted(kept)


def settled(columns, settling_s, from_s):
    """For every row, whether it is in contact and no landing: not within the settling time after a first touch, which is
    a contact at the start or after at least that time without one. `from_s`, where given, replaces that rule."""
    found, landed, last = [], None, -math.inf
    for time, colliding in zip(columns["time_s"], columns["colliding"]):
        if colliding > 0:
            if time - last >= settling_s or landed is None:
                landed = time
            last = time
        found.append(colliding > 0 and (time >= from_s if from_s is not None else time - landed >= settling_s))
    return found


def worst_moments(columns, scenario):
    """Where the settled force steps most, of a run that hardly settles the force of all its rows, and where the tool is
    deepest: title, time, value, unit."""
    chosen = scenario.get("metrics") if isinstance(scenario.get("metrics"), dict) else {}
    calm = settled(columns, chosen.get("settling_s", SETTLING_S), chosen.get("from_s"))
    times, step, depth = columns["time_s"], steps(columns), columns["depth_max_m"]
    rows = [i for i, yes in enumerate(calm) if yes]
    if len(times) < 2 or len(rows) * (times[1] - times[0]) < LEAST_SETTLED_S:
        rows = []
    title = "settled force step" if rows else "force step"
    jump = max(rows or range(len(times)), key=step.__getitem__)
    deepest = max(range(len(times)), key=depth.__getitem__)
    return [{"title": title, "time": times[jump], "value": step[jump], "unit": "N"},
            {"title": "depth", "time": times[deepest], "value": depth[deepest] * 1e3, "unit": "mm"}]
