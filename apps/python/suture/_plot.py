# SPDX-License-Identifier: GPL-3.0-or-later
"""The results of a run in one picture.

    python3 -m suture._plot RUN FILE      what `suture plot` executes
"""

import sys
from pathlib import Path

import numpy

from ._draw import add_faces
from ._errors import report_error
from ._results import TABLES, folder_of, frames_of, table_of
from ._vtk import read_quads

TIME = "time [s]"
COLOURS = ("von_mises", "nodal_von_mises", "displacement")  # the first that the frame has
LOOKS_FROM = (0.4, 0.35, 1.0)


def quantities(names):
    """{"tip displacement [m]": ["tip displacement x [m]", ...]}: the columns of each quantity."""
    found = {}
    for name in names:
        words, bracket, unit = name.rpartition(" [")
        found.setdefault(words.rpartition(" ")[0] + bracket + unit, []).append(name)
    return {key if len(columns) > 1 else columns[0]: columns for key, columns in found.items()}


def panels_of(file):
    """[(title, table, columns)]: what is drawn of a table."""
    names, rows = table_of(file)
    table = dict(zip(names, rows.T))
    results = [n for n in names if n not in ("step", TIME, "dt [s]")]
    if file.name != "energies.csv":
        return [(title, table, columns) for title, columns in quantities(results).items()]
    energies = [n for n in results if n != "balance [J]" and numpy.any(table[n] != 0)]
    return [("energies and work [J]", table, energies),
            ("balance: unexplained energy [J]", table, ["balance [J]"])]


def draw_columns(axes, title, table, columns):
    for name in columns:
        label = name.rpartition(" [")[0]
        axes.plot(table[TIME], table[name], "." if len(table[TIME]) == 1 else "-", lw=1,
                  label=label.rpartition(" ")[2] if len(columns) > 1 else label)
    axes.set_title(title)
    axes.set_xlabel(TIME)
    axes.grid(alpha=0.3)
    if len(columns) > 1:
        axes.legend(fontsize=7, loc="best")


def colour_of(quads):
    """The name and the values, one per face, of the field by which faces are coloured."""
    for name in COLOURS:
        if name in quads["fields"]:
            values = quads["fields"][name]
            return name, values if values.ndim == 1 else numpy.linalg.norm(values, axis=1)
    return "", numpy.zeros(len(quads["corners"]))


def draw_frame(axes, time, quads):
    name, values = colour_of(quads)
    faces = add_faces(axes, quads["corners"], LOOKS_FROM, array=values, cmap="viridis")
    axes.set_title(f"t = {time:.6g} s" + (f", {name}" if name else ""))
    if name:
        axes.figure.colorbar(faces, ax=axes, shrink=0.7)


def draw(frame, panels):
    """A figure with the frame, if there is one, and the panels."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    pyplot.rcParams.update({"font.size": 8, "axes.spines.top": False, "axes.spines.right": False})
    count = len(panels) + (frame is not None)
    figure, grid = pyplot.subplots((count + 1) // 2, 2, figsize=(10, 3 * ((count + 1) // 2)),
                                   squeeze=False, constrained_layout=True)
    places = list(grid.flat)
    if frame:
        draw_frame(places.pop(0), *frame)
    for panel in panels:
        draw_columns(places.pop(0), *panel)
    for place in places:
        place.set_axis_off()
    return figure


def plot(run, file):
    """Draws the last frame and the tables of a run into a picture."""
    folder = folder_of(run)
    file = Path(file) if file else folder / "plot.png"
    if file.suffix not in (".png", ".pdf", ".svg"):
        raise ValueError(f"{file}: the name of a picture must end in .png, .pdf or .svg")
    frames = frames_of(folder)
    frame = (frames[-1][0], read_quads(frames[-1][1])) if frames else None
    panels = [panel for name in TABLES if (folder / name).exists()
              for panel in panels_of(folder / name)]
    if not frame and not panels:
        raise ValueError(f"{folder}: has no frames and no tables; name the output folder of a run")
    unfinished = file.with_name(f"{file.stem}.part{file.suffix}")
    try:
        draw(frame, panels).savefig(unfinished, dpi=110)
        unfinished.replace(file)
    finally:
        unfinished.unlink(missing_ok=True)
    print(file)


def main():
    try:
        plot(*sys.argv[1:3])
        return 0
    except ImportError as error:
        print(f"suture: error: {error}; pictures need python3-matplotlib and python3-vtk9",
              file=sys.stderr)
        return 6
    except Exception as error:
        return report_error(error)


if __name__ == "__main__":
    sys.exit(main())
