"""Tests scripts/report without a browser, on results that the built program computes."""
import base64
import json
import re
import unittest
from array import array
from functools import partial
from unittest import mock

from fixture import PROGRAM, SOURCE, assert_whole, hapbench, ran, scratch_folder

from hapbench_report import __main__ as command
from hapbench_report.recording import CONTACT_COLUMNS, MEASURED_COLUMNS, Recording
from hapbench_report.replay import replays
from hapbench_report.runs import load_runs

report = partial(ran, SOURCE / "scripts" / "report")  # returns the finished process
SCENARIOS = ("peg_in_hole_2d_mean", "single_spring")
SVG = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 90 60"><path d="M5 55 L45 5 L85 55" stroke="black"/></svg>'


def make_results(directory):
    """Computes short runs for the report, and the recordings of its replay."""
    for scenario in SCENARIOS:
        hapbench("run", scenario, "--quiet", "--out", directory / "thesis" / scenario)
    # Record only every third algorithm, and a quarter of the duration of the long scene. The page shows the runs that
    # exist.
    few = [
        (scenario, ("time.duration_s=1.5",) if further else (), algorithms[::3])
        for scenario, further, algorithms in command.REPLAYED
    ]
    with mock.patch.object(command, "REPLAYED", few):
        command.record(PROGRAM, directory / "replay")


def make_figures(directory):
    directory.mkdir()
    entries = []
    for i, (title, thesis_figure) in enumerate(
        (
            ("Points", "4"),
            ("Springs", "A.4 (springs)"),
            ("Poles", "A.4 (root locus)"),
            ("Height", "7a–c"),
            ("Ours", None),
        )
    ):
        (directory / f"f{i}.svg").write_text(SVG, encoding="utf-8")
        entries.append(
            {
                "id": f"f{i}",
                "title": title,
                "thesis_figure": thesis_figure,
                "caption": f"Caption {i}.",
                "files": [f"f{i}.svg", f"f{i}.pdf"],
                "sources": ["thesis/single_spring/trajectory.csv", "spring_stiffness/limit.csv"]
                if i == 1
                else [],
            }
        )
    (directory / "figures.json").write_text(json.dumps({"figures": entries}), encoding="utf-8")


def claim(verdict, **more):
    return {
        "id": "T1",
        "place": "3.3, Fig. 4",
        "claim": "Raw points",
        "published": "44.8 ± 19.9",
        "measured": "47.4",
        "rule": "within one standard deviation",
        "verdict": verdict,
        "why": "It is an input.",
        "robustness": "not sampled",
        "number": "47",
        "published_short": "44.8",
        **more,
    }


def make_claims(file):
    verdicts = (
        "replicated",
        "qualitatively replicated",
        "not replicated",
        "contradicted",
        "not testable",
    )
    claims = [claim(verdict, id=f"C{i}") for i, verdict in enumerate(verdicts)]
    claims[0] |= {
        "robustness": "robust",
        "command": "hapbench reproduce --only C0",
        "seconds": 2.4,
        "published_short": "6.2",
        "number": "6.3",
    }
    claims[1] |= {"robustness": "sensitive to local.average"}
    claims.append(claim("holds", id="C5", ours=True))
    claims[1] |= {
        "place": "A.3, Table A.2, Fig. A.5",
        "measured": "-1.2e-07 N, -0.5 to 2e+06",
        "scenarios": ["single_spring"],
    }
    claims[2] |= {"place": "A.2", "scenarios": ["single_spring", "not_among_these"]}
    file.write_text(
        json.dumps(
            {
                "headline": "One verdict is robust.",
                "abstract": [{"sentence": "Few points are left", "claims": ["C0"]}],
                "claims": claims,
            }
        ),
        encoding="utf-8",
    )


def setUpModule():
    WithResults.root = root = scratch_folder(unittest)
    WithResults.results, WithResults.figures, WithResults.claims = (
        root / "results",
        root / "figures",
        root / "claims.json",
    )
    make_results(WithResults.results)
    make_figures(WithResults.figures)
    make_claims(WithResults.claims)


class WithResults(unittest.TestCase):
    def page(self, *words, results=None):
        out = self.root / "page.html"
        done = report(results or self.results, "--out", out, *words)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return out.read_text(encoding="utf-8")


class Page(WithResults):
    def test_it_is_whole_and_the_same_every_time(self):
        page = self.page("--figures", self.figures, "--claims", self.claims)
        self.assertEqual(page, self.page("--figures", self.figures, "--claims", self.claims))
        self.assertEqual(
            re.findall(r'<section id="(\w+)"', page),
            ["summary", "ledger", "replay", "figures", "rerun", "provenance"],
        )
        self.assertIsNone(re.search(r"@import|url\(|fetch\(|XMLHttpRequest", page))
        assert_whole(self, page)

    def test_claims_and_figures_lead_to_each_other(self):
        page = self.page("--figures", self.figures, "--claims", self.claims)
        links = lambda start, end: set(
            re.findall(r'href="#([^"]+)"', page[page.index(start) :].split(end)[0])
        )
        for id_, expected in (("C0", {"figure-f0"}), ("C1", {"figure-f1"}), ("C2", {"figure-f1"})):
            self.assertEqual(links(f'id="claim-{id_}"', "</tr>"), expected | {f"claim-{id_}"}, id_)
        self.assertEqual(links('id="figure-f1"', "</figure>"), {"claim-C1", "claim-C2"})
        # The summary links to the claims that are not confirmed. Findings of this project are in a separate table.
        self.assertEqual(links("do not confirm", "</ul>"), {"claim-C2", "claim-C3"})
        self.assertIn("claim-C5", links('id="findings-table"', "</table>"))
        self.assertNotIn("claim-C5", links('id="ledger-table"', "</table>"))

    def test_markup_in_the_input_is_text_in_the_page(self):
        hostile = '</script><script>alert(1)</script><img src="https://example.org/x">'
        results, figures = self.root / "hostile", self.root / "hostile figures"
        (results / "run").mkdir(parents=True)
        (results / "run" / "summary.json").write_text(
            json.dumps(
                dict.fromkeys(("name", "algorithm", "state_hash"), hostile)
                | {"outcome": "completes", "provenance": {"commit": hostile}}
            )
        )
        figures.mkdir()
        (figures / "f.svg").write_text("<svg xmlns='http://www.w3.org/2000/svg'/>")
        (figures / "figures.json").write_text(
            json.dumps(
                [
                    dict.fromkeys(("id", "title", "caption", "thesis_figure"), hostile)
                    | {"files": ["f.svg"], "sources": [hostile]}
                ]
            )
        )
        claims = self.root / "hostile.json"
        claims.write_text(
            json.dumps({"claims": [{k: hostile for k in claim("")} | {"verdict": "contradicted"}]})
        )
        page = self.page("--figures", figures, "--claims", claims, results=results)
        self.assertFalse("<script>alert" in page or '<img src="https' in page)

    def test_packing_keeps_contacts_to_half_a_step_and_tensors_give_the_ratios(self):
        runs = load_runs(self.results / "replay")
        for scene in replays(runs, [run.path for run in runs]):
            for packed in scene["recordings"]:
                recording = Recording(next(run for run in runs if run.path == packed["label"]))
                flat = [
                    value
                    for contacts in recording.contacts
                    for contact in contacts
                    for value in contact[: len(CONTACT_COLUMNS)]
                ]
                steps, scales = (
                    array("h", base64.b64decode(packed["contacts"])),
                    packed["contactScales"],
                )
                self.assertEqual((len(steps), len(scales)), (len(flat), len(CONTACT_COLUMNS)))
                for i, (step, value) in enumerate(zip(steps, flat)):
                    # The tolerance is half a quantisation step, plus the rounding of the division.
                    self.assertLessEqual(
                        abs(step * scales[i % len(scales)] - value),
                        0.5001 * scales[i % len(scales)],
                    )
                for row, (xx, xy, xz, yy, yz, zz), contacts in zip(
                    recording.rows(), recording.tensors, recording.contacts
                ):
                    ratios = [
                        xx * x * x
                        + yy * y * y
                        + zz * z * z
                        + 2 * (xy * x * y + xz * x * z + yz * y * z)
                        for x, y, z in (contact[4:7] for contact in contacts)
                    ]
                    if ratios:
                        smallest, largest = (
                            dict(zip(MEASURED_COLUMNS, row))[name]
                            for name in ("ratio_min", "ratio_max")
                        )
                        # The two sums of n products are added in different orders. Each has at most n rounding errors
                        # of partial sums below the largest ratio.
                        tolerance = 2 * (len(contacts) + 10) * 2.0**-53 * max(1.0, largest)
                        self.assertAlmostEqual(min(ratios), smallest, delta=tolerance)
                        self.assertAlmostEqual(max(ratios), largest, delta=tolerance)


class BadInput(WithResults):
    def test_what_is_wrong_is_named_and_nothing_written(self):
        bad = self.root / "bad"
        (bad / "results" / "run").mkdir(parents=True)
        summary, claims, figures = (
            bad / "results" / "run" / "summary.json",
            bad / "claims.json",
            bad / "figures.json",
        )
        of_claims, of_figures = (self.results, "--claims", claims), (self.results, "--figures", bad)
        for file, text, words, message in (
            (summary, "{", (bad / "results",), "not JSON"),
            (
                summary,
                '{"metrics": []}',
                (bad / "results",),
                "/metrics: got []; allowed: an object",
            ),
            (claims, '{"claims": [1]}', of_claims, "/claims/0: got 1; allowed: an object"),
            (
                claims,
                json.dumps({"claims": [claim("maybe")]}),
                of_claims,
                '/claims/0/verdict: got "maybe"; allowed: "contradicted"',
            ),
            (
                figures,
                '[{"files": ["../secret.svg"]}]',
                of_figures,
                "allowed: an SVG file beside it",
            ),
            (figures, "{}", (self.figures,), "holds no summary.json"),
        ):
            file.write_text(text)
            done = report(*words, "--out", self.root / "refused" / "page.html")
            self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
            self.assertIn(message, done.stderr)
            self.assertFalse((self.root / "refused").exists())
