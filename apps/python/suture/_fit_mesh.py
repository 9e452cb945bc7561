# SPDX-License-Identifier: GPL-3.0-or-later
"""The elements of a model, their faces and volumes."""

import numpy

# The faces of an element, by its corners in VTK's order; counterclockwise from outside.
FACES = numpy.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6],
                     [3, 0, 4, 7]])


def cells_of(sim, model):
    """(rows, 8): the vertices of the elements of a model, by its number."""
    rows = sim.column_cells(sim._models()[model], 3)
    return sim._hexahedra()[numpy.searchsorted(numpy.flatnonzero(sim.element_exists), rows)]


def _faces_by_count(cells):
    """The numbers (6 element + face) of all faces, equal ones in a row; how often each occurs."""
    flat = numpy.sort(cells[:, FACES].reshape(-1, 4), axis=1)
    _, where, count = numpy.unique(flat, axis=0, return_inverse=True, return_counts=True)
    by_face = numpy.argsort(where, kind="stable")
    return by_face, count[where[by_face]]


def shared_faces(cells):
    """(n, 2): the numbers 6 element + face of both sides of the faces inside."""
    faces, count = _faces_by_count(cells)
    return faces[count == 2].reshape(-1, 2)


def outer_faces(cells):
    """The numbers 6 element + face of the faces outside."""
    faces, count = _faces_by_count(cells)
    return faces[count == 1]


def volumes_of(corners):
    """Of elements (n, 8, 3), from the pyramids between their centroids and faces."""
    quads = corners[:, FACES] - corners.mean(axis=1)[:, None, None]
    normals = numpy.cross(quads[:, :, 2] - quads[:, :, 0], quads[:, :, 3] - quads[:, :, 1]) / 2
    return abs(numpy.einsum("efc,efc->e", quads.mean(axis=2), normals)) / 3


class Field:
    """Where the elements of a fitted field are: points (n, 3) in the scene, hexahedra (rows, 8),
    and their numbers in the mesh, ids (rows,)."""

    def __init__(self, sim, model):
        cells = cells_of(sim, model)
        used, hexahedra = numpy.unique(cells, return_inverse=True)
        self.points = (sim.rest + sim.origin)[used]
        self.hexahedra = hexahedra.reshape(cells.shape)
        self.ids = sim.element_ids[sim.column_cells(sim._models()[model], 3)]

    def as_dict(self):
        return {"points": self.points, "hexahedra": self.hexahedra, "ids": self.ids}
