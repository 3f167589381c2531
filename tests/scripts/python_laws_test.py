"""Tests force laws written in Python, and plugin modules beside them. Arguments: see python_test.py."""
import itertools
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

    def test_a_tensor_may_differ_from_its_transpose_by_rounding(self):
        def by_product(u, w):
            return (u.T * w) @ u

        def by_einsum(u, w):
            return np.einsum("i,ij,ik->jk", w, u, u)

        def in_single_precision(u, w):
            # With the factors 1.1 and 1 / 1.1, opposite entries have different roundings.
            u, w = u.astype(np.float32), w.astype(np.float32)
            return np.einsum("i,ij,ik->jk", w, np.float32(1.1) * u, u / np.float32(1.1))

        asymmetry = []
        for tensor_of in (by_product, by_einsum, in_single_precision):

            @hapbench.force_law("test_rounding")
            def law(depths, gradients, stiffness):
                w = depths / depths.sum()
                S = tensor_of(gradients, w)
                asymmetry.append(np.abs(S - S.T).max())
                return -stiffness * gradients.T @ (w * depths), S

            run = hapbench.run("drag_molar", {"rendering.algorithm": "test_rounding"})
            self.assertEqual(run.outcome, "completes", tensor_of.__name__)
        self.assertGreater(max(asymmetry), 0.0)

    def test_opposite_entries_of_a_tensor_are_averaged(self):
        def state_hash(above, below):
            S = np.eye(3)
            S[0, 1], S[1, 0] = above, below

            @hapbench.force_law("test_average")
            def law(depths, gradients, stiffness):
                return -stiffness * depths @ gradients, S

            damped = {**SHORT, "rendering.damping_ratio": 0.5}
            return hapbench.run(PEG, {**damped, "rendering.algorithm": "test_average"}).state_hash

        average = state_hash(1e-7, 1e-7)
        self.assertEqual(state_hash(0.0, 2e-7), average)
        self.assertEqual(state_hash(2e-7, 0.0), average)
        self.assertNotEqual(state_hash(0.0, 0.0), average)
        with self.assertRaisesRegex(ValueError, r"S\[0, 1\] = 0.001 and S\[1, 0\] = 0.0; allowed"):
            state_hash(1e-3, 0.0)

    def test_a_law_may_change_its_arrays(self):
        @hapbench.force_law("test_in_place")
        def law(depths, gradients, points, normals):
            for array in (depths, gradients, points, normals):
                array *= 2
            return 1

        own, built_in = (
            hapbench.run(PEG, {**SHORT, "rendering.algorithm": name}, record=["contacts"])
            for name in ("test_in_place", "summation")
        )
        self.assertEqual(own.state_hash, built_in.state_hash)
        np.testing.assert_array_equal(own.contacts.depth_m, built_in.contacts.depth_m)

    def test_many_parameters(self):
        def law_with(count):
            names = [f"p{i}" for i in range(count)]
            values = {}
            exec(
                f"def law(depths, {', '.join(names)}):\n    return ({' + '.join(names)}) / {count}",
                values,
            )
            parameters = {name: hapbench.Parameter(0.5, 0, 1) for name in names}
            return hapbench.force_law("test_many", parameters)(values["law"])

        law_with(1000)
        run = hapbench.run(
            PEG,
            {
                **SHORT,
                "rendering.algorithm": "test_many",
                "rendering.parameters.test_many.p999": 1,
            },
            record="contacts",
        )
        np.testing.assert_allclose(run.contacts.weight, 0.5005)
        with self.assertRaisesRegex(ValueError, '"test_many": it has 1001 parameters; allowed'):
            law_with(1001)

    def test_definitions_that_would_register_nothing_or_ignore_a_parameter(self):
        with self.assertRaisesRegex(TypeError, "got the function 'law' as the name"):

            @hapbench.force_law
            def law(depths):
                return 1

        with self.assertRaisesRegex(TypeError, r"force_law\('test_wrong'\)\(LAW\)"):
            hapbench.force_law("test_wrong", summation)
        for name in ("depths", "gradients", "points", "normals", "stiffness"):
            with self.assertRaisesRegex(ValueError, f"parameter '{name}', which is the name of"):
                hapbench.force_law("test_wrong", {name: 1.0})

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


class InARenderer(Scratch):
    """Tests that an exception of a law in a renderer is a FAULT of this renderer and disturbs nothing else."""

    def touched(self, algorithm):
        """Returns a function and the new renderer that it calls. The function rearms the renderer with the tool above
        the plane, then puts the tool into the plane and returns the status."""
        settings = {"rendering.algorithm": algorithm, "time.step_s": 0.001}
        renderer = hapbench.Renderer("poke_plane", settings, max_force_N=3, ramp_s=0)
        times = itertools.count(1_000_000, 1_000_000)

        def touch():
            for rearm in (True, False, False, False, False, False):
                renderer.step(next(times), (0, 0, 1e-3), velocity_m_per_s=(0, 0, 0), rearm=rearm)
            return renderer.step(next(times), (0, 0, -1e-4), velocity_m_per_s=(0, 0, 0))["status"]

        return touch, renderer

    def test_an_exception_is_a_fault_of_this_renderer(self):
        fails = True

        @hapbench.force_law("test_fails")
        def fails_at_first(depths):
            if fails:
                raise RuntimeError("a mistake\nof mine")
            return 1 / len(depths)

        @hapbench.force_law("test_good")
        def good(depths):
            return 1 / len(depths)

        touch, renderer = self.touched("test_fails")
        self.assertEqual(touch(), "FAULT")
        self.assertEqual(
            renderer.fault,
            "test_fails (python_laws_test.py) fails in step: RuntimeError: a mistake?of mine",
        )
        # Neither another renderer nor a run is affected.
        self.assertEqual(self.touched("test_good")[0](), "ON")
        for law in ("mean", "test_good"):
            run = hapbench.run(PEG, {**SHORT, "rendering.algorithm": law})
            self.assertEqual(run.outcome, "completes")
        hapbench.Simulation(PEG, SHORT).advance(10)
        # REARM ends the FAULT as soon as the law works.
        self.assertEqual(touch(), "FAULT")
        fails = False
        self.assertEqual(touch(), "ON")

    def test_wrong_answers_are_faults(self):
        hapbench.force_law("test_wrong")(lambda depths: np.nan)
        touch, renderer = self.touched("test_wrong")
        self.assertEqual(touch(), "FAULT")
        self.assertIn('ValueError: force law "test_wrong": the weight is nan', renderer.fault)

    def test_a_law_that_cannot_be_created_or_reset(self):
        fails = True

        @hapbench.force_law("test_created")
        class Law:
            def __init__(self):
                if fails:
                    raise LookupError("no table")

            def __call__(self, depths):
                return 1 / len(depths)

        with self.assertRaisesRegex(LookupError, "no table"):
            self.touched("test_created")
        fails = False
        touch, renderer = self.touched("test_created")
        self.assertEqual(touch(), "ON")
        fails = True
        renderer.step(1, (0, 0, 0))  # the time is wrong: REARM then resets the law
        self.assertEqual(touch(), "FAULT")
        self.assertIn("throws in reset: LookupError: no table", renderer.fault)
        fails = False
        self.assertEqual(touch(), "ON")
        self.assertEqual(hapbench.run(PEG, SHORT).outcome, "completes")

    def test_an_interrupt_is_raised(self):
        @hapbench.force_law("test_interrupted")
        def law(depths):
            raise KeyboardInterrupt

        touch, renderer = self.touched("test_interrupted")
        with self.assertRaises(KeyboardInterrupt):
            touch()
        self.assertIn("fails in step: KeyboardInterrupt", renderer.fault)
        self.assertEqual(hapbench.run(PEG, SHORT).outcome, "completes")

    def test_runs_in_other_threads_go_on(self):
        begun, let_go = threading.Event(), threading.Event()

        @hapbench.force_law("test_waits")
        def waits(depths):
            begun.set()
            let_go.wait(60)
            return 1 / len(depths)

        @hapbench.force_law("test_fails")
        def fails(depths):
            raise RuntimeError("a mistake")

        outcomes = []
        thread = threading.Thread(
            target=lambda: outcomes.append(
                hapbench.run(PEG, {**SHORT, "rendering.algorithm": "test_waits"}).outcome
            )
        )
        thread.start()
        try:
            self.assertTrue(begun.wait(60))
            self.assertEqual(self.touched("test_fails")[0](), "FAULT")
        finally:
            let_go.set()
            thread.join()
        self.assertEqual(outcomes, ["completes"])

    def test_a_run_inside_the_law_raises_its_own_errors(self):
        @hapbench.force_law("test_nested")
        def law(depths):
            hapbench.run(PEG, SHORT, progress=lambda *_: 1 // 0)
            return 1

        touch, renderer = self.touched("test_nested")
        self.assertEqual(touch(), "FAULT")
        self.assertIn("ZeroDivisionError", renderer.fault)
        self.assertEqual(hapbench.run(PEG, SHORT).outcome, "completes")


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
