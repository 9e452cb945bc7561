# SPDX-License-Identifier: GPL-3.0-or-later
"""Stress, reactions and probes as arrays."""

import csv
import pathlib
import tempfile
import unittest

import numpy as np

import suture
from scenes import bar, free_block


class Fields(unittest.TestCase):
    def test_stress_of_a_uniform_stretch_is_that_of_the_law(self):
        E, nu, strain = 1e5, 0.3, 1e-6
        sim = suture.Simulation(free_block())
        sim.position = sim.position * [1 + strain, 1, 1]
        lame, shear = E * nu / (1 + nu) / (1 - 2 * nu), E / 2 / (1 + nu)
        expected = np.array([lame + 2 * shear, lame, lame, 0, 0, 0]) * strain
        self.assertEqual(sim.stress.shape, (8, 6))
        np.testing.assert_allclose(sim.stress, np.tile(expected, (8, 1)), rtol=0, atol=1e-5)
        np.testing.assert_allclose(sim.von_mises, 2 * shear * strain, rtol=1e-4)
        np.testing.assert_allclose(sim.strain[:, 0], strain, rtol=1e-4)

    def test_reactions_carry_the_weight(self):
        sim = suture.Simulation(bar(gravity=[0, -0.01, 0], solver={"static": {"frames": 1}}))
        sim.run()
        np.testing.assert_allclose(sim.reactions.sum(axis=0), [0, 30, 0], atol=1e-6)
        free = sim.rest[:, 0] > 0
        self.assertFalse(sim.reactions[free].any())
        moment = sim.field("reaction_moment").sum(axis=0)
        self.assertAlmostEqual(moment[2], 45, delta=0.1)

    def test_they_are_the_fields_of_frames(self):
        from suture._frames import Frame

        fields = ["stress", "von_mises", "strain", "reaction", "force", "island", "node_id"]
        with tempfile.TemporaryDirectory() as folder:
            scene = bar(end=0.01, output={"fields": fields})
            sim = suture.Simulation(scene, output=folder)
            sim.run()
            frame = Frame(sorted(pathlib.Path(folder).glob("frame*.vtu"))[-1]).fields
        for name in fields:
            np.testing.assert_array_equal(sim.field(name), frame[name], err_msg=name)
        np.testing.assert_array_equal(sim.reactions, frame["reaction"])

    def test_reading_fields_changes_no_bit(self):
        for integrator in ("symplectic-euler", "velocity-verlet"):
            one, other = (suture.Simulation(bar(integrator=integrator)) for _ in range(2))
            for _ in range(20):
                one.step()
                other.step()
                other.stress, other.reactions
            np.testing.assert_array_equal(one.position, other.position)

    def test_elements_between_fixed_nodes_have_a_stress(self):
        scene = bar((8, 4, 4), constraints=[
            {"fix": "xyz", "where": {"box": {"min": [0, 0, 0], "max": [1.5, 1, 1]}}}])
        sim = suture.Simulation(scene)
        sim.step(5)
        self.assertTrue(np.isfinite(sim.stress).all())

    def test_rows_follow_a_cut(self):
        sim = suture.Simulation(bar())
        sim.step(10)
        before = sim.reactions
        sim.cut(plane=([1.5, 0, 0], [1, 0, 0]))
        self.assertEqual(sim.reactions.shape, sim.position.shape)
        np.testing.assert_allclose(sim.reactions[:len(before)], before, rtol=0, atol=1e-9)

    def test_what_the_scene_does_not_have_is_named(self):
        springs = suture.Simulation(bar(model="mss-baudet"))
        with self.assertRaisesRegex(AttributeError, "no model of this scene provides"):
            springs.stress
        self.assertFalse(hasattr(springs, "von_mises"))
        with self.assertRaisesRegex(suture.InputError, "did you mean .*von_mises"):
            suture.Simulation(bar()).field("von_mise")
        names = {name for name, *_ in suture.Simulation(bar()).fields()}
        self.assertLessEqual({"stress", "von_mises", "reaction", "displacement"}, names)


class Probes(unittest.TestCase):
    scene = bar(end=0.01, output={"probes": {"every_steps": 10, "at": [
        {"name": "tip", "point": [3, 1, 1]},
        {"name": "held", "where": {"set": "x0"}, "fields": ["reaction", "mass"]},
        {"name": "middle", "point": [1.5, 0.5, 0.5], "fields": ["von_mises", "stress"]}]}})

    def test_they_are_the_rows_of_the_table(self):
        with tempfile.TemporaryDirectory() as folder:
            sim = suture.Simulation(self.scene, output=folder)
            sim.run_to(0.004)
            sim.cut(plane=([1.5, 0, 0], [1, 0, 0]))
            sim.run()
            with open(pathlib.Path(folder) / "probes.csv", newline="") as file:
                *_, row = csv.reader(file)
        values = sim.probes()
        self.assertEqual(list(values), ["tip", "held", "middle"])
        self.assertEqual(list(values["tip"]), ["position", "displacement", "force"])
        flat = [np.ravel(value) for probe in values.values() for value in probe.values()]
        np.testing.assert_allclose(np.concatenate(flat), [float(x) for x in row[2:]], rtol=1e-11)
        self.assertIsInstance(values["held"]["mass"], float)

    def test_a_scene_without_probes_says_so(self):
        with self.assertRaisesRegex(suture.InputError, "no probes; give it /output/probes"):
            suture.Simulation(bar()).probes()

    def test_a_wrong_probe_is_found_at_once(self):
        scene = bar(output={"probes": {"at": [{"name": "a", "point": [0, 0, 0],
                                               "fields": ["stresss"]}]}})
        with self.assertRaisesRegex(suture.InputError, "stresss.*did you mean"):
            suture.Simulation(scene)


if __name__ == "__main__":
    unittest.main()
