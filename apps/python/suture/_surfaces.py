# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces as arrays: those of a body, and those that cut it."""

from typing import NamedTuple


class Surface(NamedTuple):
    """The boundary of a body, with the lips of cuts."""

    points: "numpy.ndarray"
    """(n, 3) coordinates in the scene, m."""
    quads: "numpy.ndarray"
    """(k, 4) int64: numbers of points, counterclockwise as seen from outside."""
    vertices: "numpy.ndarray"
    """(n,) int64: the row of every point in the simulation's arrays."""
    elements: "numpy.ndarray"
    """(k,) int64: the row of the element of every quad."""

    def values(self, of_vertices):
        """Those of the points, from an array of one row per vertex."""
        return of_vertices[self.vertices]


class EmbeddedSurface(NamedTuple):
    """The surface of a body made from a surface, which lies inside its elements, with the lips of
    cuts. Each point is a combination of vertices."""

    points: "numpy.ndarray"
    """(n, 3) coordinates in the scene, m."""
    triangles: "numpy.ndarray"
    """(k, 3) int64: numbers of points, counterclockwise as seen from outside."""
    vertices: "numpy.ndarray"
    """(n, 8) int64: rows of vertices in the simulation's arrays."""
    weights: "numpy.ndarray"
    """(n, 8): their weights, 0 for those that are not needed."""
    elements: "numpy.ndarray"
    """(k,) int64: the row of the element in which each triangle lies."""
    laid_open: "numpy.ndarray"
    """(k,) bool: True where a cut or a removal has laid the inside open."""
    cut: "numpy.ndarray"
    """(k,) int64: which cut made the triangle, by its place among the events of the scene; events
    that were applied during the run follow in their order. -1 where none did."""

    def values(self, of_vertices):
        """Those of the points, interpolated from an array of one row per vertex."""
        import numpy

        return numpy.einsum("pn,pn...->p...", self.weights, of_vertices[self.vertices])


def surface_arrays(surface):
    """(vertices, triangles) as checked arrays."""
    import numpy

    vertices, triangles = (numpy.asarray(part) for part in surface)
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise ValueError(f"vertices must have the shape (n, 3); has {vertices.shape}")
    if triangles.ndim != 2 or triangles.shape[1] != 3 or len(triangles) == 0:
        raise ValueError(f"triangles must have the shape (k, 3), k > 0; has {triangles.shape}")
    if not numpy.issubdtype(triangles.dtype, numpy.integer):
        raise TypeError(f"triangles must be integers; their dtype is {triangles.dtype}")
    if triangles.min() < 0 or triangles.max() >= len(vertices):
        raise ValueError(
            f"triangles name vertex {triangles.min() if triangles.min() < 0 else triangles.max()}; "
            f"there are vertices 0 to {len(vertices) - 1}"
        )
    vertices = vertices.astype(float)
    if not numpy.isfinite(vertices).all():
        raise ValueError("vertices must be finite")
    return vertices, triangles.astype(numpy.int64)
