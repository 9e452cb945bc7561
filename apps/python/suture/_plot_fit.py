# SPDX-License-Identifier: GPL-3.0-or-later
"""What `suture fit` draws: data and fit of each test, and chi2 from evaluation to evaluation."""

import numpy

from ._draw import add_faces
from ._fit_mesh import FACES, outer_faces
from ._results import TIME

MOST_PLACES = 22  # panels
LOOKS_FROM = (0.35, 0.4, 1.0)


def _units(label):
    return "[N]" if " reaction " in label else "[m]"


def _curve(axes, test, column):
    """One quantity against time."""
    order = numpy.argsort(test["times"])
    times = test["times"][order]
    axes.errorbar(times, test["measured"][order, column], test["deviation"][order, column],
                  fmt="o", ms=3, lw=0.7, label="measured")
    axes.plot(times, test["fitted"][order, column], lw=1.2, label="fit")
    axes.set_title(f"{test['name']}: {test['labels'][column]} {_units(test['labels'][column])}")
    axes.set_xlabel(TIME)
    axes.legend(fontsize=7)


def _points(axes, test):
    """Measured against fitted displacements; of a scan, the distances."""
    measured, fitted = test["measured"].ravel() * 1e3, test["fitted"].ravel() * 1e3
    if not measured.any():
        axes.hist(fitted, 40)
        axes.set_xlabel("distance of the scan from the body [mm]")
    else:
        axes.plot(measured, fitted, ".", ms=2)
        ends = [measured.min(), measured.max()]
        axes.plot(ends, ends, lw=0.8)
        axes.set_xlabel("measured displacement [mm]")
        axes.set_ylabel("of the fit [mm]")
    axes.set_title(f"{test['name']}: {len(measured)} values")


def _section(axes, name, values, mesh):
    """A field, cut open where it differs most from its median."""
    from matplotlib.colors import LogNorm

    corners = mesh["points"][mesh["hexahedra"]]
    centres = corners.mean(axis=1)
    share = numpy.log(values / numpy.median(values)) ** 2 if values.min() > 0 else values**2
    depth = numpy.average(centres[:, 1], weights=share + 1e-12)
    kept = numpy.flatnonzero(centres[:, 1] >= depth)  # the eye is at smaller y
    faces = outer_faces(mesh["hexahedra"][kept])
    quads = corners[kept][:, FACES].reshape(-1, 4, 3)[faces]
    of_faces = values[kept][faces // 6]
    z_up = quads[:, :, [0, 2, 1]] * [1, 1, -1]
    drawn = add_faces(axes, z_up, LOOKS_FROM, array=of_faces,
                      cmap="viridis", norm=LogNorm(values.min(), values.max())
                      if values.min() > 0 else None)
    axes.set_title(f"{name}, the body cut open at y = {depth:.3g} m")
    axes.figure.colorbar(drawn, ax=axes, shrink=0.7)


def _panels(result):
    """Functions that draw one panel each."""
    for pointer, mesh in result.fields.items():
        yield lambda axes, pointer=pointer, mesh=mesh: _section(
            axes, pointer.rpartition("/")[2], result.values[pointer], mesh)
    for test in result.tests:
        if len(test["times"]) == 1:
            yield lambda axes, test=test: _points(axes, test)
        else:
            for column in range(len(test["labels"])):
                yield lambda axes, test=test, column=column: _curve(axes, test, column)


def _history(axes, result):
    chi2 = numpy.array([numpy.nan if value is None else value for value in result.history], float)
    axes.semilogy(numpy.arange(1, len(chi2) + 1), chi2, "o-", ms=3, lw=1)
    axes.axhline(result.count, lw=0.8, ls="--", color="grey")
    axes.set_title("chi2 (dashed: the number of values)")
    axes.set_xlabel("evaluation")


def draw_fit(result):
    """A matplotlib figure."""
    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    panels = [*list(_panels(result))[:MOST_PLACES], lambda axes: _history(axes, result)]
    rows = (len(panels) + 1) // 2
    with rc_context({"font.size": 8, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(10, 3 * rows), constrained_layout=True)
        FigureCanvasAgg(figure)
        places = list(figure.subplots(rows, 2, squeeze=False).flat)
        for place, panel in zip(places, panels):
            panel(place)
            place.grid(alpha=0.3)
        for place in places[len(panels):]:
            place.set_axis_off()
    return figure
