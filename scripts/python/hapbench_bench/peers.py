"""Other collision libraries at the poses of our searches, in one process with them."""
import datetime
import json
import statistics

from .measure import rounded
from .program import ROOT, BenchError, listed, measured, say
from .table import number, quantity

RECORD = ROOT / "results" / "reference" / "peers.json"
BEGIN = "<!-- peers: scripts/bench --peers --record writes what follows, from results/reference/peers.json -->"
END = "<!-- /peers -->"
PACKAGES = "libcgal-dev, libfcl-dev, libbullet-dev, libode-dev"

TASKS = ("T1", "T2", "T3")
REPETITIONS = 9
# Name of a library, its answer, and the benchmark of ours that compares: the search alone, or with depths.
LIBRARIES = {
    "cgal_kd_tree": ("CGAL, k-d tree of the points", "the same points", "hapbench"),
    "fcl": ("FCL, OBB-RSS tree of triangles", "triangles, a depth each", "hapbench_with_depths"),
    "bullet": ("Bullet, box tree of triangles", "triangles, a depth each", "hapbench_with_depths"),
    "ode": ("ODE, OPCODE tree of triangles", "triangles, a depth each", "hapbench_with_depths"),
}


def seconds(entry):
    """Time for one pose; a repetition goes through all."""
    return entry["cpu_s"] / entry["poses"]


def row(library, task, found):
    """The library over ours: the median of the pairs' ratios and their quartiles."""
    theirs, ours = found[f"peers/{library}/{task}"], found[f"peers/{LIBRARIES[library][2]}/{task}"]
    low, middle, high = statistics.quantiles([seconds(a) / seconds(b) for a, b in zip(theirs, ours)], n=4, method="inclusive")
    first = theirs[0]
    return {"library": library, "task": task, "ratio": rounded(middle), "low": rounded(low), "high": rounded(high),
            "seconds": rounded(statistics.median(map(seconds, theirs))),
            "our_seconds": rounded(statistics.median(map(seconds, ours))),
            "contacts": rounded(first["contacts"]), "our_contacts": rounded(ours[0]["contacts"]),
            "poses_agreed": rounded(first["agree"]), "depth_m": rounded(first["depth_m"]), "our_depth_m": rounded(first["our_depth_m"])}


def measure(program):
    names = listed(program)
    libraries = [library for library in LIBRARIES if f"peers/{library}/T1" in names]
    if not libraries:
        raise BenchError(f"--peers: none of the libraries is here; allowed: with any of {PACKAGES}")
    rows = []
    for task in TASKS:
        say(f"{', '.join(libraries)} in {task}")
        mine = sorted({LIBRARIES[library][2] for library in libraries})
        context, found = measured(program, [f"peers/{name}/{task}" for name in [*mine, *libraries]], repetitions=REPETITIONS)
        rows += [row(library, task, found) for library in libraries]
    return {"commit": context["commit"], "date": datetime.date.today().isoformat(), "cpu": context["cpu"],
            "compiler": context["compiler"], "repetitions": REPETITIONS, "rows": rows}


def depths(row):
    """The library's mean largest depth and ours; nothing of a library that gives none."""
    return f"{1e6 * row['depth_m']:.0f}, {1e6 * row['our_depth_m']:.0f} µm" if row["depth_m"] else ""


def markdown(peers):
    """How many times as long as ours each takes for a pose."""
    by_task = {(row["library"], row["task"]): row for row in peers["rows"]}
    libraries = list(dict.fromkeys(row["library"] for row in peers["rows"]))
    lines = [f"{peers['cpu']}, {peers['compiler']}; commit {peers['commit']}, {peers['date']}.", "",
             f"| library | answers | {' | '.join(TASKS)} | contacts, ours | depth, ours |", "|---|---|" + "---|" * (len(TASKS) + 2)]
    for library in libraries:
        name, answers, _ = LIBRARIES[library]
        cells = [f"{number(by_task[library, task]['ratio'])} ×" for task in TASKS]
        last = by_task[library, TASKS[-1]]
        lines.append(f"| {name} | {answers} | {' | '.join(cells)} | {last['contacts']:.0f}, {last['our_contacts']:.0f} | {depths(last)} |")
    ours = [quantity(by_task[libraries[-1], task]["our_seconds"], "s") for task in TASKS]
    lines += ["", f"One × is {', '.join(ours)} of our search with depths at a pose of {', '.join(TASKS)}; of the search alone",
              "for the library that answers our question."]
    return "\n".join(lines) + "\n"


def record():
    """The record of scripts/bench --peers --record."""
    return json.loads(RECORD.read_text(encoding="utf-8"))
