# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK objects, where python3-vtk9 is installed."""

import contextlib

import numpy


def _require():
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
    core, data, support = _require()
    grid = data.vtkUnstructuredGrid()
    grid.SetPoints(_points(core, support, points))
    grid.SetCells(data.VTK_HEXAHEDRON, _cells(core, data, support, hexahedra))
    _add(support, grid.GetPointData(), point_fields)
    _add(support, grid.GetCellData(), cell_fields)
    return grid


@contextlib.contextmanager
def _silence():
    """VTK's own reports of damaged files, which go to standard error."""
    from vtkmodules.vtkCommonCore import vtkLogger

    before = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(before)


def _read(file):
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader = vtkXMLUnstructuredGridReader()
    if not reader.CanReadFile(str(file)):
        raise OSError(f"{file}: is missing, or is not a frame of a run (.vtu)")
    reader.SetFileName(str(file))
    errors = []
    reader.AddObserver("ErrorEvent", lambda *_: errors.append(True))
    with _silence():
        reader.Update()
    grid = reader.GetOutput()
    if errors or reader.GetErrorCode() != 0 or not _is_whole(grid):
        raise OSError(f"{file}: is truncated or damaged; run the scene again")
    return grid


def _is_whole(grid):
    """Every array has its values, and every cell its points."""
    if grid.GetPoints() is None or grid.GetNumberOfCells() == 0:
        return False
    connectivity = grid.GetCells().GetConnectivityArray()
    if connectivity.GetNumberOfTuples() != 8 * grid.GetNumberOfCells():
        return False
    low, high = connectivity.GetRange()
    return 0 <= low and high < grid.GetNumberOfPoints() and all(
        data.GetArray(i) is not None and data.GetArray(i).GetNumberOfTuples() == count
        for data, count in ((grid.GetPointData(), grid.GetNumberOfPoints()),
                            (grid.GetCellData(), grid.GetNumberOfCells()))
        for i in range(data.GetNumberOfArrays()))


def _arrays(support, data):
    return {data.GetArrayName(i): support.vtk_to_numpy(data.GetArray(i))
            for i in range(data.GetNumberOfArrays())}


def read_quads(file):
    """{"corners", "fields"} of the surface of a frame: 4 points per face, and values per face."""
    *_, support = _require()
    from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter

    surface = vtkDataSetSurfaceFilter()
    surface.SetInputData(_read(file))
    surface.Update()
    data = surface.GetOutput()
    quads = support.vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 4)
    fields = {name: values[quads].mean(axis=1)
              for name, values in _arrays(support, data.GetPointData()).items()}
    fields.update(_arrays(support, data.GetCellData()))
    return {"corners": support.vtk_to_numpy(data.GetPoints().GetData())[quads], "fields": fields}


def read_grid(file):
    """{"points", "cells", "fields"} of a frame: numpy arrays, fields by name."""
    *_, support = _require()
    grid = _read(file)
    fields = {**_arrays(support, grid.GetPointData()), **_arrays(support, grid.GetCellData())}
    cells = support.vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 8)
    points = support.vtk_to_numpy(grid.GetPoints().GetData())
    return {"points": points, "cells": cells, "fields": fields}
