# SPDX-License-Identifier: GPL-3.0-or-later
"""Derivatives of equilibria, beside differences of whole equilibria."""

import unittest

import numpy as np

import suture
from scenes import bar
from suture import Quantity

STEP = 1e-3  # of a parameter

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
    return bar(cells, models=[{"model": model, "parameters": MODELS[model]}],
               **{"gravity": [0.1, -0.6, 0.2],
                  "solver": {"static": {"frames": 1, "tolerance": 1e-12}, "threads": 1}, **more})


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


if __name__ == "__main__":
    unittest.main()
