# SPDX-License-Identifier: GPL-3.0-or-later
"""The results of runs and studies, and meshes, as pictures."""

import json
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

from scenes import bar
import suture
from suture import _frames, _plot, _plot_study


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
        figure = _plot.draw_runs([self.run_folder])
        titles = [axes.get_title() for axes in figure.axes if axes.get_title()]
        self.assertEqual(titles, ["t = 0.001 s, von_mises", "energies and work [J]",
                                  "balance: unexplained energy [J]", "tip displacement [m]"])
        from matplotlib import image
        picture = image.imread(self.run_folder / "plot.png")
        self.assertGreater(np.ptp(picture[:, :picture.shape[1] // 2, :3]), 0.5)

    def test_the_surface_of_two_cubes_has_ten_faces(self):
        faces = _frames.read_faces(self.run_folder / "frame_0000.vtu")
        self.assertEqual(faces["corners"].shape, (10, 4, 3))
        self.assertEqual(faces["fields"]["von_mises"].shape, (10,))

    def test_what_is_no_run_or_no_picture_is_refused(self):
        empty = self.folder / "empty"
        empty.mkdir()
        for words, code, text in (([empty], 3, "has no frames and no tables"),
                                  ([self.folder / "none"], 6, "no such folder"),
                                  ([self.run_folder, "--only", "heat"], 0, ""),
                                  ([empty, "--only", "heat"], 3, "named like heat"),
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

    def test_several_runs_share_panels_and_colours(self):
        twin = self.folder / "twin"
        shutil.copytree(self.run_folder, twin)
        table = (twin / "probes.csv").read_text().splitlines()
        (twin / "probes.csv").write_text("\n".join(table[:2]) + "\n")
        figure = _plot.draw_runs([self.run_folder, twin], only=["tip", "kinetic"])
        titles = {axes.get_title(): axes for axes in figure.axes if axes.get_title()}
        self.assertEqual(list(titles)[:2], ["run: t = 0.001 s, von_mises",
                                            "twin: t = 0.001 s, von_mises"])
        self.assertEqual(list(titles)[2], "kinetic [J]")
        first, second = (axes.collections[0].get_clim() for axes in list(titles.values())[:2])
        self.assertEqual(first, second)
        lines = titles["tip displacement y [m]"].lines
        self.assertEqual([line.get_label() for line in lines], ["run", "twin"])
        self.assertEqual([len(line.get_xdata()) for line in lines], [len(table) - 1, 1])
        drawn = plot(self.run_folder, twin, "-o", self.folder / "two.png")
        self.assertEqual(drawn.returncode, 0, drawn.stderr)
        self.assertTrue((self.folder / "two.png").exists())

    def test_bodies_made_from_a_surface_are_drawn(self):
        from matplotlib import image
        corners = "".join(f"v {x} {y} {z}\n" for z in (0, 1) for y in (0, 1) for x in (0, 1))
        (self.folder / "cube.obj").write_text(
            corners + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n")
        scene = {**bar(end=1e-4), "mesh": {"surface": "cube.obj", "edge": 0.3},
                 "constraints": [{"fix": "xyz", "where": {"half_space": {
                     "point": [0.5, 0, 0], "normal": [-1, 0, 0]}}}]}
        (self.folder / "cube.json").write_text(json.dumps(scene))
        subprocess.run([os.environ["SUTURE_PROGRAM"], "run", "-q", self.folder / "cube.json",
                        "--output", self.folder / "cube"], check=True)
        for what, picture in ((self.folder / "cube", self.folder / "cube/plot.png"),
                              (self.folder / "cube.json", self.folder / "cube.png"),
                              (self.folder / "cube.obj", self.folder / "surface.png")):
            drawn = plot(what, "-o", picture)
            self.assertEqual(drawn.returncode, 0, drawn.stderr)
            self.assertGreater(np.ptp(image.imread(picture)), 0.5)


class Meshes(unittest.TestCase):
    """Pictures of meshes: what is drawn is known."""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)

    def drawn(self, what, *words):
        from matplotlib import image

        found = plot(what, "-o", self.folder / "a.png", *words)
        self.assertEqual(found.returncode, 0, found.stderr)
        self.assertGreater(np.ptp(image.imread(self.folder / "a.png")), 0.5)
        return found

    def frame_of(self, what):
        """(points, corners, fields) that the program passes to the module, here a stub."""
        program = Path(os.environ["SUTURE_PROGRAM"])
        stub = self.folder / "python" / "suture"
        if not stub.exists():
            stub.mkdir(parents=True)
            (self.folder / "bin").mkdir()
            shutil.copy(program, self.folder / "bin")
            shutil.copy(Path(_frames.__file__).with_name("_start.py"), stub)
            for name in ("__init__.py", "_suture.py"):
                (stub / name).touch()
            (stub / "_plot_mesh.py").write_text(
                "import shutil, sys\nshutil.copy(sys.argv[1], 'frame.vtu')\n")
        libraries = program.parents[1] / "lib" / "suture"
        subprocess.run([self.folder / "bin" / program.name, "plot", what], check=True,
                       cwd=self.folder, env={**os.environ, "SUTURE_MODULE_PATH": str(libraries),
                                             "SUTURE_PLUGIN_PATH": str(libraries / "plugins")})
        return _frames.read_boundary(self.folder / "frame.vtu")

    def test_the_boundary_and_the_sets_of_a_box(self):
        from suture._plot_mesh import _normals

        box = {"size": [3, 1, 1], "cells": [3, 2, 1], "origin": [5, 0, 0]}
        scene = bar(mesh={"box": box}, loads=[{"force": [1, 0, 0], "where": {
            "nearest": [8, 1, 1]}}], models=[{**bar()["models"][0], "name": "left", "region": {
                "half_space": {"point": [6, 0, 0], "normal": [-1, 0, 0]}}}, {
                    **bar()["models"][0], "name": "right", "region": {
                        "half_space": {"point": [6, 0, 0], "normal": [1, 0, 0]}}}])
        (self.folder / "s.json").write_text(json.dumps(scene))
        mesh = self.folder / "box.vtu"
        subprocess.run([os.environ["SUTURE_PROGRAM"], "-q", "mesh", "generate", "box", mesh,
                        "--size", "3,1,1", "--cells", "3,2,1", "--origin", "5,0,0"], check=True)
        for what in (self.folder / "s.json", mesh):
            with self.subTest(what.suffix):
                points, corners, fields = self.frame_of(what)
                self.assertEqual(corners.shape, (2 * (2 + 3 + 6), 4))
                np.testing.assert_array_equal(points.min(axis=0), [5, 0, 0])
                outward = points[corners].mean(axis=1) - [6.5, 0.5, 0.5]
                self.assertTrue(((_normals(points[corners]) * outward).sum(axis=1) > 0.4).all())
                for name, axis, value in (("set x0", 0, 5), ("set y1", 1, 1), ("set z0", 2, 0)):
                    np.testing.assert_array_equal(fields[name] == 1, points[:, axis] == value)
        _, _, fields = self.frame_of(self.folder / "s.json")
        self.assertEqual({name: int(values.sum()) for name, values in fields.items()
                          if name.startswith("at ")},
                         {"at /constraints/0": 6, "at /loads/0": 1, "at /models/0 left": 12,
                          "at /models/1 right": 18})

    def test_obstacles_and_grasps_of_a_scene(self):
        from suture._plot_mesh import Sets

        path = [{"at": 0, "translation": [0, 1, 0]}, {"at": 0.02}]
        scene = bar((2, 1, 1), contact={"obstacles": [
            {"name": "ball", "sphere": {"centre": [1, 2, 0.5], "radius": 0.5}, "path": path}]},
            events=[{"at": 0.01, "grasp": {"name": "clamp", "where": {"set": "x1"}}}])
        (self.folder / "s.json").write_text(json.dumps(scene))
        points, corners, fields = self.frame_of(self.folder / "s.json")
        self.assertEqual(fields["at /events/0/grasp clamp"].sum(), 4)
        ball = points[fields["obstacle ball"] == 1]
        np.testing.assert_allclose(np.linalg.norm(ball - [1, 3, 0.5], axis=1), 0.5, rtol=1e-6)
        sets = Sets(fields, corners)
        self.assertEqual(sets.body.sum(), 10)
        self.assertEqual(sets.obstacles["obstacle ball"].sum(), len(corners) - 10)
        self.assertNotIn("obstacle ball", sets.dots())
        self.drawn(self.folder / "s.json")

    def test_the_sets_of_a_box_colour_its_sides(self):
        from suture._plot_mesh import Sets, _direction, _normals

        points = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
        corners = np.array([[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1],
                            [4, 5, 7, 6]])
        outward = np.array([[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]])
        np.testing.assert_array_equal(_normals(points[corners]), outward)
        fields = {"set all": np.ones(8), "set x0": points[:, 0] == 0.0,
                  "set edge": (points[:, 0] == 0) & (points[:, 1] == 0),
                  "at /constraints/0": points[:, 1] == 1}
        sets = Sets({name: values.astype(float) for name, values in fields.items()}, corners)
        colours = [tuple(colour) for colour in sets.face_colours(6)]
        self.assertEqual(colours, [sets.colours["set x0"]] + 5 * [sets.colours["set all"]])
        self.assertEqual(sets.dots(), ["set edge", "at /constraints/0"])
        # Both views together show all sides.
        from suture._plot_mesh import VIEWS
        seen = np.array([outward @ _direction(*view) > 0 for view in VIEWS])
        np.testing.assert_array_equal(seen.sum(axis=0), np.ones(6))

    def test_meshes_of_files_and_scenes(self):
        program = os.environ["SUTURE_PROGRAM"]
        box = self.folder / "box.msh"
        subprocess.run([program, "-q", "mesh", "generate", "box", box, "--size", "1,1,1",
                        "--cells", "2,2,2"], check=True)
        self.drawn(box)
        self.drawn(box, "--scale", "1e-3")
        scene = bar((2, 1, 1))
        scene["constraints"].append({"fix": "y", "where": {"sphere": {"centre": [9, 9, 9],
                                                                      "radius": 0.1}}})
        (self.folder / "s.json").write_text(json.dumps(scene))
        found = self.drawn(self.folder / "s.json")
        self.assertIn("/constraints/1/where: the selection contains no node", found.stderr)
        tetrahedron = self.folder / "tetrahedron.mesh"
        tetrahedron.write_text("MeshVersionFormatted 2\nDimension 3\nVertices 4\n0 0 0 1\n"
                               "1 0 0 1\n0 1 0 2\n0 0 1 2\nTetrahedra 1\n1 2 3 4 1\nEnd\n")
        self.drawn(tetrahedron)
        refused = plot(box, self.folder / "s.json")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("is drawn alone", refused.stderr)


class Studies(unittest.TestCase):
    def test_names_of_parameters(self):
        self.assertEqual(_plot_study.labels_of(["/models/0/parameters/E", "/solver/dt"]),
                         {"/models/0/parameters/E": "E", "/solver/dt": "dt"})
        self.assertEqual(list(_plot_study.labels_of(
            ["/models/0/parameters/E", "/models/1/parameters/E", "/gravity/1"]).values()),
            ["models/0/parameters/E", "models/1/parameters/E", "gravity/1"])

    def test_a_grid_has_a_curve_per_value_of_the_other_parameter(self):
        rows = [{"run": i, "/a": a, "/b": b, "tip [m]": a * b, "outcome": "finished", "seconds": i}
                for i, (a, b) in enumerate([(1, 1), (10, 1), (100, 1), (1, 2), (10, 2)])]
        with tempfile.TemporaryDirectory() as folder:
            panels = _plot_study.panels_of_study(suture.Results(rows, Path(folder) / "results.csv"))
        self.assertEqual([(panel.title, panel.x_label) for panel in panels],
                         [("tip [m]", "a"), ("tip [m]", "b")])
        curves = [(list(curve.x), list(curve.y), curve.value) for curve in panels[0].curves]
        self.assertEqual(curves, [([1, 10, 100], [1, 10, 100], 1), ([1, 10], [2, 20], 2)])
        self.assertEqual((panels[0].is_log, panels[1].is_log), (True, False))
        self.assertTrue(panels[1].scale.is_log)

    def test_words_are_numbered(self):
        rows = [{"run": i, "/m": name, "x": float(i), "outcome": "finished"}
                for i, name in enumerate(["b", "a", "b"])]
        with tempfile.TemporaryDirectory() as folder:
            panel, = _plot_study.panels_of_study(
                suture.Results(rows, Path(folder) / "results.csv"))
        self.assertEqual(panel.ticks, ["b", "a"])
        self.assertEqual([list(curve.x) for curve in panel.curves], [[0, 0, 1]])


if __name__ == "__main__":
    unittest.main()
