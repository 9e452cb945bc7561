# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads what a fit is given, from a file or from Python; every mistake is reported with its
place."""

from pathlib import Path
from typing import NamedTuple

import numpy

from ._fit_table import Table, unknown_name
from ._fit_unknowns import Unknowns, require_options
from ._scene import is_text
from ._study_file import (Object, is_number, is_object, is_range, is_whole, name_of, parse,
                          pointer_values, results_folder)

KEYS = ("scene", "set", "fit", "data", "loss", "stop", "folder", "jobs")
OPTIONS = ("per", "log", "range", "start", "regularise")
PER = ("value", "region", "element")
LOSSES = ("linear", "soft_l1", "huber", "cauchy")
COMMON = ("name", "scene", "set", "deviation", "time")
CURVE = ("curve", "columns", *COMMON)
POINTS = ("points", *COMMON)
FIELDS = {"displacement": "length", "reaction": "force"}
USUAL_DEVIATION = 0.01  # of the largest value, where none is given


class Test(NamedTuple):
    """One test: a scene, and what was measured of it."""

    name: str
    scene: "Path | dict | str"
    set: dict
    make_gauge: "callable"
    labels: list  # of what is measured
    times: numpy.ndarray  # (m,), inf: the end of the run
    measured: numpy.ndarray  # (m, k)
    deviation: numpy.ndarray  # (m, k)
    place: "callable"  # of a row, for messages
    fingerprint: str  # of the data

    def rows(self, chosen):
        """The test with some of its times."""
        numbers = numpy.arange(len(self.times))[chosen]
        return self._replace(times=self.times[chosen], measured=self.measured[chosen],
                             deviation=self.deviation[chosen],
                             place=lambda row: self.place(numbers[row]))


class Problem(NamedTuple):
    tests: list
    unknowns: Unknowns
    loss: str
    most_evaluations: int
    tolerance: float
    has_deviations: bool


def _is_file(value):
    return isinstance(value, (str, Path, dict))


def _is_columns(value):
    return isinstance(value, dict) and len(value) > 0


def _column(spec, path):
    """(name, factor) of "force" or {"column": "force", "factor": -1}."""
    if isinstance(spec, str):
        return spec, 1.0
    entry = Object(spec, path, ("column", "factor"))
    return (entry.require("column", lambda v: isinstance(v, str), "the name of a column"),
            entry.take("factor", 1.0, lambda v: is_number(v) and v != 0, "a number that is not 0"))


def _probed(name, path):
    """(probe, field, component) of "base reaction x", with or without its unit."""
    words = name.partition(" [")[0].split(" ")
    if len(words) == 3 and words[1] in FIELDS and words[2] in ("x", "y", "z"):
        return words[0], words[1], "xyz".index(words[2])
    raise ValueError(f"{path}: {name!r} must be 'PROBE displacement x' or 'PROBE reaction x' (or "
                     "y, z), with the name of a probe in the scene's /output/probes")


class _Reader:
    """Reads the tests of a problem; files are relative to its folder."""

    def __init__(self, study, home):
        self._study = study
        self._home = home

    def tests(self):
        entries = self._study.require("data", lambda v: isinstance(v, list) and v,
                                      "an array of tests, each with \"curve\" or \"points\"")
        tests = []
        for i, entry in enumerate(entries):
            path = f"/data/{i}"
            if not isinstance(entry, dict) or ("curve" in entry) == ("points" in entry):
                raise ValueError(f"{path}: must be an object with exactly one of 'curve' and "
                                 "'points'")
            kind = "curve" if "curve" in entry else "points"
            self._entry = Object(entry, path, CURVE if kind == "curve" else POINTS)
            self._table = self._table_of(kind)
            tests.append(getattr(self, "_" + kind)(path))
        return tests

    def _table_of(self, kind):
        source = self._entry.require(kind, _is_file, "a file of columns of numbers (CSV)")
        try:
            return Table(source if isinstance(source, dict) else self._home / source)
        except OSError as error:
            raise OSError(f"{self._entry.path}/{kind}: {error.filename}: "
                          f"{error.strerror}") from None

    def _scene(self):
        """The scene of a test, and its values."""
        scene = self._entry.value.get("scene", self._study.value.get("scene"))
        if not _is_file(scene):
            raise ValueError("/: 'scene' is missing: the path of a scene, relative to the study, "
                             "or a scene")
        if isinstance(scene, (str, Path)) and not is_text(scene):
            scene = (self._home / scene).resolve()
        values = [pointer_values(place.take("set", {}, is_object, "an object {pointer: value}"),
                          place.path + "/set") for place in (self._study, self._entry)]
        return scene, {**values[0], **values[1]}

    def _test(self, make_gauge, labels, times, measured, deviation):
        source = self._entry.value.get("curve", self._entry.value.get("points"))
        usual = self._entry.path if isinstance(source, dict) else Path(source).stem
        name = self._entry.take("name", usual, lambda v: isinstance(v, str), "a text")
        return Test(name, *self._scene(), make_gauge, labels, times, measured,
                    numpy.broadcast_to(deviation, measured.shape), self._table.place,
                    self._table.fingerprint)

    def _deviations(self, labels, measured):
        """(k,): as given, or a part of the largest value of each column."""
        path = self._entry.path + "/deviation"
        given = self._entry.value.get("deviation")
        if given is None:
            largest = abs(measured).max(axis=0)
            return USUAL_DEVIATION * numpy.where(largest > 0, largest, 1)
        if not isinstance(given, dict):
            given = dict.fromkeys(labels, given)
        for label in given:
            if label not in labels:
                raise ValueError(unknown_name(f"{path}: nothing measured is named", label, labels))
        for label in labels:
            if not is_number(given.get(label)) or given[label] <= 0:
                raise ValueError(f"{path}: must give a standard deviation > 0 of {label!r}, in SI "
                                 f"units; is {name_of(given.get(label))}")
        return numpy.array([given[label] for label in labels])

    def _curve(self, path):
        from ._fit_gauges import Probed

        columns = self._entry.require("columns", _is_columns, "an object {'PROBE FIELD COMPONENT': "
                                      "the name of a column}")
        name, factor = _column(self._entry.value.get("time", "time"), path + "/time")
        times = factor * self._table.column(name, "time")
        self._require_times(times, path)
        probed, measured = [], []
        for label, spec in columns.items():
            probed.append(_probed(label, path + "/columns"))
            column, factor = _column(spec, f"{path}/columns/{label}")
            measured.append(factor * self._table.column(column, FIELDS[probed[-1][1]]))
        labels, measured = list(columns), numpy.column_stack(measured)
        return self._test(lambda: Probed(probed), labels, times, measured,
                          self._deviations(labels, measured))

    def _require_times(self, times, path):
        early = numpy.flatnonzero(times < 0)
        if len(early):
            raise ValueError(f"{path}: {self._table.place(early[0])}: the time "
                             f"{times[early[0]]:g} s lies before the start of the run, 0 s")

    def _points(self, path):
        from ._fit_gauges import Markers, Scan

        given = self._entry.take("time", None, lambda v: is_number(v) and v >= 0, "a time >= 0, s")
        times = numpy.array([numpy.inf if given is None else given])
        points = numpy.column_stack([self._table.column(c, "length") for c in "xyz"])
        moved = [c for c in range(3) if "u" + "xyz"[c] in self._table.names]
        deviation = self._entry.take("deviation", None, lambda v: is_number(v) and v > 0,
                                     "a standard deviation > 0, m")
        if not moved:
            measured = numpy.zeros((1, len(points)))
            spread = USUAL_DEVIATION * numpy.ptp(points, axis=0).max()
            return self._test(lambda: Scan(points), ["distance"] * len(points), times, measured,
                              deviation or spread)
        values = numpy.column_stack([self._table.column("u" + "xyz"[c], "length") for c in moved])
        place = self._table.place
        return self._test(lambda: Markers(points, moved, place),
                          [f"displacement {'xyz'[c]}" for c in moved] * len(points), times,
                          values.reshape(1, -1),
                          deviation or USUAL_DEVIATION * abs(values).max() or 1.0)


def _unknowns(study):
    entries = study.require("fit", _is_columns, "an object {pointer: {\"range\": [low, high]}}")
    pointer_values(entries, "/fit")
    for pointer, options in entries.items():
        entry = Object(options, f"/fit/{pointer}", OPTIONS)
        entry.require("range", _is_range_or_pair, "two numbers [low, high], low < high")
        entry.take("log", False, lambda v: isinstance(v, bool), "true or false")
        entry.take("per", "value", lambda v: v in PER, " or ".join(f'"{p}"' for p in PER))
        entry.take("regularise", {}, _is_regularisation, "{\"tv\": number > 0} or "
                   "{\"tikhonov\": number > 0}")
        require_options(pointer, options)
    return Unknowns(entries)


def _is_range_or_pair(value):
    return is_range(list(value) if isinstance(value, tuple) else value)


def _is_regularisation(value):
    return (isinstance(value, dict) and len(value) == 1 and set(value) <= {"tv", "tikhonov"} and
            all(is_number(v) and v > 0 for v in value.values()))


def problem_of(study, home):
    """The Problem that an object describes. Raises ValueError for a mistake in it."""
    study = Object(study, "", KEYS)
    unknowns = _unknowns(study)
    tests = _Reader(study, home).tests()
    given = ["deviation" in entry for entry in study.value["data"]]
    if any(given) and not all(given):
        raise ValueError(f"/data/{given.index(False)}: 'deviation' is missing: give the standard "
                         "deviation of all tests, or of none")
    stop = Object(study.value.get("stop", {}), "/stop", ("evaluations", "tolerance"))
    evaluations, tolerance = (300, 1e-5) if unknowns.is_field else (50, 1e-4)
    return Problem(
        tests, unknowns, study.take("loss", "linear", lambda v: v in LOSSES, ", ".join(LOSSES)),
        stop.take("evaluations", evaluations, lambda v: is_whole(v, 1), "a whole number >= 1"),
        stop.take("tolerance", tolerance, lambda v: is_number(v) and 0 < v < 1,
                  "a number in (0, 1)"),
        all(given))


def read_fit(file):
    """(problem, folder, jobs) of a file. Raises ValueError for a mistake in it."""
    file = Path(file)
    try:
        study = Object(parse(file), "", KEYS)
        folder = study.take("folder", file.stem, lambda f: isinstance(f, str),
                            "the name of a folder")
        jobs = study.take("jobs", None, lambda n: is_whole(n, 1), "a whole number >= 1")
        return problem_of(study.value, file.parent), results_folder(file, folder), jobs
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from None
