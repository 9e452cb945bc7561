# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh with its named sets, from both sides, with numbered axes.

    python3 _start.py suture._plot_mesh FRAME TITLE PICTURE      what `suture plot MESH` executes

The frame has the boundary of the mesh and the obstacles of the scene. Its fields of points are 1 in
a set: faces in a set ("set x0") are coloured, the points of a selection of the scene ("at
/constraints/0") are dots, the faces of obstacles ("obstacle knife") are transparent.
"""

import sys
from pathlib import Path

import numpy

from ._frames import read_boundary
from ._plot import exit_code_of, picture_at, save

GREY = (0.86, 0.86, 0.86)
VIEWS = ((22, -58), (-22, 122))  # elevation and azimuth, degrees; y is up: all six sides
MOST_EDGES = 20_000  # of faces whose edges are drawn
LIGHT = numpy.array([0.3, 0.8, 0.5]) / numpy.linalg.norm([0.3, 0.8, 0.5])


class Sets:
    """The sets of points: where they are on the boundary, and their colours."""

    def __init__(self, fields, corners):
        from matplotlib import colormaps

        palette = colormaps["tab10" if len(fields) <= 10 else "tab20"].colors
        self.members = {name: values > 0.5 for name, values in fields.items()}
        self.colours = {name: palette[i % len(palette)] for i, name in enumerate(self.members)}
        self.faces = self._faces("set ", corners)
        self.obstacles = self._faces("obstacle ", corners)
        self.body = ~numpy.any([numpy.zeros(len(corners), bool), *self.obstacles.values()], axis=0)

    def _faces(self, kind, corners):
        return {name: mask[corners].all(axis=1) for name, mask in self.members.items()
                if name.startswith(kind)}

    def face_colours(self, count):
        """Later sets hide earlier ones; small ones hide large ones."""
        colours = numpy.tile(GREY, (count, 1))
        for name in sorted(self.faces, key=lambda n: -numpy.count_nonzero(self.faces[n])):
            colours[self.faces[name]] = self.colours[name]
        return colours

    def dots(self):
        """Those that are drawn as points: selections, and sets without a face."""
        return [name for name in self.members if name not in self.obstacles and
                not self.faces.get(name, numpy.zeros(1)).any()]


def _normals(faces):
    """Outward, of unit length; (0, 0, 0) of a face without area."""
    normals = numpy.cross(faces[:, 2] - faces[:, 0], faces[:, 3] - faces[:, 1])
    lengths = numpy.linalg.norm(normals, axis=1, keepdims=True)
    return numpy.divide(normals, lengths, out=numpy.zeros_like(normals), where=lengths > 0)


def _direction(elevation, azimuth):
    """Towards the viewer, with y up: matplotlib turns (x, y, z) to (z, x, y)."""
    e, a = numpy.radians([elevation, azimuth])
    return numpy.array([numpy.cos(e) * numpy.sin(a), numpy.sin(e), numpy.cos(e) * numpy.cos(a)])


def _draw(axes, points, corners, sets, view):
    from matplotlib.ticker import MaxNLocator
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    faces = points[corners]
    normals, towards = _normals(faces), _direction(*view)
    shade = (0.72 + 0.28 * numpy.abs(normals @ LIGHT))[:, None]
    seen = (normals @ towards > -1e-3) | (normals == 0).all(axis=1)  # others are hidden
    seen &= sets.body
    colours = sets.face_colours(len(corners)) * shade
    edges = "#00000060" if len(corners) <= MOST_EDGES else "none"
    layers = [(faces[sets.body].mean(axis=(0, 1)) @ towards, faces[seen],
               {"facecolors": colours[seen], "edgecolors": edges, "linewidths": 0.3})]
    layers += [(faces[mask].mean(axis=(0, 1)) @ towards, faces[mask],
                {"facecolors": [sets.colours[name]], "alpha": 0.4})
               for name, mask in sets.obstacles.items()]
    for _, polygons, style in sorted(layers, key=lambda layer: layer[0]):  # the nearest last
        # matplotlib's third axis points up; ours is y.
        axes.add_collection3d(Poly3DCollection(polygons[:, :, [2, 0, 1]], **style))
    visible = numpy.zeros(len(points), bool)
    visible[corners[seen]] = True
    for name in sets.dots():
        at = points[sets.members[name] & visible]
        axes.scatter(*at[:, [2, 0, 1]].T, color=[sets.colours[name]],
                     s=numpy.clip(2000 / max(len(at), 1), 5, 26), depthshade=False,
                     edgecolors="black", linewidths=0.3, zorder=1e6)
    low, high = points.min(axis=0), points.max(axis=0)
    size = numpy.maximum(high - low, 0.02 * (high - low).max())
    for axis, name, a in zip("xyz", "zxy", (2, 0, 1)):
        getattr(axes, f"set_{axis}lim")(low[a], low[a] + size[a])
        getattr(axes, f"set_{axis}label")(f"{name} [m]")
        share = size[a] / size.max()
        getattr(axes, f"{axis}axis").set_major_locator(MaxNLocator(6 if share > 0.5 else
                                                                   3 if share > 0.2 else 1))
    axes.set_box_aspect(size[[2, 0, 1]], zoom=1.0)
    axes.set_proj_type("ortho")
    axes.view_init(*view)


def _legend(figure, sets):
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles = []
    for name, mask in sets.members.items():
        label = name if name in sets.obstacles else f"{name}: {numpy.count_nonzero(mask):,} points"
        handles.append(Line2D([], [], marker="o", ls="", color=sets.colours[name], label=label,
                              markeredgecolor="black", markeredgewidth=0.4)
                       if name in sets.dots() else Patch(color=sets.colours[name], label=label))
    if handles:
        figure.legend(handles=handles, loc="lower center", ncols=min(3, len(handles)), fontsize=8)


def draw(title, points, corners, fields):
    """A figure of a boundary: points (n, 3), corners (k, 4), fields {name: values of points}."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    import mpl_toolkits.mplot3d  # noqa: F401: the projection

    sets = Sets(fields, corners)
    rows = -(-len(sets.members) // 3)
    figure = Figure(figsize=(12, 6 + 0.22 * rows))
    FigureCanvasAgg(figure)
    body = points[corners[sets.body]].reshape(-1, 3)
    low, high = body.min(axis=0), body.max(axis=0)
    tiny = 1e-9 * numpy.abs([low, high]).max()
    box = " to ".join("(" + ", ".join(f"{0 if abs(x) < tiny else x:.4g}" for x in corner) + ")"
                      for corner in (low, high))
    figure.suptitle(f"{title}: {box} m; from above, and from below", x=0.02, ha="left", fontsize=10)
    for i, view in enumerate(VIEWS):
        axes = figure.add_subplot(1, 2, i + 1, projection="3d", computed_zorder=False)
        _draw(axes, points, corners, sets, view)
    figure.subplots_adjust(0.02, 0.06 + 0.035 * rows, 0.96, 0.95, 0.08)
    _legend(figure, sets)
    return figure


def main():
    frame, title, picture = sys.argv[1:4]

    def drawing():
        file = picture_at(picture)
        save(draw(Path(title).name, *read_boundary(frame)), file)

    return exit_code_of(drawing)


if __name__ == "__main__":
    sys.exit(main())
