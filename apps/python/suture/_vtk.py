# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK objects and pictures, where python3-vtk9 is installed."""

import numpy


def require():
    try:
        from vtkmodules.util import numpy_support
        from vtkmodules import vtkCommonCore, vtkCommonDataModel
    except ImportError as error:
        raise ImportError("VTK's Python module is missing; install python3-vtk9") from error
    return vtkCommonCore, vtkCommonDataModel, numpy_support


def _points(core, support, points):
    result = core.vtkPoints()
    # VTK keeps a reference to the array: nothing is copied.
    result.SetData(support.numpy_to_vtk(numpy.ascontiguousarray(points)))
    return result


def _cells(core, data, support, rows):
    cells = data.vtkCellArray()
    size = rows.shape[1]
    offsets = numpy.arange(0, rows.size + 1, size, dtype=numpy.int64)
    connectivity = numpy.ascontiguousarray(rows, dtype=numpy.int64).ravel()
    # Deep copies: a vtkCellArray takes the memory over without the reference to its owner.
    cells.SetData(*(support.numpy_to_vtkIdTypeArray(part, deep=1)
                    for part in (offsets, connectivity)))
    return cells


def _add(support, attributes, fields):
    for name, values in fields.items():
        array = support.numpy_to_vtk(numpy.ascontiguousarray(values))
        array.SetName(name)
        attributes.AddArray(array)


def unstructured_grid(points, hexahedra, point_fields, cell_fields):
    core, data, support = require()
    grid = data.vtkUnstructuredGrid()
    grid.SetPoints(_points(core, support, points))
    grid.SetCells(data.VTK_HEXAHEDRON, _cells(core, data, support, hexahedra))
    _add(support, grid.GetPointData(), point_fields)
    _add(support, grid.GetCellData(), cell_fields)
    return grid


def poly_data(points, polygons, point_fields):
    core, data, support = require()
    surface = data.vtkPolyData()
    surface.SetPoints(_points(core, support, points))
    surface.SetPolys(_cells(core, data, support, polygons))
    _add(support, surface.GetPointData(), point_fields)
    return surface


def _require_display():
    """Without an X display, VTK would end the process."""
    import ctypes

    try:
        x11 = ctypes.CDLL("libX11.so.6")
    except OSError as error:
        raise OSError("VTK draws with X11, and libX11.so.6 is missing") from error
    x11.XOpenDisplay.restype = ctypes.c_void_p
    display = x11.XOpenDisplay(None)
    if not display:
        raise OSError("VTK draws off screen, but needs an X display: run the program under "
                      "xvfb-run -a (Debian packages xvfb and libgl1-mesa-dri)")
    x11.XCloseDisplay(ctypes.c_void_p(display))


def picture(surface, file, size, field, edges, direction):
    """Renders a vtkPolyData off screen into a PNG file."""
    _require_display()
    import vtkmodules.vtkInteractionStyle  # noqa: F401: the renderer needs the factories
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
    from vtkmodules.vtkIOImage import vtkPNGWriter
    from vtkmodules.vtkRenderingCore import (
        vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkWindowToImageFilter)

    mapper = vtkPolyDataMapper()
    mapper.SetInputData(surface)
    if field is not None:
        low, high = surface.GetPointData().GetArray(field).GetRange(-1)
        surface.GetPointData().SetActiveScalars(field)
        mapper.SetScalarRange(low, high)
        table = mapper.GetLookupTable()
        table.SetHueRange(0.66, 0.0)
        table.SetVectorModeToMagnitude()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetEdgeVisibility(edges)
    if field is None:
        actor.GetProperty().SetColor(0.85, 0.55, 0.5)
    renderer = vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(actor)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(*size)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(0, 0, 0)
    camera.SetPosition(*direction)
    camera.SetViewUp(0, 1, 0)
    renderer.ResetCamera()
    window.Render()
    image = vtkWindowToImageFilter()
    image.SetInput(window)
    writer = vtkPNGWriter()
    writer.SetFileName(str(file))
    writer.SetInputConnection(image.GetOutputPort())
    writer.Write()
    if writer.GetErrorCode() != 0:
        raise OSError(f"cannot write the picture {file}")
