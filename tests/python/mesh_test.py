# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of arrays, in and out, and what is made from them."""

import os
import tempfile
import types
import unittest

import numpy as np

import suture
from scenes import bar


def grid(n=(6, 2, 2), size=(3, 1, 1), origin=(0, 0, 0)):
    """The points and hexahedra of a box, in VTK's order."""
    axes = [np.linspace(0, s, k + 1) + o for s, k, o in zip(size, n, origin)]
    z, y, x = np.meshgrid(*axes[::-1], indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    number = np.arange(len(points)).reshape(n[2] + 1, n[1] + 1, n[0] + 1)
    corners = [number[c:n[2] + c, b:n[1] + b, a:n[0] + a].ravel()
               for a, b, c in [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0),
                               (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]]
    return points, np.stack(corners, axis=1)


def volume_inside(points, quads):
    """By the divergence theorem, which gives the sign of the orientation too."""
    a, b, c, d = (points[quads[:, i]] for i in range(4))
    return sum(np.einsum("ij,ij->i", p, np.cross(q, r)).sum() / 6
               for p, q, r in ((a, b, c), (a, c, d)))


def without_mesh(**more):
    scene = bar(**more)
    del scene["mesh"]
    return scene


class Given(unittest.TestCase):
    def test_arrays_run_like_the_same_box(self):
        points, cells = grid()
        mesh = suture.Mesh(points, cells, point_sets={"x0": points[:, 0] == 0})
        sims = [suture.Simulation(without_mesh(), mesh=mesh),
                suture.Simulation({**without_mesh(), "mesh": mesh}), suture.Simulation(bar())]
        for sim in sims:
            sim.run()
            np.testing.assert_array_equal(sim.position, sims[0].position)

    def test_sets_arrays_and_an_origin(self):
        points, cells = grid(origin=(100, 0, 0))
        stiff = np.where(np.arange(24) % 6 < 3, 1e5, 2e5)
        mesh = suture.Mesh(points, cells, point_sets={"x0": np.flatnonzero(points[:, 0] == 100)},
                           element_sets={"half": np.arange(24) % 6 < 3},
                           element_arrays={"E": stiff})
        models = [{"model": "tm-faure", "parameters": {"E": {"array": "E"}, "nu": 0.3, "rho": 1000}}]
        sim = suture.Simulation(without_mesh(models=models), mesh=mesh)
        self.assertEqual(sim.origin, [100, 0, 0])
        sim.run()
        self.assertEqual(sim.pierce(where={"set": "half"}).elements_removed, 12)

    def test_bad_arrays(self):
        points, cells = grid()
        cases = [
            (dict(points=points[:, :2]), ValueError, r"points must have the shape \(n, 3\)"),
            (dict(hexahedra=cells[:, :7]), ValueError, r"hexahedra must have the shape \(n, 8\)"),
            (dict(hexahedra=cells.astype(float)), TypeError, "must be integers"),
            (dict(hexahedra=cells + 1), ValueError, "names point 63; there are points 0 to 62"),
            (dict(hexahedra=cells - 1), ValueError, "names point -1"),
            (dict(points=points.astype(complex)), TypeError, "complex128"),
            (dict(point_sets={"a": [99]}), ValueError, r"point_sets\['a'\] names point 99"),
            (dict(element_arrays={"E": [1, 2]}), ValueError, "must have 24 rows"),
        ]
        for more, error, text in cases:
            with self.assertRaisesRegex(error, text):
                suture.Mesh(**{"points": points, "hexahedra": cells, **more})
        bad = points.copy()
        bad[5, 1] = np.nan
        sets = {"x0": [0]}
        with self.assertRaisesRegex(suture.InputError, "finite"):
            suture.Simulation(without_mesh(), mesh=suture.Mesh(bad, cells, sets))
        with self.assertRaisesRegex(suture.InputError, "element"):
            suture.Simulation(without_mesh(),
                              mesh=suture.Mesh(points, np.vstack([cells, cells[:1]]), sets))
        with self.assertRaisesRegex(TypeError, "must be a suture.Mesh, is str"):
            suture.Simulation(without_mesh(), mesh="beam.vtu")
        with self.assertRaisesRegex(suture.SceneError, "/mesh/box.*program"):
            suture.Simulation(bar(), mesh=suture.Mesh(points, cells, sets))

    def test_meshio(self):
        points, cells = grid()
        block = types.SimpleNamespace
        mesh = block(points=points, point_sets={"x0": np.flatnonzero(points[:, 0] == 0)},
                     cells=[block(type="quad", data=cells[:2, :4]),
                            block(type="hexahedron", data=cells[:10]),
                            block(type="hexahedron", data=cells[10:])],
                     cell_sets={"end": [None, np.array([5]), np.array([1, 2])]},
                     point_data={}, cell_data={"E": [np.ones(2), np.ones(10), 2 * np.ones(14)]})
        made = suture.Mesh.from_meshio(mesh)
        np.testing.assert_array_equal(made.hexahedra, cells)
        np.testing.assert_array_equal(made.element_sets["end"], [5, 11, 12])
        np.testing.assert_array_equal(made.element_arrays["E"], [1] * 10 + [2] * 14)
        suture.Simulation(without_mesh(), mesh=made).step(2)
        mesh.cells = mesh.cells[:1]
        with self.assertRaisesRegex(ValueError, "no hexahedra; it has quad"):
            suture.Mesh.from_meshio(mesh)


class Taken(unittest.TestCase):
    def test_the_mesh_goes_round(self):
        sim = suture.Simulation(bar())
        sim.step(100)
        sim.pierce(where={"ids": [5, 11]})
        sim.cut(plane=([1.5, 0, 0], [1, 0, 0]))
        mesh = sim.mesh()
        self.assertEqual(mesh.hexahedra.shape, (22, 8))
        self.assertEqual(len(mesh.points), sim.vertex_exists.sum())
        mesh.point_sets["x0"] = np.flatnonzero(mesh.points[:, 0] == 0)
        again = suture.Simulation(without_mesh(), mesh=mesh)
        self.assertAlmostEqual(volume_inside(*again.surface()[:2]),
                               volume_inside(*sim.surface()[:2]))

    def test_named_sets_stay(self):
        points, hexahedra = grid()
        mesh = suture.Mesh(points, hexahedra, point_sets={"left": points[:, 0] == 0, "none": []},
                           element_sets={"front": [0, 1, 2], "middle": [2, 3, 8, 9]})
        scene = {key: value for key, value in bar(constraints=[
            {"fix": "xyz", "where": {"set": "left"}}]).items() if key != "mesh"}
        sim = suture.Simulation(scene, mesh=mesh)
        now = sim.mesh()
        self.assertEqual(now.element_sets["middle"].tolist(), [2, 3, 8, 9])
        self.assertEqual(now.points[now.point_sets["left"], 0].tolist(), [0] * 9)
        self.assertEqual(now.point_sets["none"].size, 0)
        sim.cut(plane=([1.5, 0, 0], [1, 0, 0]))
        sim.pierce(where={"ids": [0]})
        sim.step(5)
        now = sim.mesh()
        ids = sim.element_ids[now.element_arrays["element"].astype(int)]
        self.assertEqual(ids[now.element_sets["front"]].tolist(), [1, 2])
        self.assertEqual(ids[now.element_sets["middle"]].tolist(), [2, 3, 8, 9])
        np.testing.assert_allclose(now.points[now.point_sets["left"], 0], 0)
        self.assertEqual(suture.Simulation(scene, mesh=now).fixed.sum(),
                         sim.fixed[sim.vertex_exists].sum())

    def test_both_lips_of_a_cut_are_in_the_set(self):
        sim = suture.Simulation(bar())
        sim.cut(plane=([0.5, 0, 0], [1, 0, 0]))
        mesh = sim.mesh()
        self.assertLessEqual({"x0", "x1", "y0", "z1"}, set(mesh.point_sets))
        floor = mesh.point_sets["z0"]
        self.assertEqual(len(floor), 7 * 3 + 3)
        np.testing.assert_array_equal(np.sort(floor), np.flatnonzero(mesh.points[:, 2] == 0))

    def test_the_surface_after_a_cut(self):
        scene = bar()
        scene["mesh"]["box"]["origin"] = [7, 8, 9]
        sim = suture.Simulation(scene)
        surface = sim.surface()
        self.assertEqual(surface.quads.shape, (2 * (6 * 2 + 6 * 2 + 2 * 2), 4))
        self.assertAlmostEqual(volume_inside(surface.points, surface.quads), 3)
        np.testing.assert_array_equal(surface.points.min(axis=0), [7, 8, 9])
        sim.cut(plane=([8.5, 0, 0], [1, 0, 0]))
        cut = sim.surface()
        self.assertEqual(len(cut.quads), len(surface.quads) + 8)
        self.assertAlmostEqual(volume_inside(cut.points, cut.quads), 3)
        np.testing.assert_array_equal(cut.points, (sim.position + sim.origin)[cut.vertices])

    def test_the_surface_inside_elements(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "octahedron.obj")
            with open(file, "w") as out:
                out.write("v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n"
                          "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\n"
                          "f 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n")
            sim = suture.Simulation({
                "suture": 1, "mesh": {"surface": file, "cells": 1000}, "gravity": [0, 0, -10],
                "models": [{"model": "tm-faure", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}}],
                "solver": {"end": 1}})

        def volume_of(surface):
            return volume_inside(surface.points, surface.triangles[:, [0, 1, 2, 2]])

        surface = sim.surface()
        self.assertIsInstance(surface, suture.EmbeddedSurface)
        heights = np.abs(surface.points).sum(axis=1)  # 1 on the planes of the octahedron
        self.assertLess(heights.max(), 1 + 1e-12)
        self.assertGreater(np.median(heights), 1 - 1e-3)
        self.assertAlmostEqual(volume_of(surface), 4 / 3, delta=0.02)
        np.testing.assert_allclose(surface.weights.sum(axis=1), 1, rtol=1e-14)
        np.testing.assert_allclose(surface.values(sim.position + sim.origin), surface.points)
        self.assertFalse(surface.laid_open.any())
        self.assertLess(surface.elements.max(), len(sim.element_exists))
        sim.cut(plane=([0.02, 0, 0], [1, 0, 0]))
        cut = sim.surface()
        self.assertEqual((~cut.laid_open).sum(), len(surface.triangles))
        self.assertGreater(cut.laid_open.sum(), 20)
        np.testing.assert_array_equal(cut.cut == 0, cut.laid_open)
        self.assertTrue((surface.cut == -1).all())
        self.assertAlmostEqual(volume_of(cut), volume_of(surface))
        sim.step(5)
        np.testing.assert_allclose(sim.surface().points, cut.values(sim.position + sim.origin))


class Shown(unittest.TestCase):
    def test_records(self):
        sim = suture.Simulation(bar())
        tip = int(np.argmax(sim.rest.sum(axis=1)))
        record = sim.record(20, tip=lambda s: s.position[tip])
        sim.run()
        self.assertEqual(len(record), 11)
        self.assertEqual(record["tip"].shape, (11, 3))
        np.testing.assert_allclose(record.time, np.linspace(0, 0.02, 11), atol=1e-12)
        self.assertTrue((np.diff(record["gravity"]) > 0).all())
        with self.assertRaisesRegex(KeyError, "it has time, kinetic"):
            record["nothing"]
        with self.assertRaisesRegex(ValueError, "already has 'kinetic'"):
            sim.record(1, kinetic=lambda s: 0)

    def test_records_of_steps_that_were_rolled_back_are_replaced(self):
        sim = suture.Simulation(bar(dt="auto", end=5, gravity=[0, -0.5, 0]))
        record = sim.record(1, energies=False, fast=lambda s: abs(s.velocity).max())

        @sim.force_term(stiffness=0)  # which is wrong: the step is unstable
        def stiff(x, v, t, f):
            f[:, 1] -= 8e4 * (x - sim.rest)[:, 1]

        sim.run()
        self.assertIn("rolled back", sim.messages[0])
        self.assertTrue((np.diff(record.time) > 0).all())
        self.assertEqual(record.time[-1], sim.time)

    def test_plots(self):
        try:
            import matplotlib
        except ImportError:
            return
        matplotlib.use("Agg")
        sim = suture.Simulation(bar())
        record = sim.record(20, tip=lambda s: s.position[62])
        sim.run()
        self.assertEqual(len(record.plot().lines), 3)
        lines = record.plot("kinetic", "elastic").lines
        self.assertEqual([line.get_label() for line in lines], ["kinetic", "elastic"])
        np.testing.assert_array_equal(lines[0].get_ydata(), record["kinetic"])

    def test_vtk(self):
        try:
            from vtkmodules.util.numpy_support import vtk_to_numpy
        except ImportError:
            with self.assertRaisesRegex(ImportError, "python3-vtk9"):
                suture.Simulation(bar()).to_vtk()
            return
        sim = suture.Simulation(bar())
        sim.step(100)
        sim.cut(plane=([1.5, 0, 0], [1, 0, 0]))
        grid = sim.to_vtk({"mass": sim.mass})
        self.assertEqual((grid.GetNumberOfPoints(), grid.GetNumberOfCells()), (72, 24))
        np.testing.assert_array_equal(vtk_to_numpy(grid.GetPointData().GetArray("mass")), sim.mass)
        self.assertEqual(grid.GetCell(0).GetCellType(), 12)


if __name__ == "__main__":
    unittest.main()
