# SPDX-License-Identifier: GPL-3.0-or-later
"""Operations, callbacks, and interruptions."""

import gc
import os
import signal
import subprocess
import sys
import textwrap
import time
import traceback
import types
import unittest
import unittest.mock
import weakref

import numpy as np

import suture
from scenes import bar, free_block


class Operations(unittest.TestCase):
    def test_a_plane_cuts(self):
        sim = suture.Simulation(bar())
        change = sim.cut(plane=([1.5, 0, 0], [1, 0, 0]))
        self.assertEqual(change.faces_cut, 4)
        self.assertTrue(change)
        self.assertEqual(sorted(map(tuple, np.sort(change.faces))),
                         [(2, 3), (8, 9), (14, 15), (20, 21)])
        self.assertIn("cut 4 faces, 2 islands", sim.messages[-1])
        with self.assertWarnsRegex(UserWarning, "event cut no face"):
            self.assertFalse(sim.cut(plane=([1.5, 0, 0], [1, 0, 0])))

    def test_a_plane_as_in_a_scene(self):
        sim = suture.Simulation(bar())
        half = {"polygon": [[1.5, 0, 0], [1.5, 1, 0], [1.5, 1, 0.4], [1.5, 0, 0.4]]}
        self.assertEqual(sim.cut(plane=half, shape="rest").faces_cut, 2)

    def test_a_surface_of_arrays(self):
        sim = suture.Simulation(bar())
        vertices = np.array([[1.1, -1, -1], [1.1, 3, -1], [1.1, -1, 3]])
        self.assertEqual(sim.cut(surface=(vertices, [[0, 1, 2]])).faces_cut, 4)

    def test_cuts_along_the_blade_divide_elements(self):
        plane = {"point": [2.4, 0.5, 0.5], "normal": [1, 0.3, 0]}
        scene = bar(events=[{"at": 0.02, "cut": {"plane": plane, "along": "blade"}}])
        sim = suture.Simulation(scene)
        mass = sim.mass.sum()
        change = sim.cut(plane=([1.3, 0.5, 0.5], [1, 0.2, 0.1]), along="blade")
        self.assertTrue(change)
        self.assertEqual(change.elements_cut, 4)
        self.assertIn("cut 4 elements, 2 islands", sim.messages[-1])
        sim.run_to(0.005)
        vertices = np.array([[0.7, -9, -9], [0.8, 9, -9], [0.7, 0, 9]])
        self.assertEqual(sim.cut(surface=(vertices, [[0, 1, 2]]), along="blade").elements_cut, 4)
        self.assertAlmostEqual(sim.mass.sum() / mass, 1, 12)
        sim.run()
        self.assertIn("4 islands", sim.messages[-1])
        with self.assertRaisesRegex(suture.InputError, "set \"divisible\": true in the scene"):
            suture.Simulation(bar()).cut(plane=([1.3, 0, 0], [1, 0, 0]), along="blade")
        with self.assertRaisesRegex(ValueError, "along must be 'faces' or 'blade'"):
            sim.cut(surface=(vertices, [[0, 1, 2]]), along="side")

    def test_faces_pierce_suture_and_islands(self):
        sim = suture.Simulation(bar())
        self.assertEqual(sim.cut(faces=[(0, 1), (6, 7)]).faces_cut, 2)
        self.assertEqual(sim.suture().faces_sewn, 2)
        removed = sim.pierce(path=[[0.25, -1, 0.25], [0.25, 2, 0.25]], radius=0.1)
        np.testing.assert_array_equal(removed.elements, [0, 6])
        self.assertEqual(sim.element_exists.sum(), 22)
        self.assertEqual(sim.cut(plane=([2.5, 0, 0], [1, 0, 0])).faces_cut, 4)
        self.assertEqual(sim.remove_islands(below=10).elements_removed, 4)
        self.assertEqual(len(sim.pierce(where={"ids": [9]}).elements), 1)

    def test_grasp_and_release(self):
        sim = suture.Simulation(bar())
        end = {"box": {"min": [2.9, -1, -1], "max": [4, 2, 2]}}
        held = sim.rest[:, 0] > 2.9
        sim.grasp("clamp", end, move={"translation": [0, 0, 0.01]}, ramp=2 * sim.dt)
        self.assertTrue((sim.fixed[held] == 7).all())
        sim.step(3)
        np.testing.assert_allclose((sim.position - sim.rest)[held], [[0, 0, 0.01]] * held.sum(),
                                   atol=1e-12)
        sim.move_grasp("clamp", [0.01, 0, 0], at=sim.time + 4 * sim.dt)
        sim.step(2)
        half = (sim.position - sim.rest)[held]
        np.testing.assert_allclose(half, [[0.005, 0, 0.01]] * held.sum(), atol=1e-12)
        sim.step(4)
        np.testing.assert_allclose((sim.position - sim.rest)[held],
                                   [[0.01, 0, 0.01]] * held.sum(), atol=1e-12)
        with self.assertRaisesRegex(suture.InputError, "duration > 0"):
            sim.move_grasp("clamp", [0.01, 0, 0], at=sim.time)
        with self.assertRaisesRegex(suture.InputError, "did you mean 'clamp'"):
            sim.move_grasp("clam", [0.01, 0, 0], at=1)
        with self.assertRaisesRegex(suture.InputError, "did you mean 'clamp'"):
            sim.release("clam")
        sim.release("clamp")
        self.assertTrue((sim.fixed[held] == 0).all())
        with self.assertRaisesRegex(suture.InputError, "no node of the deformed body"):
            sim.grasp("air", {"box": {"min": [8, 8, 8], "max": [9, 9, 9]}})

    def test_tear(self):
        sim = suture.Simulation(bar())
        sim.position = sim.rest * [1.5, 1, 1]
        self.assertGreater(sim.tear(above=0.4, most=1).faces_torn, 0)

    def test_bad_arguments_change_nothing(self):
        sim = suture.Simulation(bar())
        square = np.zeros((3, 3))
        cases = [
            (lambda: sim.cut(), TypeError, "exactly one of plane, surface, faces; 0 are given"),
            (lambda: sim.cut(plane=([0, 0], [1, 0, 0])), suture.SceneError, "/cut/plane/point"),
            (lambda: sim.cut(plane={"pt": 1}), suture.SceneError, "/cut/plane/pt"),
            (lambda: sim.cut(faces=[(0, 99)]), suture.InputError, "no element 99"),
            (lambda: sim.cut(faces=[(0, 3)]), suture.InputError, "0 and 3"),
            (lambda: sim.cut(surface=(square[:, :2], [[0, 1, 2]])), ValueError, r"\(n, 3\)"),
            (lambda: sim.cut(surface=(square, [[0, 1]])), ValueError, r"\(k, 3\)"),
            (lambda: sim.cut(surface=(square, [[0, 1, 3]])), ValueError, "vertex 3"),
            (lambda: sim.cut(surface=(square, [[0., 1, 2]])), TypeError, "float64"),
            (lambda: sim.cut(surface=(square * np.nan, [[0, 1, 2]])), ValueError, "finite"),
            (lambda: sim.cut(plane=([1, 0, 0], [1, 0, 0]), shape="bent"), suture.SceneError,
             "/shape"),
            (lambda: sim.pierce(), suture.SceneError, "exactly one of 'where', 'path'"),
            (lambda: sim.tear(above=-1), suture.SceneError, "/tear/above"),
            (lambda: sim.suture(faces=[(0, 0)]), suture.SceneError, "twice"),
            (lambda: sim.pierce(where="all"), suture.InputError, "all 24 remaining"),
        ]
        for call, error, text in cases:
            with self.assertRaisesRegex(error, text):
                call()
        self.assertEqual(sim.messages, [])
        sim.run()


class Callbacks(unittest.TestCase):
    def test_every_and_at(self):
        sim = suture.Simulation(bar())
        steps, times = [], []

        @sim.every(steps=30)
        def each(s):
            self.assertIs(s, sim)
            steps.append(s.steps)

        sim.at(0.0101)(lambda s: times.append(s.time))
        sim.step(60)
        self.assertEqual(steps, [30, 60])
        sim.run()
        self.assertEqual(steps, [30, 60, 90, 120, 150, 180])
        self.assertEqual(len(times), 1)
        self.assertAlmostEqual(times[0], 0.0101)

    def test_a_callback_cuts_and_the_frame_of_its_time_shows_it(self):
        sim, twin = (suture.Simulation(bar()) for _ in range(2))

        @sim.at(0.01)
        def cut(s):
            self.assertEqual(s.cut(plane=([1.5, 0, 0], [1, 0, 0])).faces_cut, 4)

        sim.run()
        twin.run_to(0.01)
        twin.cut(plane=([1.5, 0, 0], [1, 0, 0]))
        twin.run()
        np.testing.assert_array_equal(sim.position, twin.position)

    def test_an_exception_reaches_the_caller_and_the_run_goes_on(self):
        sim, twin = (suture.Simulation(bar()) for _ in range(2))

        @sim.at(0.005)
        def fail(s):
            raise KeyError("mine")

        try:
            sim.run()
            self.fail("nothing was raised")
        except KeyError as error:
            self.assertEqual(traceback.extract_tb(error.__traceback__)[-1].name, "fail")
        self.assertEqual(sim.steps, 50)
        self.assertIsNone(sim.outcome)
        sim.run()
        twin.run()
        self.assertEqual(sim.outcome, "finished")
        np.testing.assert_array_equal(sim.position, twin.position)

    def test_a_callback_cannot_make_steps(self):
        sim = suture.Simulation(bar())
        sim.every(10)(lambda s: s.step())
        with self.assertRaisesRegex(RuntimeError, "cannot make steps of its own run"):
            sim.run()
        self.assertEqual(sim.steps, 10)

    def test_bad_intervals(self):
        sim = suture.Simulation(bar())
        for steps in (0, -3, 1.5):
            with self.assertRaisesRegex(ValueError, "whole number"):
                sim.every(steps)

    def test_progress_is_reported(self):
        sim = suture.Simulation(bar((20, 10, 10), dt=1e-5, end=10))
        seen = []

        def progress(step, t, end):
            seen.append((step, t, end))
            if len(seen) == 2:
                raise InterruptedError

        with self.assertRaises(InterruptedError):
            sim.run(progress)
        self.assertEqual([end for *_, end in seen], [10, 10])
        self.assertLess(seen[0][0], seen[1][0])


    def test_progress_is_a_bar_where_tqdm_is(self):
        class Bar:
            def __init__(self, **options):
                bars.append(self)
                self.n = 0.0

            def __enter__(self):
                return self

            def __exit__(self, *unused):
                self.closed = True

            def update(self, change):
                self.n += change

        bars = []
        module = types.ModuleType("tqdm.auto")
        module.tqdm = Bar
        with unittest.mock.patch.dict(sys.modules, {"tqdm": types.ModuleType("tqdm"),
                                                    "tqdm.auto": module}):
            summary = suture.Simulation(bar((20, 10, 10), dt=1e-5, end=0.03)).run(progress=True)
        self.assertEqual(summary["steps"], 3000)
        self.assertTrue(bars[0].closed)
        self.assertTrue(0 < bars[0].n <= 0.03)
        with unittest.mock.patch.dict(sys.modules, {"tqdm.auto": None}):
            suture.Simulation(bar()).run(progress=True)


class Interruptions(unittest.TestCase):
    def test_control_c_stops_between_steps(self):
        sim = suture.Simulation(bar((20, 10, 10), dt=1e-5, end=100))
        pid = os.fork()
        if pid == 0:
            time.sleep(0.3)
            os.kill(os.getppid(), signal.SIGINT)
            os._exit(0)
        start = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            sim.run()
        self.assertLess(time.monotonic() - start, 5)
        os.waitpid(pid, 0)
        steps = sim.steps
        self.assertGreater(steps, 0)
        self.assertEqual(sim.step(3), 3)
        self.assertEqual(sim.steps, steps + 3)

    def test_control_c_gives_up_a_step_that_solves_equations(self):
        def sagging():
            return suture.Simulation(bar((40, 16, 16), gravity=[0, -1e-3, 0],
                                         solver={"static": {}, "threads": 1}))

        sim, other = sagging(), sagging()
        before = signal.signal(signal.SIGALRM, signal.default_int_handler)
        try:
            with self.assertRaises(KeyboardInterrupt):
                signal.setitimer(signal.ITIMER_REAL, 0.02)  # Newton's method takes 0.1 s and more
                sim.run()
        finally:
            signal.signal(signal.SIGALRM, before)
        self.assertEqual(sim.steps, 0)
        np.testing.assert_array_equal(sim.position, sim.rest)
        sim.run()
        other.run()
        np.testing.assert_array_equal(sim.position, other.position)


class Leaks(unittest.TestCase):
    def test_cycles_are_collected(self):
        class Watched(suture.Simulation):
            pass

        references = []
        for _ in range(3):
            sim = Watched(bar())
            sim.every(5)(lambda s, own=sim: own.time)

            @sim.force_term(stiffness=0)
            def nothing(x, v, t, f, own=sim):
                own.time

            sim.step(10)
            references.append(weakref.ref(sim))
        del sim, nothing
        gc.collect()
        self.assertEqual([reference() for reference in references], [None] * 3)

    def test_a_thousand_simulations(self):
        program = textwrap.dedent("""
            import gc, resource, suture
            from scenes import bar

            def peak():
                gc.collect()
                with open("/proc/self/statm") as file:
                    return int(file.read().split()[1]) * resource.getpagesize()

            def some(count):
                for _ in range(count):
                    sim = suture.Simulation(bar((4, 2, 2)))
                    x = sim.position
                    sim.every(2)(lambda s, own=sim: None)
                    sim.step(3)
                    sim.cut(plane=([1.5, 0, 0], [1, 0, 0]))
                    x = x[3:5] if x is not None else x

            some(1500)
            before = peak()
            some(1000)
            print((peak() - before) / 1000)
        """)
        grown = subprocess.run([sys.executable, "-c", program], check=True, text=True,
                               capture_output=True,
                               cwd=os.path.dirname(os.path.abspath(__file__))).stdout
        self.assertLess(float(grown), 1000, "bytes per simulation")


if __name__ == "__main__":
    unittest.main()
