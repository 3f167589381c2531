"""Results to report on, made afresh by the built program, and the report."""
import json
from functools import partial
from unittest import mock

from fixture import PROGRAM, SOURCE, hapbench, ran

from hapbench_report import __main__ as command

report = partial(ran, SOURCE / "scripts" / "report")  # the finished process
SCENARIOS = ("peg_in_hole_2d_mean", "single_spring")
SVG = ('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 90 60"><path d="M5 55 L45 5 L85 55" stroke="black"/></svg>')


def make_results(directory):
    """Short runs, and the replay's recordings."""
    for scenario in SCENARIOS:
        hapbench("run", scenario, "--quiet", "--out", directory / "thesis" / scenario)
    # Every third algorithm and a quarter of the long scene: the page takes what there is.
    few = [(scenario, ("time.duration_s=1.5",) if further else (), algorithms[::3]) for scenario, further, algorithms in command.REPLAYED]
    with mock.patch.object(command, "REPLAYED", few):
        command.record(PROGRAM, directory / "replay")


def make_figures(directory):
    directory.mkdir()
    entries = []
    for i, (title, thesis_figure) in enumerate((("Points", "4"), ("Springs", "A.4 (springs)"), ("Poles", "A.4 (root locus)"),
                                                ("Height", "7a–c"), ("Ours", None))):
        (directory / f"f{i}.svg").write_text(SVG, encoding="utf-8")
        entries.append({"id": f"f{i}", "title": title, "thesis_figure": thesis_figure, "caption": f"Caption {i}.",
                        "files": [f"f{i}.svg", f"f{i}.pdf"], "sources": ["thesis/single_spring/trajectory.csv", "spring_stiffness/limit.csv"] if i == 1 else []})
    (directory / "figures.json").write_text(json.dumps({"figures": entries}), encoding="utf-8")


def claim(verdict, **more):
    return {"id": "T1", "place": "3.3, Fig. 4", "claim": "Raw points", "published": "44.8 ± 19.9", "measured": "47.4",
            "rule": "within one standard deviation", "verdict": verdict, "why": "It is an input.",
            "sureness": "not sampled", **more}


def make_claims(file):
    verdicts = ("reproduced", "reproduced in kind", "not reproduced", "refuted", "not reproducible")
    claims = [claim(verdict, id=f"C{i}") for i, verdict in enumerate(verdicts)]
    claims[0] |= {"sureness": "steady", "robustness": {"holds": 64, "judged": 64}, "command": "hapbench reproduce --only C0", "seconds": 2.4,
                  "main": {"claim": "Few points are left", "published": "6.2", "ours": "6.3"}}
    claims[1] |= {"sureness": "fragile", "robustness": {"holds": 24, "judged": 64}}
    claims.append(claim("holds", id="C5", ours=True))
    claims[1] |= {"place": "A.3, Table A.2, Fig. A.5", "measured": "-1.2e-07 N, -0.5 to 2e+06", "scenarios": ["single_spring"]}
    claims[2] |= {"place": "A.2", "scenarios": ["single_spring", "not_among_these"]}
    file.write_text(json.dumps({"headline": "One verdict is steady.", "claims": claims}), encoding="utf-8")
