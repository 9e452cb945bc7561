# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the frames of a run, and their fields at other places, with python3-vtk9."""

import contextlib
from pathlib import Path
from xml.etree import ElementTree

import numpy

from ._vtk import grid_of, require


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


POINT_IN_FRAME = "point_in_frame"  # a field of pieces: the numbers of their points in the frame


def _read(file):
    """The grid of a .vtu, or of the pieces of a .pvtu, which become the frame that one process
    writes."""
    return _read_pieces(file) if str(file).endswith(".pvtu") else _read_file(file)


def _read_pieces(file):
    *_, support = require()
    try:
        sources = [piece.get("Source", "") for piece in ElementTree.parse(file).iter("Piece")]
    except ElementTree.ParseError as error:
        raise OSError(f"{file}: is damaged ({error}); run the scene again") from error
    pieces = [_read_file(Path(file).parent / source) for source in sources]
    if not pieces or any(p.GetPointData().GetArray(POINT_IN_FRAME) is None for p in pieces):
        raise OSError(f"{file}: names no pieces with the field '{POINT_IN_FRAME}', as runs write "
                      "them; run the scene again")
    points = [_arrays(support, piece.GetPointData()) for piece in pieces]
    cells = [_arrays(support, piece.GetCellData()) for piece in pieces]
    places = numpy.concatenate([support.vtk_to_numpy(piece.GetPoints().GetData())
                                for piece in pieces])
    numbers = [fields.pop(POINT_IN_FRAME) for fields in points]
    joined, first, again = numpy.unique(numpy.concatenate(numbers), return_index=True,
                                        return_inverse=True)
    if (any(_kinds(fields) != _kinds(of[0]) for of in (points, cells) for fields in of) or
            not numpy.array_equal(joined, numpy.arange(joined.size)) or
            not numpy.array_equal(places[first][again], places, equal_nan=True)):
        raise OSError(f"{file}: its pieces are not those of one frame; run the scene again")

    def joined_fields(fields):
        return {name: numpy.concatenate([of[name] for of in fields]) for name in fields[0]}

    def joined_cells(array):
        return numpy.concatenate([support.vtk_to_numpy(array(piece)) for piece in pieces])

    ends = joined_cells(lambda piece: piece.GetCells().GetOffsetsArray())
    sizes = numpy.diff(ends)
    corners = numpy.concatenate(
        [of_frame[support.vtk_to_numpy(piece.GetCells().GetConnectivityArray())]
         for of_frame, piece in zip(numbers, pieces)])
    return grid_of(
        places[first], corners, sizes[sizes > 0],
        joined_cells(lambda piece: piece.GetCellTypesArray()),
        {name: array[first] for name, array in joined_fields(points).items()},
        joined_fields(cells))


def _kinds(fields):
    return {name: (array.dtype, array.shape[1:]) for name, array in fields.items()}


def _read_file(file):
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader = vtkXMLUnstructuredGridReader()
    if not reader.CanReadFile(str(file)):
        raise OSError(f"{file}: is missing, or is not a frame of a run (.vtu, .pvtu)")
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
    count = grid.GetNumberOfCells()
    if grid.GetPoints() is None or count == 0:
        return False
    connectivity, ends = grid.GetCells().GetConnectivityArray(), grid.GetCells().GetOffsetsArray()
    if (ends.GetNumberOfTuples() != count + 1 or
            ends.GetComponent(count, 0) != connectivity.GetNumberOfTuples()):
        return False
    low, high = connectivity.GetRange()
    return 0 <= low and high < grid.GetNumberOfPoints() and all(
        data.GetArray(i) is not None and data.GetArray(i).GetNumberOfTuples() == tuples
        for data, tuples in ((grid.GetPointData(), grid.GetNumberOfPoints()),
                             (grid.GetCellData(), count))
        for i in range(data.GetNumberOfArrays()))


def _arrays(support, data):
    return {data.GetArrayName(i): support.vtk_to_numpy(data.GetArray(i))
            for i in range(data.GetNumberOfArrays())}


def _corner_numbers(support, polygons):
    """(k, 4) numbers of points; a triangle has its last corner twice."""
    connectivity = support.vtk_to_numpy(polygons.GetConnectivityArray())
    ends = support.vtk_to_numpy(polygons.GetOffsetsArray())
    last = numpy.diff(ends)[:, None] - 1
    return connectivity[ends[:-1, None] + numpy.minimum(numpy.arange(4), last)]


def read_faces(file):
    """{"corners", "fields"} of the surface of a frame: 4 points per face, and values per face. A
    triangle has its last corner twice."""
    *_, support = require()
    from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter

    surface = vtkDataSetSurfaceFilter()
    surface.SetInputData(_read(file))
    surface.Update()
    data = surface.GetOutput()
    corners = _corner_numbers(support, data.GetPolys())
    fields = {name: values[corners].mean(axis=1)
              for name, values in _arrays(support, data.GetPointData()).items()}
    fields.update(_arrays(support, data.GetCellData()))
    return {"corners": support.vtk_to_numpy(data.GetPoints().GetData())[corners],
            "fields": fields}


def read_boundary(file):
    """(points, corners, fields) of a file with triangles and quadrilaterals: 4 numbers of points
    per face, and {name: values} of the points."""
    *_, support = require()
    grid = _read(file)
    return (support.vtk_to_numpy(grid.GetPoints().GetData()),
            _corner_numbers(support, grid.GetCells()), _arrays(support, grid.GetPointData()))


class Frame:
    """A frame: points, cells and fields as numpy arrays.

    points        (n, 3) where the deformation has moved them, m
    cells         numbers of points of all cells, one after the other
    cell_count    number of cells
    point_fields  {name: values}, as cell_fields
    """

    def __init__(self, file):
        *_, self._support = require()
        self.file = file
        self._grid = grid = _read(file)
        numbers = self._support.vtk_to_numpy
        self.points = numbers(grid.GetPoints().GetData())
        self.cells = numbers(grid.GetCells().GetConnectivityArray())
        self.cell_count = grid.GetNumberOfCells()
        self.point_fields = _arrays(self._support, grid.GetPointData())
        self.cell_fields = _arrays(self._support, grid.GetCellData())

    @property
    def fields(self):
        return {**self.point_fields, **self.cell_fields}

    def rest(self):
        """(n, 3) the points before the deformation."""
        if "displacement" not in self.point_fields:
            raise ValueError(f"{self.file}: has no field 'displacement', by which points of "
                             "different meshes are matched; add it to /output/fields")
        return self.points - self.point_fields["displacement"]

    def centres(self):
        """(cells, 3) the centroids of the corners of all cells, before the deformation."""
        ends = self._support.vtk_to_numpy(self._grid.GetCells().GetOffsetsArray())
        return (numpy.add.reduceat(self.rest()[self.cells], ends[:-1], axis=0) /
                numpy.diff(ends)[:, None])

    def probe(self, places):
        """({name: values}, mask): the fields at places (n, 3) in the body at rest, and which of the
        places lie in it. Fields of points are interpolated, those of cells are constant in each."""
        from vtkmodules.vtkFiltersCore import vtkProbeFilter
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkUnstructuredGrid

        def points_of(values):
            points = vtkPoints()
            points.SetDataTypeToDouble()
            points.SetData(self._support.numpy_to_vtk(numpy.ascontiguousarray(values, float),
                                                      deep=1))
            return points

        source, wanted = vtkUnstructuredGrid(), vtkPolyData()
        source.ShallowCopy(self._grid)
        source.SetPoints(points_of(self.rest()))
        wanted.SetPoints(points_of(places))
        probe = vtkProbeFilter()
        probe.SetSourceData(source)
        probe.SetInputData(wanted)
        probe.Update()
        data = probe.GetOutput().GetPointData()
        values = _arrays(self._support, data)
        return values, values.pop(probe.GetValidPointMaskArrayName()) != 0
