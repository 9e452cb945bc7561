# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK objects, where python3-vtk9 is installed."""

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
    return _cell_array(data, support, numpy.arange(0, rows.size + 1, rows.shape[1]), rows.ravel())


def _cell_array(data, support, offsets, corners):
    cells = data.vtkCellArray()
    # Deep copies: a vtkCellArray takes the memory over without the reference to its owner.
    cells.SetData(*(support.numpy_to_vtkIdTypeArray(
        numpy.ascontiguousarray(part, dtype=numpy.int64), deep=1) for part in (offsets, corners)))
    return cells


def _add(support, attributes, fields):
    for name, values in fields.items():
        array = support.numpy_to_vtk(numpy.ascontiguousarray(values))
        array.SetName(name)
        attributes.AddArray(array)


def unstructured_grid(points, hexahedra, point_fields, cell_fields):
    core, data, support = require()
    return _grid(points, _cells(core, data, support, hexahedra),
                 numpy.full(len(hexahedra), data.VTK_HEXAHEDRON), point_fields, cell_fields)


def grid_of(points, corners, sizes, types, point_fields, cell_fields):
    """A grid of any cells: `corners` has the points of all, one cell after the other, `sizes` how
    many each has, and `types` VTK's numbers of their kinds."""
    _, data, support = require()
    offsets = numpy.concatenate(([0], numpy.cumsum(sizes)))
    return _grid(points, _cell_array(data, support, offsets, corners), types, point_fields,
                 cell_fields)


def _grid(points, cells, types, point_fields, cell_fields):
    core, data, support = require()
    grid = data.vtkUnstructuredGrid()
    grid.SetPoints(_points(core, support, points))
    grid.SetCells(support.numpy_to_vtk(types.astype(numpy.uint8), deep=1), cells)
    _add(support, grid.GetPointData(), point_fields)
    _add(support, grid.GetCellData(), cell_fields)
    return grid


def write_grid(file, points, hexahedra, cell_fields):
    """Writes a .vtu file, which ParaView opens and a scene takes as its mesh."""
    grid = unstructured_grid(points, hexahedra, {}, cell_fields)
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(file))
    writer.SetInputData(grid)
    if not writer.Write():
        raise OSError(f"{file}: cannot be written")
