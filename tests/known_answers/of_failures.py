"""Known answers for runs that fail: the time at which they end, and the rules of the diagnosis."""
import json
import re

from answers import EXACT, ROUNDING, Table, scene
from fixture import PROGRAM, SOURCE, must
from physics import SPRING, SUMMED

STEP, SPEED, BOUND = (
    1e-3,
    1.0,
    0.0105,
)  # a mass that moves 1 mm per step exceeds the bound in step 11


@scene
def early_end(bench):
    """Checks the time at which a run ends because it diverges. A mass moves freely, because its spring is extremely
    soft, until its position exceeds the bound."""
    base = bench.scenario(
        "early_end",
        time={"step_s": STEP, "steps": 40},
        initial={"position_m": [0, 0, 0], "velocity_m_per_s": [SPEED, 0, 0]},
        environment=SPRING,
        rendering={**SUMMED, "stiffness_N_per_m": 1e-6},
        bounds={"position_m": BOUND},
        expect={"outcome": "completes"},
    )
    ended = 11 * STEP
    bench.hapbench(
        "compare",
        base,
        "--algorithms",
        "summation,mean",
        "--out",
        "both",
        "--quiet",
        statuses=(0, 3),
    )
    compared = Table(bench.folder / "both" / "comparison.csv")
    bench.hapbench(
        "sweep",
        base,
        "--vary",
        "rendering.mass_kg=0.1,0.2",
        "--out",
        "swept",
        "--quiet",
        statuses=(0, 3),
    )
    swept = Table(bench.folder / "swept" / "sweep.csv")
    full = bench.run(base, statuses=(0, 3))
    for field, found, known in (
        ("comparison.csv:ended_at_s", compared["ended_at_s"], [ended] * 2),
        ("sweep.csv:ended_at_s", swept["ended_at_s"], [ended] * 2),
    ):
        bench.add(
            field,
            found,
            known,
            "a mass that moves 1 mm in a step, and a bound of 10.5 mm",
            ROUNDING,
            ("the planned end", [40 * STEP] * 2),
        )
    bench.add(
        "run --json: ended_at_s",
        full.summary["ended_at_s"],
        None,
        "a single run is not a batch, and makes all steps that it can",
        EXACT,
        ("of a batch", ended),
    )


@scene
def rules_of_the_diagnosis(bench):
    """Checks that a test in C++ tests each rule of the diagnosis, on a scene with the fault and on a scene without
    it."""
    text = (SOURCE / "tests/scenarios/run/diagnosis_test.cpp").read_text(encoding="utf-8")
    table = re.search(r"std::vector<Pair> pairs\(\) {(.*?)\n}", text, re.S)[1]
    test = re.search(
        r"TEST\(Diagnosis, EachRuleFindsItsFaultAndIsSilentWithout\) {(.*?)\n}", text, re.S
    )[1]
    words = json.loads(must(PROGRAM, "describe", "words", "--json"))["words"]
    for word in words:
        if word["kind"] != "rule of the diagnosis":
            continue
        name = word["name"]
        scenes = re.search(rf'\{{"{name}",\s*(.*?)\}}(?:,|\n|;)\s*(?:\{{"|\}})', table, re.S)
        in_test = f'"{name}"' in test
        bench.add(
            f"{name} (rule of the diagnosis)",
            bool(scenes) or in_test,
            True,
            "the test Diagnosis.EachRuleFindsItsFaultAndIsSilentWithout",
            EXACT,
            ("a rule that no scene tests", f'"{name}_of_no_scene"' in text),
        )
