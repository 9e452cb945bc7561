# SPDX-License-Identifier: GPL-3.0-or-later
"""Forces that Python functions compute."""

import os
import tempfile
import unittest

import numpy as np

import suture
from scenes import bar, free_block


class Forces(unittest.TestCase):
    def test_an_oscillator(self):
        w = 40.0  # 1/s, of all vertices together: the block moves and does not deform
        sim = suture.Simulation(free_block(2, dt=1e-4, end=1))
        mass = sim.mass.copy()
        centre = sim.rest.mean(axis=0)

        @sim.force_term(energy=lambda x, t: 0.5 * w**2 * 3000 * (
            (mass @ x) / 3000 - centre)[0] ** 2)
        def together(x, v, t, f):
            f[:, 0] -= w**2 * mass * ((mass @ x) / 3000 - centre)[0]

        sim.velocity = np.tile([1.0, 0, 0], (len(sim.rest), 1))
        period = 2 * np.pi / w
        sim.run_to(period / 4)
        # x = sin(w t) / w, of steps of dt: the error is (w dt)^2 / 24
        expected = np.sin(w * sim.time) / w
        np.testing.assert_allclose(sim.position[:, 0] - sim.rest[:, 0], expected, rtol=1e-4)
        e = sim.energies()
        self.assertAlmostEqual(e["elastic"], 0.5 * 3000, delta=1)
        self.assertLess(abs(e["balance"]), 1)

    def test_it_agrees_with_the_same_load_of_a_scene(self):
        load = {"force": [0, 50, 30], "where": {"set": "x1"}}
        loaded = suture.Simulation(bar(loads=[load]))
        sim = suture.Simulation(bar())
        end = np.isclose(sim.rest[:, 0], 3)
        # The nodes of the end face share the load by the areas around them: 1, 2 or 4 of 16.
        edges = np.isclose(sim.rest[:, 1] % 1, 0).astype(int) + np.isclose(sim.rest[:, 2] % 1, 0)
        share = np.where(end, 2.0 ** (2 - edges) / 16, 0)

        @sim.force_term(stiffness=0)
        def pull(x, v, t, f):
            f += share[:, None] * [0, 50, 30]

        for one in (sim, loaded):
            one.run()
        np.testing.assert_allclose(sim.position, loaded.position, atol=1e-12)
        self.assertAlmostEqual(sim.energies()["pull"], loaded.energies()["loads"], places=8)
        term, = sim.force_terms
        self.assertEqual(term.name, "pull")
        self.assertGreaterEqual(term.calls, 200)
        self.assertLess(term.calls, 260)
        self.assertGreater(term.seconds, 0)

    def test_work_without_an_energy_closes_the_balance(self):
        sim = suture.Simulation(bar())

        @sim.force_term(stiffness=1e3)
        def drag(x, v, t, f):
            f -= 5 * v

        sim.run()
        e = sim.energies()
        self.assertLess(e["drag"], 0)
        self.assertLess(abs(e["balance"]), 0.02 * e["gravity"])

    def test_a_stiff_force_shortens_the_automatic_step(self):
        for stiffness, highest in ((None, 1.35), (1e7, 1.01)):
            with self.subTest(stiffness):
                sim = suture.Simulation(free_block(2, dt="auto", end=0.01),
                                        set={"/solver/safety": 0.4})
                free = sim.dt
                rest = sim.rest.copy()

                @sim.force_term(stiffness=stiffness,
                                energy=lambda x, t: 0.5e7 * ((x - rest) ** 2).sum())
                def foundation(x, v, t, f):
                    f -= 1e7 * (x - rest)

                lightest = sim.mass.min()
                limit = 2 * np.sqrt(lightest / 1e7)  # of the foundation alone
                self.assertLess(sim.dt, free / 2)
                self.assertLess(sim.dt, limit)
                sim.velocity = np.random.default_rng(2).normal(size=rest.shape)
                sim.run()
                e = sim.energies()
                self.assertLess(abs(e["balance"]), 0.2 * e["events"])

    def test_an_implicit_integrator_uses_its_derivative(self):
        sim = suture.Simulation(bar(dt=5e-3, end=0.05, integrator="newmark"))
        rest = sim.rest.copy()

        @sim.force_term(energy=lambda x, t: 5e3 * ((x - rest) ** 2).sum())
        def foundation(x, v, t, f):
            f -= 1e4 * (x - rest)

        explicit = suture.Simulation(bar(dt=1e-4, end=0.05))
        explicit.force_term(lambda x, v, t, f: np.subtract(f, 1e4 * (x - rest), out=f),
                            energy=lambda x, t: 5e3 * ((x - rest) ** 2).sum(), name="foundation")
        sim.run()
        explicit.run()
        moved = np.abs(explicit.position - rest).max()
        self.assertGreater(moved, 1e-3)
        np.testing.assert_allclose(sim.position, explicit.position, atol=0.1 * moved)

    def test_an_equilibrium(self):
        scene = bar(gravity={"value": [0, -1, 0], "ramp": 1}, solver={"static": {"frames": 3}})
        sim, free = suture.Simulation(scene), suture.Simulation(scene)
        rest = sim.rest.copy()

        @sim.force_term(energy=lambda x, t: 50 * ((x - rest) ** 2).sum())
        def foundation(x, v, t, f):
            f -= 100 * (x - rest)

        sim.run(), free.run()
        lifted = 100 * (rest - sim.position)[:, 1].sum()
        held = sim.fixed == 0
        # What the springs carry, the clamp does not.
        self.assertGreater(lifted, 100)
        residual = sim.force[held] + sim.mass[held, None] * [0, -1, 0]
        self.assertLess(np.abs(residual).max(), 1e-4)
        self.assertLess(np.abs(sim.position - rest).max(), 0.9 * np.abs(free.position - rest).max())

    def test_it_goes_on_after_a_cut(self):
        sim = suture.Simulation(bar())
        sizes = []

        @sim.force_term(stiffness=0)
        def lift(x, v, t, f):
            sizes.append(len(x))
            f[:, 1] += 1

        sim.step(10)
        sim.cut(plane=([1.5, 0, 0], [1, 0, 0]))
        sim.run()
        self.assertEqual((sizes[0], sizes[-1]), (63, 72))


class Mistakes(unittest.TestCase):
    def test_an_exception_around_a_cut_comes_with_the_next_step(self):
        sim = suture.Simulation(bar(model="mss-baudet"))
        broken = []

        @sim.force_term(stiffness=0)
        def lift(x, v, t, f):
            if broken:
                raise ZeroDivisionError("mine")
            f[:, 1] += 1

        sim.step(10)
        broken.append(True)
        self.assertEqual(sim.cut(plane=([1.5, 0, 0], [1, 0, 0])).faces_cut, 4)
        self.assertEqual(sim.position.shape, (72, 3))
        with self.assertRaisesRegex(ZeroDivisionError, "mine"):
            sim.step()
        broken.clear()
        sim.run()
        self.assertEqual(sim.outcome, "finished")

    def test_an_exception_reaches_the_caller_and_the_run_goes_on(self):
        for integrator in ("symplectic-euler", "velocity-verlet", "newmark"):
            with self.subTest(integrator):
                sims = []
                for fails in (True, False):
                    sim = suture.Simulation(bar(integrator=integrator))
                    calls = [0]

                    @sim.force_term(stiffness=0)
                    def lift(x, v, t, f, calls=calls, fails=fails):
                        calls[0] += 1
                        if fails and calls[0] == 20:
                            raise ZeroDivisionError("mine")
                        f[:, 1] += 5

                    if fails:
                        with self.assertRaisesRegex(ZeroDivisionError, "mine"):
                            sim.run()
                        self.assertTrue(0 < sim.steps < 20)
                        self.assertIsNone(sim.outcome)
                    sim.run()
                    sims.append(sim)
                np.testing.assert_array_equal(sims[0].position, sims[1].position)
                self.assertEqual(sims[0].steps, sims[1].steps)

    def test_forces_that_are_not_finite(self):
        sim = suture.Simulation(bar())

        @sim.force_term(stiffness=0)
        def bad(x, v, t, f):
            if t > 0.001:
                f[7, 2] = np.inf

        with self.assertRaisesRegex(ValueError, "'bad' gave a force that is not finite, on vertex 7"):
            sim.run()
        self.assertTrue(np.isfinite(sim.position).all())

    def test_a_function_that_fails_at_once_is_not_added(self):
        sim = suture.Simulation(bar())
        with self.assertRaises(IndexError):
            sim.force_term(lambda x, v, t, f: f[99999])
        with self.assertRaisesRegex(TypeError, "returned a value"):
            sim.force_term(lambda x, v, t, f: f + 1)
        with self.assertRaises(TypeError):
            sim.force_term(lambda x: None)
        with self.assertRaisesRegex(ValueError, "stiffness"):
            sim.force_term(lambda x, v, t, f: None, stiffness=-1)
        with self.assertRaisesRegex(ValueError, "already has an entry 'gravity'"):
            sim.force_term(lambda x, v, t, f: None, name="gravity")
        self.assertEqual(sim.force_terms, ())
        twin = suture.Simulation(bar())
        sim.run(), twin.run()
        np.testing.assert_array_equal(sim.position, twin.position)

    def test_energies_csv_has_no_column_for_it(self):
        before = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                sim = suture.Simulation(bar(output={"energies": {"every_steps": 10}}),
                                        output=True)
                with self.assertRaisesRegex(suture.InputError, "energies.csv has no column"):
                    sim.force_term(lambda x, v, t, f: None, name="mine")
            finally:
                os.chdir(before)

    def test_a_force_function_may_read_columns_and_nothing_else(self):
        sim = suture.Simulation(bar())
        tried = []

        @sim.force_term(stiffness=0)
        def lift(x, v, t, f):
            f[:, 1] += sim.mass * (sim.rest[:, 0] > 1)
            np.testing.assert_array_equal(sim.position, x)
            for forbidden in tried:
                forbidden()

        sim.step(2)
        for forbidden, text in [
            (lambda: sim.cut(plane=([1.5, 0, 0], [1, 0, 0])), "within a step"),
            (lambda: sim.force, "within a step"),
            (lambda: sim.energies(), "within a step"),
            (lambda: setattr(sim, "velocity", sim.rest), "within a step"),
            (lambda: sim.step(), "cannot make steps of its own run"),
        ]:
            tried[:] = [forbidden]
            with self.assertRaisesRegex(RuntimeError, text):
                sim.step()
        tried.clear()
        sim.run()
        self.assertEqual(sim.outcome, "finished")

    def test_arguments_that_are_kept_stay_as_they_were(self):
        sim = suture.Simulation(bar())
        kept = []

        @sim.force_term(stiffness=0)
        def keep(x, v, t, f):
            kept.append((x, f, x.copy()))
            f[:, 1] += 1

        sim.step(20)
        for x, f, copy in kept:
            np.testing.assert_array_equal(x, copy)
            f[:] = 1e30  # too late to act
        sim.run()
        self.assertLess(np.abs(sim.position).max(), 10)


if __name__ == "__main__":
    unittest.main()
