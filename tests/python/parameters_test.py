# SPDX-License-Identifier: GPL-3.0-or-later
"""Parameters of models and gravity that change between two steps."""

import unittest

import numpy as np

import suture
from scenes import bar, free_block


def models():
    """Those of the suite that have a Young's modulus."""
    names = []
    for name in ("tm-faure", "mss-baudet", "mss-golec", "neo-hookean", "hooke", "mooney-rivlin",
                 "corotational", "visco", "damage"):
        try:
            suture.Simulation(bar(model=name))
        except suture.Error:
            continue
        names.append(name)
    return names


def sum_of_energy(energies):
    return energies["kinetic"] + energies["elastic"]


class Parameters(unittest.TestCase):
    def test_they_are_those_of_the_scene(self):
        sim = suture.Simulation(bar())
        values = sim.parameters["tm-faure"]
        self.assertEqual((values["E"], values["nu"], values["rho"]), (1e5, 0.3, 1000))
        self.assertEqual(values["element"], "trilinear")
        self.assertEqual(list(sim.parameters), ["tm-faure"])

    def test_everything_is_as_if_the_scene_had_them(self):
        for name in models():
            with self.subTest(model=name):
                sim = suture.Simulation(bar(model=name, dt="auto", end=100))
                sim.step(10)
                sim.cut(plane=([1.5, 0, 0], [1, 0, 0]), shape="rest")
                sim.parameters[name].update(E=4e5, nu=0.25, rho=500)
                other = suture.Simulation(bar(model=name, dt="auto", end=100), set={
                    "/models/0/parameters/E": 4e5, "/models/0/parameters/nu": 0.25,
                    "/models/0/parameters/rho": 500})
                other.cut(plane=([1.5, 0, 0], [1, 0, 0]), shape="rest")
                other.position = sim.position
                for what in ("mass", "force"):
                    ours, theirs = getattr(sim, what), getattr(other, what)
                    self.assertGreater(abs(theirs).max(), 0)
                    np.testing.assert_allclose(ours, theirs, rtol=1e-10,
                                               atol=1e-10 * abs(theirs).max(), err_msg=what)
                for model, column, *_ in sim.columns():
                    np.testing.assert_allclose(sim.column(model, column),
                                               other.column(model, column), rtol=1e-12, atol=1e-12)
                self.assertAlmostEqual(sim.dt / other.dt, 1, delta=0.02)
                self.assertAlmostEqual(sim.energies()["elastic"], other.energies()["elastic"])
                before = sim.dt
                sim.parameters[name]["E"] = 16e5
                self.assertAlmostEqual(sim.dt / before, 0.5, delta=0.02)

    def test_of_one_model_of_two(self):
        def made(rho):
            half = [{"box": {"min": [0, 0, 0], "max": [1.5, 1, 1]}},
                    {"box": {"min": [1.5, 0, 0], "max": [3, 1, 1]}}]
            values = {"E": 1e5, "nu": 0.3, "rho": 1000}
            return suture.Simulation(bar(models=[
                {"model": "tm-faure", "parameters": values, "region": half[0]},
                {"model": "neo-hookean", "parameters": {**values, "rho": rho}, "region": half[1]}]))

        sim = made(1000)
        sim.parameters["neo-hookean"]["rho"] = 3000
        np.testing.assert_allclose(sim.mass, made(3000).mass, rtol=1e-12)
        self.assertEqual(sim.parameters["tm-faure"]["rho"], 1000)
        self.assertEqual(sim.messages[-1], "t = 0 s: model 'neo-hookean' has {\"rho\": 3000}")

    def test_the_change_of_the_energy_is_booked(self):
        for integrator in ("symplectic-euler", "velocity-verlet"):
            sim = suture.Simulation(bar(integrator=integrator, dt=1e-3, end=1))
            sim.step(200)
            before = sim.energies()
            self.assertGreater(before["elastic"], 100)
            sim.parameters["tm-faure"]["E"] = 2e5
            after = sim.energies()
            self.assertAlmostEqual(after["kinetic"], before["kinetic"], delta=1e-9)
            self.assertAlmostEqual(after["elastic"] / before["elastic"], 2)
            self.assertAlmostEqual(after["events"], after["elastic"] - before["elastic"], delta=1e-6)
            self.assertAlmostEqual(after["balance"], before["balance"], delta=1e-6)
            sim.parameters["tm-faure"]["rho"] = 2000
            self.assertAlmostEqual(sim.energies()["kinetic"], 2 * before["kinetic"], delta=1e-6)
            sim.step(200)
            last = sim.energies()
            self.assertLess(abs(last["balance"]), 0.01 * last["gravity"])

    def test_the_balance_with_contact(self):
        for law, integrator in (("impulse", "symplectic-euler"), ("impulse", "velocity-verlet"),
                                ("penalty", "velocity-verlet")):
            contact = {"obstacles": [{"name": "ball",
                                      "sphere": {"centre": [1.4, 0.5, 1.3], "radius": 0.3},
                                      "path": [{"at": 0}, {"at": 1, "translation": [0, 0, -0.2]}]}]}
            if law == "penalty":
                contact["law"] = law
            sim = suture.Simulation(free_block(8, constraints=[
                {"fix": "xyz", "where": {"set": "z0"}}], contact=contact, solver={
                    "dt": "auto", "end": 1, "integrator": integrator, "threads": 1}))
            sim.run_to(0.2)
            before = sim.energies()
            self.assertGreater(sim.tools["ball"].force[2], 10)
            sim.parameters["tm-faure"].update(E=2e5, rho=800)
            after = sim.energies()
            self.assertAlmostEqual(after["kinetic"] / before["kinetic"], 0.8)
            self.assertAlmostEqual(after["elastic"] / before["elastic"], 2, delta=0.2)
            self.assertAlmostEqual(after["balance"], before["balance"],
                                   delta=1e-3 * before["elastic"])
            sim.run_to(0.4)
            last = sim.energies()
            self.assertLess(abs(last["balance"]), 0.03 * last["elastic"])

    def test_implicit_steps_use_them(self):
        def made(**more):
            return suture.Simulation(bar(model="tm-faure", integrator="implicit-euler", dt=5e-3,
                                         end=1, **more))

        sim = made()
        sim.step(20)
        sim.parameters["tm-faure"]["E"] = 1e6
        other = made(models=[{"model": "tm-faure",
                              "parameters": {"E": 1e6, "nu": 0.3, "rho": 1000}}])
        other.position, other.velocity = sim.position, sim.velocity
        for _ in range(5):
            sim.step()
            other.step()
            np.testing.assert_allclose(sim.position, other.position, rtol=0, atol=1e-7)

    def test_static_steps_use_them(self):
        scene = bar(gravity={"value": [0, -0.01, 0], "ramp": {"to": 1}},
                    solver={"static": {"frames": 2}})
        plain, changed = suture.Simulation(scene), suture.Simulation(scene)
        plain.run()
        changed.step()
        half = (changed.position - changed.rest)[:, 1].min()
        changed.parameters["tm-faure"]["E"] = 5e4
        changed.run()
        full = (plain.position - plain.rest)[:, 1].min()
        self.assertAlmostEqual(half / full, 0.5, delta=0.01)
        self.assertAlmostEqual((changed.position - changed.rest)[:, 1].min() / full, 2, delta=0.02)

    def test_what_a_scene_could_not_have_is_refused(self):
        sim = suture.Simulation(bar())
        sim.step(5)
        organ, twin = sim.parameters["tm-faure"], suture.Simulation(bar())
        twin.step(5)
        for values, text in (({"E": -1}, "/E: must be > 0 Pa"), ({"F": 1}, "did you mean 'E'"),
                             ({"nu": 0.5}, "/nu: must be > -1 and < 0.5"),
                             ({"E": "soft"}, "must be a number"),
                             ({"rho": 500, "element": "trilinea"}, "did you mean")):
            with self.assertRaisesRegex(suture.SceneError, text):
                organ.update(values)
        rows = np.full(24, 1e5)
        for wrong, error, text in (
                ([1, 2], suture.InputError, "has 24 rows of elements; .* is given 2 values"),
                (np.where(np.arange(24) == 7, -1, rows), suture.InputError,
                 "'E' must be > 0 Pa, is -1 at element 7"),
                (np.where(np.arange(24) == 7, np.nan, rows), suture.InputError, "element 7"),
                (rows[:, None], ValueError, "one value per element"), (["a"], TypeError, "a number")):
            with self.assertRaisesRegex(error, text):
                organ["E"] = wrong
        with self.assertRaisesRegex(suture.InputError, "not a number"):
            organ["quadrature"] = rows
        with self.assertRaisesRegex(suture.InputError, "switch functors .* when a scene is built"):
            organ["element"] = "mean-gradient"
        with self.assertRaisesRegex(KeyError, "did you mean 'tm-faure'"):
            sim.parameters["tm-faur"]
        with self.assertRaisesRegex(KeyError, "did you mean 'rho'"):
            organ["rh"]
        sim.step(5)
        twin.step(5)
        np.testing.assert_array_equal(sim.position, twin.position)

    def test_what_would_be_ignored_cannot_be_assigned(self):
        sim = suture.Simulation(bar())
        with self.assertRaisesRegex(AttributeError, "no 'gravityy' .* mean 'gravity'"):
            sim.gravityy = [0, 0, 0]
        with self.assertRaisesRegex(AttributeError, r"sim.parameters\[model\]\[name\]"):
            sim.E = 2e4
        for wrong in ("stress", "dt", "mass", "parameters"):
            with self.assertRaises(AttributeError):
                setattr(sim, wrong, 1)
        with self.assertRaises(AttributeError):
            sim.parameters["tm-faure"].E = 2e4
        with self.assertRaises(TypeError):
            sim.parameters["tm-faure"] = {"E": 2e4}
        sim._mine = 3
        self.assertEqual(sim._mine, 3)

    def test_a_parameter_by_element(self):
        """A number for all elements, and an array of one per element, before and after a cut."""
        table = {"regions": [{"region": {"box": {"min": [0, 0, 0], "max": [1.5, 1, 1]}},
                              "value": 1e5}], "elsewhere": 2e5}
        for name in models():
            given = {"/models/0/parameters/" + p: table for p in ("E",)}
            try:
                scene = suture.Simulation(bar(model=name), set=given)
            except suture.SceneError:  # none of its parameters may differ
                continue
            with self.subTest(model=name):
                field = scene.parameters[name]["E"]
                self.assertEqual(set(field), {1e5, 2e5})
                assigned = suture.Simulation(bar(model=name))
                for sim in (scene, assigned):
                    sim.cut(plane=([1.5, 0, 0], [1, 0, 0]), shape="rest")
                assigned.parameters[name]["E"] = field
                np.testing.assert_array_equal(assigned.parameters[name]["E"], field)
                assigned.position = scene.position = 1.05 * scene.rest + 0.02 * scene.rest**2
                np.testing.assert_allclose(assigned.force, scene.force, rtol=1e-11,
                                           atol=1e-11 * abs(scene.force).max())
                scene.parameters[name]["E"] = 1e5
                self.assertEqual(set(scene.parameters[name]["E"]), {1e5})

    def test_arrays_of_before_keep_their_values(self):
        sim = suture.Simulation(bar())
        mass = sim.mass
        sim.parameters["tm-faure"]["rho"] = 500
        np.testing.assert_allclose(mass, 2 * sim.mass)

    def test_a_callback_may_change_them(self):
        sim = suture.Simulation(bar(dt="auto", end=100))

        @sim.at(0.01)
        def stiffen(sim):
            sim.parameters["tm-faure"]["E"] *= 4

        before = sim.dt
        sim.run_to(0.02)
        self.assertAlmostEqual(sim.dt / before, 0.5, delta=0.03)


class Gravity(unittest.TestCase):
    def test_a_falling_block_goes_on_without_it(self):
        for integrator in ("symplectic-euler", "velocity-verlet"):
            sim = suture.Simulation(free_block(gravity=[0, -10, 0], dt=1e-3, end=1,
                                               integrator=integrator))
            sim.step(100)
            falling = sim.energies()["kinetic"]
            self.assertGreater(falling, 1400)
            sim.gravity = [0, 0, 0]
            self.assertAlmostEqual(sim.energies()["kinetic"] / falling, 1)
            sim.step(100)
            self.assertAlmostEqual(sim.energies()["kinetic"] / falling, 1)
            sim.gravity = [0, 10, 0]
            sim.step(50)
            energies = sim.energies()
            self.assertAlmostEqual(energies["kinetic"] / falling, 0.25, delta=0.01)
            self.assertAlmostEqual(energies["gravity"] / energies["kinetic"], 1, delta=1e-3)
            self.assertAlmostEqual(energies["balance"], 0, delta=0.04)  # h^2/8 sum F^2/m
            self.assertAlmostEqual(energies["events"], 0, delta=1e-9)

    def test_its_value_and_its_mistakes(self):
        sim = suture.Simulation(bar())
        self.assertEqual(sim.gravity, [0, -9.8, 0])
        sim.gravity = np.array([1, 2, 3])
        self.assertEqual(sim.gravity, [1, 2, 3])
        for wrong in (9.8, [1, 2], "down", None):
            with self.assertRaisesRegex(TypeError, "gravity must be three numbers"):
                sim.gravity = wrong
        with self.assertRaisesRegex(suture.InputError, "gravity must be finite"):
            sim.gravity = [0, float("nan"), 0]
        self.assertEqual(sim.gravity, [1, 2, 3])


if __name__ == "__main__":
    unittest.main()
