"""The page and the figure, from predictions."""
import math

import numpy as np

from .judge import COVERAGE, SHARE, points_of, verdict
from .predict import SEEDS, largest_error

HEAD = """# How far to believe a number

This page says what each claim of accuracy of hapbench rests on, in the plain words of ASME V&V 40's factors, and compares
predicted limits with those that others measured on hardware. `scripts/validation` makes all of it: verdicts follow from
rules, and nobody edits them.

## Context of use

**Question**: which force algorithm, stiffness, damping and rate does a haptic scene take on a device, before there is one?
**Role**: hapbench orders candidates and explains them; measurements on the device decide. **If it is wrong**: a prototype
vibrates at its first contact, or a good setting is never tried. It moves nobody's hand, and controls no machine.

## What the claims rest on

| claim | is the code right? | are the numbers converged? | does hardware agree? | how much do inputs matter? |
|---|---|---|---|---|
| forces and stiffness of the algorithms | [known answers](../../tests/known_answers/README.md), [claims of the thesis](../thesis_claims/README.md) | `compare --errors`, `converge` | the thesis's own figures; no other measurement | `sweep --sample`; [claims](../thesis_claims/README.md) sampled over choices that are ours |
| motion of the tool in time | [observed orders](../../tests/verification/README.md), closed forms in [known answers](../../tests/known_answers/README.md) | [run time against error](../studies/README.md#run-time-against-error), `converge` | no | `converge`, `sweep` |
| limits of stability, linear | eigenvalues and polynomials, `tests/device_model/linear_loops_test.cpp` | bisection to a stated width | see below | [maps](../studies/README.md#stability) |
| limits of an impedance device at a wall | exact maps, elastic transmission included: `tests/device_model/linear_loops_test.cpp`, `tests/device_model/elastic_motion_test.cpp` | the handle moves exactly between samples | **cases below** | intervals below: dry friction, delay, damping, press, tremor; of presets `limit --device` has both ends |
| limits of an admittance device | `tests/device_model/admittance_device_test.cpp` | `limit` to a stated width | **no measured limit was found** | [maps](../studies/README.md#stability) |
| dry friction between tool and surface | [known answers](../../tests/known_answers/README.md) | `converge` | no | `sweep` |
| a device identified from its log | an independent simulator, `tests/scripts/identify_test.py` | exact integration | no log of hardware was available | 95 % intervals with every number |
| what people feel | not claimed | - | - | - |

## Measured and predicted

Measured: the stiffness K of a wall at which the device vibrates, for each damping B of the wall. Predicted: `hapbench limit`
for samples of every input that was not published (ranges below); the period T_u of what vibrates is that just beyond the
predicted limit. The finger trembles: each sample has a session (seed) of its own. A session of measuring
scatters by a factor of {scatter:g}, and a prediction is a session too, so two of one setting differ by {apart:.2f}, in the logarithm
the square root of two more. Fitted cases keep the samples whose whole curve is as close as that (rms); judged cases are
predicted with those samples in {seeds} new sessions each, and nothing is fitted to them. Error: ln(median predicted / measured). Its uncertainty combines the
scatter, the rounding of readings, the spread of the samples and the bisection (ASME V&V 20); a point is within where the
error is at most {coverage:g} of it. A curve agrees where {share:.0%} of its points are; "weakly" says that what
was not published leaves more open than measuring does, so that the case tests less than its measurement could.

![Measured and predicted K over B](validation.svg)

"""

NOT_FOR = """
## Where it applies

- Scenes, algorithms and devices within the ranges of the tests linked above; devices and settings like those of the cases
  that agree. A verdict holds for its case: a stronger filter, a slower loop or another hand is another case.
- Ratios of algorithms on one device rest on the same device model in both and are safer than any absolute K.

## What it is not for

- The K of a real device without its own numbers: dry friction and the hand's press alone move K by factors of ten
  (`limit --device` has both ends). Measure them with `hapbench identify`, then read K as that of one approach.
- Devices with more than one resonance within the band (`device.transmission` is one spring between motors and handle, and no
  preset has one, because none is published), position estimators other than low-passes, amplifiers with dynamics of their own,
  dry friction that depends on place or history.
- What people feel, learn or tolerate; safety of a person; certification of a device.
"""


def judged(data, cases, recorded):
    """(case, its record, points, word, sentence) of each case."""
    for name, case in cases.items():
        record = recorded["cases"][name]
        points = points_of(case, record["edges"], recorded["resolution"])
        reached = recorded["cases"][case.fit].get("reached", True)
        yield (case, record, points, *verdict(case, points, reached))


def page(data, cases, recorded):
    text = HEAD.format(scatter=data["scatter"], apart=math.exp(largest_error(data["scatter"])), seeds=SEEDS, coverage=COVERAGE, share=SHARE)
    text += "| case | what | role | predicted / measured, geometric mean (least ... largest) | verdict |\n|---|---|---|---|---|\n"
    results = list(judged(data, cases, recorded))
    for case, record, points, word, sentence in results:
        errors = np.array([point.error for point in points])
        role = "fitted" if case.role == "fitted" else f"judged with the fit of {case.fit}"
        text += (f"| {case.name} | {case.title} | {role} | {math.exp(errors.mean()):.2f} ({math.exp(errors.min()):.2f} ... "
                 f"{math.exp(errors.max()):.2f}) | **{word}**: {sentence} |\n")
    for case, record, points, word, sentence in results:
        if case.role == "fitted":
            best, worst = min(record["rms_factors"]), max(record["rms_factors"])
            text += f"\nFit of {case.name}: {len(record['samples'])} of {record['tried']} samples kept, rms error x{best:.2f} ... x{worst:.2f}.\n"
        elif not case.more and len(record["edges"]) == SEEDS * len(recorded["cases"][case.fit]["edges"]):
            sessions = np.log(np.maximum(record["edges"], 0.5 * case.reading)).reshape(SEEDS, -1)  # a row for each session of all inputs
            between = math.exp(math.sqrt(float(np.mean(sessions.var(axis=0, ddof=1)))))
            text += f"\n{case.name}: predicted K scatters by x{between:.2f} between sessions of the same inputs, by the tremor's phases alone.\n"
    text += f"\nScatter: {data['scatter_source']}. Citations: " + "; ".join(f"[{n}] {c}" for n, c in data["citations"].items()) + ".\n"
    for case, record, points, word, sentence in results:
        units = f"K in {case.unit_name}; B in the same per s" if case.quantity == "stiffness" else f"T_u in {case.unit_name}"
        text += f"\n### {case.name}: {case.title}\n\nMeasured: {case.source}. {units}.\n\n"
        text += "| B | measured | predicted (samples) | not fitted | error / uncertainty |\n|---|---|---|---|---|\n"
        for point, never in zip(points, np.array(record["unfitted_edges"]).T):
            text += (f"| {point.B:g} | {point.measured:g} | {point.predicted:.2g} ({point.low:.2g} ... {point.high:.2g}) | "
                     f"{never.min():.2g} ... {never.max():.2g} | {point.error / point.uncertainty:+.1f}{'' if point.within else ' **out**'} |\n")
    text += "\n## What was published, and what is drawn\n"
    for name, device in data["devices"].items():
        text += f"\n**{name}**: {device['published']}. Drawn:\n\n| field | range | why |\n|---|---|---|\n"
        own = {field: given for case in cases.values() if case.device == name for field, given in case.more.items()}
        for field, (low, high, kind, why) in (device["unpublished"] | own).items():
            text += f"| `{field}` | {low:g} {'or' if kind == 'either' else '...'} {high:g}{' (log)' if kind == 'log' else ''} | {why} |\n"
    text += NOT_FOR
    text += (f"\n## Do it again\n\n    scripts/validation --program build/release/bin/hapbench\n"
             f"    hapbench limit epfl_paddle.json --vary rendering.stiffness_N_per_m --between 200:400000    # "
             f"in this folder\n\nPredicted by {recorded['program']}. Cases and ranges: [data/cases.json](data/cases.json); rules: "
             "`scripts/python/hapbench_validation`.\n")
    return text


def figure(data, cases, recorded):
    from hapbench_style import AMBER, PALE, PETROL, SAND, SETTINGS, panels, picture, plt
    plt.rcParams.update(SETTINGS)
    rows = len(cases) // 4 + 1  # the legend has a place of its own, too
    figure, axes = panels(rows, 4, 2.3 * rows)
    for ax in axes.flat[len(cases):]:
        ax.set_axis_off()
    for ax, (case, record, points, word, _) in zip(axes.flat, judged(data, cases, recorded)):
        B = [point.B for point in points]
        never = np.array(record["unfitted_edges"])
        marks = {"marker": "_", "ms": 9, "ls": "none"} if len(B) == 1 else {}
        if len(B) > 1:
            ax.fill_between(B, never.min(axis=0), never.max(axis=0), color=SAND, lw=0, label="not fitted")
            ax.fill_between(B, [p.low for p in points], [p.high for p in points], color=PALE, lw=0, label="samples kept")
        else:
            ax.vlines(B, [p.low for p in points], [p.high for p in points], color=PALE, lw=8)
        ax.plot(B, [p.predicted for p in points], color=PETROL, label="predicted", **marks)
        factor = case.scatter
        ax.errorbar(B, case.K, yerr=[[k - k / factor for k in case.K], [k * factor - k for k in case.K]], fmt="o", color=AMBER, ms=3, lw=0.8,
                    label=f"measured, x{factor:g}")
        ax.set_yscale("log")
        ax.set_title(f"{case.name}: {word}")
        ax.set_ylabel(f"{'K' if case.quantity == 'stiffness' else 'T_u'} [{case.unit_name}]")
        if len(B) == 1:
            ax.set_xticks([])
        else:
            ax.set_xlabel("B [the same, per s]")
    axes.flat[-1].legend(*axes[0][0].get_legend_handles_labels(), loc="center")
    return picture(figure, "svg")
