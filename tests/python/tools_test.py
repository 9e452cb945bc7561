# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact: forces and gaps of the body, and tools that Python steers."""

import unittest

import numpy as np

import suture
from scenes import free_block

RADIUS, CENTRE = 0.3, np.array([1.4, 0.5, 1.3])


def probed_block(coupling=None, **more):
    """A block of 3 x 1 x 1 m that is held at the bottom, with a ball that touches it from above
    and a wall at its end."""
    ball = {"name": "probe", "sphere": {"centre": list(CENTRE), "radius": RADIUS}}
    if coupling:
        ball["coupling"] = coupling
    wall = {"name": "wall", "half_space": {"point": [3, 0, 0], "normal": [-1, 0, 0]}}
    return free_block(4, **{"constraints": [{"fix": "xyz", "where": {"set": "z0"}}],
                            "contact": {"friction": 0.2, "obstacles": [ball, wall]},
                            "solver": {"dt": "auto", "end": 1, "damping": 10, "threads": 1},
                            **more})


class Contact(unittest.TestCase):
    def test_forces_on_the_body_are_those_on_the_tools(self):
        sim = suture.Simulation(probed_block())
        np.testing.assert_array_equal(sim.contact_force, np.zeros((125, 3)))
        sim.tools["probe"].move_to([0.1, 0, -0.1], at=0.2)
        sim.run_to(0.25)
        force = sim.contact_force
        self.assertGreater((force != 0).any(axis=1).sum(), 3)
        on_tools = sum(tool.force for tool in sim.tools.values())
        self.assertGreater(on_tools[2], 100)
        np.testing.assert_allclose(force.sum(axis=0), -on_tools, rtol=0, atol=1e-9)
        sim.cut(plane=([1.5, 0, 0], [1, 0, 0]))
        self.assertEqual(sim.contact_force.shape, sim.position.shape)
        self.assertEqual(force.shape, (125, 3), "a copy")

    def test_gap_is_the_distance_from_the_nearest_obstacle(self):
        sim = suture.Simulation(probed_block())
        sim.tools["probe"].move_to([0, 0, 0.5], at=0.1)
        sim.run_to(0.1)
        x = sim.position
        from_ball = np.linalg.norm(x - CENTRE - [0, 0, 0.5], axis=1) - RADIUS
        inside = ((sim.rest > 0) & (sim.rest < [3, 1, 1])).all(axis=1)
        expected = np.where(inside, np.nan, np.minimum(from_ball, 3 - x[:, 0]))
        np.testing.assert_allclose(sim.gap, expected, rtol=0, atol=1e-12)

    def test_without_contact_there_is_none(self):
        sim = suture.Simulation(free_block())
        self.assertEqual(len(sim.tools), 0)
        for name in ("gap", "contact_force"):
            with self.assertRaisesRegex(AttributeError, "the scene has no contact"):
                getattr(sim, name)


class Tools(unittest.TestCase):
    def test_are_the_obstacles_by_name(self):
        sim = suture.Simulation(probed_block())
        self.assertEqual(list(sim.tools), ["probe", "wall"])
        self.assertEqual(sim.tools["wall"].name, "wall")
        self.assertIn("probe", sim.tools)
        with self.assertRaisesRegex(KeyError, "no obstacle 'prob'; did you mean 'probe'"):
            sim.tools["prob"]
        with self.assertRaisesRegex(KeyError, "it has probe, wall"):
            sim.tools["scalpel"]

    def test_hold_what_they_touch(self):
        sim = suture.Simulation(probed_block())
        sim.grasp("held", obstacle="probe", reach=0.02)
        held = (sim.fixed == 7).squeeze() & (sim.rest[:, 2] > 0)
        self.assertGreater(held.sum(), 0)
        start = sim.position[held].copy()
        for shift, at in ([0.1, 0, 0.1], 0.05), ([0, 0, 0.05], 0.1):
            sim.tools["probe"].move_to(shift, at=at)
            sim.run_to(at)
            np.testing.assert_allclose(sim.position[held] - start,
                                       np.tile(sim.tools["probe"].translation, (held.sum(), 1)),
                                       atol=1e-12)
        sim.release("held")

    def test_move_to_a_pose_and_stay(self):
        sim = suture.Simulation(probed_block())
        probe = sim.tools["probe"]
        self.assertIsNone(probe.hand_force)
        probe.move_to([0, 0, 0.2], [0, 0.6, 0], at=0.1)
        sim.run_to(0.05)
        np.testing.assert_allclose(probe.translation, [0, 0, 0.1], atol=1e-3)
        np.testing.assert_allclose(probe.rotation, [0, 0.3, 0], atol=3e-3)
        probe.move_to(np.array([0.1, 0, 0.2]), at=0.2)  # keeps the rotation
        turned = probe.rotation
        sim.run_to(0.2)
        self.assertAlmostEqual(sim.time, 0.2, places=12)
        sim.run_to(0.25)
        np.testing.assert_array_equal(probe.translation, [0.1, 0, 0.2])
        np.testing.assert_allclose(probe.rotation, turned, atol=1e-15)

    def test_the_hand_of_a_compliant_tool_feels_the_body(self):
        sim = suture.Simulation(probed_block({"mass": 20, "stiffness": 1e4}))
        probe = sim.tools["probe"]
        probe.move_to([0, 0, -0.1], at=0.1)
        sim.run_to(1)
        self.assertGreater(probe.translation[2], -0.099)  # the spring gives way
        self.assertGreater(probe.hand_force[2], 10)
        spring = 1e4 * (probe.translation[2] + 0.1)
        np.testing.assert_allclose(probe.hand_force[2], spring, rtol=0.01)
        np.testing.assert_allclose(probe.hand_force[2], probe.force[2], rtol=0.01)
        self.assertEqual(probe.hand_torque.shape, (3,))

    def test_a_callback_steers(self):
        sim, twin = (suture.Simulation(probed_block()) for _ in range(2))

        @sim.at(0.05)
        def press(s):
            s.tools["probe"].move_to([0, 0, -0.05], at=0.1)

        sim.run_to(0.2)
        twin.run_to(0.05)
        press(twin)
        twin.run_to(0.2)
        self.assertGreater(sim.tools["probe"].force[2], 100)
        np.testing.assert_array_equal(sim.position, twin.position)

    def test_bad_targets_change_nothing(self):
        sim = suture.Simulation(probed_block())
        sim.step(5)
        probe = sim.tools["probe"]
        cases = [
            (dict(translation=[0, 0, 1], at=sim.time), suture.InputError, "later than now"),
            (dict(translation=[0, 0, np.nan], at=1), suture.InputError, "not finite"),
            (dict(translation=[0, 0], at=1), ValueError, "translation must be three numbers"),
            (dict(rotation=0.3, at=1), TypeError, "not iterable"),
            (dict(translation=[0, 0, 1]), TypeError, "at"),
        ]
        for arguments, error, text in cases:
            with self.assertRaisesRegex(error, text):
                probe.move_to(**arguments)
        sim.run_to(0.2)
        np.testing.assert_array_equal(probe.translation, np.zeros(3))

    def test_not_within_a_step(self):
        sim = suture.Simulation(probed_block())

        @sim.force_term(stiffness=0)
        def steer(x, v, t, f):
            if t > 0:
                sim.tools["probe"].move_to([0, 0, 1], at=t + 1)

        with self.assertRaisesRegex(RuntimeError, "not possible in a force function"):
            sim.step(2)


if __name__ == "__main__":
    unittest.main()
