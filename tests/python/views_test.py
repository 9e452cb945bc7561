# SPDX-License-Identifier: GPL-3.0-or-later
"""Columns as arrays: no copy, and never a dangling one."""

import gc
import unittest

import numpy as np

import suture
from scenes import bar, free_block


def address(array):
    return array.__array_interface__["data"][0]


class Columns(unittest.TestCase):
    def test_arrays_are_the_memory_of_the_kernel(self):
        sim = suture.Simulation(bar())
        x = sim.position
        self.assertEqual(x.shape, (63, 3))
        self.assertIs(sim.position, x)
        before = x.copy()
        sim.step(20)
        self.assertEqual(address(sim.position), address(x))
        self.assertGreater(np.abs(x - before).max(), 0)  # it has moved with the body
        self.assertEqual(sim.mass.shape, (63,))
        self.assertAlmostEqual(sim.mass.sum(), 3000)
        np.testing.assert_array_equal(np.unique(sim.fixed), [0, 7])

    def test_arrays_are_read_only(self):
        sim = suture.Simulation(bar())
        for array in (sim.position, sim.velocity, sim.force, sim.rest, sim.mass, sim.fixed):
            with self.assertRaisesRegex(ValueError, "read-only"):
                array[0] = 1
        with self.assertRaises(ValueError):
            sim.position[2:4] += 1
        with self.assertRaises(ValueError):
            sim.position.flags.writeable = True
        with self.assertRaises(ValueError):
            sim.position[2:4].setflags(write=True)

    def test_numbers_are_those_of_the_user(self):
        sim = suture.Simulation(bar())
        self.assertEqual(sorted(sim.point_ids), list(range(63)))
        grid = np.array([[i * 0.5, j * 0.5, k * 0.5]
                         for k in range(3) for j in range(3) for i in range(7)])
        np.testing.assert_allclose(sim.rest, grid[sim.point_ids])

    def test_positions_are_relative_to_the_origin(self):
        scene = bar()
        scene["mesh"]["box"]["origin"] = [5, 6, 7]
        sim = suture.Simulation(scene)
        self.assertEqual(sim.origin, [5, 6, 7])
        np.testing.assert_array_equal(sim.rest.min(axis=0), 0)

    def test_velocity_is_at_the_time_of_the_positions(self):
        sim = suture.Simulation(free_block(integrator="velocity-verlet", gravity=[0, 0, -9.8]))
        sim.step(50)
        np.testing.assert_allclose(sim.velocity[:, 2], -9.8 * sim.time, rtol=1e-9)

    def test_force_leaves_out_gravity(self):
        sim = suture.Simulation(bar())
        sim.step(100)
        free = sim.fixed == 0
        before, force = sim.velocity.copy(), sim.force.copy()
        sim.step()
        expected = 1e-4 * (force / sim.mass[:, None] + [0, -9.8, 0])
        np.testing.assert_allclose((sim.velocity - before)[free], expected[free], rtol=1e-9,
                                   atol=1e-15)

    def test_columns_of_models(self):
        sim = suture.Simulation(bar(model="mss-baudet", models=[
            {"model": "mss-baudet", "name": "tissue", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}}]))
        listed = {name: (dimension, components, unit)
                  for model, name, dimension, components, unit, doc in sim.columns()
                  if model == "tissue"}
        self.assertTrue(listed)
        for name, (dimension, components, unit) in listed.items():
            with self.subTest(name):
                values = sim.column("tissue", name)
                rows = len(sim.column_cells("tissue", dimension))
                expected = (rows,) if components == 1 else None
                if expected:
                    self.assertEqual(values.shape, expected)
                self.assertTrue(np.isfinite(values).all())
        with self.assertRaisesRegex(KeyError, "it has tissue"):
            sim.column("tm", "E")
        with self.assertRaisesRegex(KeyError, "no column 'nothing'"):
            sim.column("tissue", "nothing")


class Stale(unittest.TestCase):
    def test_an_array_of_before_a_cut_keeps_its_values(self):
        sim = suture.Simulation(bar())
        sim.step(50)
        x, part = sim.position, sim.position[::2, 1]
        kept, kept_part = x.copy(), part.copy()
        self.assertTrue(sim.cut(plane=([1.5, 0, 0], [1, 0, 0])))
        sim.step(50)
        np.testing.assert_array_equal(x, kept)
        np.testing.assert_array_equal(part, kept_part)
        with self.assertRaises(ValueError):
            part[0] = 1
        self.assertEqual(sim.position.shape, (72, 3))
        self.assertGreater(np.abs(sim.position[:63] - kept).max(), 0)

    def test_events_of_the_scene_do_the_same(self):
        cut = {"at": 0.005, "cut": {"plane": {"point": [1.5, 0, 0], "normal": [1, 0, 0]}}}
        sim = suture.Simulation(bar(events=[cut]))
        sim.step(10)
        x = sim.position
        sim.run()
        self.assertEqual(x.shape, (63, 3))
        self.assertEqual(sim.position.shape, (72, 3))
        self.assertLess(np.abs(x[:, 1] - sim.position[:63, 1]).min(), 1)

    def test_bits_do_not_depend_on_arrays_that_are_held(self):
        looked, twin = suture.Simulation(bar()), suture.Simulation(bar())
        held = []
        for sim in (looked, twin):
            for face in ([0, 1], [7, 8], [14, 15]):
                sim.step(11)
                if sim is looked:
                    held += [sim.position, sim.velocity, sim.mass]
                sim.cut(faces=[face])
            sim.run()
        np.testing.assert_array_equal(looked.position, twin.position)

    def test_cuts_in_a_loop_with_arrays_of_every_age(self):
        sim = suture.Simulation(bar((10, 4, 4), model="mss-baudet"))
        rng = np.random.default_rng(1)
        held = []
        columns = [(model, name) for model, name, *_ in sim.columns()]
        for _ in range(60):
            sim.step(2)
            arrays = [sim.position, sim.velocity, sim.mass, sim.force]
            arrays += [sim.column(*column) for column in columns]
            held += [(array, array.copy(), array[1::2]) for array in arrays]
            e = int(rng.integers(0, 159))
            try:
                sim.cut(faces=[[e, e + 1]])
            except suture.InputError:
                continue  # they share no face
            for index in rng.integers(0, len(held), len(held) // 20):
                held[index] = (*held[index][:2], held[index][0][1::2])
            if rng.random() < 0.2:
                del held[: len(held) // 2]
        self.assertGreater(len(sim.position), 275)
        for array, values, part in held:
            self.assertEqual(part.base is array or part.base is array.base, True)
            part.sum()

    def test_arrays_outlive_their_simulation(self):
        sim = suture.Simulation(bar())
        sim.step(5)
        x, m = sim.position[10:20], sim.mass
        kept = x.copy()
        del sim
        gc.collect()
        other = [suture.Simulation(bar()) for _ in range(5)]  # would reuse freed memory
        np.testing.assert_array_equal(x, kept)
        self.assertAlmostEqual(m.sum(), 3000)
        del other


class Assignments(unittest.TestCase):
    def test_velocity_is_set_and_booked(self):
        sim = suture.Simulation(free_block(4, dt=1e-4))
        sim.velocity = np.tile([1.0, 0, 2.0], (len(sim.rest), 1))
        self.assertAlmostEqual(sim.energies()["events"], 0.5 * sim.mass.sum() * 5, places=6)
        sim.step(100)
        np.testing.assert_allclose(sim.position - sim.rest, [[0.01, 0, 0.02]] * len(sim.rest),
                                   atol=1e-12)
        self.assertAlmostEqual(sim.energies()["balance"], 0, places=6)

    def test_position_is_set_and_constraints_hold(self):
        sim = suture.Simulation(bar())
        sim.position = sim.rest * [1.1, 1, 1]
        clamped = sim.fixed == 7
        np.testing.assert_array_equal(sim.position[clamped], sim.rest[clamped])
        self.assertAlmostEqual(sim.position[:, 0].max(), 3.3)
        self.assertGreater(sim.energies()["elastic"], 100)

    def test_bad_arrays_change_nothing(self):
        sim = suture.Simulation(bar())
        sim.step(10)
        before = sim.position.copy()
        bad = before.copy()
        bad[17, 1] = np.nan
        cases = [
            (bad, "position of node .* is not finite; nothing was changed"),
            (before[:5], r"shape \(63, 3\)"),
            (before.ravel(), r"shape \(63, 3\)"),
        ]
        for values, text in cases:
            with self.assertRaisesRegex(ValueError, text):
                sim.position = values
        with self.assertRaisesRegex(TypeError, "dtype is complex128"):
            sim.position = before.astype(complex)
        with self.assertRaises(TypeError):
            sim.velocity = "fast"
        np.testing.assert_array_equal(sim.position, before)
        with self.assertRaises(AttributeError):
            sim.mass = sim.mass


if __name__ == "__main__":
    unittest.main()
