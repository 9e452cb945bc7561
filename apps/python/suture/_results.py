# SPDX-License-Identifier: GPL-3.0-or-later
"""The files in the output folder of a run."""

import csv
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy

TABLES = ("energies.csv", "probes.csv", "tools.csv")
TIME = "time [s]"


def folder_of(run):
    """The folder of a run, which may be given by its run.pvd. Warns if the run is unfinished."""
    folder = Path(run)
    if folder.suffix == ".pvd":
        folder = folder.parent
    if not folder.is_dir():
        raise OSError(f"{run}: no such folder; name the output folder of a run, or its run.pvd")
    if (folder / "suture-unfinished.txt").exists():
        print(f"suture: warning: {folder}: the run that writes here has not finished (it still runs, "
              "was killed, or a plugin ended it); its results are incomplete", file=sys.stderr)
    return folder


def names_of(folders):
    """Short names of folders: the shortest ends of their paths that differ."""
    paths = [Path(folder).resolve().parts for folder in folders]
    longest = max(map(len, paths), default=0)
    for length in range(1, longest + 1):
        names = ["/".join(parts[-length:]) for parts in paths]
        if len(set(names)) == len(set(paths)):
            return names
    return []


def frames_of(folder):
    """[(time, file)] of run.pvd; none if the run wrote no frames."""
    collection = folder / "run.pvd"
    if not collection.exists():
        return []
    try:
        sets = ElementTree.parse(collection).getroot().iter("DataSet")
        return [(float(s.get("timestep")), folder / s.get("file")) for s in sets]
    except (ElementTree.ParseError, TypeError, ValueError) as error:
        raise ValueError(f"{collection}: is not a list of frames ({error}); run the scene "
                         "again") from error


def table_of(file):
    """(names, rows): a table of a run as numbers."""
    with open(file, newline="", encoding="utf-8", errors="replace") as stream:
        names, *rows = [*csv.reader(stream)] or [[]]
    if names[:2] != ["step", TIME]:
        raise ValueError(f"{file}: is not a table of a run, whose first columns are 'step' and "
                      "'time [s]'; run the scene again")
    try:
        if not rows:
            raise ValueError("no row")
        return names, numpy.array(rows, float).reshape(-1, len(names))
    except ValueError:
        raise ValueError(f"{file}: is damaged: it needs rows of {len(names)} numbers each; run the "
                      "scene again") from None
