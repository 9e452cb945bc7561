# SPDX-License-Identifier: GPL-3.0-or-later
"""Differences between runs: values that are known, and runs that cannot be compared."""

import contextlib
import io
import json
import os
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

from scenes import bar
from suture import _compare, _differences, _frames, _orders, _results


def run(folder, gravity=-1.0, cells=(2, 1, 1), every=5, words=(), **more):
    """A run of 10 steps, unless `more` says otherwise; returns its output folder."""
    scene = bar(cells, end=1e-3, gravity=[0, gravity, 0] if isinstance(gravity, float) else gravity,
                output={"every_steps": every, "energies": {}})
    scene.update(more)
    file = folder.with_suffix(".json")
    file.write_text(json.dumps(scene), encoding="utf-8")
    subprocess.run([os.environ["SUTURE_PROGRAM"], "run", "-q", file, "--output", folder, *words],
                   check=True)
    return folder


class Compare(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)

    def test_the_difference_of_known_values(self):
        rms, largest, scale = _compare.difference(
            np.array([[3.0, 0], [0, 4]]), np.array([[3.0, 0], [0, 0]]))
        self.assertAlmostEqual(rms, 8 ** 0.5)
        self.assertAlmostEqual(largest, 4)
        self.assertAlmostEqual(scale, 12.5 ** 0.5)

    def test_undefined_values(self):
        nan = np.nan
        self.assertEqual(_compare.difference(np.array([nan, 2.0]), np.array([nan, 1.0]))[1], 1)
        self.assertEqual(_compare.difference(np.array([nan, 2.0]), np.array([0.0, 2.0]))[1], np.inf)
        self.assertEqual(_compare.difference(np.array([1.0]), np.array([nan]))[0], np.inf)

    def test_common_times(self):
        one, two = run(self.folder / "1"), run(self.folder / "2", every=10)
        rows, *_ = _compare.compare_frames(one, two, common=True)
        self.assertEqual({row[1] for row in rows}, {0, 1e-3})
        self.assertEqual({row[2] for row in rows}, {0.0})

    def test_a_tolerance(self):
        one, two = run(self.folder / "1"), run(self.folder / "2", -1.01)
        program = [os.environ["SUTURE_PROGRAM"], "compare", one, two, "--tolerance"]
        self.assertEqual(subprocess.run([*program, "0.03"], stdout=subprocess.PIPE).returncode, 0)
        beyond = subprocess.run([*program, "0.005"], capture_output=True, text=True)
        self.assertEqual(beyond.returncode, 1)
        self.assertRegex(beyond.stdout, "beyond 0.005: .*displacement \\(frames\\)")
        self.assertEqual(subprocess.run([*program, "-1"], capture_output=True).returncode, 2)

    def test_files_of_the_working_folder_are_not_imported(self):
        one = run(self.folder / "1")
        for name in "json", "numpy", "suture":
            (self.folder / f"{name}.py").write_text("raise ImportError('a file of the user')")

        def program(*words):
            return subprocess.run([os.environ["SUTURE_PROGRAM"], *words], cwd=self.folder,
                                  capture_output=True, text=True)

        same = program("compare", one, one)
        self.assertEqual(same.returncode, 0, same.stderr)
        self.assertRegex(program("fit", "nowhere.json").stderr, "nowhere.json: No such file")

    def test_a_run_equals_itself_and_twice_the_load_moves_it_twice_as_far(self):
        one, two = run(self.folder / "1"), run(self.folder / "2", -2.0)
        rows, lonely, _ = _compare.compare_frames(one, one)
        self.assertEqual({row[2] for row in rows}, {0.0})
        self.assertEqual(lonely, set())
        rows, *_ = _compare.compare_frames(one, two)
        last = [row for row in rows if row[0] == "displacement"][-1]
        self.assertAlmostEqual(last[1], 1e-3)
        self.assertAlmostEqual(last[4], 1, places=4)  # |u - 2 u| / |u|
        rows, _ = _compare.compare_tables(one / "energies.csv", two / "energies.csv")
        work = {row[0]: row[4] for row in rows}["gravity [J]"]
        self.assertAlmostEqual(work, 3, places=3)  # |w - 4 w| / |w|

    def test_runs_that_cannot_be_compared(self):
        one = run(self.folder / "1")
        with self.assertRaisesRegex(ValueError, "other times.*has 3 .* has 2 .*--common"):
            _compare.compare(one, run(self.folder / "3", every=10))
        with self.assertRaisesRegex(OSError, "no such folder"):
            _compare.compare(one, self.folder / "4")
        (self.folder / "5").mkdir()
        with self.assertRaisesRegex(ValueError, "no frames or tables"):
            _compare.compare(one, self.folder / "5")

    def test_meshes_that_differ_are_probed(self):
        """A bar that is stretched has a linear displacement on any mesh."""
        def stretched(name, cells, by=0.3, **more):
            return run(self.folder / name, cells=cells, **{
                "gravity": [0, 0, 0], "solver": {"static": {"frames": 1}, "end": 1},
                "constraints": [{"fix": "xyz", "where": {"set": "x0"}},
                                {"fix": "yz", "where": {"half_space": {
                                    "point": [-1, 0, 0], "normal": [1, 0, 0]}}},
                                {"move": {"translation": [by, 0, 0]}, "ramp": 1,
                                 "where": {"set": "x1"}}],
                "output": {"fields": ["displacement", "von_mises"]}, **more})

        coarse, fine = stretched("1", (4, 1, 1)), stretched("2", (6, 3, 3))
        rows, _, notes = _compare.compare_frames(coarse, fine)
        self.assertRegex(str(notes), "meshes differ \\(4 and 54 cells\\)")
        last = {name: (largest, relative) for name, time, _, largest, relative in rows}
        self.assertEqual(set(last), {"displacement", "von_mises"})
        self.assertLess(last["displacement"][0], 1e-7)
        self.assertLess(last["von_mises"][1], 1e-6)
        # Twice as far: the same points of the body are compared, wherever they are now.
        rows, *_ = _compare.compare_frames(coarse, stretched("6", (6, 3, 3), by=0.6))
        self.assertAlmostEqual(rows[-2][4], 1, places=6)
        # A body that is elsewhere, and a finer one that is smaller.
        away = stretched("3", (2, 1, 1), mesh={"box": {"size": [3, 1, 1], "cells": [2, 1, 1],
                                                       "origin": [9, 0, 0]}})
        with self.assertRaisesRegex(ValueError, "do not overlap at rest"):
            _compare.compare(coarse, away)
        small = stretched("4", (6, 3, 3), mesh={"box": {"size": [1.6, 1, 1], "cells": [6, 3, 3]}})
        *_, notes = _compare.compare_frames(coarse, small)
        self.assertRegex(str(notes), "of which 8 of 20 lie outside the second")
        bare = stretched("5", (6, 3, 3), output={"fields": ["von_mises"]})
        with self.assertRaisesRegex(ValueError, "has no field 'displacement'"):
            _compare.compare(coarse, bare)

    @unittest.skipUnless(os.environ.get("SUTURE_LAUNCHER"), "MPI is missing")
    def test_pieces_are_joined_to_the_frames_of_one_process(self):
        """The lips of a cut are at the same places, and remain apart."""
        cut = {"cut": {"along": "faces", "plane": {"point": [1, 0, 0], "normal": [1, 0, 0]}}}
        scene = {"cells": (6, 2, 2), "events": [{"at": 0, **cut}]}
        output = {"every_steps": 5, "fields": ["displacement", "stress", "element_id"]}
        one = run(self.folder / "1", **scene, output=output)
        three = run(self.folder / "3", **scene, output={**output, "pieces": True},
                    words=["--processes", "3"])
        pairs = list(zip(_results.frames_of(one), _results.frames_of(three), strict=True))
        self.assertEqual(len(pairs), 3)
        for (time, file), (same_time, joined) in pairs:
            self.assertEqual((time, file.suffix, joined.suffix), (same_time, ".vtu", ".pvtu"))
            frame, other = _frames.Frame(file), _frames.Frame(joined)
            np.testing.assert_array_equal(frame.points, other.points)
            np.testing.assert_array_equal(frame.cells, other.cells)
            self.assertEqual(set(frame.fields), set(other.fields))
            for name, values in frame.fields.items():
                np.testing.assert_array_equal(values, other.fields[name])
            faces, same = _frames.read_faces(file), _frames.read_faces(joined)
            np.testing.assert_array_equal(faces["corners"], same["corners"])
        *_, notes = _compare.compare_frames(one, three)
        self.assertEqual(notes, set())
        next(three.glob("frame_0001_1.vtu")).unlink()
        with self.assertRaisesRegex(OSError, "frame_0001_1.vtu: is missing"):
            _compare.compare(one, three)
        last = three / "frame_0002.pvtu"
        lines = last.read_text().splitlines(keepends=True)
        last.write_text("".join(line for line in lines if "frame_0002_1.vtu" not in line))
        with self.assertRaisesRegex(OSError, "frame_0002.pvtu: its pieces are not those of one"):
            _frames.Frame(last)

    def test_lips_of_cuts_are_left_out(self):
        places = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 0], [2, 0, 0.1 + 0.2], [2, 0, 0.3]])
        np.testing.assert_array_equal(_differences.without_lips(places), [1, 0, 0, 0, 0])

    def test_orders_of_known_sequences(self):
        for sizes in ((0.4, 0.2, 0.1), (0.5, 0.3, 0.1), (0.3, 0.2, 0.19)):
            for order in (0.5, 1, 2, 4):
                values = [7 + 2 * h ** order for h in sizes]
                ratio = (values[0] - values[1]) / (values[1] - values[2])
                found = _orders.observed_order(ratio, sizes)
                self.assertAlmostEqual(found, order, places=6)
                self.assertAlmostEqual(_orders.limit_of(values, found, sizes), 7, places=6)
        self.assertTrue(np.isnan(_orders.observed_order(-1, (0.4, 0.2, 0.1))))
        self.assertTrue(np.isnan(_orders.observed_order(np.nan, (0.4, 0.2, 0.1))))
        self.assertAlmostEqual(_orders.observed_order(1, (0.4, 0.2, 0.1)), 0, places=6)

    def orders(self, *folders):
        """{column or field: numbers}, and what was printed."""
        done = subprocess.run([os.environ["SUTURE_PROGRAM"], "compare", *folders],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [re.split(" {2,}", line) for line in done.stdout.splitlines()]
        return {row[0]: row[1:] for row in rows if len(row) > 2}, done.stdout

    def test_three_steps_show_the_order_of_the_integrator(self):
        """A block falls freely: symplectic Euler is off by g t dt / 2."""
        runs = [run(self.folder / str(i), solver={"dt": dt, "end": 0.016}, constraints=[],
                    cells=(2, 1, 1), gravity=[0, -10, 0],
                    output={"every_steps": 16, "probes": {"every_steps": 1, "at": [
                        {"name": "tip", "point": [3, 1, 1], "fields": ["displacement"]}]}})
                for i, dt in enumerate((4e-3, 2e-3, 1e-3))]
        rows, text = self.orders(*runs)
        self.assertIn("sizes of steps: 0.004, 0.002, 0.001 s", text)
        order, limit = map(float, rows["tip displacement y [m]"][-2:])
        self.assertAlmostEqual(order, 1, places=4)
        self.assertAlmostEqual(limit, -10 * 0.016 ** 2 / 2, places=7)
        self.assertAlmostEqual(float(rows["displacement"][-1]), 1, places=4)
        wrong = subprocess.run([os.environ["SUTURE_PROGRAM"], "compare", *runs[::-1]],
                               capture_output=True, text=True)
        self.assertEqual(wrong.returncode, 3)
        self.assertIn("from coarse to fine: their sizes of steps are 0.001, 0.002", wrong.stderr)

    def test_three_meshes_show_the_order_of_the_elements(self):
        """A bar that hangs: its nodes are exact for any mesh, its energy converges quadratically, and
        its stress, which is constant in each element, linearly."""
        runs = [run(self.folder / str(n), cells=(2 * n, n, n), gravity=[1e-3, 0, 0],
                    solver={"static": {"frames": 1}, "end": 1},
                    constraints=[{"fix": "x", "where": {"set": "x0"}},
                                 {"fix": "yz", "where": {"half_space": {
                                     "point": [-1, 0, 0], "normal": [1, 0, 0]}}}],
                    output={"fields": ["displacement", "von_mises"], "energies": {}})
                for n in (1, 2, 4)]
        rows, text = self.orders(*runs)
        self.assertRegex(text, "sizes of elements: .*m")
        self.assertAlmostEqual(float(rows["elastic [J]"][-2]), 2, places=2)
        self.assertAlmostEqual(float(rows["von_mises"][-1]), 1, places=2)

    def test_files_that_are_damaged_are_errors_and_no_differences(self):
        one, two = run(self.folder / "1"), run(self.folder / "2")
        program = [os.environ["SUTURE_PROGRAM"], "compare", one, two]
        for name, code in (("frame_0001.vtu", 6), ("energies.csv", 3), ("run.pvd", 3)):
            good = (two / name).read_bytes()
            for bad in (b"", good[:100], good[:300], good[:len(good) // 2],
                        b"x,y\n1,2\n"):
                with self.subTest(name, bad=bad[-20:]):
                    (two / name).write_bytes(bad)
                    done = subprocess.run(program, capture_output=True, text=True)
                    self.assertEqual(done.returncode, code, done.stderr)
                    self.assertRegex(done.stderr, f"suture: error: .*{name}: ")
                    self.assertNotIn("Traceback", done.stderr)
            (two / name).write_bytes(good)
        self.assertEqual(subprocess.run(program, capture_output=True).returncode, 0)
        for tolerance in ("nan", "-1", "x", "inf"):
            done = subprocess.run([*program, "--tolerance", tolerance], capture_output=True)
            self.assertEqual(done.returncode, 2, done.stderr)

    def test_the_table(self):
        one = run(self.folder / "1")
        text = io.StringIO()
        with contextlib.redirect_stdout(text):
            _compare.compare(one, one / "run.pvd")
        self.assertRegex(text.getvalue(), r"displacement +0.001 +0 +0 +0")

    def test_a_module_that_is_not_built_is_missed(self):
        program = self.folder / "bin" / "suture"
        program.parent.mkdir()
        shutil.copy(os.environ["SUTURE_PROGRAM"], program)
        shutil.copytree(Path(_compare.__file__).parent, self.folder / "python" / "suture",
                        ignore=shutil.ignore_patterns("*.so"))
        missed = subprocess.run([program, "compare", "a", "b"], capture_output=True, text=True)
        self.assertEqual(missed.returncode, 6)
        self.assertIn("the Python module of Suture is missing", missed.stderr)


if __name__ == "__main__":
    unittest.main()
