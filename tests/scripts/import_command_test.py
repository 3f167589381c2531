"""Tests the command `import stroke`: files, pipes, presets, Ctrl-C and output."""
import json
import os
import shlex
import signal as signals
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
from fixture import ENVIRONMENT, PROGRAM, SOURCE, hapbench, ran

from recordings import LOG, PRESETS, STRAIGHT, Given, moved, run, table


class Command(Given):
    def test_makes_a_stroke_that_runs_at_once_and_is_compared_with_its_force(self):
        report, _, _ = self.imported("--set", "shift=0,0,-0.001")
        self.assertEqual(
            (report["rate_Hz"], report["resampled"], report["has_roll"]), (99, True, True)
        )
        self.assertAlmostEqual(report["quantum_force_N"], 0.2, delta=1e-7)
        hapbench(
            "new", "stroke", "--from", self.root / "stroke.csv", "--out", self.root / "stroke.json"
        )
        hapbench("validate", self.root / "stroke.json")
        # The shift by -1 mm in z moves the edge of the tool deeper into the surface than half of the tool's width, so
        # that the outcome is went_through.
        done = json.loads(
            hapbench(
                "run",
                self.root / "stroke.json",
                "--set",
                "record.force_reference=true",
                "--set",
                "expect.outcome=went_through",
                "--out",
                self.root / "run",
                "--json",
            )
        )
        self.assertGreater(done[0]["fidelity"]["rows"], 100)

    def test_writes_nothing_of_a_bad_recording(self):
        rec = self.write("t,x,y,z\n0,0,0,0\n1,0,0\n0.5,nan,0,0\n")
        errors = hapbench(
            "import",
            "stroke",
            rec,
            "--columns",
            "time=t,position=x",
            "--out",
            self.root / "new" / "stroke.csv",
            expected=2,
        )
        self.assertIn("line 3: got 3 values; allowed: 4", errors)
        self.assertIn('line 4: column 2 x: got "nan"', errors)
        self.assertEqual(os.listdir(self.root), ["rec.csv"])

    def test_does_not_depend_on_the_locale(self):
        rec = self.write("zeit,größe_x,größe_y,größe_z\n0,0,0,0\n0.5,0.001,0,0\n", "prüfung.csv")
        for locale in ("C", "C.UTF-8", "de_DE.ISO-8859-1"):
            done = run(
                "import",
                "stroke",
                rec,
                "--columns",
                "time=zeit,position=größe",
                "--out",
                self.root / "ö.csv",
                LC_ALL=locale,
            )
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("ö.csv", done.stdout)
            self.assertIn(
                "prüfung.csv: columns: position",
                run(
                    "import", "stroke", rec, "--columns", "time=zeit,position=no", LC_ALL=locale
                ).stderr,
            )

    def test_reads_a_pipe_once(self):
        pipe = self.root / "pipe"
        os.mkfifo(pipe)
        with subprocess.Popen(["sh", "-c", 'printf %s "$1" > "$0"', pipe, STRAIGHT]) as writer:
            hapbench(
                "import",
                "stroke",
                pipe,
                "--columns",
                "time=1,position=2",
                "--out",
                self.root / "a.csv",
            )
            self.assertEqual(writer.wait(), 0)
        file = self.write(STRAIGHT)
        hapbench(
            "import", "stroke", file, "--columns", "time=1,position=2", "--out", self.root / "b.csv"
        )
        self.assertEqual((self.root / "a.csv").read_bytes(), (self.root / "b.csv").read_bytes())

    def test_a_file_name_may_begin_with_a_dash(self):
        self.write(STRAIGHT, "-rec.csv")
        columns = ("--columns", "time=1,position=2", "--out", "s.csv")
        done = ran(PROGRAM, "import", "stroke", *columns, "--", "-rec.csv", cwd=self.root)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((self.root / "s.csv").exists())

    def test_presets_and_devices_may_come_from_a_pipe(self):
        for name, text in (
            ("preset", '\ufeff{"columns": {"time": 1, "position": 2}}'),
            ("device", '{"type": "impedance", "handle_mass_kg": 0.1}'),
        ):
            (self.root / name).write_text(text, encoding="utf-8")
        file = self.write(STRAIGHT)
        for words in (
            f"import stroke {file} --preset <(cat {self.root}/preset) --out {self.root}/s.csv",
            f"limit tap_wall --device <(cat {self.root}/device) --vary rendering.stiffness_N_per_m "
            f"--between 1000:2000 --out {self.root}/limit",
        ):
            done = ran("bash", "-c", f"{shlex.quote(str(PROGRAM))} {words}")
            self.assertEqual(done.returncode, 0, done.stderr)
        missing = run(
            "limit", "tap_wall", "--device", "./none", "--vary", "rendering.stiffness_N_per_m"
        )
        self.assertIn("none: ", missing.stderr)

    def test_numbers_may_have_a_plus_sign(self):
        signed = STRAIGHT.replace("0.0", "+0.0").replace("0,0\n", "+0,+0\n")
        np.testing.assert_array_equal(self.stroke(signed).position, self.stroke(STRAIGHT).position)
        semicolons = signed.replace(",", ";").replace(".", ",")
        np.testing.assert_array_equal(
            self.stroke(semicolons).position, self.stroke(STRAIGHT).position
        )

    def test_ctrl_c_stops_it_at_any_time(self):
        file = self.write(
            table("t,x,y,z", 0.001 * np.arange(60000), moved(0.001 * np.arange(60000)))
        )
        words = [
            "import",
            "stroke",
            file,
            "--columns",
            "time=t,position=x",
            "--out",
            self.root / "s.csv",
        ]
        for seconds in (0.02, 0.1, 0.2, 0.3, 0.45, 0.6):
            with subprocess.Popen(
                [*map(str, (PROGRAM, *words))],
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                env=ENVIRONMENT,
                text=True,
                # Restores the default action of SIGINT, as for a process that a terminal starts.
                preexec_fn=lambda: signals.signal(signals.SIGINT, signals.SIG_DFL),
            ) as process:
                time.sleep(seconds)
                is_over = process.poll() is not None
                process.send_signal(signals.SIGINT)
                errors = process.communicate()[1]
                # Directly after the start, the handler of Ctrl-C is not yet installed, and the signal itself ends the
                # process. Later, the handler ends the process with the status 130. A shell reports both as 130.
                self.assertIn(process.returncode, (130, -signals.SIGINT), errors)
                self.assertNotIn("Traceback", errors)
                self.assertLessEqual(errors.count("\n"), 1, errors)
                self.assertFalse(is_over, "a longer recording is needed")
        self.assertEqual([name for name in os.listdir(self.root) if name.endswith(".tmp")], [])

    def test_any_other_failure_is_one_line(self):
        program = "from hapbench_command import stop_on_ctrl_c\nstop_on_ctrl_c('import stroke')\n"
        for failure, message in (
            ("1 / 0", "internal error: ZeroDivisionError: division by zero (<string>, line 3)"),
            ("raise MemoryError", "not enough memory (<string>, line 3)"),
            (
                "import no_such_module",
                "internal error: ModuleNotFoundError: No module named 'no_such_module'",
            ),
        ):
            done = ran(
                sys.executable,
                "-c",
                program + failure,
                env={"PYTHONPATH": str(SOURCE / "scripts" / "python")},
            )
            self.assertEqual(done.returncode, 1)
            self.assertIn(f"hapbench: error: import stroke: {message}", done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1)
        full = run("import", "stroke", LOG, "--preset", "hapi", "--out", self.root / "s.csv")
        self.assertEqual(full.returncode, 0)
        with open("/dev/full", "w", encoding="utf-8") as no_room:
            done = subprocess.run(
                [*map(str, (PROGRAM, "import", "stroke"))],
                stdout=no_room,
                stderr=subprocess.PIPE,
                text=True,
                env=ENVIRONMENT,
            )
        self.assertEqual(
            (done.returncode, done.stderr),
            (1, "hapbench: error: cannot write to standard output: No space left on device\n"),
        )

    def test_the_next_command_can_be_pasted(self):
        file = self.write(STRAIGHT, "my 'log'.csv")
        done = ran(
            PROGRAM,
            "import",
            "stroke",
            file,
            "--columns",
            "time=1,position=2",
            "--json",
            cwd=self.root,
        )
        line = (
            json.loads(done.stdout)["next"]
            .replace("hapbench", shlex.quote(str(PROGRAM)))
            .partition(" && ")[0]
        )
        self.assertEqual(ran("sh", "-c", line, cwd=self.root).returncode, 0)
        self.assertTrue((self.root / "my 'log'_stroke.json").exists())

    def test_names_the_packages_that_are_missing(self):
        bare = self.root / "python"
        bare.write_text(f'#!/bin/sh\nexec {sys.executable} -S -I "$@"\n')
        bare.chmod(0o755)
        launch = (
            (SOURCE / "scripts" / "python" / "launch")
            .read_text()
            .replace("/usr/bin/python3 python3;", f"{bare};")
        )
        done = ran(
            "bash",
            self.write(launch, "launch"),
            "hapbench_import",
            env={"PATH": os.environ["PATH"]},
        )
        self.assertEqual(done.returncode, 1)
        self.assertRegex(
            done.stderr, "^hapbench: error: import needs a python3 with numpy, scipy, .*\n$"
        )

    def test_lists_presets_that_can_be_copied(self):
        presets = json.loads(hapbench("import", "stroke", "--json"))
        refusal_of = partial(
            hapbench, "import", "stroke", "--out", self.root / "out.csv", expected=2
        )
        self.assertEqual(
            [preset["preset"] for preset in presets],
            sorted(file.stem for file in PRESETS.iterdir()),
        )
        for preset in presets:
            copy = self.write(Path(preset["file"]).read_bytes(), "copy.json")
            self.assertIn(
                "missing: cannot be read",
                refusal_of(self.root / "missing", "--preset", copy),
                "the preset is right",
            )
        for text, problem in (
            ("{,}", "is not JSON: syntax error at line 1, column 2"),
            ("[1]", "got [1]; allowed: an object"),
            ('{"colums": {}}', 'nearest valid name: "columns"'),
            ('{"floats": 1}', "floats: got 1; allowed: true, false"),
            (
                '{"max_gap": 1, "floats": false, "max_gap": 2}',
                'the key "max_gap" stands twice in one object; allowed: once',
            ),
            ('{"scale": {"time": 1, "time": 0.001}}', 'the key "time" stands twice in one object'),
        ):
            self.assertIn(
                "bad.json: ", found := refusal_of(LOG, "--preset", self.write(text, "bad.json"))
            )
            self.assertIn(problem, found)
        self.assertIn(
            'the key "time" stands twice',
            refusal_of(LOG, "--preset", "hapi", "--set", 'scale={"time": 1, "time": 2}'),
        )
