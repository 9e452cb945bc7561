# SPDX-License-Identifier: GPL-3.0-or-later
"""What is measured of an equilibrium, as numbers with their derivatives by displacements and
reactions."""

from typing import NamedTuple

import numpy

try:
    from scipy import sparse
    from scipy.spatial import cKDTree
except ImportError as error:
    raise ImportError("a fit needs SciPy; install python3-scipy") from error

COMPONENTS = ("x", "y", "z")
CANDIDATES = 12  # nearest elements or triangles that are searched
# The corners of an element in VTK's order, between -1 and 1.
CORNERS = numpy.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1],
                       [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], float)


class Reading(NamedTuple):
    """Values (k,), and matrices (k, 3 vertices) that give their changes."""

    values: numpy.ndarray
    by_displacement: sparse.csr_matrix
    by_reaction: "sparse.csr_matrix | None" = None

    def along(self, displacement, reaction):
        """The derivative where displacements and reactions have these."""
        change = self.by_displacement @ displacement.ravel()
        return change if self.by_reaction is None else change + self.by_reaction @ reaction.ravel()


def _displacement(sim):
    return (sim.position - sim.rest).ravel()


class Probed:
    """Columns of probes: [(probe, field, component)], with fields displacement and reaction."""

    def __init__(self, columns):
        self._columns = columns

    def read(self, sim):
        shape = len(self._columns), sim.rest.size
        matrices = {field: sparse.lil_matrix(shape) for field in ("displacement", "reaction")}
        for row, (probe, field, component) in enumerate(self._columns):
            vertices, of = sim._probe_vertices(probe, field)
            if len(vertices):
                matrices[field][row, 3 * vertices + component] = (
                    1 / len(vertices) if of == "mean" else 1)
        by_displacement, by_reaction = (matrices[field].tocsr() for field in matrices)
        has_reactions = by_reaction.nnz > 0
        values = by_displacement @ _displacement(sim)
        if has_reactions:
            values = values + by_reaction @ sim.reactions.ravel()
        return Reading(values, by_displacement, by_reaction if has_reactions else None)


class Markers:
    """Displacements of material points, given at rest in the scene's coordinates.

    components  of the displacement that are measured, [0, 1, 2] for all
    """

    def __init__(self, points, components, place):
        self._points = points
        self._components = components
        self._place = place  # of a row in the file, for messages
        self._elements = None

    def _find(self, sim):
        """The element in which each point lies at rest, and the weights of its corners."""
        rows = numpy.flatnonzero(sim.element_exists)
        corners = (sim.rest + sim.origin)[sim._hexahedra()]
        near = cKDTree(corners.mean(axis=1)).query(
            self._points, min(CANDIDATES, len(corners)))[1].reshape(len(self._points), -1)
        found = numpy.zeros(len(near), int)
        weights = numpy.zeros((len(near), 8))
        distance = numpy.full(len(near), numpy.inf)
        for candidate in near.T:
            these, far = _inside(corners[candidate], self._points)
            better = far < distance
            distance[better], weights[better] = far[better], these[better]
            found[better] = candidate[better]
        allowed = 0.25 * numpy.ptp(corners, axis=1).max(axis=1)[found]
        outside = numpy.flatnonzero(distance > allowed)
        if len(outside):
            row = outside[0]
            raise ValueError(
                f"{self._place(row)}: the point {self._points[row].round(6).tolist()} lies "
                f"{distance[row]:.3g} m outside of the body at rest; give points of the undeformed "
                "body in the coordinates of the scene, with their units")
        self._elements, self._weights = rows[found], weights

    def read(self, sim):
        if self._elements is None:
            self._find(sim)
        order = numpy.searchsorted(numpy.flatnonzero(sim.element_exists), self._elements)
        vertices = sim._hexahedra()[order]
        rows, columns, values = [], [], []
        for i, component in enumerate(self._components):
            row = numpy.arange(len(vertices)) * len(self._components) + i
            rows.append(numpy.repeat(row, 8))
            columns.append((3 * vertices + component).ravel())
            values.append(self._weights.ravel())
        matrix = sparse.csr_matrix(
            (numpy.concatenate(values), (numpy.concatenate(rows), numpy.concatenate(columns))),
            (len(vertices) * len(self._components), sim.rest.size))
        return Reading(matrix @ _displacement(sim), matrix)


def _inside(corners, points):
    """Weights (n, 8) of the corners (n, 8, 3) at the points (n, 3), or at the nearest place of the
    element by its local coordinates; and the distances from there."""
    local = numpy.zeros_like(points)
    for _ in range(8):  # Newton's method; exact at once in a box
        factors = 1 + CORNERS * local[:, None]
        weights = factors.prod(axis=2) / 8
        slopes = numpy.stack([CORNERS[:, c] * numpy.delete(factors, c, 2).prod(axis=2) / 8
                              for c in range(3)], axis=-1)
        miss = points - numpy.einsum("nk,nkc->nc", weights, corners)
        jacobian = numpy.einsum("nkc,nkd->ncd", corners, slopes)
        local = numpy.clip(local + numpy.linalg.solve(jacobian, miss[..., None])[..., 0], -1, 1)
    weights = (1 + CORNERS * local[:, None]).prod(axis=2) / 8
    return weights, numpy.linalg.norm(
        points - numpy.einsum("nk,nkc->nc", weights, corners), axis=1)


class Scan:
    """Signed distances of a measured surface from the body, positive where the body lies outside of
    the points: which material point a measured one shows is not known."""

    def __init__(self, points):
        self._points = points

    def read(self, sim):
        points, triangles, vertices, shares = _triangles(sim)
        corners = points[triangles]
        near = cKDTree(corners.mean(axis=1)).query(
            self._points, min(CANDIDATES, len(corners)))[1].reshape(len(self._points), -1)
        best = numpy.full(len(near), numpy.inf)
        weights, chosen = numpy.zeros((len(near), 3)), numpy.zeros(len(near), int)
        for candidate in near.T:
            these = _nearest_in_triangle(corners[candidate], self._points)
            far = numpy.linalg.norm(
                numpy.einsum("nk,nkc->nc", these, corners[candidate]) - self._points, axis=1)
            better = far < best
            best[better], weights[better], chosen[better] = (
                far[better], these[better], candidate[better])
        corners = corners[chosen]
        normals = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= numpy.linalg.norm(normals, axis=1, keepdims=True)
        miss = numpy.einsum("nk,nkc->nc", weights, corners) - self._points
        # The nearest place moves along the surface, which does not change the distance.
        of_points = sparse.csr_matrix(
            (weights.ravel(), (numpy.repeat(numpy.arange(len(near)), 3),
                               triangles[chosen].ravel())), (len(near), len(points)))
        of_vertices = (of_points @ sparse.csr_matrix(
            (shares.ravel(), (numpy.repeat(numpy.arange(len(points)), shares.shape[1]),
                              vertices.ravel())), (len(points), len(sim.rest)))).tocoo()
        matrix = sparse.csr_matrix(
            ((of_vertices.data[:, None] * normals[of_vertices.row]).ravel(),
             (numpy.repeat(of_vertices.row, 3),
              (3 * of_vertices.col[:, None] + numpy.arange(3)).ravel())),
            (len(near), sim.rest.size))
        return Reading(numpy.einsum("nc,nc->n", miss, normals), matrix)


def _triangles(sim):
    """The surface as points, triangles, and each point as a combination of vertices."""
    surface = sim.surface()
    if hasattr(surface, "triangles"):
        return surface.points, surface.triangles, surface.vertices, surface.weights
    quads, count = surface.quads, len(surface.points)
    centres = count + numpy.arange(len(quads))
    triangles = numpy.concatenate([numpy.column_stack([quads[:, i], quads[:, (i + 1) % 4], centres])
                                   for i in range(4)])
    points = numpy.concatenate([surface.points, surface.points[quads].mean(axis=1)])
    vertices = numpy.concatenate([numpy.repeat(surface.vertices[:, None], 4, axis=1),
                                  surface.vertices[quads]])
    shares = numpy.full((len(points), 4), 0.25)
    return points, triangles, vertices, shares


def _dot(a, b):
    return numpy.einsum("nc,nc->n", a, b)


def _nearest_in_triangle(corners, points):
    """Weights (n, 3) of the place in each triangle that is nearest to its point."""
    along, across = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    to = points - corners[:, 0]
    aa, ab, bb, ta, tb = (_dot(along, along), _dot(along, across), _dot(across, across),
                          _dot(to, along), _dot(to, across))
    with numpy.errstate(divide="ignore", invalid="ignore"):
        scale = aa * bb - ab * ab
        v, w = (bb * ta - ab * tb) / scale, (aa * tb - ab * ta) / scale
        inside = numpy.stack([1 - v - w, v, w], axis=1)
        edges = []
        for i, j in ((0, 1), (1, 2), (2, 0)):
            edge = corners[:, j] - corners[:, i]
            t = numpy.clip(_dot(points - corners[:, i], edge) / _dot(edge, edge), 0, 1)
            weights = numpy.zeros((len(points), 3))
            weights[:, i], weights[:, j] = 1 - t, t
            edges.append(weights)
    far = numpy.stack([numpy.linalg.norm(numpy.einsum("nk,nkc->nc", e, corners) - points, axis=1)
                       for e in edges])
    on_edge = numpy.stack(edges)[far.argmin(axis=0), numpy.arange(len(points))]
    return numpy.where((inside >= 0).all(axis=1)[:, None], inside, on_edge)
