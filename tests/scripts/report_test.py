"""scripts/report, without a browser."""
import base64
import functools
import json
import random
import re
import shutil
import unittest
from array import array
from dataclasses import replace
from unittest import mock

from fixture import SOURCE, main, scratch_folder
from report_fixture import claim, make_claims, make_figures, make_results, report

from hapbench_report import replay
from hapbench_report.markup import column, number, strip, typeset
from hapbench_report.recording import CONTACT_COLUMNS, MEASURED_COLUMNS, Recording
from hapbench_report.thesis import figure_labels



def setUpModule():
    WithResults.root = root = scratch_folder(unittest)
    WithResults.recorded, WithResults.results = root / "recorded", root / "results"
    WithResults.figures, WithResults.claims = root / "figures", root / "claims.json"
    # Every third algorithm and a quarter of the long scene: the page takes what there is.
    few = [replace(scene, algorithms=scene.algorithms[::3], settings=("time.duration_s=1.5",) if scene.settings else ())
           for scene in replay.SCENES]
    with mock.patch.object(replay, "SCENES", few):
        make_results(WithResults.recorded)
    shutil.copytree(WithResults.recorded, WithResults.results, ignore=shutil.ignore_patterns("replay"))
    make_figures(WithResults.figures)
    make_claims(WithResults.claims)


class WithResults(unittest.TestCase):
    """`recorded` are the results; `results` are they without the recordings to replay, which take long to pack."""

    def page(self, *words, results=None):
        out = self.root / "page.html"
        done = report(results or self.results, "--out", out, *words)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return out.read_text(encoding="utf-8")

    def written_full_page(self):
        return self.page("--figures", self.figures, "--claims", self.claims, results=self.recorded)

    @staticmethod
    @functools.cache
    def full_page():
        return WithResults().written_full_page()


class Page(WithResults):
    def test_same_input_gives_the_same_bytes(self):
        self.assertEqual(self.full_page(), self.written_full_page())

    def test_refers_to_nothing_outside_itself(self):
        page = self.full_page()
        self.assertLess(len(page.encode()), 8_000_000)
        for reference in re.findall(r'(?:src|href)="([^"]*)"', page):
            self.assertRegex(reference, r"^(#|data:)")
        self.assertNotRegex(page, r"@import|url\(|fetch\(|XMLHttpRequest")

    def test_links_lead_to_something(self):
        page = self.full_page()
        names = re.findall(r'\bid="([^"]+)"', page)
        self.assertEqual(len(names), len(set(names)))
        self.assertLessEqual(set(re.findall(r'href="#([^"]+)"', page)), set(names))

    def part(self, page, start, end):
        return page[page.index(start):].split(end)[0]

    def links_of(self, page, start, end):
        return re.findall(r'href="#([^"]+)"', self.part(page, start, end))

    def test_claims_figures_and_runs_lead_to_each_other(self):
        page = self.full_page()
        run = "run-thesis-single-spring"
        for claim_, expected in (("C0", {"figure-f0"}), ("C1", {"figure-f1", "thesis-table-a-2-appendix-a-", run}),
                                 ("C2", {"figure-f1", run})):
            found = {target.rstrip("-") for target in self.links_of(page, f'id="claim-{claim_}"', "</tr>")}
            self.assertEqual(found, {target.rstrip("-") for target in expected} | {f"claim-{claim_}"}, claim_)
            self.assertIn(f"hapbench reproduce --only {claim_}", self.part(page, f'id="claim-{claim_}"', "</tr>"))
        self.assertEqual(self.links_of(page, 'id="figure-f0"', "</figure>"), ["claim-C0", "claim-C3", "claim-C4", "claim-C5"])
        self.assertEqual(self.links_of(page, 'id="figure-f1"', "</figure>"),
                         ["claim-C1", "claim-C2", run, run, "thesis-a-3"])
        self.assertEqual(self.links_of(page, f'id="{run}"', "</details>"), ["claim-C1", "claim-C2", "figure-f1"])
        self.assertIn("<code>not_among_these</code>", self.part(page, 'id="claim-C2"', "</tr>"))
        # The summary leads to the claims that are not confirmed.
        self.assertEqual(self.links_of(page, "do not confirm", "</ul>"), ["claim-C2", "claim-C3"])

    def test_numbers_are_typeset(self):
        page = self.full_page()
        self.assertIn("−1.2 × 10⁻⁷ N, −0.5 to 2 × 10⁶", page)
        for given, shown in (("t = -0.3, K-1", "t = −0.3, K-1"), ("(-22, 10)", "(−22, 10)"), ("1e-9", "1 × 10⁻⁹"),
                             ("a-3", "a-3"), ("3-5", "3-5"), ("<", "&lt;"), ("1.5e+12x", "1.5e+12x")):
            self.assertEqual(typeset(given), shown)
        for given, shown in ((2740.4, "2740"), (-0.00012, "−0.00012"), (1e-9, "1 × 10⁻⁹"), (123456.7, "123500"), (None, "–")):
            self.assertEqual(number(given), shown)

    def test_studies_are_folded_and_name_their_units(self):
        study = self.results / "study" / "study_x.csv"
        study.parent.mkdir()
        self.addCleanup(shutil.rmtree, study.parent)
        study.write_text("setting,error_rms_m,length_m,seconds_per_step,force_max_N,kept_mean\na,0.0002,0.5,1e-6,3,2\n")
        page = self.page()
        section = self.part(page, '<section id="studies"', "</section>")
        self.assertEqual(section.count("<table"), section.count("<details"))
        heads = [strip(head.replace("<br>", "|")) for head in re.findall(r"<th [^>]*>(.*?)</th>", section)]
        self.assertEqual(heads, ["setting", "error rms|mm", "length|m", "time of a step|µs", "force max|N", "kept mean"])
        self.assertEqual([strip(cell_) for cell_ in re.findall(r"<td[^>]*>(.*?)</td>", section)], ["a", "0.2", "0.5", "1", "3", "2"])

    def test_the_credibility_page_is_a_section_whose_lines_lead_to_what_is_behind_them(self):
        section = self.part(self.full_page(), '<section id="credibility"', "</section>")
        markdown = (SOURCE / "scenarios" / "validation" / "README.md").read_text(encoding="utf-8")
        for words in re.findall(r"\*\*(agrees, weakly|agrees|fails|fit fails|fitted|not judged)\*\*", markdown):
            self.assertIn(f"<b>{words}</b>", section)
        claims = [line for line in markdown.split("## What the claims rest on")[1].split("\n## ")[0].split("\n") if line.startswith("| ")][1:]
        rows = re.findall(r"<tr role=\"row\">(.*?)</tr>", section.split("What the claims rest on")[1].split("</table>")[0])[1:]
        self.assertEqual(len(rows), len(claims))
        for claim_, row in zip(claims, rows):
            self.assertIn(strip(row.split("</td>")[0]).strip(), claim_)
            self.assertTrue("not claimed" in row or "href=" in row or "<code>" in row, row)
        for path in re.findall(r"<code class=file>([^<]+)</code>", section):
            self.assertTrue((SOURCE / path).exists(), path)
        self.assertNotRegex(strip(section), r"\*\*|\]\(|^\|")

    def test_cells_of_cards_carry_their_headings(self):
        rows = self.part(self.full_page(), 'id="ledger-table"', "</table>").split("<tr")[2:]
        for row in rows:
            self.assertEqual(re.findall(r'data-label="([^"]+)"', row),
                             ["Id", "Verdict", "Claim", "Published", "Measured", "Robustness"])

    def test_every_verdict_and_every_run_is_there(self):
        page = self.full_page()
        for text in ("✓ reproduced", "≈ reproduced in kind", "✗ not reproduced", "⊘ refuted", "– not reproducible",
                     "hapbench run single_spring --out thesis/single_spring", "Caption 3."):
            self.assertIn(text, page)
        for file in self.results.glob("thesis/*/summary.json"):
            self.assertIn(json.loads(file.read_text())["provenance"]["scenario_hash"], page)

    def test_the_ledger_tells_how_robust_its_verdicts_are(self):
        page = self.full_page()
        for text in ("steady: 64 of 64<", "fragile: 24 of 64<", "not sampled<", "One verdict is steady."):
            self.assertIn(text, page)
        # What is contradicted comes first.
        self.assertLess(page.index('id="claim-C3"'), page.index('id="claim-C0"'))
        for text in ("Few points are left", "hapbench reproduce --only C0", "<td>2</td>"):
            self.assertIn(text, self.part(page, 'id="main-results"', "</table>"))
        # What was found on the way is counted apart.
        self.assertIn('id="claim-C5"', self.part(page, 'id="findings-table"', "</table>"))
        self.assertNotIn('id="claim-C5"', self.part(page, 'id="ledger-table"', "</table>"))

    def test_every_choice_on_record_is_there(self):
        choices = self.root / "choices.json"
        choices.write_text(json.dumps({"choices": [
            {"id": "hand.angle", "what": "its direction", "thesis": "silent", "value": 0.5, "unit": "rad", "range": [0, 0.9],
             "scale": "log", "chosen": "after", "why": "none"},
            {"id": "density", "value": "binary", "options": ["binary", "smooth"]}, {"id": "odd", "options": 1, "range": 2}]}))
        page = self.page("--choices", choices)
        for text in ("its direction", "0.5 rad", "0 to 0.9, log", "binary, smooth", "odd"):
            self.assertIn(text, page)

    def test_the_index_tells_figures_of_the_same_number_apart(self):
        page = self.full_page()
        for title, target in (("Springs without limits", "figure-f1"), ("Root locus of the leapfrog step", "figure-f2"),
                              ("Task 2 against the ideal trajectory", "figure-f3")):
            row = page[re.search(rf"<td[^>]*>{title}</td>", page).start():].split("</tr>")[0]
            self.assertEqual(re.findall('href="#([^"]+)"', row), [target])

    def test_without_figures_claims_and_replay_says_so(self):
        bare = self.root / "bare"
        shutil.copytree(self.results / "thesis", bare / "thesis")
        done = report(bare)
        self.assertEqual(done.returncode, 0, done.stderr)
        page = strip((bare / "report.html").read_text(encoding="utf-8"))
        for text in ("No ledger was given", "No figures were given", "No recorded runs were given", "No studies among"):
            self.assertIn(text, page)

    def test_targets_stand_beside_the_published_ones(self):
        rate = round(random.Random(7).uniform(0.1, 0.9), 3)
        measures = {"success_rate": {"mean": rate, "standard_error": 0.0625, "subjects": 6}}
        self.add_run("vertical_peg_in_hole_original_averaging", {"targets": {"1": measures}})
        page = self.page()
        table = page[page.index('id="thesis-table-a-1-appendix-d"'):].split("</table>")[0]
        rows = [strip(row) for row in table.split("<tr>")]
        row = next(row for row in rows if row.startswith("Success rate"))
        self.assertIn("0.32 ± 0.09", row)
        self.assertIn(f"{rate} ± 0.062", row)
        self.assertIn("0.97 ± 0.02", row)

    def test_markup_in_the_input_is_text_in_the_page(self):
        hostile = '</script><script>alert(1)</script><img src="https://example.org/x">'
        self.add_run("hostile", {"name": hostile, "algorithm": hostile, "outcome": hostile,
                                 "provenance": {"commit": hostile}, "state_hash": hostile},
                     {"description": hostile, hostile: hostile})
        figures = self.root / "hostile figures"
        figures.mkdir()
        (figures / "f.svg").write_text("<svg xmlns='http://www.w3.org/2000/svg'/>")
        (figures / "figures.json").write_text(json.dumps([{"id": hostile, "title": hostile, "caption": hostile,
                                                           "thesis_figure": hostile, "files": ["f.svg"], "sources": [hostile]}]))
        claims = self.root / "hostile.json"
        claims.write_text(json.dumps({"claims": [{k: hostile for k in claim("")} | {"verdict": "refuted"}]}))
        page = self.page("--figures", figures, "--claims", claims)
        self.assertNotIn("<script>alert", page)
        self.assertNotIn("<img src=\"https", page)
        self.assertIn("&lt;script&gt;alert(1)", page)

    def add_run(self, name, summary, scenario=None):
        directory = self.results / "thesis" / name
        directory.mkdir()
        self.addCleanup(shutil.rmtree, directory)
        (directory / "summary.json").write_text(json.dumps({"name": name} | summary))
        if scenario:
            (directory / "scenario.effective.json").write_text(json.dumps(scenario))


class Replay(WithResults):
    def test_tensors_give_the_recorded_ratios(self):
        for trajectory in self.recorded.glob("replay/*/*/trajectory.csv"):
            recording = Recording(trajectory.parent)
            self.assertIsNotNone(recording.tensors)
            for packed, tensor, contacts in zip(recording.rows(), recording.tensors, recording.contacts):
                if not contacts:
                    continue
                row, (sxx, sxy, sxz, syy, syz, szz) = dict(zip(MEASURED_COLUMNS, packed)), tensor
                ratios = [sxx * x * x + syy * y * y + szz * z * z + 2 * (sxy * x * y + sxz * x * z + syz * y * z)
                          for x, y, z in (contact[4:7] for contact in contacts)]
                # Two sums of n products of factors up to one, in different orders: n roundings each, of sums below the
                # largest ratio.
                tolerance = 2 * (len(contacts) + 10) * 2.0 ** -53 * max(1.0, row["ratio_max"])
                self.assertAlmostEqual(min(ratios), row["ratio_min"], delta=tolerance)
                self.assertAlmostEqual(max(ratios), row["ratio_max"], delta=tolerance)

    def test_packing_keeps_contacts_to_half_a_step(self):
        for scene in replay.packed_replays(self.recorded / "replay"):
            for packed in scene["recordings"]:
                recording = Recording(self.recorded / "replay" / scene["id"] / packed["algorithm"])
                flat = [value for contacts in recording.contacts for contact in contacts for value in contact[:len(CONTACT_COLUMNS)]]
                steps = array("h", base64.b64decode(packed["contacts"]))
                scales = packed["contactScales"]
                self.assertEqual(len(steps), len(flat))
                self.assertEqual(len(scales), len(CONTACT_COLUMNS))
                for i, (step, value) in enumerate(zip(steps, flat)):
                    scale = scales[i % len(scales)]
                    # Half a step, and the rounding of the division.
                    self.assertLessEqual(abs(step * scale - value), 0.5001 * scale)


class BadInput(WithResults):
    def refused(self, *words):
        """The one line of the error; nothing was written."""
        out = self.root / "refused" / "page.html"
        done = report(*words, "--out", out)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertFalse(out.parent.exists())
        return done.stderr

    def written(self, name, text):
        file = self.root / "bad" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        self.addCleanup(shutil.rmtree, self.root / "bad", ignore_errors=True)
        file.write_bytes(text.encode() if isinstance(text, str) else text)
        return file

    def test_results(self):
        for text, said in (("{", "not JSON"), ("[" * 100_000, "not JSON"), ("7", "/: got 7; allowed: an object"),
                           (b"\xff\xfe", "cannot be read"), ('{"metrics": []}', "/metrics: got []; allowed: an object")):
            file = self.written("results/run/summary.json", text)
            error = self.refused(file.parents[1])
            self.assertIn(f"{file}: ", error)
            self.assertIn(said, error)
        self.assertIn("no such directory", self.refused(self.root / "nowhere"))
        self.assertIn("holds no summary.json", self.refused(self.figures))

    def test_tables(self):
        for text, said in (("", "empty"), ("a,b\n1\n", "line 2: got 1 fields; allowed: 2")):
            self.written("results/run/summary.json", "{}")
            file = self.written("results/study/study.csv", text)
            self.assertIn(f"{file}: {said}", self.refused(file.parents[1]))

    def test_claims(self):
        for value, said in (([], "got []"), ({"claims": 1}, "/claims: got 1; allowed: an array"),
                            ({"claims": [1]}, "/claims/0: got 1; allowed: an object"),
                            ({"claims": [claim("refuted", sureness=1)]}, '/claims/0/sureness: got 1; allowed: "steady"'),
                            ({"claims": [claim("maybe")]}, '/claims/0/verdict: got "maybe"; allowed: "reproduced"')):
            file = self.written("claims.json", json.dumps(value))
            self.assertIn(said, self.refused(self.results, "--claims", file))

    def test_figures(self):
        for value, said in (({"figures": 1}, "/figures: got 1"), ([{"files": ["none.svg"]}], '/figures/0/files: got ["none.svg"]'),
                            ([{"title": 1}], "/figures/0/title: got 1; allowed: a string")):
            file = self.written("figures.json", json.dumps(value))
            self.assertIn(said, self.refused(self.results, "--figures", file.parent))

    def test_figures_do_not_leave_their_directory(self):
        self.written("secret.svg", "<svg/>")
        file = self.written("figures/figures.json", json.dumps([{"files": ["../secret.svg"]}]))
        self.assertIn("allowed: an SVG or PNG file beside it", self.refused(self.results, "--figures", file.parent))

    def test_recordings(self):
        recorded = self.recorded / "replay" / "peg_in_hole_2d"
        for name, old, new, said in (
                ("mean/trajectory.csv", "px_m", "qx_m", "line 1: no column px_m"),
                ("mean/contacts.csv", "\n0,", "\nnan,", "line 2: step: got nan; allowed: a finite number"),
                ("mean/stiffness_tensor.csv", "sxx", "qxx", "line 1: no column sxx"),
                ("mean/stiffness_tensor.csv", "\n0,", "\n1000000,", "no row of step 0"),
                ("mean/scenario.effective.json", "diameter_m", "width_m", "/tool/diameter_m: missing"),
                ("shell.csv", "nx", "mx", "line 1: no column nx")):
            bad = self.root / "bad" / "peg_in_hole_2d"
            shutil.copytree(recorded, bad)
            text = (bad / name).read_text()
            self.written(f"peg_in_hole_2d/{name}", text.replace(old, new, 1))
            error = self.refused(self.results, "--replay", bad.parent)
            shutil.rmtree(bad)
            self.assertIn(f"{bad / name}: {said}", error)

    def test_program(self):
        self.assertIn("No such file", self.refused(self.results, "--program", self.root / "no program"))
        self.assertIn("exit status", self.refused(self.results, "--program", shutil.which("false")))

    def test_out(self):
        done = report(self.results, "--out", self.claims / "page.html")
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)


class Names(unittest.TestCase):
    def test_columns_name_their_units(self):
        for name, expected in (("force_reversals_per_s", ("force reversals", "1/s", 1)), ("speed_max_m_per_s", ("speed max", "m/s", 1)),
                               ("stiffness_N_per_m", ("stiffness", "N/m", 1)), ("steps", ("steps", "", 1)),
                               ("power_m2_per_s2", ("power", "m²/s²", 1)), ("seconds_per_call", ("time of a call", "µs", 1e6))):
            self.assertEqual(column(name, [1]), expected)
        # The usual length decides: one that was thrown out does not.
        self.assertEqual(column("depth_m", [0.001, 0.002, 18])[1:], ("mm", 1e3))
        self.assertEqual(column("depth_m", [0, 0.02])[1:], ("m", 1))

    def test_figure_labels(self):
        for given, labels in (("4", {"4"}), ("Fig. 7a–c", {"7"}), ("A.4 (root locus)", {"A.4"}), ("B.4/B.5", {"B.4", "B.5"}),
                              ("F4", {"F.4"}), ("ours", set()), ("", set()), ("C.2, C.3", {"C.2", "C.3"})):
            self.assertEqual(figure_labels(given), labels, given)


if __name__ == "__main__":
    main()
