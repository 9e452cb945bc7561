# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes and surfaces as arrays, in and out."""

import numpy


def _array(values, name, columns, integer=False):
    array = numpy.asarray(values)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(f"{name} must have the shape (n, {columns}); has {array.shape}")
    if integer and not numpy.issubdtype(array.dtype, numpy.integer):
        raise TypeError(f"{name} must be integers; their dtype is {array.dtype}")
    if not integer and array.dtype.kind not in "fiu":
        raise TypeError(f"{name} must be real numbers; their dtype is {array.dtype}")
    return array.astype(numpy.int64 if integer else float)


def _require_range(numbers, count, name, what):
    wrong = numbers[(numbers < 0) | (numbers >= count)]
    if wrong.size:
        raise ValueError(f"{name} names {what} {wrong.flat[0]}; there are {what}s 0 to {count - 1}")


def _sets(sets, count, name, what):
    checked = {}
    for key, cells in (sets or {}).items():
        cells = numpy.asarray(cells)
        if cells.dtype == bool:
            cells = numpy.flatnonzero(cells)
        if cells.ndim != 1 or not (numpy.issubdtype(cells.dtype, numpy.integer) or not cells.size):
            raise ValueError(f"{name}[{key!r}] must be a list of {what} numbers or a mask")
        _require_range(cells, count, f"{name}[{key!r}]", what)
        checked[str(key)] = cells.astype(numpy.int64)
    return checked


def _arrays(arrays, count, name):
    checked = {}
    for key, values in (arrays or {}).items():
        values = numpy.asarray(values, float)
        if values.ndim not in (1, 2) or len(values) != count:
            raise ValueError(f"{name}[{key!r}] must have {count} rows; has the shape {values.shape}")
        checked[str(key)] = values
    return checked


class Mesh:
    """Points and hexahedra.

    points          (n, 3) coordinates in the scene, m
    hexahedra       (k, 8) numbers of points, in VTK's order: around the lower face, then around
                    the upper one
    point_sets      {name: numbers or mask} for "where": {"set": name} in constraints and loads
    element_sets    the same for regions
    point_arrays    {name: values} of (n,) or (n, components): for values of a model's parameters
    element_arrays  the same by element
    """

    def __init__(self, points, hexahedra, point_sets=None, element_sets=None, point_arrays=None,
                 element_arrays=None):
        self.points = _array(points, "points", 3)
        self.hexahedra = _array(hexahedra, "hexahedra", 8, integer=True)
        _require_range(self.hexahedra, len(self.points), "hexahedra", "point")
        self.point_sets = _sets(point_sets, len(self.points), "point_sets", "point")
        self.element_sets = _sets(element_sets, len(self.hexahedra), "element_sets", "element")
        self.point_arrays = _arrays(point_arrays, len(self.points), "point_arrays")
        self.element_arrays = _arrays(element_arrays, len(self.hexahedra), "element_arrays")

    @classmethod
    def from_meshio(cls, mesh):
        """The hexahedra of a meshio.Mesh, with its sets and data."""
        blocks = [i for i, block in enumerate(mesh.cells) if block.type == "hexahedron"]
        if not blocks:
            found = ", ".join(sorted({block.type for block in mesh.cells})) or "no cells"
            raise ValueError(f"the mesh has no hexahedra; it has {found}")

        def joined(parts):
            return numpy.concatenate([numpy.asarray(parts[i]) for i in blocks])

        starts = numpy.cumsum([0] + [len(mesh.cells[i].data) for i in blocks])
        element_sets = {
            name: numpy.concatenate([
                numpy.asarray([] if parts[i] is None else parts[i], dtype=int) + start
                for i, start in zip(blocks, starts)
            ])
            for name, parts in getattr(mesh, "cell_sets", {}).items()
        }
        return cls(
            mesh.points,
            joined([block.data for block in mesh.cells]),
            point_sets=dict(getattr(mesh, "point_sets", {})),
            element_sets=element_sets,
            point_arrays=dict(mesh.point_data),
            element_arrays={name: joined(parts) for name, parts in mesh.cell_data.items()},
        )

    def __repr__(self):
        return f"<suture.Mesh: {len(self.points)} points, {len(self.hexahedra)} hexahedra>"


def without_unused(points, cells):
    """Drops the points that no cell has; returns points, renumbered cells, and the rows kept."""
    used = numpy.unique(cells)
    number = numpy.full(len(points), -1)
    number[used] = numpy.arange(len(used))
    return points[used], number[cells], used
