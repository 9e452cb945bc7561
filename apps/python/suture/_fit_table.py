# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured columns: a CSV file with units in its header, or arrays in SI units."""

import csv
import difflib
import hashlib
import math
import re

import numpy

UNITS = {
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0},
    "length": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6},
    "force": {"N": 1.0, "mN": 1e-3, "uN": 1e-6, "kN": 1e3},
}


def unknown_name(what, name, names):
    """The text of a mistake: what has no such name."""
    near = difflib.get_close_matches(name, names, 1)
    return f"{what} {name!r}" + (f"; did you mean {near[0]!r}?" if near else
                                 f"; it has {', '.join(names) or 'none'}")


def _split_unit(name):
    """("force", "mN") of "force [mN]"."""
    found = re.fullmatch(r"(.*?)\s*\[([^\[\]]*)\]\s*", name)
    return (found[1], found[2]) if found else (name, "")


class Table:
    """Columns by their names. As in tables of motions, lines that begin with # are left out, and
    cells lie between commas, semicolons or tabs."""

    def __init__(self, source):
        if isinstance(source, dict):
            self.title = "the data"
            self._of_arrays(source)
        else:
            self.title = str(source)
            self._of_file(source)
        self._units = {name: unit for name, unit in map(_split_unit, self._header)}

    def _of_arrays(self, arrays):
        columns = [numpy.asarray(values, float) for values in arrays.values()]
        if not columns or len({column.shape for column in columns}) > 1 or columns[0].ndim != 1:
            raise ValueError("arrays of data must have one axis and the same length")
        self._header = list(arrays)
        self._rows = numpy.column_stack(columns)
        self._lines = [f"row {i}" for i in range(len(self._rows))]
        self._has_units = False

    def _of_file(self, file):
        with open(file, newline="", encoding="utf-8-sig", errors="replace") as stream:
            lines = [(i, line) for i, line in enumerate(stream, 1)
                     if line.strip() and not line.lstrip().startswith("#")]
        if len(lines) < 2:
            raise ValueError(f"{file}: has no rows of numbers below a row with the names of its "
                             "columns")
        separator = max(",;\t", key=lines[0][1].count)
        cells = [[cell.strip() for cell in row]
                 for row in csv.reader((line for _, line in lines), delimiter=separator)]
        self._header = cells[0]
        self._lines = [f"{file}:{i}" for i, _ in lines[1:]]
        self._rows = numpy.array([self._numbers(row, line)
                                  for row, line in zip(cells[1:], self._lines)])
        self._has_units = True

    def _numbers(self, row, line):
        if len(row) != len(self._header):
            raise ValueError(f"{line}: has {len(row)} cells, and the first row names "
                             f"{len(self._header)}")
        return [_number(cell, f"{line}: column {name!r}") for cell, name in zip(row, self._header)]

    @property
    def names(self):
        """Without units."""
        return list(self._units)

    def __len__(self):
        return len(self._rows)

    @property
    def fingerprint(self):
        """A text that tells these numbers from others."""
        text = "\0".join(self._header).encode() + self._rows.tobytes()
        return hashlib.sha256(text).hexdigest()

    def place(self, row):
        """Of a row, for messages."""
        return self._lines[row]

    def column(self, name, quantity):
        """The values in SI units. quantity: a key of UNITS."""
        if name not in self._units:
            raise ValueError(unknown_name(f"{self.title}: has no column", name, self.names))
        unit = self._units[name]
        if not unit and not self._has_units:
            unit = next(iter(UNITS[quantity]))
        if unit not in UNITS[quantity]:
            raise ValueError(
                f"{self.title}: column {name!r} has "
                + (f"the unit {unit!r}, which is none of {quantity}" if unit else "no unit")
                + f"; write it as '{name} [UNIT]', with one of {', '.join(UNITS[quantity])}")
        return self._rows[:, list(self._units).index(name)] * UNITS[quantity][unit]


def _number(cell, place):
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{place}: {cell!r} is not a finite number" if cell else
                         f"{place}: is empty; each row needs a number")
    return value
