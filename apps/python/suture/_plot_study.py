# SPDX-License-Identifier: GPL-3.0-or-later
"""What `suture plot` draws of a study: results against parameters, and time series by colour."""

import itertools

import numpy

from ._panels import Curve, Panel, Scale, is_chosen, is_logarithmic
from ._study_results import BOOKKEEPING


class Parameter:
    """A parameter that varies, as numbers: texts are numbered in the order of their appearance."""

    def __init__(self, results, pointer, label):
        values = [row.get(pointer) for row in results.rows]
        self.label = label
        self.names = None
        if not all(isinstance(value, (int, float)) for value in values):
            texts = list(dict.fromkeys(map(str, values)))
            self.names = [text if len(text) <= 24 else text[:21] + "..." for text in texts]
            values = [texts.index(str(value)) for value in values]
        self.values = numpy.array(values, float)
        self.is_log = self.names is None and is_logarithmic(self.values)

    def scale(self):
        return Scale(self.label, self.values.min(), self.values.max(), self.is_log)


def labels_of(pointers):
    """{"/models/0/parameters/E": "E"}: the shortest ends that differ."""
    labels = {}
    for pointer in pointers:
        parts = pointer.split("/")
        for length in range(1, len(parts) + 1):
            end = parts[-length:]
            same = [p for p in pointers if p.split("/")[-length:] == end]
            if len(same) == 1 and not end[0].isdigit():
                break
        labels[pointer] = "/".join(end)
    return labels


def parameters_of(results):
    """Those that vary."""
    varying = [name for name in results.parameters
               if len({str(row.get(name)) for row in results.rows}) > 1]
    labels = labels_of(varying)
    return [Parameter(results, name, labels[name]) for name in varying]


def result_columns(results):
    """Numbers that differ from run to run; those of probes, if there are any."""
    found = []
    for name in results.columns:
        values = [row.get(name) for row in results.rows if name in row]
        if (name not in BOOKKEEPING and not name.startswith("/") and
                all(isinstance(value, (int, float)) for value in values) and len(set(values)) > 1):
            found.append(name)
    probed = [name for name in found if name.endswith("]")]  # with a unit
    return probed or found


def _against(results, column, parameter, others):
    """The curves of a result against a parameter: one for each combination of the other
    parameters."""
    y = results[column]
    groups = {}
    for row in numpy.flatnonzero(numpy.isfinite(y)):
        groups.setdefault(tuple(other.values[row] for other in others), []).append(row)
    for key, rows in groups.items():
        rows = sorted(rows, key=lambda row: parameter.values[row])
        yield Curve("", parameter.values[rows], y[rows], key[0] if key else 0.0)


def panels_of_study(results, only=()):
    """Each result against each parameter that varies, then each time series."""
    parameters = parameters_of(results)
    panels = []
    for column, parameter in itertools.product(result_columns(results), parameters):
        if not is_chosen(column, only):
            continue
        others = [other for other in parameters if other is not parameter]
        title = column + " at the end" if column in results.series_columns else column
        panels.append(Panel(title, list(_against(results, column, parameter, others)),
                            parameter.label, others[0].scale() if others else None,
                            has_legend=False, has_marks=True, is_log=parameter.is_log,
                            ticks=parameter.names))
    for column in results.series_columns:
        series = results.series(column)
        if not is_chosen(column, only) or all(numpy.ptp(y) == 0 for _, y in series if y.size):
            continue
        colours = parameters[0].values if parameters else numpy.zeros(len(series))
        panels.append(Panel(column, [Curve("", x, y, value) for (x, y), value in
                                     zip(series, colours) if x.size],
                            scale=parameters[0].scale() if parameters else None,
                            has_legend=False))
    return panels
