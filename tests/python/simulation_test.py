# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes, their mistakes, and steps."""

import ast
import csv
import json
import os
import subprocess
import sys
import tempfile
import threading
import unittest
import warnings
from pathlib import Path

import numpy as np

import suture
from scenes import bar, free_block


class Sources(unittest.TestCase):
    def test_a_dict_a_text_and_a_file_are_the_same_scene(self):
        scene = bar()
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "bar.json"
            file.write_text(json.dumps(scene))
            sims = [suture.Simulation(s) for s in (scene, json.dumps(scene), file, str(file))]
        self.assertEqual(len({sim.hash for sim in sims}), 1)
        for sim in sims:
            self.assertEqual(sim.step(30), 30)
        for sim in sims[1:]:
            np.testing.assert_array_equal(sim.position, sims[0].position)

    def test_numpy_values_are_numbers(self):
        scene = bar(gravity=np.array([0, -9.8, 0]), dt=np.float64(1e-4))
        self.assertEqual(suture.Simulation(scene).hash, suture.Simulation(bar()).hash)

    def test_set_replaces_values(self):
        sim = suture.Simulation(bar(), set={"/solver/dt": 5e-5, "/gravity": [0, 0, -1]})
        self.assertEqual(sim.dt, 5e-5)

    def test_nothing_is_written_unless_asked_for(self):
        with tempfile.TemporaryDirectory() as folder:
            before = os.getcwd()
            os.chdir(folder)
            try:
                scene = bar(output={"directory": "out", "every": 0.01,
                                    "energies": {"every_steps": 50}})
                suture.Simulation(scene).run()
                self.assertEqual(os.listdir(), [])
                summary = suture.Simulation(scene, output=True).run()
                self.assertEqual(summary["frames"], 3)
                self.assertIn("energies.csv", os.listdir("out"))
            finally:
                os.chdir(before)

    def test_two_simulations_do_not_share_a_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = bar(output={"directory": "ignored", "every_steps": 1, "energies": {}})
            out = Path(folder) / "out"
            first = suture.Simulation(scene, output=out)
            first.step(20)
            refusals = []

            def attempt():
                try:
                    suture.Simulation(scene, output=out)
                except suture.IoError as error:
                    refusals.append(str(error))

            threads = [threading.Thread(target=attempt) for _ in range(3)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertEqual(len(refusals), 3)
            self.assertIn("another run of this process writes to this folder", refusals[0])
            first.run()
            frames = len(list(out.glob("*.vtu")))
            # A run that has ended leaves the folder to the next one, although it still exists.
            second = suture.Simulation(scene, {"/solver/end": 1e-3}, output=out)
            second.run()
            self.assertLess(len(list(out.glob("*.vtu"))), frames)
            self.assertFalse(Path("ignored").exists())

    def test_other_types_are_refused(self):
        with self.assertRaisesRegex(TypeError, "path, a dict or a JSON text; is int"):
            suture.Simulation(3)
        with self.assertRaisesRegex(TypeError, "set must be a dict"):
            suture.Simulation(bar(), set=["/solver/dt=1"])


class Mistakes(unittest.TestCase):
    def test_all_are_listed_with_path_line_and_text(self):
        text = '{"suture": 1,\n "mesh": {"box": {"size": [1, 1, 1], "cells": [1, 1, 0]}},\n' \
               ' "models": [{"model": "tm-faur"}],\n "solver": {"dt": -1, "end": 1}}'
        with self.assertRaises(suture.SceneError) as caught:
            suture.Simulation(text)
        mistakes = caught.exception.mistakes
        self.assertEqual([(path, line) for path, line, _ in mistakes],
                         [("/mesh/box/cells/2", 2), ("/models/0/model", 3), ("/solver/dt", 4)])
        self.assertIn("did you mean 'tm-faure'", mistakes[1][2])
        self.assertIn("3 mistakes", str(caught.exception))
        self.assertIsInstance(caught.exception, ValueError)

    def test_a_dict_has_no_lines(self):
        with self.assertRaises(suture.SceneError) as caught:
            suture.Simulation(bar(slover={}))
        (path, line, text), = caught.exception.mistakes
        self.assertEqual((path, line), ("/slover", None))
        self.assertIn("did you mean 'solver'", text)

    def test_set_and_syntax(self):
        with self.assertRaises(suture.SceneError) as caught:
            suture.Simulation(bar(), set={"/solver/dt": "fast"})
        self.assertEqual(caught.exception.mistakes[0][:2], ("/solver/dt", None))
        with self.assertRaises(suture.SceneError) as caught:
            suture.Simulation('{"suture": 1,\n "mesh": }')
        self.assertEqual(caught.exception.mistakes[0][1], 2)
        for bad in ([0, float("nan"), 0], np.array([0, -np.inf, 0]), [0, np.float32("nan"), 0]):
            with self.assertRaisesRegex(ValueError, "^/gravity/1: must be a finite number"):
                suture.Simulation(bar(gravity=bad))

    def test_selections_that_the_mesh_does_not_have(self):
        scene = bar(constraints=[{"fix": "xyz", "where": {"set": "x9"}}])
        with self.assertRaises(suture.SceneError) as caught:
            suture.Simulation(scene)
        self.assertTrue(caught.exception.mistakes[0][0].startswith("/constraints/0/where"))

    def test_a_missing_file(self):
        with self.assertRaises(OSError) as caught:
            suture.Simulation("nowhere.json")
        self.assertIsInstance(caught.exception, suture.IoError)

    def test_warnings_are_those_of_python(self):
        with self.assertWarnsRegex(UserWarning, "exceeds the stable step"):
            suture.Simulation(bar(dt=0.1, end=1))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with self.assertRaisesRegex(UserWarning, "exceeds the stable step"):
                suture.Simulation(bar(dt=0.1, end=1))


class Steps(unittest.TestCase):
    def test_the_bits_are_those_of_the_program(self):
        scene = bar(output={"directory": "out", "probes": {"every_steps": 1, "at": [
            {"name": "tip", "point": [3, 1, 1], "fields": ["position"]}]}},
            events=[{"at": 0.01, "cut": {"plane": {"point": [1.5, 0, 0], "normal": [1, 0, 0]}}}])
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "bar.json").write_text(json.dumps(scene))
            subprocess.run([os.environ["SUTURE_PROGRAM"], "-q", "run", "bar.json"], cwd=folder,
                           check=True)
            with open(Path(folder) / "out" / "probes.csv") as table:
                rows = list(csv.reader(table))
        sim = suture.Simulation(scene)
        tip = int(np.linalg.norm(sim.rest - [3, 1, 1], axis=1).argmin())
        found = [sim.position[tip].tolist()]
        while sim.step():
            found.append(sim.position[tip].tolist())
        self.assertEqual(found, [[float(value) for value in row[-3:]] for row in rows[1:]])

    def test_parts_of_a_run_are_the_run(self):
        for integrator in ("symplectic-euler", "velocity-verlet", "newmark"):
            with self.subTest(integrator):
                dt = 2e-3 if integrator == "newmark" else 1e-4
                whole, parts = (suture.Simulation(bar(dt=dt, integrator=integrator))
                                for _ in range(2))
                whole.run()
                parts.step()
                parts.velocity, parts.force, parts.energies()
                parts.run_to(0.01)
                self.assertAlmostEqual(parts.time, 0.01, delta=1e-9)
                parts.run()
                self.assertEqual(parts.outcome, "finished")
                np.testing.assert_array_equal(parts.position, whole.position)

    def test_the_end(self):
        sim = suture.Simulation(bar(end=0.001))
        self.assertIsNone(sim.outcome)
        self.assertEqual(sim.step(100), 10)
        self.assertEqual(sim.outcome, "finished")
        self.assertEqual(sim.step(), 0)
        self.assertEqual(sim.run()["steps"], 10)

    def test_energies_add_up(self):
        sim = suture.Simulation(bar())
        sim.step(100)
        e = sim.energies()
        self.assertGreater(e["gravity"], 0)
        self.assertAlmostEqual(e["kinetic"] + e["elastic"], e["gravity"],
                               delta=0.02 * e["gravity"])
        self.assertAlmostEqual(e["potential"], -e["gravity"], delta=1e-9 * e["gravity"])

    def test_explain_says_what_is_skipped(self):
        explained = suture.Simulation(bar()).explain()
        self.assertIn("edge ids", [subject for subject, _ in explained["skipped"]])
        self.assertEqual(explained["threads"], 1)

    def test_bad_arguments(self):
        sim = suture.Simulation(bar())
        with self.assertRaises(TypeError):
            sim.step(1.5)
        with self.assertRaises(TypeError):
            sim.step(-1)
        with self.assertRaisesRegex(ValueError, "NaN"):
            sim.run_to(float("nan"))
        self.assertEqual(sim.steps, 0)

    def test_a_run_that_failed_can_be_read_and_not_continued(self):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            sim = suture.Simulation(bar(dt=0.02, end=10))
            with self.assertRaises(suture.NumericalError):
                sim.run()
        with self.assertRaisesRegex(RuntimeError, "has ended with an error .*restore\(\) an earlier state, or create a new one"):
            sim.step()
        self.assertTrue(np.isfinite(sim.rest).all())
        self.assertEqual(sim.position.shape, sim.rest.shape)


class Threads(unittest.TestCase):
    def test_simulations_side_by_side_and_in_threads(self):
        alone = suture.Simulation(bar())
        alone.run()
        sims = [suture.Simulation(bar()) for _ in range(4)]
        for _ in range(100):  # two in turn on this thread
            sims[0].step()
            sims[1].step()
        threads = [threading.Thread(target=sim.run) for sim in sims]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for sim in sims:
            np.testing.assert_array_equal(sim.position, alone.position)

    def test_simulations_are_made_in_threads(self):
        ends = [None] * 8

        def make(i):
            sim = suture.Simulation(bar(model=("tm-faure", "mss-baudet")[i % 2]))
            sim.cut(plane=([1.5, 0, 0], [1, 0, 0]))
            sim.run()
            ends[i] = sim.position

        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            threads = [threading.Thread(target=make, args=(i,)) for i in range(8)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
        for i in range(2, 8):
            np.testing.assert_array_equal(ends[i], ends[i % 2])

    def test_another_thread_may_not_read_a_run(self):
        sim = suture.Simulation(bar((20, 10, 10), dt=1e-5, end=1))
        started = threading.Event()
        sim.every(1)(lambda s: started.set())

        @sim.every(200)
        def stop(s):
            raise InterruptedError

        def run():
            try:
                sim.run()
            except InterruptedError:
                pass

        thread = threading.Thread(target=run)
        thread.start()
        started.wait()
        refused = 0
        while thread.is_alive():
            try:
                sim.position
            except RuntimeError as error:
                self.assertIn("another thread", str(error))
                refused += 1
        thread.join()
        self.assertGreater(refused, 0)
        self.assertGreater(len(sim.position), 0)

    def test_a_forked_process_is_told(self):
        program = """
import os, sys, suture
from scenes import bar
sim = suture.Simulation(bar())
sim.step(3)
pid = os.fork()
if pid == 0:
    try:
        sim.step()
    except RuntimeError as error:
        assert "forked" in str(error), error
        x = sim.position.sum()
        del sim
        own = suture.Simulation(bar())
        own.step(3)
        assert own.position.sum() == x
        os._exit(0)
    os._exit(1)
assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 0
sim.step()
"""
        subprocess.run([sys.executable, "-c", program], check=True,
                       cwd=os.path.dirname(os.path.abspath(__file__)))


class Repetitions(unittest.TestCase):
    def test_are_limited_with_every_integrator(self):
        """A cube is pressed through itself, which no step can pass."""
        for integrator in ("xpbd", "symplectic-euler", "implicit-euler"):
            sim = suture.Simulation({
                "suture": 2, "mesh": {"box": {"size": [1, 1, 1], "cells": [2, 2, 2]}},
                "models": [{"model": "neo-hookean", "parameters": {
                    "E": 1e5, "nu": 0.3, "rho": 1000, "element": "trilinear"}}],
                "constraints": [{"fix": "xyz", "where": {"set": "z0"}},
                                {"move": {"translation": [0, 0, -1.5]}, "ramp": 1,
                                 "where": {"set": "z1"}}],
                "solver": {"integrator": integrator, "end": 1,
                           **({"dt": 0.01} if integrator == "implicit-euler" else {})},
                "output": False})
            with self.assertRaises(suture.Error, msg=integrator):
                sim.run()
            self.assertLess(sim.time, 0.7)


if __name__ == "__main__":
    unittest.main()
