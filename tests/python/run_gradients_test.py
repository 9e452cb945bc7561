# SPDX-License-Identifier: GPL-3.0-or-later
"""Derivatives of runs of implicit steps, beside differences of whole runs."""

import unittest
import warnings

import numpy as np

import suture
from gradients_test import MODELS, by_differences, shipped
from scenes import bar
from suture import Quantity

STEPS = 100
DAMAGE = {"E": 1e5, "rho": 1000, "e0": 0.02, "e1": 0.3}


def swinging(model="tm-faure", prepare=lambda sim: None, steps=STEPS, solver=(), **more):
    """A bar that swings, with a damping, and the steps from its start."""
    sim = suture.Simulation(bar((4, 2, 2), **{
        "models": [{"model": model, "parameters": MODELS[model]}],
        "gravity": [0.1, -2, 0.2],
        "solver": {"integrator": "implicit-euler", "dt": 5e-3, "end": 5e-3 * steps,
                   "damping": 0.5, "threads": 1, **dict(solver)},
        **more}))
    prepare(sim)
    sim.keep_steps()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the scheme dissipates
        sim.run()
    return sim


def objective(sim):
    end = np.flatnonzero(sim.rest[:, 0] == 3)
    return Quantity.displacement(end, 1) ** 2 + 1e-5 * Quantity.energy()


class RunGradients(unittest.TestCase):
    def assert_near(self, found, expected, noise=0):
        """noise: of the differences."""
        self.assertLess(abs(found - expected), 1e-5 * abs(expected) + noise)

    def test_by_parameters_of_all_models(self):
        for model in shipped():
            sim = swinging(model)
            J = objective(sim)
            numbers = [name for name, value in MODELS[model].items()
                       if isinstance(value, (int, float))]
            a = sim.adjoint(J, 1e-10, wrt=[(model, name) for name in numbers], moments=True)
            self.assertEqual(a.loads.shape, (STEPS + 1, *sim.rest.shape))
            self.assertAlmostEqual(a.value, J.value(sim))
            for name in numbers:
                value = MODELS[model][name]
                with self.subTest(model=model, parameter=name):
                    def value_with(v):
                        other = swinging(model, lambda sim: sim.parameters[model].update({name: v}))
                        return J.value(other)

                    self.assert_near(a.gradient(model, name),
                                     by_differences(value_with, value, 3e-4 * value),
                                     1e-13 * abs(a.value) / (3e-4 * value))

    def test_by_all_that_determines_a_run(self):
        """After a cut, with a field, a load and a motion at the start, also of a sum over steps."""
        field = 1e5 * np.random.default_rng(1).uniform(0.8, 1.2, 16)
        pull = np.zeros((60, 3))
        shift = np.random.default_rng(2).normal(size=(60, 3))

        def run(E=0, gravity=0, load=0, position=0, velocity=0):
            def prepare(sim):
                sim.cut(plane={"point": [0, 0.5, 0], "normal": [0, 1, 0]}, shape="rest")
                sim.parameters["tm-faure"]["E"] = field * (1 + E * np.linspace(0, 1, 16))
                sim.gravity = [0.1, -2 + gravity, 0.2]
                free = sim.rest[:, :1] > 0
                sim.position = sim.position + position * shift * free
                sim.velocity = 0.3 * sim.rest + velocity * shift * free
                pull[sim.rest[:, 0] == 3] = [0, 30, 10]

                @sim.force_term(energy=lambda x, t: -(1 + load) * (pull * x).sum(), stiffness=0)
                def constant(x, v, t, f):
                    f += (1 + load) * pull

            return swinging(prepare=prepare, steps=30)

        sim = run()
        J = objective(sim)
        for every_step in (False, True):
            def value(**change):
                other = run(**change)
                if not every_step:
                    return J.value(other)
                return other.adjoint(J, every_step=True).value

            a = sim.adjoint(J, 1e-10, every_step)
            by_element = a.gradient("tm-faure", "E")
            self.assert_near(by_element.sum(), a.gradient("tm-faure", "E", "value"))
            regions = np.arange(16) % 2
            np.testing.assert_allclose(a.gradient("tm-faure", "E", regions)[1],
                                       by_element[1::2].sum())
            for name, found, step in (
                    ("E", by_element @ (field * np.linspace(0, 1, 16)), 1e-2),
                    ("gravity", a.gravity[1], 1e-2), ("load", (a.load * pull).sum(), 1e-1),
                    ("position", (a.initial_position * shift).sum(), 1e-4),
                    ("velocity", (a.initial_velocity * shift).sum(), 1e-2)):
                with self.subTest(every_step=every_step, by=name):
                    self.assert_near(found, by_differences(lambda h: value(**{name: h}), 0, step))

    def test_loads_motions_and_reactions_with_a_memory(self):
        """By the force at one moment, the amplitude of a prescribed motion, and a parameter; of a
        reaction and a displacement."""
        def run(integrator, pull=0.0, way=0.05, e1=DAMAGE["e1"]):
            scene = bar((4, 2, 2), gravity=[0, -0.1, 0], models=[
                {"model": "damage-springs", "parameters": {**DAMAGE, "e1": e1}}],
                constraints=[{"fix": "xyz", "where": {"set": "x0"}},
                             {"move": {"translation": [way, 0, 0]}, "ramp": 0.1,
                              "where": {"set": "x1"}}],
                solver={"integrator": integrator, "dt": 0.01, "end": 0.2, "threads": 1} if integrator != "static" else
                {"static": {"frames": 20, "tolerance": 1e-12}, "end": 0.2, "threads": 1})
            sim = suture.Simulation(scene)

            @sim.force_term(energy=lambda x, t: -pull * x[30, 1] * (t > 0.145), stiffness=0)
            def late(x, v, t, f):
                f[30, 1] += pull * (t > 0.145)

            sim.keep_steps(states=6)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                sim.run()
            return sim

        base = np.flatnonzero(run("static").rest[:, 0] == 0)
        J = Quantity.reaction(base, 0) ** 2 + 1e4 * Quantity.displacement([31], 1)
        for integrator in ("implicit-euler", "newmark", "static"):
            sim = run(integrator)
            a = sim.adjoint(J, 1e-11, wrt=[("damage-springs", "e1")], moments=True)
            times = np.linspace(0, 0.2, 21)
            ends = sim.rest[:, 0] == 3
            by_way = (a.motions[:, ends, 0].sum(axis=1) * np.minimum(times / 0.1, 1)).sum()
            for name, found, at, step in (
                    ("pull", a.loads[times > 0.145, 30, 1].sum(), 0, 0.05),
                    ("way", by_way, 0.05, 5e-5),
                    ("e1", a.gradient("damage-springs", "e1"), DAMAGE["e1"], 1e-3)):
                with self.subTest(integrator=integrator, by=name):
                    self.assert_near(found, by_differences(
                        lambda value: J.value(run(integrator, **{name: value})), at, step),
                        1e-10 * abs(a.value) / step)

    def test_a_cut_between_two_runs(self):
        def run(E=1e5):
            scene = bar((4, 2, 2), gravity=[0.1, -2, 0.2], models=[
                {"model": "tm-faure", "parameters": {**MODELS["tm-faure"], "E": E}}],
                solver={"integrator": "newmark", "dt": 5e-3, "end": 0.2, "threads": 1})
            before, after = suture.Simulation(scene), suture.Simulation(scene)
            before.keep_steps(states=4)
            before.run_to(0.1)
            after.restore(before.copy())
            after.cut(plane={"point": [0, 0.5, 0], "normal": [0, 1, 0]}, shape="rest")
            after.keep_steps()
            after.run()
            return before, after

        before, after = run()
        J = objective(after)
        _, (found, by_element, by_gravity) = suture.gradient(
            [before, after], J, [("tm-faure", "E"), ("tm-faure", "E", "element"), "gravity"], 1e-11)
        self.assert_near(found, by_differences(lambda E: J.value(run(E)[1]), 1e5, 30))
        self.assert_near(found, by_element.sum())
        self.assertEqual(by_gravity.shape, (3,))
        with self.assertRaisesRegex(ValueError, "does not start where"):
            suture.gradient([after, after], J, [("tm-faure", "E")])

    def test_under_a_pressure_up_to_a_free_edge(self):
        """The tangent is not symmetric: the adjoint is that of its transpose."""
        load = {"pressure": 4000, "where": {"box": {"min": [1, 1, 0], "max": [2.25, 1, 0.5]}}}
        for solver in ({}, {"integrator": "newmark"},
                       {"integrator": "symplectic-euler", "dt": 1e-3, "end": 0.1}):
            def run(nu):
                return swinging(prepare=lambda sim: sim.parameters["tm-faure"].update(nu=nu),
                                steps=20, solver=solver, loads=[load])

            sim = run(0.3)
            J = objective(sim)
            self.assert_near(sim.adjoint(J, 1e-11).gradient("tm-faure", "nu"),
                             by_differences(lambda nu: J.value(run(nu)), 0.3, 1e-4))

    def test_gradient_is_that_of_the_adjoint(self):
        sim = swinging(steps=5)
        J = objective(sim)
        a = sim.adjoint(J)
        value, found = suture.gradient(sim, J, [("tm-faure", "nu"), "gravity"])
        self.assertEqual(suture.gradient(sim, J, [("tm-faure", "nu")], 1e-9)[1][0], found[0])
        self.assertEqual(value, a.value)
        self.assertEqual(found[0], a.gradient("tm-faure", "nu"))  # by a sweep of its own
        self.assertEqual(value, a.value)
        np.testing.assert_array_equal(found[1], a.gravity)

    def test_later_steps_keep_their_bits(self):
        def run(asks):
            sim = suture.Simulation(bar((4, 2, 2), dt=5e-3, end=0.1, integrator="implicit-euler"))
            sim.keep_steps()
            while sim.step():
                if asks:
                    sim.adjoint(objective(sim), every_step=True).gradient("tm-faure", "rho")
            return sim

        plain, asked = run(False), run(True)
        np.testing.assert_array_equal(plain.position, asked.position)
        np.testing.assert_array_equal(plain.velocity, asked.velocity)
        np.testing.assert_array_equal(plain.mass, asked.mass)

    def test_what_has_no_derivative_is_refused(self):
        def assert_refused(message, change=lambda sim: None, prepare=lambda sim: None, **scene):
            with self.assertRaisesRegex(suture.InputError, message):
                sim = swinging(prepare=prepare, steps=4, **scene)
                change(sim)
                sim.adjoint(objective(sim))

        def between(change):
            """After the second step."""
            return lambda sim: sim.every(2)(lambda sim: sim.steps == 2 and change(sim))

        def cut(sim):
            sim.cut(plane={"point": [0, 0.5, 0], "normal": [0, 1, 0]}, shape="rest")

        assert_refused("energy of a model with a memory", models=[
            {"model": "damage-springs", "parameters": DAMAGE}])
        assert_refused("contact", contact={"obstacles": [
            {"name": "floor", "half_space": {"point": [0, -1, 0], "normal": [0, 1, 0]}}]})
        def push(sim):
            @sim.force_term(stiffness=0)
            def without_energy(x, v, t, f):
                f[30, 1] += 1

        assert_refused("not symmetric", prepare=push)
        assert_refused("do not solve the equations", solver={"integrator": "xpbd"})
        assert_refused("do not solve the equations", solver={"budget": {"iterations": 5}})
        assert_refused("a cut has changed", prepare=between(cut))
        assert_refused("differ in length", model="mss-golec", gravity=[0, -4000, 0],
                       solver={"dt": 0.1, "end": 0.6, "damping": 0})  # a step is rejected
        assert_refused("not in balance",
                       prepare=between(lambda sim: sim.parameters["tm-faure"].update(E=2e5)))
        assert_refused("not in balance", change=lambda sim: sim.parameters["tm-faure"].update(E=2e5))
        assert_refused("has changed since", change=cut)
        assert_refused("no step was made", change=lambda sim: sim.keep_steps())
        with self.assertRaisesRegex(suture.InputError, "reactions"):
            swinging(steps=2, solver={"integrator": "velocity-verlet"}).adjoint(
                Quantity.reaction([0], 1))
        with self.assertRaisesRegex(ValueError, "keep_steps"):
            suture.Simulation(bar()).adjoint(Quantity.energy(), every_step=True)
        sim = suture.Simulation(bar(dt=5e-3, integrator="implicit-euler"))
        sim.keep_steps()
        sim.step(2)
        a = sim.adjoint(objective(sim))
        sim.step()
        with self.assertRaisesRegex(RuntimeError, "has left the run"):
            a.gradient("tm-faure", "E")


if __name__ == "__main__":
    unittest.main()
