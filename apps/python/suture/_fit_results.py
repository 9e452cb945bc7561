# SPDX-License-Identifier: GPL-3.0-or-later
"""What a fit has found: values, standard errors, and how well the data determine them."""

import csv
import io
import json
from pathlib import Path

import numpy

from ._scene import to_json
from ._sweep import write_whole
from ._vtk import write_grid

FILE = "fit.json"
WEAK = 0.25  # a standard error, as part of the range
TOGETHER = 0.98  # a correlation
AT_END = 1e-3  # of the range


class FitResult:
    """The result of a fit.

    values        {pointer: number, or array of regions or elements}
    errors        {pointer: standard error}, of what is not fitted per element
    fields        {pointer: {"points", "hexahedra", "ids"}}, of what is fitted per element: where
                  its values are, at rest, and the numbers of the elements in the mesh
    correlation   (numbers, numbers), in the order of `names`; None with fields
    names, notes  of the numbers; {name: a word where one is not identifiable or at an end}
    chi2          the sum of squares of (fitted - measured) / deviation, of `count` values
    outcome       "converged" or "stopped", with `reason`
    tests         [{"name", "labels", "times", "measured", "fitted", "deviation"}]
    evaluations   how often all tests were computed, in `seconds`; history: chi2 of each
    has_deviations  False: chi2 is relative to 1 % of the largest values, and errors to its size
    """

    def __init__(self, fields):
        self.values = {key: _number_or_array(value) for key, value in fields["values"].items()}
        self.errors = {key: _number_or_array(value) for key, value in fields["errors"].items()}
        self.fields = {key: {name: numpy.array(part) for name, part in mesh.items()}
                       for key, mesh in fields["fields"].items()}
        self.correlation = _number_or_array(fields["correlation"])
        self.names = fields["names"]
        self.notes = fields["notes"]
        self.chi2 = fields["chi2"]
        self.count = fields["count"]
        self.has_deviations = fields["has_deviations"]
        self.outcome = fields["outcome"]
        self.reason = fields["reason"]
        self.evaluations = fields["evaluations"]
        self.history = fields["history"]
        self.seconds = fields["seconds"]
        self.tests = [{**test, **{key: numpy.array(test[key], float) for key in
                                  ("times", "measured", "fitted", "deviation")}}
                      for test in fields["tests"]]

    def __repr__(self):
        values = ", ".join(f"{name} = {text}" for name, text in self._texts())
        return f"<suture.FitResult: {values}; chi2 = {self.chi2:.4g} of {self.count} values>"

    def _texts(self):
        """(name, "3.01e+04 +- 120") of what is not a field."""
        for pointer, value in self.values.items():
            name = pointer.rpartition("/")[2]
            error = self.errors.get(pointer)
            if error is None and numpy.ndim(value):
                yield name, f"{value.min():.4g} to {value.max():.4g}, {len(value)} elements"
                continue
            errors = numpy.full(numpy.size(value), numpy.nan) if error is None else error
            for i, (v, e) in enumerate(zip(numpy.atleast_1d(value), numpy.atleast_1d(errors))):
                label = f"{name} (region {i})" if numpy.ndim(value) else name
                yield label, f"{v:.5g}" + ("" if numpy.isnan(e) else f" +- {e:.3g}")

    def summary(self):
        """Lines for people."""
        lines = [f"{name} = {text}" + (f" ({self.notes[name]})" if name in self.notes else "")
                 for name, text in self._texts()]
        lines.append(f"chi2 = {self.chi2:.4g} of {self.count} values"
                     + ("" if self.has_deviations else ", with deviations of 1 % of the largest"))
        plural = "" if self.evaluations == 1 else "s"
        lines.append(f"{self.outcome} after {self.evaluations} evaluation{plural}: {self.reason}")
        return lines

    def plot(self):
        """A matplotlib figure of the data and the fit."""
        from ._plot_fit import draw_fit

        return draw_fit(self)

    def save(self, folder):
        """Writes fit.json, values.csv and data.csv, and fields as FIELD.vtu where VTK is
        installed."""
        folder = Path(folder)
        write_whole(folder / FILE, to_json(self._plain(), indent=1))
        write_whole(folder / "values.csv", _table(
            ["parameter", "number", "value", "standard error"], self._value_rows()))
        write_whole(folder / "data.csv", _table(
            ["test", "time [s]", "quantity", "measured", "fitted", "deviation"],
            self._data_rows()))

        for pointer, mesh in self.fields.items():
            name = pointer.rpartition("/")[2]
            try:
                write_grid(folder / f"{name}.vtu", mesh["points"], mesh["hexahedra"],
                           {name: self.values[pointer], "element_id": mesh["ids"]})
            except ImportError:
                pass

    def _plain(self):
        def plain(value):
            if isinstance(value, dict):
                return {key: plain(v) for key, v in value.items()}
            if isinstance(value, list):
                return [plain(v) for v in value]
            if isinstance(value, numpy.ndarray):
                return plain(value.tolist())
            return None if isinstance(value, float) and not numpy.isfinite(value) else value

        return plain(self.__dict__)

    def _value_rows(self):
        for pointer, value in self.values.items():
            value = numpy.atleast_1d(value)
            error = self.errors.get(pointer)
            errors = [""] * len(value) if error is None else numpy.atleast_1d(error)
            mesh = self.fields.get(pointer)
            numbers = range(len(value)) if mesh is None else mesh["ids"]
            for row in zip(numbers, value, errors):
                yield [pointer, *row]

    def _data_rows(self):
        for test in self.tests:
            for i, time in enumerate(test["times"]):
                for j, label in enumerate(test["labels"]):
                    yield [test["name"], time, label, *(test[key][i, j] for key in
                                                        ("measured", "fitted", "deviation"))]


def read_fit_result(folder):
    """The FitResult of a fit that was made before, from its folder."""
    return FitResult(json.loads((Path(folder) / FILE).read_text(encoding="utf-8")))


def _number_or_array(value):
    return numpy.array(value, float) if isinstance(value, (list, numpy.ndarray)) else value


def _table(header, rows):
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(header)
    table.writerows(rows)
    return text.getvalue()


def covariance_of(jacobian):
    """The inverse of J^T J; directions without effect get a very large variance."""
    _, singular, directions = numpy.linalg.svd(jacobian, full_matrices=False)
    singular = numpy.maximum(singular, 1e-12 * max(singular.max(), 1e-300))
    return (directions.T / singular**2) @ directions


def correlation_of(covariance):
    spread = numpy.sqrt(numpy.diag(covariance))
    return covariance / numpy.outer(spread, spread)


def notes_of(names, q, covariance):
    """A word on each number that the data do not determine. q and its covariance: as parts of the
    range."""
    notes = {}
    correlation = correlation_of(covariance)
    for i, name in enumerate(names):
        words = []
        others = numpy.delete(abs(correlation[i]), i)
        if covariance[i, i] ** 0.5 > WEAK:
            words.append("not identifiable from these data: its standard error is "
                         f"{min(covariance[i, i] ** 0.5, 99):.2g} of its range")
        if len(others) and others.max() > TOGETHER:
            other = numpy.delete(numpy.arange(len(names)), i)[others.argmax()]
            words.append(f"determined only together with {names[other]}: correlation "
                         f"{correlation[i, other]:.3f}")
        if not AT_END < q[i] < 1 - AT_END:
            words.append("at the end of its range")
        if words:
            notes[name] = "; ".join(words)
    return notes
