# SPDX-License-Identifier: GPL-3.0-or-later
"""States in memory: Simulation.copy() and Simulation.restore()."""

import gc
import os
import subprocess
import tempfile
import unittest

import numpy as np

import suture
from scenes import bar, free_block

PLANE = ([1.5, 0, 0], [1, 0, 0])


def bits(sim):
    return (sim.position.tobytes(), sim.velocity.tobytes(), sim.time, sim.steps,
            tuple(sim.energies().items()))


def tool_scene():
    return free_block(4, constraints=[{"fix": "xyz", "where": {"set": "z0"}}],
                      contact={"friction": 0.2, "obstacles": [
                          {"name": "ball", "sphere": {"centre": [1.4, 0.5, 1.3], "radius": 0.3}}]},
                      solver={"dt": "auto", "end": 1, "damping": 10, "threads": 1})


class SameBits(unittest.TestCase):
    def check(self, sim, go_on, disturb, others=()):
        """From a copy, the run goes on as it did: in the same simulation, whatever happened to it
        since, and in others of the scene."""
        state = sim.copy()
        self.assertEqual((state.time, state.steps), (sim.time, sim.steps))
        start = bits(sim)
        go_on(sim)
        end = bits(sim)
        self.assertNotEqual(end, start)
        disturb(sim)
        for each in (sim, sim, *others):
            each.restore(state)
            self.assertEqual(bits(each), start)
            go_on(each)
            self.assertEqual(bits(each), end)

    def test_of_every_kind_of_step(self):
        for integrator in ("symplectic-euler", "velocity-verlet", "implicit-euler", "newmark"):
            for dt in (1e-3, "auto"):
                with self.subTest(integrator=integrator, dt=dt):
                    scene = bar(integrator=integrator, dt=dt, end=1, gravity=[0, -1, 0])
                    if dt == "auto" and integrator in ("implicit-euler", "newmark"):
                        continue
                    sim = suture.Simulation(scene)
                    sim.step(7)
                    self.check(sim, lambda s: s.step(9), lambda s: s.step(3),
                               [suture.Simulation(scene)])

    def test_before_and_after_cuts(self):
        sim, other = (suture.Simulation(bar(dt="auto", end=1)) for _ in range(2))
        sim.step(3)

        def cut(s):
            s.cut(plane=PLANE, shape="rest")
            s.step(5)
            s.remove_islands(5)
            s.step(5)

        self.check(sim, cut, lambda s: s.pierce(where={"ids": [0]}), [other])
        self.check(sim, lambda s: s.step(20), cut, [other])
        self.assertEqual(sim.position.shape, (72, 3))
        other.cut(plane=([0.5, 0, 0], [1, 0, 0]), shape="rest")
        state = sim.copy()
        other.restore(state)
        self.assertEqual(bits(other), bits(sim))

    def test_with_tools(self):
        sim, other = (suture.Simulation(tool_scene()) for _ in range(2))
        sim.tools["ball"].move_to([0, 0, -0.1], at=0.1)
        sim.run_to(0.05)
        sim.grasp("end", {"set": "x1"}, move={"translation": [0.1, 0, 0]}, ramp=0.1)

        def go_on(s):
            s.run_to(0.07)
            s.release("end")
            s.run_to(0.12)

        self.check(sim, go_on, lambda s: s.tools["ball"].move_to([0, 0, 1], at=0.2), [other])
        self.assertGreater(sim.tools["ball"].force[2], 1)

    def test_with_other_parameters(self):
        sim, other = (suture.Simulation(bar(dt="auto", end=1)) for _ in range(2))
        sim.step(5)
        sim.parameters["tm-faure"].update(E=3e5, rho=800)
        sim.gravity = [1, 2, 3]
        sim.step(2)

        def go_on(s):
            s.cut(plane=PLANE, shape="rest")
            s.step(20)

        def disturb(s):
            s.gravity = [0, 0, 0]
            s.parameters["tm-faure"]["E"] = 1e4

        self.check(sim, go_on, disturb, [other])
        for each in (sim, other):
            self.assertEqual(each.parameters["tm-faure"]["E"], 3e5)
            self.assertEqual(each.gravity, [1, 2, 3])
        go_on(sim)
        self.check(sim, lambda s: s.step(5), disturb, [other])

    def test_with_a_force_function(self):
        def made():
            sim = suture.Simulation(free_block())
            centre = np.array([1.5, 0.5, 0.5])

            @sim.force_term
            def pull(x, v, t, f):
                f -= 50 * (x - centre) + v

            return sim

        sim, other = made(), made()
        sim.step(5)
        self.check(sim, lambda s: s.step(20), lambda s: s.step(1), [other])
        self.assertEqual(sim.force_terms[0].work, sim.energies()["pull"])

    def test_a_force_function_that_knows_the_cut_body(self):
        sim = suture.Simulation(free_block(3))
        sim.cut(faces=[(0, 1)])
        rest = sim.rest.copy()
        self.assertGreater(len(rest), 64)

        @sim.force_term(energy=lambda x, t: 250 * ((x - rest) ** 2).sum(), stiffness=500)
        def anchor(x, v, t, f):
            f -= 500 * (x - rest)

        sim.velocity = np.ones_like(rest)
        sim.step(5)
        self.check(sim, lambda s: s.step(20), lambda s: s.step(1))

    def test_checkpoints_contain_the_changes(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = bar(checkpoint={"every_steps": 10}, dt="auto", end=0.5)
            sim = suture.Simulation(scene, output=folder)
            sim.step(5)
            sim.parameters["tm-faure"]["E"] = 3e5
            sim.parameters["tm-faure"]["nu"] = np.linspace(0.1, 0.4, len(sim.element_ids))
            sim.gravity = [0, -1, 0]
            sim.cut(plane=PLANE, shape="rest")
            sim.run()
            frames = sorted(name for name in os.listdir(folder) if name.startswith("frame"))
            with open(os.path.join(folder, frames[-1]), "rb") as file:
                expected = file.read()
            first = sorted(name for name in os.listdir(folder) if name.endswith(".h5"))[0]
            again = os.path.join(folder, "again")
            subprocess.run([os.environ["SUTURE_PROGRAM"], "run", "--resume",
                            os.path.join(folder, first), "--output", again, "--quiet"],
                           check=True, capture_output=True)
            frames = sorted(name for name in os.listdir(again) if name.startswith("frame"))
            with open(os.path.join(again, frames[-1]), "rb") as file:
                self.assertEqual(file.read(), expected)


    def test_checkpoints_go_on_without_the_script(self):
        scene = bar(dt=1e-3, end=0.1)
        with tempfile.TemporaryDirectory() as folder:
            whole = suture.Simulation(scene, output=os.path.join(folder, "whole"))
            part = suture.Simulation(scene)
            for sim in (whole, part):
                sim.step(20)
                sim.parameters["tm-faure"]["E"] = 3e5
                sim.cut(plane=PLANE, shape="rest")
                sim.step(5)
            whole.run()
            file = os.path.join(folder, "saved.h5")
            part.save_checkpoint(file)
            subprocess.run([os.environ["SUTURE_PROGRAM"], "run", "--resume", file, "--output",
                            os.path.join(folder, "rest"), "--quiet"], check=True, capture_output=True)
            last = [sorted(f for f in os.listdir(os.path.join(folder, run)) if f.startswith("frame"))[-1]
                    for run in ("whole", "rest")]
            self.assertEqual(last[0], last[1])
            read = lambda run: open(os.path.join(folder, run, last[0]), "rb").read()
            self.assertEqual(read("whole"), read("rest"))

    def test_checkpoints_need_a_scene_that_says_everything(self):
        sim = suture.Simulation(bar())

        @sim.force_term(energy=lambda x, t: 0.0)
        def nothing(x, v, t, f):
            pass

        with self.assertRaisesRegex(suture.InputError, "the force function 'nothing'"):
            sim.save_checkpoint("never.h5")
        with tempfile.TemporaryDirectory() as folder:
            sim = suture.Simulation(bar(), output=folder)
            with self.assertRaisesRegex(suture.InputError, "writes nothing"):
                sim.save_checkpoint("never.h5")
        self.assertFalse(os.path.exists("never.h5"))


class Around(unittest.TestCase):
    def test_arrays_keep_their_values(self):
        sim = suture.Simulation(bar())
        state = sim.copy()
        sim.step(10)
        position, values = sim.position, sim.position.copy()
        sim.restore(state)
        gc.collect()
        np.testing.assert_array_equal(position, values)
        np.testing.assert_array_equal(sim.position, sim.rest)

    def test_callbacks_stay(self):
        sim, calls = suture.Simulation(bar(end=1)), []
        sim.every(4)(lambda s: calls.append(s.steps))
        sim.at(0.0002)(lambda s: calls.append("early"))
        sim.at(0.0006)(lambda s: calls.append("late"))
        sim.step(4)
        state = sim.copy()
        sim.step(5)
        self.assertEqual(calls, ["early", 4, "late", 8])
        sim.restore(state)
        sim.step(5)
        self.assertEqual(calls, ["early", 4, "late", 8, "late", 8])

    def test_records_go_back(self):
        sim = suture.Simulation(bar(end=1))
        record = sim.record(2, lowest=lambda s: s.position[:, 1].min())
        sim.step(10)
        state, before = sim.copy(), record["lowest"]
        sim.gravity = [0, 9.8, 0]
        sim.step(10)
        self.assertEqual(len(record), 11)
        sim.restore(state)
        sim.step(4)
        self.assertEqual(len(record), 8)
        np.testing.assert_array_equal(record["lowest"][:6], before)
        self.assertTrue((np.diff(record["lowest"]) < 0).all())
        self.assertEqual(sim.messages[-2:], ["t = 0.001 s: gravity is (0, 9.8, 0) m/s^2",
                                             "t = 0.001 s: restored to step 10"])

    def test_a_run_that_failed_goes_on(self):
        sim = suture.Simulation(bar(dt=0.001, end=10))
        sim.step(3)
        state = sim.copy()
        sim.step(2)
        expected = bits(sim)
        sim.velocity = np.full_like(sim.rest, 1e6) * [[1, 0, 0]] * (sim.rest[:, :1] > 1)
        with self.assertRaises(suture.NumericalError):
            sim.run()
        with self.assertRaisesRegex(RuntimeError, "has ended with an error"):
            sim.copy()
        sim.restore(state)
        sim.step(2)
        self.assertEqual(bits(sim), expected)

    def test_the_outcome_belongs_to_the_state(self):
        sim = suture.Simulation(bar())
        start = sim.copy()
        sim.run()
        end = sim.copy()
        sim.restore(start)
        self.assertIsNone(sim.outcome)
        sim.restore(end)
        self.assertEqual(sim.outcome, "finished")

    def test_probes_are_those_of_the_body_as_built(self):
        scene = bar(output={"probes": {"at": [{"name": "end", "where": {"set": "x1"}}]}})
        sim = suture.Simulation(scene)
        sim.step(5)
        state = sim.copy()
        before = sim.probes()["end"]["displacement"]
        sim.pierce(where={"ids": [5, 11, 17, 23]})
        self.assertTrue(np.isnan(sim.probes()["end"]["displacement"]).all())
        sim.restore(state)
        np.testing.assert_array_equal(sim.probes()["end"]["displacement"], before)

    def test_many_states_in_turn(self):
        sim = suture.Simulation(bar())
        states = []
        for _ in range(5):
            sim.step(3)
            states.append(sim.copy())
        for state in reversed(states):
            sim.restore(state)
            self.assertEqual(sim.steps, state.steps)
        self.assertGreater(states[0].nbytes, 63 * 6 * 8)
        self.assertRegex(repr(states[0]), "<suture.State: step 3, t = 0.0003 s>")

    def test_what_cannot_be_restored_says_why(self):
        sim = suture.Simulation(bar())
        state = sim.copy()
        with self.assertRaisesRegex(suture.InputError, "belongs to another scene"):
            suture.Simulation(bar(gravity=[0, 1, 0])).restore(state)
        box = sim.mesh()
        moved = suture.Mesh(box.points * 2, box.hexahedra)
        scene = {key: value for key, value in bar(constraints=[]).items() if key != "mesh"}
        one, other = suture.Simulation(scene, mesh=box), suture.Simulation(scene, mesh=moved)
        with self.assertRaisesRegex(suture.InputError, "belongs to another"):
            other.restore(one.copy())
        before = bits(sim)
        sim.force_term(lambda x, v, t, f: None, name="nothing", stiffness=0)
        with self.assertRaisesRegex(suture.InputError, "other force functions: none; this .*'noth"):
            sim.restore(state)
        self.assertEqual(bits(sim)[:4], before[:4])
        with self.assertRaises(TypeError):
            sim.restore(None)

    def test_not_while_it_runs_and_not_with_output(self):
        sim = suture.Simulation(bar())
        states = []
        sim.at(0.001)(lambda s: states.append(s.copy()))
        sim.at(0.002)(lambda s: s.restore(states[0]))
        with self.assertRaisesRegex(RuntimeError, "not possible while the simulation runs"):
            sim.run()
        end = suture.Simulation(bar())
        end.run()
        sim.restore(states[0])
        self.assertEqual(sim.steps, 10)
        sim.step(9)
        with self.assertRaisesRegex(RuntimeError, "not possible while"):
            sim.run()  # it is called again
        sim.run()
        self.assertEqual(bits(sim), bits(end))
        with tempfile.TemporaryDirectory() as folder:
            writes = suture.Simulation(bar(), output=folder)
            for call in (writes.copy, lambda: writes.restore(states[0])):
                with self.assertRaisesRegex(suture.InputError, "create it with output=False"):
                    call()


class AfterRemovals(unittest.TestCase):
    def test_after_removals_and_other_parameters(self):
        for model, of in (("tm-faure", "E"), ("neo-hookean", "rho"), ("mss-golec", "E")):
            scene = {
                "suture": 2, "mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [6, 2, 2]}},
                "models": [{"name": "m", "model": model,
                            "parameters": {"E": 2e4, "nu": 0.25, "rho": 1000}}],
                "gravity": [0, -2, 0], "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
                "solver": {"dt": 0.002, "end": 9}, "output": False}
            pierce = lambda s: s.pierce(path=[[0.28, 0.03, 0.07], [0.28, 1, 0.07]], radius=0.06)
            change = lambda s: s.parameters["m"].update(**{of: 1.5 * s.parameters["m"][of]})
            for acts in ((pierce, change), (change, pierce), (pierce, change, pierce)):
                sim = suture.Simulation(scene)
                sim.step(3)
                for act in acts:
                    act(sim)
                state = sim.copy()
                sim.step(40)
                for other in (sim, suture.Simulation(scene)):
                    end = sim.position.tobytes()
                    other.restore(state)
                    other.step(40)
                    self.assertEqual(other.position.tobytes(), end, (model, len(acts)))


if __name__ == "__main__":
    unittest.main()
