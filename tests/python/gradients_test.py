# SPDX-License-Identifier: GPL-3.0-or-later
"""Derivatives of equilibria, beside differences of whole equilibria."""

import re
import unittest
from importlib.util import find_spec
from pathlib import Path

import numpy as np

import suture
from scenes import bar
from suture import Quantity

STEP = 1e-3  # of a parameter
DOCS = Path(__file__).parents[2] / "docs"

MODELS = {
    "tm-faure": {"E": 1e5, "nu": 0.3, "rho": 1000},
    "neo-hookean": {"E": 1e5, "nu": 0.3, "rho": 1000},
    "hooke": {"E": 1e5, "nu": 0.3, "rho": 1000},
    "corotational": {"E": 1e5, "nu": 0.3, "rho": 1000},
    "mooney-rivlin": {"C10": 1e4, "C01": 5e3, "K": 1e5, "rho": 1000},
    "fibres": {"mu": 4e4, "lambda": 6e4, "k1": 1e5, "k2": 20, "rho": 1000, "fibre": [1, 0.5, 0.2]},
    "mss-baudet": {"E": 1e5, "nu": 0.25, "rho": 1000},
    "mss-golec": {"E": 1e5, "nu": 0.3, "rho": 1000},
}


def sagging(model, cells=(4, 2, 2), **more):
    """The equilibrium of a bar."""
    return bar(cells, **{"models": [{"model": model, "parameters": MODELS[model]}],
                         "gravity": [0.1, -0.6, 0.2],
                         "solver": {"static": {"frames": 1, "tolerance": 1e-12}, "threads": 1},
                         **more})


def shipped():
    """The models of this installation."""
    for name in MODELS:
        try:
            suture.Simulation(sagging(name))
        except suture.SceneError as error:
            if "parameters" in str(error):
                raise
            continue
        yield name


def objective(sim):
    """Of displacements, reactions and the energy."""
    end, base = (np.flatnonzero(sim.rest[:, 0] == x) for x in (3, 0))
    return (Quantity.displacement(end, 1) ** 2 + 1e-3 * Quantity.displacement(end[:2], 0)
            + 1e-6 * Quantity.reaction(base[:3], 0) - 1e-5 * Quantity.energy())


def by_differences(value_at, at, step):
    values = [value_at(at + k * step) for k in (-2, -1, 1, 2)]
    return (8 * (values[2] - values[1]) - (values[3] - values[0])) / (12 * step)


class Gradients(unittest.TestCase):
    def assert_near(self, found, expected, message="", noise=0):
        """noise: of the differences."""
        self.assertLess(abs(found - expected), 1e-6 * abs(expected) + noise, message)

    def check_parameters(self, sim, model):
        J = objective(sim)
        a = sim.adjoint(J, tolerance=1e-10)
        self.assertAlmostEqual(a.value, J.value(sim))
        numbers = {name: value for name, value in sim.parameters[model].items()
                   if isinstance(value, float) and value > 0}
        found = {name: (a.gradient(model, name),
                        sim.sensitivity(model, name, tolerance=1e-10).of(J)) for name in numbers}

        def value_at(name, value):
            sim.parameters[model][name] = value
            sim.equilibrate()
            return J.value(sim)

        for name, value in numbers.items():
            with self.subTest(model=model, parameter=name):
                expected = by_differences(lambda v: value_at(name, v), value, STEP * value)
                value_at(name, value)
                noise = 1e-11 * abs(a.value) / (STEP * value)
                self.assert_near(found[name][0], expected, "adjoint", noise)
                self.assert_near(found[name][1], expected, "sensitivity", noise)

    def test_by_parameters_of_all_models(self):
        for model in shipped():
            sim = suture.Simulation(sagging(model))
            sim.run()
            self.check_parameters(sim, model)

    def test_after_a_cut(self):
        for model in shipped():
            sim = suture.Simulation(sagging(model))
            sim.cut(plane={"point": [0, 0.5, 0], "normal": [0, 1, 0]}, shape="rest")
            sim.run()
            self.check_parameters(sim, model)


    def field(self, sim, model, parameter, seed=1):
        """A random field around the value of the scene."""
        rows = len(sim.column_cells(model, 3))
        return MODELS[model][parameter] * np.random.default_rng(seed).uniform(0.8, 1.2, rows)

    def test_by_element_region_and_value(self):
        for model in set(shipped()) & {"tm-faure", "mss-golec", "fibres"}:
            sim = suture.Simulation(sagging(model))
            sim.cut(plane={"point": [0, 0.5, 0], "normal": [0, 1, 0]}, shape="rest")
            sim.run()
            for name in [name for name in MODELS[model] if name not in ("fibre", "k2")]:
                sim.parameters[model][name] = self.field(sim, model, name)
            sim.equilibrate()
            J = objective(sim)
            for name in ("E", "nu", "rho", "mu", "k1"):
                if name not in MODELS[model]:
                    continue
                with self.subTest(model=model, parameter=name):
                    a = sim.adjoint(J, 1e-10)
                    by_element = a.gradient(model, name)
                    self.assertEqual(by_element.shape, (len(sim.column_cells(model, 3)),))
                    self.assertGreater(abs(by_element).min(), 0)
                    regions = np.arange(len(by_element)) % 3 - 1
                    np.testing.assert_allclose(
                        a.gradient(model, name, regions),
                        [by_element[regions == 0].sum(), by_element[regions == 1].sum()],
                        rtol=1e-12)
                    self.assert_near(a.gradient(model, name, "value"), by_element.sum())
                    of_regions = sim.sensitivity(model, name, regions, 1e-10)
                    self.assertEqual(of_regions.displacement.shape, (2, *sim.rest.shape))
                    for found, expected in zip(of_regions.of(J),
                                               a.gradient(model, name, regions)):
                        self.assert_near(found, expected)
                    self.assertLess(suture.check_gradient(sim, J, (model, name)).error, 1e-6)

    def test_on_parts_of_elements(self):
        cut = {"at": 0, "cut": {"plane": {"point": [1.6, 0.55, 0.5], "normal": [0.3, 1, 0.1],
                                          "radius": 0.9}, "along": "blade"}}
        for model in set(shipped()) & {"tm-faure", "mss-golec", "fibres"}:
            sim = suture.Simulation(sagging(model, (6, 3, 3), events=[cut]))
            sim.run()
            self.assertGreater(len(sim.column_cells(model, 3)), 60)
            J = objective(sim)
            for name in set(MODELS[model]) - {"fibre", "k2"}:
                with self.subTest(model=model, parameter=name):
                    a = sim.adjoint(J, 1e-10)
                    self.assert_near(a.gradient(model, name, "element").sum(),
                                     a.gradient(model, name, "value"))
                    self.assertLess(suture.check_gradient(sim, J, (model, name)).error, 1e-6)

    def test_by_element_of_a_uniform_parameter(self):
        sim = suture.Simulation(sagging("mss-golec"))
        sim.run()
        a = sim.adjoint(objective(sim), 1e-10)
        self.assert_near(a.gradient("mss-golec", "E", "element").sum(),
                         a.gradient("mss-golec", "E"))

    def test_by_gravity_and_forces(self):
        sim = suture.Simulation(sagging("tm-faure"))
        pull = np.zeros(sim.rest.shape)
        pull[sim.rest[:, 0] == 3] = [0, 0.3, 0.1]
        amount = 1.0

        @sim.force_term(energy=lambda x, t: -amount * (pull * x).sum(), stiffness=0)
        def load(x, v, t, f):
            f += amount * pull

        sim.run()
        J = objective(sim)
        a = sim.adjoint(J, 1e-10)

        def with_gravity(g):
            sim.gravity = [0.1, g, 0.2]
            sim.equilibrate()
            return J.value(sim)

        self.assert_near(a.gravity[1], by_differences(with_gravity, -0.6, 1e-3))
        with_gravity(-0.6)

        def with_load(factor):
            nonlocal amount
            amount = factor
            sim.gravity = sim.gravity  # the forces are others
            sim.equilibrate()
            return J.value(sim)

        self.assert_near((a.load * pull).sum(), by_differences(with_load, 1, 1e-3))

    def test_by_prescribed_motion(self):
        def stretched(by):
            sim = suture.Simulation(sagging("tm-faure", constraints=[
                {"fix": "xyz", "where": {"set": "x0"}},
                {"move": {"translation": [by, 0.1, 0]}, "ramp": 1, "where": {"set": "x1"}}]))
            sim.run()
            return sim

        def J(sim):
            base = np.flatnonzero(sim.rest[:, 0] == 0)
            middle = np.flatnonzero(sim.rest[:, 0] == 1.5)
            return (Quantity.reaction(base, 0) / 1e3 + Quantity.displacement(middle[:2], 1)
                    + Quantity.energy() / 1e4)

        sim = stretched(0.2)
        a = sim.adjoint(J(sim), 1e-10)
        end = sim.rest[:, 0] == 3
        self.assert_near(a.motion[end, 0].sum(),
                         by_differences(lambda by: J(sim).value(stretched(by)), 0.2, 1e-3))
        self.assertEqual(abs(a.motion[(sim.rest[:, 0] > 0) & ~end]).max(), 0)

    def test_by_rest_positions(self):
        """Of a bar whose shape changes, after a cut, beside scenes of the other shapes."""
        def shaped(model, by):
            box = suture.Simulation(sagging(model)).mesh()
            x = box.points
            bulge = np.c_[0.1 * x[:, 1] * x[:, 0], 0.05 * x[:, 0] ** 2, 0.1 * np.sin(x[:, 0])]
            mesh = suture.Mesh(x + (0.5 + by) * bulge, box.hexahedra)
            base, end = (np.flatnonzero(x[:, 0] == at).tolist() for at in (0, 3))
            sim = suture.Simulation(sagging(model, mesh=mesh, constraints=[
                {"fix": "xyz", "where": {"ids": base}},
                {"move": {"translation": [0.1, 0, 0]}, "ramp": 1, "where": {"ids": end}}]))
            sim.cut(faces=[(4, 5), (8, 9)])
            sim.run()
            return sim, bulge[sim.point_ids]

        def without_energy(sim):
            middle = np.flatnonzero(abs(sim.point_ids - 20) < 4)
            base = np.flatnonzero(sim.rest[:, 0] == 0)
            return Quantity.displacement(middle, 1) + Quantity.reaction(base[:4], 0) / 1e5

        def J(sim):
            return without_energy(sim) + Quantity.energy() / 1e4

        for model in set(shipped()) & {"tm-faure", "neo-hookean", "corotational"}:
            with self.subTest(model=model):
                sim, bulge = shaped(model, 0)
                a = sim.adjoint(J(sim), 1e-10)
                self.assert_near(
                    a.along_rest(bulge),
                    by_differences(lambda by: J(sim).value(shaped(model, by)[0]), 0, 1e-3))
                of_all = sim.adjoint(without_energy(sim), 1e-10)
                self.assert_near((of_all.rest * bulge).sum(), of_all.along_rest(bulge))
                self.assertGreater(np.count_nonzero(of_all.rest), of_all.rest.size / 2)
                whole = abs(a.along_rest(np.ones_like(bulge)))
                self.assertLess(whole, 1e-6 * abs(a.motion).max())

    def test_where_an_obstacle_presses(self):
        """Where its gaps are held exactly: a run holds them to 1e-4 of an edge."""
        def indented(friction=0, **values):
            ball = {"name": "ball", "sphere": {"centre": [1.5, 1.3, 0.5], "radius": 0.3},
                    "friction": friction,
                    "path": [{"at": 0}, {"at": 1, "translation": [0.02, -0.1, 0.01]}]}
            sim = suture.Simulation(sagging(
                "neo-hookean", (6, 3, 6), contact={"obstacles": [ball]},
                constraints=[{"fix": "xyz", "where": {"set": "y0"}}]))
            sim.parameters["neo-hookean"].update(values)
            sim.run()
            for _ in range(12):
                sim.equilibrate()
            self.assertGreater((sim.contact_force != 0).any(axis=1).sum(), 2)
            return sim

        sim = indented()
        base, top = (np.flatnonzero(sim.rest[:, 1] == y) for y in (0, 1))
        beside = top[abs(sim.rest[top, 0] - 1.5) > 0.6]
        J = (Quantity.reaction(base, 1) / 1e3 + Quantity.displacement(beside, 1)
             + Quantity.energy() / 1e2)
        a = sim.adjoint(J, 1e-8)
        for name, value in (("E", 1e5), ("nu", 0.3)):
            found = a.gradient("neo-hookean", name)
            self.assert_near(sim.sensitivity("neo-hookean", name, tolerance=1e-8).of(J), found)
            self.assert_near(found, by_differences(
                lambda v: J.value(indented(**{name: v})), value, 2e-3 * value))
        with self.assertRaisesRegex(suture.InputError, "contact with friction"):
            indented(0.3).adjoint(Quantity.energy())

    def test_objectives(self):
        sim = suture.Simulation(sagging("tm-faure", output={"probes": {"at": [
            {"name": "end", "where": {"set": "x1"}, "fields": ["displacement"]},
            {"name": "base", "where": {"set": "x0"}, "fields": ["reaction"]}]}}))
        sim.run()
        end = np.flatnonzero(sim.rest[:, 0] == 3)
        u = Quantity.displacement("end", 1)
        self.assertAlmostEqual(u.value(sim), sim.probes()["end"]["displacement"][1], delta=1e-14)
        self.assertAlmostEqual(Quantity.reaction("base", 1).value(sim),
                               sim.probes()["base"]["reaction"][1], delta=1e-8)

        def by_hand(sim):
            slope = np.zeros(sim.rest.shape)
            slope[end, 1] = 1 / len(end)
            return (sim.position - sim.rest)[end, 1].mean(), slope

        E = ("tm-faure", "E")
        value, (slope,) = suture.gradient(sim, u, [E], 1e-10)
        again, (same,) = suture.gradient(sim, by_hand, [E], 1e-10)
        self.assertAlmostEqual(value, again, delta=1e-14)
        self.assert_near(slope, same)
        for J, expected in ((2 * u - 1, 2 * slope), (3 - u / 2, -slope / 2),
                            (1 / u, -slope / value**2), (u * u, 2 * value * slope),
                            (u.map(np.sin, np.cos), np.cos(value) * slope)):
            self.assert_near(suture.gradient(sim, J, [E], 1e-10)[1][0], expected)
        for mistake, kind in ((lambda sim: 3, TypeError), (lambda sim: (3, {"u": 1}), ValueError),
                              (lambda sim: (3, np.zeros((2, 3))), ValueError),
                              (lambda sim: (3, np.full(sim.rest.shape, np.nan)), ValueError),
                              (Quantity.displacement("tip", 0), suture.InputError)):
            with self.assertRaises(kind):
                suture.gradient(sim, mistake, [E])
        with self.assertRaisesRegex(TypeError, "must be a list"):
            suture.gradient(sim, u, E)
        with self.assertRaisesRegex(KeyError, "no parameter 'mu'"):
            suture.gradient(sim, u, [("tm-faure", "mu")])

    def test_what_has_no_derivative_is_refused(self):
        def refusal(sim):
            with self.assertRaises(suture.InputError) as caught:
                sim.adjoint(objective(sim))
            return str(caught.exception)

        sim = suture.Simulation(bar())
        self.assertIn("state of motion", refusal(sim))
        sim = suture.Simulation(sagging("tm-faure"))
        self.assertIn("not in balance", refusal(sim))
        sim.run()
        sim.parameters["tm-faure"]["E"] = 2e5
        self.assertIn("not in balance", refusal(sim))
        sim.equilibrate()
        a = sim.adjoint(objective(sim))
        with self.assertRaisesRegex(ValueError, "integers"):
            a.gradient("tm-faure", "E", [0.5])
        with self.assertRaisesRegex(suture.InputError, "not a number"):
            a.gradient("tm-faure", "quadrature")
        sim.parameters["tm-faure"]["E"] = 1e5
        sim.equilibrate()
        with self.assertRaisesRegex(RuntimeError, "left the state"):
            a.gradient("tm-faure", "E")
        with_memory = suture.Simulation(sagging("tm-faure", models=[
            {"model": "damage-springs",
             "parameters": {"E": 1e5, "rho": 1000, "e0": 0.5, "e1": 0.1}}]))
        with_memory.run()
        self.assertIn("memory", refusal(with_memory))
        pressed = suture.Simulation(sagging("tm-faure", loads=[
            {"pressure": 100, "where": {"box": {"min": [1, 1, 0], "max": [2.25, 1, 0.5]}}}]))
        pressed.run()
        self.assertIn("not symmetric", refusal(pressed))
        column = suture.Simulation(sagging(
            "tm-faure", gravity=[-0.4, 0, 0],
            mesh={"box": {"size": [3, 0.3, 0.3], "cells": [12, 2, 2]}}))
        column.run()
        self.assertEqual(column.outcome, "unstable equilibrium")
        sideways = np.zeros(column.rest.shape)
        sideways[:, 1] = column.rest[:, 0]
        with self.assertRaisesRegex(suture.InputError, "indefinite"):
            column.adjoint(lambda sim: (0, sideways))

    def test_later_steps_keep_their_bits(self):
        def run(asks):
            sim = suture.Simulation(sagging("tm-faure", solver={
                "static": {"frames": 4}, "threads": 1}, loads=[
                    {"traction": [0, -500, 0], "ramp": 1, "where": {"set": "x1"}}]))
            for step in range(4):
                sim.step()
                if asks:
                    J = objective(sim)
                    sim.adjoint(J, 1e-10).gradient("tm-faure", "E", "element")
                    sim.sensitivity("tm-faure", "rho")
            return sim

        plain, asked = run(False), run(True)
        np.testing.assert_array_equal(plain.position, asked.position)
        np.testing.assert_array_equal(plain.mass, asked.mass)


@unittest.skipUnless(find_spec("torch"), "PyTorch is not installed")
class Torch(unittest.TestCase):
    def test_the_function_of_the_docs(self):
        import torch

        code = re.search(r"```py\n(.*?)```", (DOCS / "gradients.md").read_text(), re.S).group(1)
        names = {}
        exec(code, names)
        sim = suture.Simulation(sagging("tm-faure", models=[
            {"name": "organ", "model": "tm-faure", "parameters": MODELS["tm-faure"]}]))
        sim.run()
        moduli = torch.full((16,), 1e5, dtype=torch.float64, requires_grad=True)
        (names["Displacement"].apply(moduli, sim) ** 2).sum().backward()
        u = sim.position - sim.rest
        expected = sim.adjoint(lambda sim: ((u**2).sum(), 2 * u)).gradient("organ", "E", "element")
        np.testing.assert_allclose(moduli.grad.numpy(), expected, rtol=1e-5)


if __name__ == "__main__":
    unittest.main()
