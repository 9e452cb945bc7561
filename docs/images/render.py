#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws frames of a run, two in a row, as they are deformed, coloured by a field of the elements.

usage: xvfb-run -a docs/images/render.py [--field NAME] [--beside OTHER.pvd] RUN.pvd PICTURE.png [TIME ...]

Without a field: von_mises. Without times: the first frame, two between and the last. With --beside:
the last frames of the two runs, with the names of their folders. Debian packages: python3-vtk9 xvfb libgl1-mesa-dri.
"""
import argparse
import os
import xml.etree.ElementTree as ElementTree

import vtk

WIDTH, HEIGHT = 640, 340  # of one frame, pixels


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


def renderer_of(grid, field, value_range, colours, camera):
    surface = vtk.vtkDataSetSurfaceFilter()
    surface.SetInputData(grid)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(surface.GetOutputPort())
    mapper.SetScalarModeToUseCellFieldData()
    mapper.SelectColorArray(field)
    mapper.SetScalarRange(*value_range)
    mapper.SetLookupTable(colours)
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().EdgeVisibilityOn()
    actor.GetProperty().SetEdgeColor(0.15, 0.15, 0.2)
    actor.GetProperty().SetAmbient(0.45)
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(actor)
    renderer.SetActiveCamera(camera)
    return renderer


def label(renderer, text):
    actor = vtk.vtkTextActor()
    actor.SetInput(text)
    actor.GetTextProperty().SetFontSize(22)
    actor.GetTextProperty().SetColor(0.1, 0.1, 0.1)
    actor.SetPosition(24, HEIGHT - 40)
    renderer.AddViewProp(actor)


def common_camera(grids):
    """Looks at the box of all frames together, a little from above."""
    box = vtk.vtkBoundingBox()
    for grid in grids:
        box.AddBounds(grid.GetBounds())
    centre = [0.0, 0.0, 0.0]
    box.GetCenter(centre)
    camera = vtk.vtkCamera()
    camera.SetFocalPoint(*centre)
    longest = max(range(3), key=box.GetLength)
    side = 1 if longest == 2 else 2  # look across the long axis
    size = [box.GetLength(i) for i in range(3)]
    eye = list(centre)
    upwards = 3 - longest - side
    up = [0.0, 0.0, 0.0]
    up[upwards] = 1.0
    eye[side] += 2.0 * size[longest]
    eye[upwards] += 0.55 * size[longest]
    eye[longest] += 0.45 * size[longest]
    camera.SetPosition(*eye)
    camera.SetViewUp(*up)
    camera.ParallelProjectionOn()
    camera.SetParallelScale(max(0.31 * size[longest], 0.56 * size[upwards]))
    return camera


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--field", default="von_mises")
    parser.add_argument("--beside", help="OTHER.pvd")
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
    camera = common_camera(grids)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    rows = (len(grids) + 1) // 2
    window.SetSize(2 * WIDTH, HEIGHT * rows)
    for i, (grid, (text, _)) in enumerate(zip(grids, shown)):
        renderer = renderer_of(grid, field, value_range, colours, camera)
        row, left = i // 2, 0.5 * (i % 2)
        renderer.SetViewport(left, 1 - (row + 1) / rows, left + 0.5, 1 - row / rows)
        label(renderer, text)
        window.AddRenderer(renderer)
    window.Render()
    image = vtk.vtkWindowToImageFilter()
    image.SetInput(window)
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(options.picture)
    writer.SetInputConnection(image.GetOutputPort())
    writer.Write()


main()
