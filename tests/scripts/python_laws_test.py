"""Tests force laws written in Python, and plugin modules beside them. Arguments: see python_test.py."""
import json
import threading
import traceback

import numpy as np
from fixture import SOURCE, must
from python_test import PEG, SHORT, WEDGE, Scratch, python, words_of

import hapbench


def summation(depths):
    """The sum of all springs."""
    return np.ones(len(depths))


class Laws(Scratch):
    def test_a_law_is_like_a_built_in_one(self):
        hapbench.force_law("test_summation")(summation)
        for scene in (PEG, "springs_limited_mean"):
            own, built_in = (
                hapbench.run(scene, {**SHORT, "rendering.algorithm": name}, record=["contacts"])
                for name in ("test_summation", "summation")
            )
            self.assertEqual(own.state_hash, built_in.state_hash, scene)
            np.testing.assert_array_equal(own.contacts.weight, built_in.contacts.weight)
            self.assertEqual(own.summary["provenance"]["plugin"]["file"], "python_laws_test.py")
            self.assertNotIn("plugin", built_in.summary["provenance"])
        self.assertIn("test_summation", hapbench.algorithms())
        self.assertIn(
            "The sum of all springs", json.dumps(hapbench.command("describe", "test_summation"))
        )

    def test_a_force_and_a_tensor(self):
        @hapbench.force_law("test_force")
        def law(depths, gradients, stiffness):
            return -stiffness * depths @ gradients, gradients.T @ gradients

        own = hapbench.run(PEG, {**SHORT, "rendering.algorithm": "test_force"})
        built_in = hapbench.run(PEG, {**SHORT, "rendering.algorithm": "summation"})
        # The program adds the same terms in another order: the first row differs by the rounding of at most some 30
        # terms.
        np.testing.assert_allclose(
            own.trajectory.fx_N[0], built_in.trajectory.fx_N[0], rtol=1e-13, atol=1e-10
        )

    def test_arguments(self):
        seen = {}

        @hapbench.force_law(
            "test_arguments",
            parameters={"share": hapbench.Parameter(0.5, 0, 1, "1", "of the weights"), "other": 2},
        )
        def law(normals, share, points, stiffness, gradients, depths, other):
            seen.update(
                shapes=(normals.shape, points.shape, gradients.shape, depths.shape),
                share=share,
                other=other,
                K=stiffness,
                contiguous=gradients.flags.c_contiguous,
                owned=gradients.flags.owndata,
            )
            return share

        run = hapbench.run(
            PEG,
            {
                **SHORT,
                "rendering.algorithm": "test_arguments",
                "rendering.parameters.test_arguments.share": 0.25,
            },
            record=["contacts"],
        )
        n = int(run.trajectory.rendered[run.trajectory.rendered > 0][-1])
        self.assertEqual(seen["shapes"], ((n, 3), (n, 3), (n, 3), (n,)))
        self.assertEqual(
            (seen["share"], seen["other"], seen["K"], seen["contiguous"], seen["owned"]),
            (0.25, 2.0, 20000.0, True, False),
        )
        self.assertEqual(set(run.contacts.weight), {0.25})
        self.assertEqual(
            run.scenario["rendering"]["parameters"]["test_arguments"], {"share": 0.25, "other": 2.0}
        )
        with self.assertRaises(hapbench.ScenarioError) as caught:
            hapbench.run(
                PEG,
                {
                    "rendering.algorithm": "test_arguments",
                    "rendering.parameters.test_arguments.share": 2,
                },
            )
        self.assertEqual(caught.exception.pointer, "/rendering/parameters/test_arguments/share")
        with self.assertRaisesRegex(TypeError, "unknown argument 'depth'"):
            hapbench.force_law("test_wrong")(lambda depth: 1)
        with self.assertRaisesRegex(ValueError, "built-in"):
            hapbench.force_law("mean")(summation)

    def test_a_new_definition_replaces(self):
        hashes = []
        for weight in (0.5, 1.0):
            hapbench.force_law("test_again")(eval(f"lambda depths: {weight}"))
            hashes.append(
                hapbench.run(PEG, {**SHORT, "rendering.algorithm": "test_again"}).state_hash
            )
        self.assertNotEqual(*hashes)
        self.assertEqual(
            hashes[1], hapbench.run(PEG, {**SHORT, "rendering.algorithm": "summation"}).state_hash
        )
        self.assertEqual(hapbench.algorithms().count("test_again"), 1)

    def test_a_state_of_each_run(self):
        made = []

        @hapbench.force_law("test_state")
        class Law:
            def __init__(self):
                self.calls = 0
                made.append(self)

            def __call__(self, depths):
                self.calls += 1
                return 1.0 / self.calls

        first, second = (
            hapbench.run(PEG, {**SHORT, "rendering.algorithm": "test_state"}).state_hash
            for _ in range(2)
        )
        self.assertEqual(first, second)
        self.assertGreaterEqual(len(made), 2)

    def test_in_studies(self):
        hapbench.force_law("test_summation")(summation)
        report = hapbench.compare(PEG, ["summation", "test_summation"], SHORT, jobs=2)
        self.assertEqual(
            report.runs["summation"].state_hash, report.runs["test_summation"].state_hash
        )
        table = hapbench.sweep(
            PEG,
            {"rendering.algorithm": "test_summation,summation", "seed": [1, 2, 3]},
            SHORT,
            jobs=2,
        ).sweep
        self.assertEqual(list(table["state_hash"][:3]), list(table["state_hash"][3:]))
        table = hapbench.limit(
            "single_spring", algorithms=["test_summation", "summation"], resolution=0.5, jobs=2
        ).limit_runs
        own, built_in = table.where(algorithm="test_summation"), table.where(algorithm="summation")
        self.assertEqual(list(own["class"]), list(built_in["class"]))
        self.assertGreater(own.rows, 16)

    def test_exceptions_end_the_run(self):
        calls = []

        @hapbench.force_law("test_raises")
        def law(depths):
            calls.append(len(depths))
            if len(calls) > 3:
                raise RuntimeError("enough")
            return 1

        for compute in (
            lambda: hapbench.run(PEG, {**SHORT, "rendering.algorithm": "test_raises"}),
            lambda: hapbench.compare(
                PEG, ["mean", "test_raises"], SHORT, out=self.root / "out", jobs=2
            ),
            lambda: hapbench.sweep(
                PEG, {"rendering.algorithm": "test_raises", "seed": [1, 2]}, SHORT, jobs=2
            ),
        ):
            calls.clear()
            try:
                compute()
            except RuntimeError as error:
                self.assertEqual(
                    (str(error), traceback.extract_tb(error.__traceback__)[-1].name),
                    ("enough", "law"),
                )
            else:
                self.fail("no error")
        self.assertFalse((self.root / "out" / "test_raises" / "summary.json").exists())
        # A failed law must have no effect on later runs.
        self.assertEqual(hapbench.run(PEG, SHORT).outcome, "completes")

    def test_answers_that_are_no_force(self):
        for answer, message in (
            (np.ones(1000), "shape"),
            (np.nan, "nan"),
            ("text", "str"),
            (None, "NoneType"),
            ((1, 2, 3), "tuple of 3"),
            ((np.zeros(3), np.arange(9.0).reshape(3, 3)), "symmetric"),
            (np.ones((2, 2)), "shape"),
        ):
            hapbench.force_law("test_wrong")(eval("lambda depths: answer", {"answer": answer}))
            with self.assertRaisesRegex(ValueError, f'force law "test_wrong": .*{message}'):
                hapbench.run(PEG, {**SHORT, "rendering.algorithm": "test_wrong"})

    def test_laws_on_the_command_line(self):
        script = self.root / "mine.py"
        script.write_text(
            "import sys, hapbench\n@hapbench.force_law('mine')\ndef mine(depths):\n    return 1\n"
            "sys.exit(hapbench.main())\n"
        )
        words = [
            "run",
            PEG,
            *words_of({**SHORT, "rendering.algorithm": "mine"}),
            "--out",
            self.root / "out",
        ]
        done = python(script, *words)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(
            hapbench.load(self.root / "out").state_hash,
            hapbench.run(PEG, {**SHORT, "rendering.algorithm": "summation"}).state_hash,
        )


LAW_OF_A_SCRIPT = """import hapbench, numpy, sys, threading, time, types

begun = threading.Event()

@hapbench.force_law("even")
def even(depths):
    begun.set()
    return numpy.full(len(depths), 1 / len(depths))
"""


class TheEndOfTheInterpreter(Scratch):
    """Tests threads that wait for the Python interpreter while the interpreter shuts down. If hapbench did not handle
    such a thread, the thread would abort the process."""

    def script(self, text):
        done = python("-c", LAW_OF_A_SCRIPT + text)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_finds_threads_that_have_just_ended(self):
        # The main thread holds the interpreter from the comparison to the end of the script, so that many of 16 threads
        # still wait when the interpreter shuts down. If hapbench did not handle such threads, three of four scripts
        # would be aborted.
        words = [
            "compare",
            WEDGE,
            "--algorithms",
            "even",
            "--jobs",
            "16",
            "--seeds",
            "64",
            "--jitter",
            "2e-5",
            *words_of(SHORT),
            "--set",
            "record.every=100",
        ]
        for _ in range(5):
            self.script(
                f"hapbench.main({[*words, '--out', str(self.root / 'out'), '--quiet']!r})\n"
                "sys.setswitchinterval(1000)\n"
                "end = time.monotonic() + 0.02\n"
                "while time.monotonic() < end: pass\n"
                "class Late:\n    def __del__(self, sleep=time.sleep): sleep(0.1)\n"
                "sys.modules['late'] = types.ModuleType('late')\n"
                "sys.modules['late'].late = Late()\n"
            )

    def test_ends_the_work_of_daemons(self):
        endless = {
            "time.steps": 10_000_000,
            "time.stop_when": "[]",
            "expect": "{}",
            "rendering.algorithm": "even",
            "record.trajectory": False,
        }
        for work in (
            f"hapbench.run({PEG!r}, {endless}, progress=False)",
            f"hapbench.Simulation({PEG!r}, {endless}).advance(10_000_000)",
        ):
            self.script(
                f"threading.Thread(target=lambda: {work}, daemon=True).start()\n"
                "assert begun.wait(60)\n"
            )


PLUGIN = SOURCE / "algorithms/module/examples/depth_weighted.c"


class Plugins(Scratch):
    def test_stand_beside_laws_in_python(self):
        must(
            "cc",
            "-shared",
            "-fPIC",
            f"-I{SOURCE}/algorithms/module",
            "-o",
            self.root / "law.so",
            PLUGIN,
            "-lm",
        )
        before = set(hapbench.algorithms())
        hapbench.load_plugin(self.root / "law.so")
        (name,) = set(hapbench.algorithms()) - before
        hapbench.force_law("test_summation")(summation)
        report = hapbench.compare(PEG, [name, "test_summation", "summation"], SHORT)
        self.assertEqual(list(report.comparison.algorithm), [name, "test_summation", "summation"])

    def test_none_is_loaded_while_a_thread_computes(self):
        source = self.root / "other.c"
        source.write_text(PLUGIN.read_text().replace("depth_weighted", "other_law"))
        must(
            "cc",
            "-shared",
            "-fPIC",
            f"-I{SOURCE}/algorithms/module",
            "-o",
            self.root / "other.so",
            source,
            "-lm",
        )
        begun, let_go = threading.Event(), threading.Event()

        def wait(*_):
            begun.set()
            let_go.wait(60)

        work = threading.Thread(
            target=hapbench.run,
            args=(PEG, {**SHORT, "time.steps": 200_000, "time.stop_when": "[]"}),
            kwargs={"progress": wait},
        )
        work.start()
        self.assertTrue(begun.wait(60))
        try:
            with self.assertRaisesRegex(hapbench.ScenarioError, "while another thread computes"):
                hapbench.load_plugin(self.root / "other.so")
        finally:
            let_go.set()
            work.join()
        self.assertNotIn("other_law", hapbench.algorithms())
        hapbench.load_plugin(self.root / "other.so")
        self.assertIn("other_law", hapbench.algorithms())
