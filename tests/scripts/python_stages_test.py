"""Force stages in Python. Arguments: those of python_fixture.py."""
import unittest

import numpy as np
from python_fixture import PEG, SHORT, Scratch, main

import hapbench


def added(name, **config):
    return {"rendering.force_stage": {"type": "added", "name": name, "config": config}}


class Stages(Scratch):
    def test_an_idle_stage_moves_no_bit(self):
        hapbench.force_stage("test_idle")(lambda force: force)
        for scene in (PEG, "drag_molar"):
            bare, idle = (hapbench.run(scene, {**SHORT, **stage}) for stage in ({}, added("test_idle")))
            self.assertEqual(bare.state_hash, idle.state_hash)
            self.assertEqual(idle.summary["force_stage"], {"changed_share": 0.0, "taken_J": 0.0})

    def test_a_brake_is_more_damping(self):
        """-b v beside f is what a spring of damping B + b gives, where S is the whole plane's projector: on one spring."""
        @hapbench.force_stage("test_brake")
        def brake(force, velocity, damping=1.0):
            return force - damping * velocity

        spring = {"time.steps": 300, "expect": "{}", "rendering.damping_N_s_per_m": 5}
        braked = hapbench.run("single_spring", {**spring, **added("test_brake", damping=7)}, record=["trajectory"])
        damped = hapbench.run("single_spring", {**spring, "rendering.damping_N_s_per_m": 12}, record=["trajectory"])
        # Roundings of 300 steps on 1 mm.
        np.testing.assert_allclose(braked.trajectory.px_m, damped.trajectory.px_m, rtol=0, atol=1e-15)
        # What it took: b |v|^2 dt, by the mean of the velocities of two rows.
        v = braked.trajectory.vx_m_per_s
        taken = np.sum(7 * v[:-1] * (v[:-1] + v[1:]) / 2) * 0.0005
        self.assertAlmostEqual(braked.summary["force_stage"]["taken_J"], taken, delta=1e-12 * taken)

    def test_what_it_is_told(self):
        seen = []

        @hapbench.force_stage("test_told")
        class Told:
            def __init__(self, gain):
                self.gain, self.rows = gain, 0

            def __call__(self, force, spring, tensor, position, velocity, device_position, device_velocity, device_force, energy,
                         in_contact, row, time_step, mass, stiffness):
                assert row == self.rows, (row, self.rows)  # an object of its own for each run
                self.rows += 1
                seen.append((np.concatenate([force, spring, position, velocity, device_force]), tensor, energy, in_contact,
                             (time_step, mass, stiffness)))
                return self.gain * force

        run = hapbench.run("drag_molar", {"time.steps": 400, "expect": "{}", **added("test_told", gain=0.5)},
                           record=["trajectory", "stiffness_tensor"])
        t = run.trajectory
        told = np.array([row[0] for row in seen])
        np.testing.assert_array_equal(told[:, 6], t.px_m)
        np.testing.assert_array_equal(told[:, 9], t.vx_m_per_s)
        np.testing.assert_array_equal(told[:, 5], t.fspring_z_N)
        np.testing.assert_array_equal(0.5 * told[:, 2], t.fz_N)
        self.assertEqual([row[3] for row in seen], list(t.rendered > 0))
        self.assertTrue(any(row[3] for row in seen))
        self.assertEqual(seen[0][4], (run.scenario["time"]["step_s"], 0.1, run.scenario["rendering"]["stiffness_N_per_m"]))
        self.assertEqual(seen[-1][1].shape, (3, 3))
        np.testing.assert_array_equal(seen[-1][1], seen[-1][1].T)

    def test_in_studies(self):
        hapbench.force_stage("test_half")(lambda force, share=0.5: share * force)
        table = hapbench.sweep(PEG, {"rendering.algorithm": "summation,mean", "rendering.force_stage.config.share": [0.5, 1.0]},
                               {**SHORT, **added("test_half", share=1.0)}, jobs=2).sweep
        self.assertEqual(len(set(table["state_hash"])), 4)
        compared = hapbench.compare(PEG, ["summation", "mean"], {**SHORT, **added("test_half", share=1.0)}, jobs=2)
        self.assertEqual(compared.runs["mean"].state_hash, hapbench.run(PEG, {**SHORT, "rendering.algorithm": "mean"}).state_hash)

    def test_what_is_wrong_is_raised(self):
        @hapbench.force_stage("test_raises")
        def raises(force, row):
            if row == 3:
                raise RuntimeError("enough")
            return force

        with self.assertRaisesRegex(RuntimeError, "enough"):
            hapbench.run(PEG, {**SHORT, **added("test_raises")})
        for answer, said in ((None, "got None"), ([1, 2], r"got \[1, 2\]"), ([1, 2, np.nan], "three finite numbers")):
            hapbench.force_stage("test_wrong")(lambda force, answer=answer: answer)
            with self.assertRaisesRegex(ValueError, f'force stage "test_wrong": .*{said}'):
                hapbench.run(PEG, {**SHORT, **added("test_wrong")})
        with self.assertRaisesRegex(TypeError, "unexpected keyword argument 'gain'"):
            hapbench.run(PEG, {**SHORT, **added("test_raises", gain=1)})
        with self.assertRaisesRegex(TypeError, "arguments .*'share', 'force'.*; allowed: first some of force, spring"):
            hapbench.force_stage("test_order")(lambda share, force: force)
        with self.assertRaises(hapbench.ScenarioError) as caught:
            hapbench.run(PEG, {**SHORT, **added("test_nobody")})
        self.assertEqual(caught.exception.pointer, "/rendering/force_stage/name")


if __name__ == "__main__":
    main()
