# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces drawn by matplotlib, from the back to the front, which needs no display."""

import base64
import io

import numpy

LIGHT = numpy.array([0.4, 0.8, 0.6])  # right, up, towards the eye


class Picture:
    """A picture in PNG format; notebooks show it."""

    def __init__(self, png):
        self.png = png

    def save(self, file):
        """Write it to a file."""
        with open(file, "wb") as out:
            out.write(self.png)

    def _repr_png_(self):
        return self.png

    def _repr_html_(self):
        return f'<img src="data:image/png;base64,{base64.b64encode(self.png).decode()}">'

    def __repr__(self):
        return f"<suture.Picture: {len(self.png)} bytes>"


def axes_of_view(direction):
    """Right, up and towards the eye, for an eye in `direction`; y is up, or z if one looks along
    y."""
    towards = numpy.asarray(direction, float)
    if towards.shape != (3,) or not 0 < numpy.linalg.norm(towards) < numpy.inf:
        raise ValueError(f"direction must be three numbers that are not all 0, is {direction!r}")
    towards = towards / numpy.linalg.norm(towards)
    right = numpy.cross([0, 1, 0] if abs(towards[1]) < 0.999 else [0, 0, -1], towards)
    right /= numpy.linalg.norm(right)
    return right, numpy.cross(towards, right), towards


def add_faces(axes, corners, direction, edges=True, **colours):
    """Draws faces of (k, n, 3) corners, counterclockwise from outside; those that look away are
    left out. colours["array"] or ["facecolors"] have a row per face. Returns the collection."""
    from matplotlib.collections import PolyCollection

    right, up, towards = axes_of_view(direction)
    flat = numpy.stack([corners @ right, corners @ up], axis=-1)
    across = flat[:, 2] - flat[:, 0], flat[:, -1] - flat[:, 1]
    seen = numpy.flatnonzero(across[0][:, 0] * across[1][:, 1] > across[0][:, 1] * across[1][:, 0])
    order = seen[numpy.argsort((corners @ towards).mean(axis=1)[seen])]
    width = 0.3 if edges and len(corners) < 5000 else 0
    # Without lines, smooth edges would show what is behind through every seam.
    faces = PolyCollection(flat[order], linewidths=width, antialiaseds=width > 0,
                           edgecolors="black" if width else "face",
                           **{key: values[order] if key in ("array", "facecolors") else values
                              for key, values in colours.items()})
    axes.add_collection(faces)
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.set_axis_off()
    return faces


def _of_faces(surface, values, vertices, elements):
    """One number per face, from an array of one row per vertex or element."""
    values = numpy.asarray(values, float)
    if values.ndim == 2 and values.shape[1] == 3:
        values = numpy.linalg.norm(values, axis=1)
    if values.ndim != 1:
        raise ValueError(f"a picture shows numbers and vectors; the field has the shape "
                         f"{values.shape}, choose one of its components")
    if len(values) == elements and elements != vertices:
        return values[surface.elements]
    if len(values) != vertices:
        raise ValueError(f"a field must have one row per vertex, {vertices}, or element, "
                         f"{elements}; has {len(values)}")
    return surface.values(values)[surface[1]].mean(axis=1)


def _shade(corners, direction):
    """Between 0.55 and 1: how much light falls on each face."""
    right, up, towards = axes_of_view(direction)
    normals = numpy.cross(corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1])
    length = numpy.linalg.norm(normals, axis=1, keepdims=True)
    light = (LIGHT @ [right, up, towards]) / numpy.linalg.norm(LIGHT)
    return 0.55 + 0.45 * numpy.clip(normals / numpy.where(length > 0, length, 1) @ light, 0, 1)


def draw_surface(surface, values, name, vertices, elements, size, edges, direction, title):
    """A Picture of a Surface or an EmbeddedSurface; values: see Simulation.picture()."""
    try:
        import matplotlib
    except ImportError as error:
        raise ImportError("a picture needs matplotlib; install python3-matplotlib") from error
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    corners = surface.points[surface[1]]
    figure = Figure(figsize=(size[0] / 100, size[1] / 100), dpi=100)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes([0.02, 0.02, 0.8 if values is not None else 0.96, 0.9])
    if values is None:
        colours = numpy.tile([0.85, 0.55, 0.5], (len(corners), 1))
    else:
        of_faces = numpy.ma.masked_invalid(_of_faces(surface, values, vertices, elements))
        scale = ScalarMappable(Normalize(of_faces.min(), of_faces.max()),
                               matplotlib.colormaps["viridis"].with_extremes(bad="lightgrey"))
        colours = scale.to_rgba(of_faces)[:, :3]
        figure.colorbar(scale, cax=figure.add_axes([0.85, 0.15, 0.03, 0.65]), label=name)
    add_faces(axes, corners, direction, edges,
              facecolors=colours * _shade(corners, direction)[:, None])
    figure.text(0.02, 0.98, title, fontsize=9, va="top")
    out = io.BytesIO()
    canvas.print_png(out)
    return Picture(out.getvalue())
