# SPDX-License-Identifier: GPL-3.0-or-later
"""The results of a run as a picture."""

import json
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

from scenes import bar
from suture import _plot


def plot(*words):
    return subprocess.run([os.environ["SUTURE_PROGRAM"], "plot", *map(str, words)],
                          capture_output=True, text=True)


class Plot(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.run_folder = cls.folder / "run"
        tip = {"where": {"nearest": [1, 0, 0]}, "name": "tip", "fields": ["displacement"]}
        scene = bar((2, 1, 1), end=1e-3, gravity=[0, -1, 0],
                    output={"every_steps": 5, "fields": ["displacement", "von_mises"],
                            "energies": {}, "probes": {"at": [tip]}})
        file = cls.folder / "scene.json"
        file.write_text(json.dumps(scene), encoding="utf-8")
        subprocess.run([os.environ["SUTURE_PROGRAM"], "run", "-q", file, "--output",
                        cls.run_folder], check=True)

    def test_draws_the_last_frame_energies_balance_and_probes(self):
        drawn = plot(self.run_folder)
        self.assertEqual(drawn.returncode, 0, drawn.stderr)
        figure = _plot.draw((1.0, _plot.read_quads(self.run_folder / "frame_0001.vtu")),
                            [panel for name in ("energies.csv", "probes.csv")
                             for panel in _plot.panels_of(self.run_folder / name)])
        titles = [axes.get_title() for axes in figure.axes if axes.get_title()]
        self.assertEqual(titles, ["t = 1 s, von_mises", "energies and work [J]",
                                  "balance: unexplained energy [J]", "tip displacement [m]"])
        from matplotlib import image
        picture = image.imread(self.run_folder / "plot.png")
        self.assertGreater(np.ptp(picture[:, :picture.shape[1] // 2, :3]), 0.5)

    def test_the_surface_of_two_cubes_has_ten_faces(self):
        quads = _plot.read_quads(self.run_folder / "frame_0000.vtu")
        self.assertEqual(quads["corners"].shape, (10, 4, 3))
        self.assertEqual(quads["fields"]["von_mises"].shape, (10,))

    def test_what_is_no_run_or_no_picture_is_refused(self):
        for words, code, text in (([self.folder], 3, "has no frames and no tables"),
                                  ([self.folder / "none"], 6, "no such folder"),
                                  ([self.run_folder, "-o", "a.txt"], 3, "must end in .png")):
            refused = plot(*words)
            self.assertEqual(refused.returncode, code)
            self.assertIn(text, refused.stderr)

    def test_a_damaged_table_leaves_the_earlier_picture(self):
        copy = self.folder / "copy"
        shutil.copytree(self.run_folder, copy)
        (copy / "plot.png").write_text("earlier")
        with open(copy / "energies.csv", "a", encoding="utf-8") as table:
            table.write("1,2,x\n")
        refused = plot(copy)
        self.assertEqual(refused.returncode, 3)
        self.assertIn("energies.csv", refused.stderr)
        self.assertEqual((copy / "plot.png").read_text(), "earlier")
        self.assertEqual(list(copy.glob("*.part*")), [])


if __name__ == "__main__":
    unittest.main()
