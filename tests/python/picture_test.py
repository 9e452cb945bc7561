# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the body, as files and in notebooks."""

import io
import os
import subprocess
import sys
import tempfile
import textwrap
import threading
import time
import unittest
from unittest import mock

import numpy as np

import suture
from scenes import bar

try:
    from matplotlib import image
except ImportError:
    image = None

PNG = b"\x89PNG\r\n\x1a\n"


def pixels(picture):
    return image.imread(io.BytesIO(picture.png))[:, :, :3]


def inked(picture):
    """What is not white, below the title."""
    return (pixels(picture)[20:] < 1).any(axis=2)


@unittest.skipIf(image is None, "python3-matplotlib is missing")
class Pictures(unittest.TestCase):
    def test_of_every_kind_of_field(self):
        sim = suture.Simulation(bar())
        sim.step(100)
        fields = ["displacement", "von_mises", "nodal_von_mises", None, sim.mass, sim.von_mises,
                  sim.stress[:, 0], sim.velocity]
        pictures = [sim.picture(field=field, size=(200, 150)) for field in fields]
        for picture in pictures:
            self.assertTrue(picture.png.startswith(PNG))
            self.assertEqual(pixels(picture).shape, (150, 200, 3))
            self.assertGreater(inked(picture).mean(), 0.2)
        self.assertNotEqual(pictures[0].png, pictures[1].png)

    def test_the_silhouette_is_that_of_the_body(self):
        sim = suture.Simulation(bar())
        picture = sim.picture(field=None, size=(400, 400), direction=(0, 0, 1), edges=False)
        rows, columns = np.nonzero(inked(picture))
        self.assertAlmostEqual(np.ptp(columns) / np.ptp(rows), 3, delta=0.1)
        self.assertAlmostEqual(inked(picture).sum() / (np.ptp(rows) * np.ptp(columns)), 1, delta=0.1)
        end = sim.picture(field=None, size=(400, 400), direction=(0, 1, 0), edges=False)
        rows, columns = np.nonzero(inked(end))
        self.assertAlmostEqual(np.ptp(columns) / np.ptp(rows), 3, delta=0.1)

    def test_what_lies_in_front_hides_what_lies_behind(self):
        sim = suture.Simulation(bar((30, 10, 10)))
        plain = sim.picture(field=None, edges=False)
        sim.cut(plane=([1.5, 0, 0], [1, 0, 0]))
        np.testing.assert_array_equal(pixels(sim.picture(field=None, edges=False)), pixels(plain))

    def test_of_a_body_inside_its_elements(self):
        corners = np.vstack([np.eye(3), -np.eye(3)])
        faces = [(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5),
                 (0, 4, 5)]
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "octahedron.obj")
            with open(file, "w") as out:
                out.writelines(f"v {x} {y} {z}\n" for x, y, z in corners)
                out.writelines(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces)
            sim = suture.Simulation({
                "suture": 1, "mesh": {"surface": file, "cells": 4000},
                "models": bar()["models"], "solver": bar()["solver"]})
            sim.step(2)
        picture = sim.picture(field=None, direction=(0, 0, 1), size=(400, 400), edges=False)
        rows, columns = np.nonzero(inked(picture))  # a square on its corner
        self.assertAlmostEqual(inked(picture).sum() / (np.ptp(rows) * np.ptp(columns)), 0.5,
                               delta=0.08)
        self.assertTrue(sim.picture(field="von_mises").png.startswith(PNG))

    def test_files_without_a_display(self):
        program = textwrap.dedent("""
            import sys, suture
            from scenes import bar
            suture.Simulation(bar()).picture(sys.argv[1], size=(200, 150))
            assert "matplotlib.pyplot" not in sys.modules
        """)
        environment = {k: v for k, v in os.environ.items() if k != "DISPLAY"}
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "bar.png")
            subprocess.run([sys.executable, "-c", program, file], check=True, env=environment,
                           cwd=os.path.dirname(os.path.abspath(__file__)))
            with open(file, "rb") as written:
                self.assertEqual(written.read(8), PNG)

    def test_in_a_third_of_a_second(self):
        sim = suture.Simulation(bar((120, 40, 40)))
        sim.picture()  # imports
        start = time.process_time()
        sim.picture(field="velocity")
        self.assertLess(time.process_time() - start, 1, "0.1 s on an idle machine")

    def test_mistakes(self):
        sim = suture.Simulation(bar())
        for arguments, text in (({"field": "stres"}, "did you mean"),
                                ({"field": "stress"}, "choose one of its components"),
                                ({"field": np.zeros(5)}, "one row per vertex, 63, or element, 24"),
                                ({"direction": (0, 0, 0)}, "not all 0"),
                                ({"direction": (1, 0)}, "three numbers")):
            with self.assertRaisesRegex(ValueError, text):
                sim.picture(**arguments)
        with self.assertRaises(OSError):
            sim.picture("/proc/no/such/folder.png")


class Notebooks(unittest.TestCase):
    @unittest.skipIf(image is None, "python3-matplotlib is missing")
    def test_they_show_simulations_and_pictures(self):
        sim = suture.Simulation(bar(title="a <bar>"))
        shown = sim._repr_html_()
        self.assertIn("a &lt;bar&gt;", shown)
        self.assertIn('<img src="data:image/png;base64,iVBOR', shown)
        self.assertTrue(sim.picture()._repr_png_().startswith(PNG))

    def test_without_matplotlib_there_is_a_line(self):
        with mock.patch.dict(sys.modules, {"matplotlib": None}):
            self.assertRegex(suture.Simulation(bar())._repr_html_(), "^<pre>.*</pre>$")
            with self.assertRaisesRegex(ImportError, "install python3-matplotlib"):
                suture.Simulation(bar()).picture()

    def test_a_simulation_that_runs_elsewhere_is_no_error(self):
        sim = suture.Simulation(bar(end=1e9))
        seen = threading.Event()
        stop = threading.Event()

        @sim.every(1)
        def wait(sim):
            seen.set()
            if stop.is_set():
                raise InterruptedError

        def run():
            with self.assertRaises(InterruptedError):
                sim.run()

        thread = threading.Thread(target=run)
        thread.start()
        seen.wait()
        try:
            self.assertRegex(sim._repr_html_(), "<pre>")
        finally:
            stop.set()
            thread.join()


if __name__ == "__main__":
    unittest.main()
