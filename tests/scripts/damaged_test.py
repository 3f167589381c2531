"""Tests `hapbench plot` and `report` with result folders of which a file was cut or edited: each fault is named with
its file, and complete results cause no warning."""
import json
import shutil
import tempfile
from pathlib import Path

from fixture import PROGRAM, SOURCE, in_process, ran
from pictures_test import Given, made, make_root

from hapbench.columns import read_columns, read_records
from hapbench.errors import ResultError
from hapbench_pictures.__main__ import main as pictures
from hapbench_style import plt

STEPS = ("--set", "time.steps=300", "--set", "expect={}")
CUT = "the last line has no line break"
JUNK = bytes(range(256)) * 8


def setUpModule():
    make_root()
    made("run", "run", "tap_wall", "--set", "record.contacts=true", "--set", "record.energy=true")
    made("springs", "run", "springs_limited_mean", *STEPS)
    made("compare", "compare", "tap_wall", "--algorithms", "mean,summation")
    made("seeds", "compare", "tap_wall", "--algorithms", "mean,summation", "--seeds", "2")
    stiffness = ("--vary", "rendering.stiffness_N_per_m=1e3:1e4:4:log")
    made("sweep", "sweep", "springs_limited_mean", *stiffness, "--keep-runs", *STEPS)
    field = ("--vary", "rendering.stiffness_N_per_m", "--resolution", 0.5)
    made("limit", "limit", "springs_limited_mean", *field, *STEPS)
    laws = ("--algorithms", "mean,shaped_stiffness")
    made("tune", "tune", "impedance_at_wall", *laws, "--damping-ratio", "0.2:0.3")
    metrics = ("--metric", "force_max_N,final_position_m.x", "--levels", 4)
    made("converge", "converge", "springs_oscillation", *metrics)
    model = ("--over", "rendering.algorithm=mean,summation", "--set", "time.duration_s=0.1")
    made("model", "converge", "plane_wiped_round", *model)
    (Given.root / "replay").mkdir()
    shutil.copy(SOURCE / "tests/data/loop.csv", Given.root / "replay/replay.csv")


def called(command, *words):
    """Returns (exit status, standard error) of `hapbench plot` or `report`."""
    status, _, error = in_process(pictures, command, *words, HAPBENCH_PROGRAM=str(PROGRAM))
    plt.close("all")
    return status, error


def cut(file, first, last=None):
    """Removes lines `first` to `last` of a file, counted from 1; without `last`, to the end."""
    lines = file.read_bytes().splitlines(keepends=True)
    file.write_bytes(b"".join(lines[: first - 1] + ([] if last is None else lines[last:])))


def put(file, line, column, text):
    """Replaces the field of a column in a line of a table, counted from 1."""
    lines = file.read_text().split("\n")
    fields = lines[line - 1].split(",")
    fields[lines[0].split(",").index(column)] = text
    lines[line - 1] = ",".join(fields)
    file.write_text("\n".join(lines))


class Damaged(Given):
    def assert_warns(self, folder, *texts, commands=("plot", "report")):
        """Checks that the commands succeed and print one warning, which has the texts and is also on the page."""
        for command in commands:
            status, error = called(command, folder)
            self.assertEqual((status, error.count("warning")), (0, 1), error)
            for text in texts:
                self.assertIn(text, error)
                if command == "report":
                    self.assertIn(text, (folder / "report.html").read_text())

    def assert_refuses(self, folder, text, commands=("plot", "report")):
        for command in commands:
            status, error = called(command, folder)
            self.assertEqual((status, error.count("error")), (2, 1), error)
            self.assertIn(text, error)

    def test_complete_results_cause_no_warning(self):
        every = made("every", "run", "springs_limited_mean", *STEPS, "--set", "record.every=7")
        ended = made("ended", "run", "peg_in_hole_2d_summation", "--set", "record.every=2")
        through = made("through", "run", "flat_press_normal_projection")
        diverged = self.root / "diverged"
        unstable = ("--set", "record.energy=true", "--set", "record.every=4", "--set", "expect={}")
        words = (PROGRAM, "run", "springs_unlimited_tandpasta", *unstable, "--out", diverged)
        ran(*words)
        names = ("run", "compare", "seeds", "sweep/runs/000000")
        for folder in (*(self.root / name for name in names), every, ended, through, diverged):
            for command in ("plot", "report"):
                self.assertEqual(called(command, folder), (0, ""), folder)
        for name in ("sweep", "limit", "tune", "converge", "model", "replay"):
            self.assertEqual(called("plot", self.root / name), (0, ""), name)
        untraced = made("untraced", "run", "tap_wall", "--set", "record.trajectory=false")
        self.assertEqual(called("report", untraced), (0, ""))
        self.assert_refuses(untraced, "--set record.trajectory=true", ["plot"])

    def test_parts_of_a_sweep(self):
        folder = self.root / "shards"
        vary = ("--vary", "rendering.stiffness_N_per_m=1e3:1e4:4:log", *STEPS)
        words = ("sweep", "springs_limited_mean", *vary, "--out", folder, "--quiet", "--shard")
        ran(PROGRAM, *words, "0/2")
        self.assertEqual(called("plot", folder)[0], 2)
        ran(PROGRAM, *words, "1/2")
        ran(PROGRAM, "sweep", folder)
        self.assertEqual(called("plot", folder), (0, ""))

    def test_rows_of_a_run_are_missing(self):
        for first, last, rows, step in ((251, None, 249, 249), (101, 200, 200, 99)):
            run = self.copy("springs")
            cut(run / "trajectory.csv", first, last)
            gap = f"{rows} of 300 rows; the first missing row is of step {step}"
            self.assert_warns(run, f"trajectory.csv: {gap}")
        run = self.copy("run")
        file = run / "trajectory.csv"
        file.write_text(file.read_text() + file.read_text().splitlines()[-1] + "\n")
        self.assert_warns(run, "trajectory.csv: 1001 rows, but the 1000 steps", commands=["plot"])
        run = self.copy("run")
        cut(run / "energy.csv", 900)
        self.assert_warns(run, "energy.csv: 898 of 1000 rows")
        run = self.copy("run")
        cut(run / "contacts.csv", 500)
        self.assert_warns(run, "contacts.csv: 498 rows, but trajectory.csv", commands=["report"])
        (run / "trajectory.csv").unlink()
        absent = "trajectory.csv: is missing, although the run has written it: repeat the run"
        self.assert_refuses(run, absent, ["plot"])
        self.assert_warns(run, absent, commands=["report"])

    def test_rows_that_are_not_in_the_order_of_time(self):
        for name in ("trajectory.csv", "energy.csv"):
            run = self.copy("run")
            file = run / name
            lines = file.read_text().splitlines(keepends=True)
            file.write_text("".join([*lines[:99], lines[100], lines[99], *lines[101:]]))
            self.assert_refuses(run, f"{file}: line 101: step: got 98 after 99; allowed: rows")
            put(file, 100, "step", "98")
            put(file, 101, "step", "99")
            self.assert_refuses(run, f"{file}: line 101: time_s: got ")
        run = self.copy("run")
        file = run / "trajectory.csv"
        lines = file.read_text().splitlines(keepends=True)
        file.write_text("".join([*lines[:100], lines[99], *lines[101:]]))
        gap = "999 of 1000 rows; the first missing row is of step 99"
        self.assert_warns(run, f"{file}: {gap}", commands=["plot"])

    def test_a_summary_with_other_values_than_the_program_writes(self):
        for key, value, text in (
            ("metrics/force_max_N", "a", '/metrics/force_max_N: got "a"; allowed: a number'),
            ("metrics/final_position_m", [0, True, 0], "/metrics/final_position_m/1: got true;"),
            ("passivity/energy_min_J", "NaN", '/passivity/energy_min_J: got "NaN"; allowed'),
            ("steps", "1000", '/steps: got "1000"; allowed: a number'),
            ("outcome", "exploded", '/outcome: got "exploded"; allowed: "completes", "leaves_'),
        ):
            run = self.copy("run")
            summary = json.loads((run / "summary.json").read_text())
            *section, name = key.split("/")
            (summary[section[0]] if section else summary)[name] = value
            (run / "summary.json").write_text(json.dumps(summary))
            self.assert_refuses(run, f"{run / 'summary.json'}: {text}")

    def test_why_a_table_is_not_there(self):
        """A message names the cause that is true, and a fix."""

        def folder(file):
            file.mkdir()

        def cycle(file):
            file.symlink_to(file.name)

        def dangling(file):
            file.symlink_to("elsewhere.csv")

        def packed(file):
            file.with_name(f"{file.name}.gz").write_bytes(b"")

        for name, words in (("trajectory.csv", ()), ("energy.csv", ("--y", "energy"))):
            for change, text in (
                (folder, "is a folder, not a file: remove the folder"),
                (cycle, f"is a link to {name}, which leads in a circle: remove the link"),
                (dangling, "is a link to elsewhere.csv, which does not exist: remove the link"),
                (packed, f"is missing, but {name}.gz is there: decompress {name}.gz"),
            ):
                run = self.copy("run")
                (run / name).unlink()
                change(run / name)
                status, error = called("plot", run, *words)
                self.assertEqual((status, error.count("error")), (2, 1), error)
                self.assertIn(f"{run / name}: {text}", error.splitlines()[-1])
                if change is folder:
                    self.assert_warns(run, f"{name}: {text}", commands=["report"])
        self.assert_warns(run, "energy.csv: is missing, but", commands=["plot"])
        (run / "scenario.effective.json").unlink()
        self.assertIn("scenario.effective.json: is missing, although", called("plot", run)[1])
        status, error = called("report", self.root / "run", run, "--tolerance", "0")
        text = f"{run / 'scenario.effective.json'}: is missing, although the run has written it"
        self.assertEqual((status, error.count("\n")), (2, 1))
        self.assertIn(f"{text}: repeat the run", error)

    def test_a_cut_last_line_is_refused(self):
        for size, text in ((1, f"line 301: {CUT}"), (12, "line 301: "), (4, "line 301: ")):
            run = self.copy("springs")
            file = run / "trajectory.csv"
            file.write_bytes(file.read_bytes()[:-size])
            self.assert_refuses(run, f"{file}: {text}")
        with self.assertRaisesRegex(ResultError, f"line 301: {CUT}|got"):
            read_columns(file)

    def test_what_is_no_finite_number(self):
        for text in ("nan", "-inf", "1e999", "abc", ""):
            run = self.copy("springs")
            put(run / "trajectory.csv", 50, "fx_N", text)
            shown = text or "an empty field"
            self.assert_refuses(run, f"trajectory.csv: line 50: fx_N: got {shown}; allowed: a fi")
        run = self.copy("springs")
        put(run / "trajectory.csv", 60, "ratio_min", "nan")
        self.assert_warns(run, "trajectory.csv: line 60: ratio_min: got nan")
        run = self.copy("run")
        put(run / "energy.csv", 70, "created_J", "inf")
        self.assert_warns(run, "energy.csv: line 70: created_J: got inf")
        put(run / "contacts.csv", 70, "depth_m", "nan")
        self.assert_refuses(run, "contacts.csv: line 70: depth_m: got nan", ["report"])
        for folder, name, line, column in (
            ("limit", "limit.csv", 2, "limit"),
            ("limit", "limit_runs.csv", 5, "rendering.stiffness_N_per_m"),
            ("tune", "tune_trials.csv", 40, "force_rms_above_30Hz_N"),
            ("converge", "converge_levels.csv", 3, "result"),
            ("converge", "converge_levels_timing.csv", 3, "seconds"),
            ("model", "convergence_model.csv", 2, "force_error_rms_N"),
            ("model", "convergence_model_timing.csv", 2, "step_median_s"),
            ("sweep", "sweep.csv", 3, "force_max_N"),
            ("sweep", "sweep.csv", 3, "rendering.stiffness_N_per_m"),
            ("sweep", "sweep.csv", 3, "index"),
        ):
            for text in ("abc", "nan"):
                study = self.copy(folder)
                put(study / name, line, column, text)
                words = () if folder != "sweep" else ("--metric", "force_max_N")
                status, error = called("plot", study, *words)
                self.assertEqual(status, 2, (name, column, text))
                self.assertIn(f"{study / name}: line {line}: {column}: got {text}", error)
        log = self.copy("replay") / "replay.csv"
        text = log.read_text().split("\n")
        for wrong in ("nan", "abc"):
            text[9] = ",".join([wrong, *text[9].split(",")[1:]])
            log.write_text("\n".join(text))
            self.assert_refuses(log.parent, f"line 10: call: got {wrong}", ["plot"])

    def test_rows_of_a_study_are_missing(self):
        for folder, name, first, text in (
            ("sweep", "sweep.csv", 3, "1 of 4 rows; the first missing row is of run 1"),
            ("limit", "limit_runs.csv", 101, "99 of "),
            ("tune", "tune_trials.csv", 20, "no rows for line 3 of tune.csv"),
            ("tune", "tune.csv", 3, "tune.csv has no row with algorithm shaped_stiffness"),
            ("model", "convergence_model.csv", 3, "no rows for line 3 of convergence_model_timing"),
        ):
            study = self.copy(folder)
            cut(study / name, first)
            status, error = called("plot", study)
            self.assertEqual((status, error.count("warning")), (0, 1), (name, error))
            self.assertIn(text, error)
        study = self.copy("sweep")
        cut(study / "sweep.csv", 2, 2)
        status, error = called("plot", study)
        self.assertIn("3 of 4 rows; the first missing row is of run 0", error)

    def test_a_law_of_a_comparison_is_missing(self):
        folder = self.copy("compare")
        (folder / "mean" / "summary.json").write_text("{}")
        self.assert_refuses(folder, "mean/summary.json: line 1: no field algorithm")
        (folder / "mean" / "summary.json").unlink()
        self.assert_warns(folder, "comparison.csv: 1 of 1 runs of mean missing")
        seeds = self.copy("seeds")
        (seeds / "mean" / "seed_1" / "summary.json").unlink()
        self.assert_warns(seeds, "comparison.csv: 1 of 2 runs of mean missing")
        folder = self.copy("compare")
        cut(folder / "comparison.csv", 3)
        self.assert_warns(folder, "comparison.csv: no row of summation")
        cut(folder / "comparison.csv", 2)
        self.assert_refuses(folder, "comparison.csv: line 2: missing")
        file = folder / "comparison.csv"
        file.write_bytes(file.read_bytes()[:200])
        self.assert_refuses(folder, f"{file}: line 1: {CUT}")

    def test_a_comparison_or_a_sweep_that_was_stopped(self):
        """`compare` writes its table last. `sweep` renames the table sweep.csv.part last."""
        begin = "has no comparison.csv, which"
        folder = self.copy("compare")
        (folder / "comparison.csv").unlink()
        self.assert_warns(folder, f"{folder}: {begin}", "laws may be missing\n", commands=["plot"])
        (folder / "proxy").mkdir()
        (folder / "mean" / "summary.json").unlink()
        self.assert_warns(folder, begin, "laws may be missing: no summary.json in mean, proxy")
        seeds = self.copy("seeds")
        (seeds / "comparison.csv").unlink()
        (seeds / "mean" / "seed_1" / "summary.json").unlink()
        self.assert_warns(seeds, f"{seeds}: {begin}", "no summary.json in mean/seed_1")
        # The comparison is found below a folder of several results, too.
        self.assertIn(f"{folder}: {begin}", called("report", folder.parent)[1])
        sweep = self.copy("sweep")
        (sweep / "sweep.csv").rename(sweep / "sweep.csv.part")
        text = f"{sweep}/sweep.csv.part: the sweep was stopped or has not ended, and runs are"
        for given in (sweep, sweep / "runs"):
            self.assert_warns(given, text)

    def test_a_byte_order_mark_is_no_text(self):
        for name in ("run", "compare", "seeds", "sweep", "limit", "tune", "converge", "replay"):
            folder = self.copy(name)
            for file in folder.rglob("*"):
                if file.suffix in (".csv", ".json"):
                    file.write_bytes(b"\xef\xbb\xbf" + file.read_bytes())
            for command in ("plot", "report") if name in ("run", "compare", "seeds") else ["plot"]:
                status, error = called(command, folder)
                self.assertEqual((status, error), (0, ""), name)

    def test_every_fault_of_a_file_names_the_file(self):
        """Checks each file of each kind of folder, emptied, cut in half, with its first line only, and with other
        bytes: the command succeeds or names the file, and has no internal error."""
        for name in (
            "run",
            "compare",
            "seeds",
            "sweep",
            "limit",
            "tune",
            "converge",
            "model",
            "replay",
        ):
            whole = self.root / name
            for file in sorted(
                file for file in whole.rglob("*") if file.suffix in (".csv", ".json")
            ):
                path = file.relative_to(whole)
                if {"summation", "seed_1", "runs"} & set(path.parts):
                    continue
                data = file.read_bytes()
                for bad in (b"", data[: len(data) // 2], data.split(b"\n")[0] + b"\n", JUNK):
                    folder = self.copy(name)
                    (folder / path).write_bytes(bad)
                    of_runs = name == "run" or path.name.startswith(("comp", "rank"))
                    for command in ("plot", "report") if of_runs else ("plot",):
                        status, error = called(command, folder)
                        self.assertIn(status, (0, 2), (path, bad[:20], error))
                        if status == 2:
                            self.assertIn(path.name, error, (command, bad[:20]))
                    shutil.rmtree(folder.parent)

    def test_lines_of_records(self):
        file = Path(tempfile.mkdtemp(dir=self.root)) / "a.csv"
        file.write_text('name,x\n"two\nlines",1\n\nlast,2\n', encoding="utf-8-sig")
        rows = read_records(file)
        self.assertEqual([(row.line, row["x"]) for row in rows], [(3, "1"), (5, "2")])
        with self.assertRaisesRegex(ResultError, "a.csv: line 1: no column y"):
            rows[0]["y"]
        file.write_bytes(b"a,b\n1,2\n\xff,3\n")
        with self.assertRaisesRegex(ResultError, "a.csv: line 3: not UTF-8"):
            read_records(file)
        file.write_text(json.dumps({"a": 1}) + "\n")
        with self.assertRaisesRegex(ResultError, "a.csv: line 1: no column a"):
            read_columns(file, ["a"])
