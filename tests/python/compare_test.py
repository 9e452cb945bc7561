# SPDX-License-Identifier: GPL-3.0-or-later
"""Differences between runs: values that are known, and runs that cannot be compared."""

import contextlib
import io
import json
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

from scenes import bar
from suture import _compare


def run(folder, gravity=-1.0, cells=(2, 1, 1), every=5):
    """A run of 10 steps; returns its output folder."""
    scene = bar(cells, end=1e-3, gravity=[0, gravity, 0],
                output={"every_steps": every, "energies": {}})
    file = folder.with_suffix(".json")
    file.write_text(json.dumps(scene), encoding="utf-8")
    subprocess.run([os.environ["SUTURE_PROGRAM"], "run", "-q", file, "--output", folder],
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
        rows, _ = _compare.compare_frames(one, two, common=True)
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

    def test_a_run_equals_itself_and_twice_the_load_moves_it_twice_as_far(self):
        one, two = run(self.folder / "1"), run(self.folder / "2", -2.0)
        rows, lonely = _compare.compare_frames(one, one)
        self.assertEqual({row[2] for row in rows}, {0.0})
        self.assertEqual(lonely, set())
        rows, _ = _compare.compare_frames(one, two)
        last = [row for row in rows if row[0] == "displacement"][-1]
        self.assertAlmostEqual(last[1], 1e-3)
        self.assertAlmostEqual(last[4], 1, places=4)  # |u - 2 u| / |u|
        rows, _ = _compare.compare_tables(one / "energies.csv", two / "energies.csv")
        work = {row[0]: row[4] for row in rows}["gravity [J]"]
        self.assertAlmostEqual(work, 3, places=3)  # |w - 4 w| / |w|

    def test_runs_that_cannot_be_compared(self):
        one = run(self.folder / "1")
        with self.assertRaisesRegex(ValueError, "meshes differ.*12 nodes and 2.*16 and 3"):
            _compare.compare(one, run(self.folder / "2", cells=(3, 1, 1)))
        with self.assertRaisesRegex(ValueError, "other times.*has 3 .* has 2 .*--common"):
            _compare.compare(one, run(self.folder / "3", every=10))
        with self.assertRaisesRegex(OSError, "no such folder"):
            _compare.compare(one, self.folder / "4")
        (self.folder / "5").mkdir()
        with self.assertRaisesRegex(ValueError, "no frames or tables"):
            _compare.compare(one, self.folder / "5")

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
