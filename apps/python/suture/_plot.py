# SPDX-License-Identifier: GPL-3.0-or-later
"""Results in one picture: of a run, of several runs, or of a study.

    python3 _start.py suture._plot WHAT ... [--output FILE] [--only TEXT ...]   what `suture plot` executes
"""

import argparse
import sys
from pathlib import Path

import numpy

from ._draw import add_faces
from ._errors import report_error
from ._frames import read_faces
from ._panels import Curve, Panel, draw_panel, is_chosen, limited
from ._plot_study import panels_of_study
from ._results import TABLES, TIME, folder_of, frames_of, names_of, table_of
from ._study_file import read_study
from ._study_results import read_results

COLOURS = ("von_mises", "nodal_von_mises", "displacement")  # the first that the frame has
LOOKS_FROM = (0.4, 0.35, 1.0)
MOST_FRAMES = 6
PICTURES = (".png", ".pdf", ".svg")


def quantities(names):
    """{"tip displacement [m]": ["tip displacement x [m]", ...]}: the columns of each quantity."""
    found = {}
    for name in names:
        words, bracket, unit = name.rpartition(" [")
        found.setdefault(words.rpartition(" ")[0] + bracket + unit, []).append(name)
    return {key if len(columns) > 1 else columns[0]: columns for key, columns in found.items()}


def _columns_of(file, only):
    """(table, names): the columns of a table by name, and those to draw."""
    names, rows = table_of(file)
    table = dict(zip(names, rows.T))
    return table, [name for name in names
                   if name not in ("step", TIME, "dt [s]") and is_chosen(name, only)]


def _panel(title, table, columns):
    """One quantity, with a curve per component."""
    labels = [name.rpartition(" [")[0] for name in columns]
    if len(columns) > 1:
        labels = [label.rpartition(" ")[2] for label in labels]
    return Panel(title, [Curve(label, table[TIME], table[name])
                         for label, name in zip(labels, columns)], has_legend=len(columns) > 1)


def panels_of(file, only=()):
    """What is drawn of a table of one run."""
    table, names = _columns_of(file, only)
    if file.name != "energies.csv":
        return [_panel(title, table, columns) for title, columns in quantities(names).items()]
    energies = [n for n in names if n != "balance [J]" and numpy.any(table[n] != 0)]
    panels = [_panel("energies and work [J]", table, energies)] if energies else []
    if "balance [J]" in names:
        panels.append(_panel("balance: unexplained energy [J]", table, ["balance [J]"]))
    return panels


def panels_of_runs(folders, only=()):
    """Each column of the tables of several runs, with a curve per run."""
    labels = names_of(folders)
    panels = []
    for name in TABLES:
        tables = [(label, *_columns_of(folder / name, only))
                  for label, folder in zip(labels, folders) if (folder / name).exists()]
        for column in dict.fromkeys(column for *_, names in tables for column in names):
            curves = [Curve(label, table[TIME], table[column])
                      for label, table, _ in tables if column in table]
            if any(numpy.any(curve.y != 0) for curve in curves):
                panels.append(Panel(column, curves))
    return panels


class Body:
    """The last frame of a run, to draw: its faces, and one value per face."""

    def __init__(self, folder, title):
        time, file = frames_of(folder)[-1]
        faces = read_faces(file)
        self.corners = faces["corners"]
        self.field, self.values = colour_of(faces)
        self.title = f"{title}t = {time:.6g} s" + (f", {self.field}" if self.field else "")


def colour_of(faces):
    """The name and the values, one per face, of the field by which faces are coloured."""
    for name in COLOURS:
        if name in faces["fields"]:
            values = faces["fields"][name]
            return name, values if values.ndim == 1 else numpy.linalg.norm(values, axis=1)
    return "", numpy.zeros(len(faces["corners"]))


def draw_frame(axes, frame, limits):
    faces = add_faces(axes, frame.corners, LOOKS_FROM, array=frame.values, cmap="viridis",
                      clim=limits)
    axes.set_title(frame.title)
    if frame.field:
        axes.figure.colorbar(faces, ax=axes, shrink=0.7)


def _limits(frames):
    """The range of colours of each field, the same in all frames."""
    limits = {}
    for frame in frames:
        low, high = limits.get(frame.field, (numpy.inf, -numpy.inf))
        limits[frame.field] = (min(low, frame.values.min()), max(high, frame.values.max()))
    return limits


def draw(frames, panels):
    """A figure of frames and panels."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib import rc_context

    panels = limited(panels)
    count = len(panels) + len(frames)
    columns = min(count, 2)
    rows = -(-count // columns)
    style = {"font.size": 8, "axes.spines.top": False, "axes.spines.right": False}
    with rc_context(style):
        figure = Figure(figsize=(10, 3 * rows if columns == 2 else 6), constrained_layout=True)
        FigureCanvasAgg(figure)
        places = list(figure.subplots(rows, columns, squeeze=False).flat)
        limits = _limits(frames)
        for frame in frames:
            draw_frame(places.pop(0), frame, limits[frame.field])
        for panel in panels:
            draw_panel(places.pop(0), panel)
        for place in places:
            place.set_axis_off()
    return figure


def save(figure, file):
    """Writes a picture completely or not at all, and says where."""
    file = Path(file)
    unfinished = file.with_name(f"{file.stem}.part{file.suffix}")
    try:
        figure.savefig(unfinished, dpi=110)
        unfinished.replace(file)
    finally:
        unfinished.unlink(missing_ok=True)
    print(file)


def draw_runs(folders, only=()):
    """The last frames and the tables of one run or several."""
    has_frame = [folder for folder in folders if frames_of(folder)]
    titles = [name + ": " if len(folders) > 1 else "" for name in names_of(has_frame)]
    frames = [Body(folder, title) for folder, title in zip(has_frame, titles)]
    if len(frames) > MOST_FRAMES:
        print(f"suture: the frames of more than {MOST_FRAMES} runs are not drawn", file=sys.stderr)
        frames = []
    if len(folders) == 1:
        panels = [panel for name in TABLES if (folders[0] / name).exists()
                  for panel in panels_of(folders[0] / name, only)]
    else:
        panels = panels_of_runs(folders, only)
    if not frames and not panels:
        raise ValueError(f"{folders[0]}: has no frames and no tables"
                         + (f" with a column named like {' or '.join(only)}" if only else "") +
                         "; name the output folder of a run, or the folder of a study")
    return draw(frames, panels)


def draw_study(folder, only=()):
    panels = panels_of_study(read_results(folder), only)
    if not panels:
        raise ValueError(f"{folder}: no result differs from run to run"
                         + (f" and is named like {' or '.join(only)}" if only else "") +
                         "; a study draws numbers against the parameters that vary")
    return draw([], panels)


def _folder_of_study(file):
    from ._sweep import grid, latin_hypercube

    folder = read_study(file, grid, latin_hypercube)["folder"]
    if not (folder / "results.csv").exists():
        raise OSError(f"{folder}: has no results.csv; make the runs with `suture sweep {file}`")
    return folder


def plot(what, file=None, only=()):
    """Draws runs, or a study, into a picture: plot.png in the folder of one, or here."""
    what = [_folder_of_study(name) if str(name).endswith(".json") else name for name in what]
    studies = [Path(name) for name in what if (Path(name) / "results.csv").exists()]
    if studies and len(what) > 1:
        raise ValueError(f"{studies[0]}: is a study; draw one study at a time")
    folders = studies or [folder_of(name) for name in what]
    file = picture_at(file or Path(folders[0] if len(what) == 1 else "") / "plot.png")
    save(draw_study(folders[0], only) if studies else draw_runs(folders, only), file)


def picture_at(name):
    """Returns the path of a picture; raises ValueError for a format that is not drawn."""
    file = Path(name)
    if file.suffix not in PICTURES:
        raise ValueError(f"{file}: the name of a picture must end in .png, .pdf or .svg")
    return file


def exit_code_of(drawing):
    """Calls drawing(), and reports its error like the program does."""
    try:
        drawing()
        return 0
    except ImportError as error:
        print(f"suture: error: {error}; pictures need python3-matplotlib and python3-vtk9",
              file=sys.stderr)
        return 6
    except Exception as error:
        return report_error(error)


def main():
    parser = argparse.ArgumentParser(prog="suture plot")
    parser.add_argument("what", nargs="+")
    parser.add_argument("--output")
    parser.add_argument("--only", nargs="+", default=[])
    options = parser.parse_args()
    return exit_code_of(lambda: plot(options.what, options.output, options.only))


if __name__ == "__main__":
    sys.exit(main())
