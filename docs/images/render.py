#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws frames of a run, two or (upright) four in a row, as they are deformed, coloured by a field of the elements.

usage: xvfb-run -a /usr/bin/python3 docs/images/render.py [OPTIONS] RUN.pvd PICTURE.png [TIME ...]

Without times: the first frame, two between and the last. The longest axis is horizontal. Pictures
have 256 colours, to be small. Debian packages: python3-vtk9 python3-pil xvfb libgl1-mesa-dri.
"""
import argparse
import os
import xml.etree.ElementTree as ElementTree

import vtk
from PIL import Image

WIDE, TALL = (2, 640, 340), (4, 320, 400)  # frames in a row, pixels of a frame


def frames(pvd):
    """[(time, path)] of a ParaView collection of hexahedra."""
    folder = os.path.dirname(os.path.abspath(pvd))
    sets = ElementTree.parse(pvd).getroot().iter("DataSet")
    return sorted((float(s.get("timestep")), os.path.join(folder, s.get("file"))) for s in sets)


def chosen(all_frames, times):
    if times:
        return [min(all_frames, key=lambda f: abs(f[0] - t)) for t in times]
    last = len(all_frames) - 1
    return [all_frames[round(last * k / 3)] for k in range(4)]


def picked(options):
    """[(label, path)] of the frames to draw."""
    if options.beside:
        runs = [options.run, options.beside]
        return [(os.path.basename(os.path.dirname(os.path.abspath(run))), frames(run)[-1][1]) for run in runs]
    return [(f"t = {time:.3g} s", path) for time, path in chosen(frames(options.run), options.times)]


def read(path):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def scalar_range(grids, field):
    low_high = [g.GetCellData().GetArray(field).GetRange() for g in grids]
    return 0.0, max(high for _, high in low_high)


def surface_actor(grid):
    surface = vtk.vtkDataSetSurfaceFilter()
    surface.SetInputData(grid)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(surface.GetOutputPort())
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    return actor


def obstacles_of(frame):
    """The obstacles that belong to FOLDER/frame_0042.vtu."""
    return read(frame.replace("frame_", "obstacles_"))


def obstacle_actor(grid):
    actor = surface_actor(grid)
    actor.GetMapper().ScalarVisibilityOff()
    actor.GetProperty().SetColor(0.62, 0.62, 0.65)
    return actor


def renderer_of(grid, field, value_range, colours, camera):
    actor = surface_actor(grid)
    mapper = actor.GetMapper()
    mapper.SetScalarModeToUseCellFieldData()
    mapper.SelectColorArray(field)
    mapper.SetScalarRange(*value_range)
    mapper.SetLookupTable(colours)
    # Those of tetrahedra, which fill elements up to a surface, would hide it.
    actor.GetProperty().SetEdgeVisibility(grid.IsHomogeneous())
    actor.GetProperty().SetEdgeColor(0.15, 0.15, 0.2)
    actor.GetProperty().SetAmbient(0.45)
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(actor)
    renderer.SetActiveCamera(camera)
    return renderer


def label(renderer, text, height):
    actor = vtk.vtkTextActor()
    actor.SetInput(text)
    actor.GetTextProperty().SetFontSize(22)
    actor.GetTextProperty().SetColor(0.1, 0.1, 0.1)
    actor.SetPosition(24, height - 40)
    renderer.AddViewProp(actor)


def common_camera(grids, upright):
    """Looks at the box of all frames together, a little from above; upright: along z, with y up."""
    box = vtk.vtkBoundingBox()
    for grid in grids:
        box.AddBounds(grid.GetBounds())
    centre = [0.0, 0.0, 0.0]
    box.GetCenter(centre)
    camera = vtk.vtkCamera()
    camera.SetFocalPoint(*centre)
    longest = 0 if upright else max(range(3), key=box.GetLength)
    side = 1 if longest == 2 else 2  # look across the long axis
    size = [box.GetLength(i) for i in range(3)]
    eye = list(centre)
    upwards = 3 - longest - side
    up = [0.0, 0.0, 0.0]
    up[upwards] = 1.0
    distance = max(size)
    eye[side] += 2.0 * distance
    eye[upwards] += 0.55 * distance
    eye[longest] += 0.45 * distance
    camera.SetPosition(*eye)
    camera.SetViewUp(*up)
    camera.ParallelProjectionOn()
    camera.SetParallelScale(max((0.72 if upright else 0.31) * size[longest], 0.56 * size[upwards] + 0.5 * size[side]))
    return camera


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--field", default="von_mises", help="of the elements; default: von_mises")
    parser.add_argument("--beside", metavar="OTHER.pvd",
                        help="the last frames of two runs, with the names of their folders")
    parser.add_argument("--upright", action="store_true", help="y is up, whatever axis is the longest")
    parser.add_argument("--obstacles", action="store_true", help="draw the obstacles, in grey")
    parser.add_argument("run", help="RUN.pvd")
    parser.add_argument("picture", help="PICTURE.png")
    parser.add_argument("times", nargs="*", type=float)
    options = parser.parse_args()
    field = options.field
    shown = picked(options)
    grids = [read(path) for _, path in shown]
    value_range = scalar_range(grids, field)
    colours = vtk.vtkColorTransferFunction()
    colours.SetColorSpaceToDiverging()
    colours.AddRGBPoint(value_range[0], 0.23, 0.30, 0.75)
    colours.AddRGBPoint(value_range[1], 0.71, 0.02, 0.15)
    obstacles = [obstacles_of(path) for _, path in shown] if options.obstacles else []
    camera = common_camera(grids + obstacles, options.upright)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    columns, width, height = TALL if options.upright else WIDE
    rows = -(-len(grids) // columns)
    window.SetSize(columns * width, rows * height)
    for i, (grid, (text, _)) in enumerate(zip(grids, shown)):
        renderer = renderer_of(grid, field, value_range, colours, camera)
        row, column = divmod(i, columns)
        renderer.SetViewport(column / columns, 1 - (row + 1) / rows, (column + 1) / columns, 1 - row / rows)
        if obstacles:
            renderer.AddActor(obstacle_actor(obstacles[i]))
        label(renderer, text, height)
        window.AddRenderer(renderer)
    window.Render()
    image = vtk.vtkWindowToImageFilter()
    image.SetInput(window)
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(options.picture)
    writer.SetInputConnection(image.GetOutputPort())
    writer.Write()
    Image.open(options.picture).convert("RGB").quantize(256, kmeans=2).save(options.picture, optimize=True)


main()
