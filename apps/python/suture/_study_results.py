# SPDX-License-Identifier: GPL-3.0-or-later
"""The results of a study: one row per run, and the time series of its runs."""

import csv
import itertools
import math
from pathlib import Path

from ._results import TABLES, TIME, table_of

# Columns that neither the scene nor `measure` gives.
BOOKKEEPING = ("run", "outcome", "steps", "time", "seconds", "scene_hash", "suture", "error")


def run_folder(study, number):
    return Path(study) / "runs" / f"{number:04d}"


class Results:
    """The table of a study.

    results["tip"]                the values of a column, as an array (NaN where a run has none)
    results.series("tip y [m]")   [(times, values)] of a column of probes.csv, energies.csv or
                                  tools.csv, one per run
    results.plot()                a figure: parameters against results, and the series
    results.rows                  a list of dicts, one per run
    results.file                  results.csv
    """

    def __init__(self, rows, file):
        self.rows = rows
        self.file = Path(file)
        self._tables = {}

    @property
    def columns(self):
        return list(dict.fromkeys(itertools.chain.from_iterable(self.rows)))

    @property
    def parameters(self):
        """The columns that are JSON pointers into the scene."""
        return [name for name in self.columns if name.startswith("/")]

    def __len__(self):
        return len(self.rows)

    def __getitem__(self, column):
        import numpy

        if column not in self.columns:
            raise KeyError(f"no run has {column!r}; the columns are {', '.join(self.columns)}")
        return numpy.array([row.get(column, math.nan) for row in self.rows])

    def _table(self, row, name):
        """(names, rows) of a table of a run; without names if the run has no such table."""
        file = run_folder(self.file.parent, row["run"]) / name
        if file not in self._tables:
            try:
                self._tables[file] = table_of(file) if file.exists() else ((), None)
            except ValueError:
                if row["outcome"] != "failed":  # which may have been before the first row
                    raise
                self._tables[file] = (), None
        return self._tables[file]

    @property
    def series_columns(self):
        """The names that series() knows."""
        return [column for table in TABLES for column in self._columns_of(table)]

    def _columns_of(self, table):
        names = dict.fromkeys(itertools.chain.from_iterable(
            self._table(row, table)[0] for row in self.rows))
        return [name for name in names if name not in ("step", TIME, "dt [s]")]

    def series(self, column):
        """[(times, values)] of a column of probes.csv, energies.csv or tools.csv, one per run; two
        empty arrays for a run without it."""
        import numpy

        for table in TABLES:
            if column in self._columns_of(table):
                break
        else:
            raise KeyError(f"no run has a series {column!r}; there are "
                           f"{', '.join(self.series_columns) or 'none'}")
        found = []
        for row in self.rows:
            names, rows = self._table(row, table)
            has = column in names
            found.append((rows[:, names.index(TIME)], rows[:, names.index(column)]) if has else
                         (numpy.empty(0), numpy.empty(0)))
        return found

    def plot(self, only=()):
        """A matplotlib figure of the parameters against the results, and of the series.

        only    texts: only columns whose name contains one of them
        """
        from ._plot import draw
        from ._plot_study import panels_of_study

        return draw([], panels_of_study(self, only))


def _value(text):
    try:
        return float(text)
    except ValueError:
        return text


def read_results(folder):
    """The Results of a study that was made before, from its folder."""
    file = Path(folder) / "results.csv"
    try:
        with open(file, newline="", encoding="utf-8") as table:
            rows = [{name: _value(text) for name, text in row.items() if text}
                    for row in csv.DictReader(table)]
        for row in rows:
            row["run"] = int(row["run"])
    except (KeyError, TypeError, ValueError, AttributeError):
        raise ValueError(f"{file}: is not the table of a study; run `suture sweep` again") from None
    if not rows:
        raise ValueError(f"{file}: has no run; run `suture sweep` again")
    return Results(rows, file)


def series_rows(study, numbers, name):
    """The names, and an iterator over the rows, of the tables `name` of all runs together."""
    files = {number: run_folder(study, number) / name for number in numbers}
    files = {number: file for number, file in files.items() if file.exists()}
    names = {}
    for file in files.values():
        with open(file, newline="", encoding="utf-8") as table:
            names.update(dict.fromkeys(next(csv.reader(table), [])))

    def rows():
        for number, file in files.items():
            with open(file, newline="", encoding="utf-8") as table:
                for row in csv.DictReader(table):
                    yield {"run": number, **row}

    return ["run", *names] if names else [], rows()
