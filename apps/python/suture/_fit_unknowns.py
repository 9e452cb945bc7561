# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbers that a fit changes: parameters of models, or other values of a scene."""

import re

import numpy

from ._fit_mesh import Field
from ._study_file import is_number, name_of

MODEL = re.compile(r"/models/(\d+)/parameters/([^/]+)")
MOST_REGIONS = 100
STEP = 1e-5  # of central differences by numbers of scenes, relative
LEAST_SIZE = 1e-3  # of such a number, as a part of its range


class Unknown:
    """One entry of "fit". Its numbers p lie in a range; an optimiser sees q, between 0 and 1, which
    is linear in p or in log p."""

    def __init__(self, pointer, options):
        self.pointer = pointer
        self.per = options.get("per", "value")
        self.is_log = options.get("log", False)
        self.low, self.high = map(float, options["range"])
        self.regularise = options.get("regularise")
        self._given = options.get("start")
        found = MODEL.fullmatch(pointer)
        self.model, self.parameter = (int(found[1]), found[2]) if found else (None, None)

    def prepare(self, sim):
        """Reads the start from a simulation, and which elements share a number."""
        start, self.groups = None, None
        if self.model is not None:
            names = sim._models()
            if self.model >= len(names):
                raise ValueError(f"/fit: {self.pointer!r}: the scene has no model {self.model}; it "
                                 f"has {len(names)}")
            name = names[self.model]
            start = sim.parameters[name][self.parameter]  # raises KeyError with the names
            if self.per != "value":
                start = self._grouped(sim, name, start)
        self.size = 1 if self.groups is None else self.groups.max() + 1
        self.start = self._start(start)

    def _grouped(self, sim, name, start):
        rows = len(sim.column_cells(name, 3))
        if self.per == "element":
            self.groups = numpy.arange(rows)
            self.mesh = Field(sim, self.model)
            return numpy.broadcast_to(start, rows)
        values, self.groups = numpy.unique(numpy.broadcast_to(start, rows), return_inverse=True)
        if not 1 < len(values) <= MOST_REGIONS:
            raise ValueError(
                f"/fit: {self.pointer!r} is fitted per region, which are elements with the same "
                f"value in the scene; it has {len(values)} different values there. Give it a table "
                "over regions with a start for each, or fit it per \"element\"")
        return values

    def _start(self, of_scene):
        """What the study gives, else the scene, else the middle of the range."""
        given = self._given if self._given is not None else of_scene
        if given is None or isinstance(given, str):
            given = self.p_at(0.5)
        start = numpy.array(numpy.broadcast_to(numpy.asarray(given, float), self.size))
        outside = (start < self.low) | (start > self.high)
        if self._given is None and outside.any():
            start[outside] = self.p_at(0.5)
        elif outside.any():
            raise ValueError(f"/fit: {self.pointer!r} starts at {start[outside][0]:g}, outside of "
                             f"its range [{self.low:g}, {self.high:g}]")
        return start

    def p_at(self, q):
        if self.is_log:
            return self.low * (self.high / self.low) ** q
        return self.low + (self.high - self.low) * q

    def q_at(self, p):
        if self.is_log:
            return numpy.log(p / self.low) / numpy.log(self.high / self.low)
        return (p - self.low) / (self.high - self.low)

    def slope(self, p):
        """dp/dq."""
        return p * numpy.log(self.high / self.low) if self.is_log else numpy.full_like(
            p, self.high - self.low)

    @property
    def unit(self):
        """The range in the numbers of which differences are regularised."""
        return float(numpy.log(self.high / self.low)) if self.is_log else 1.0

    def weights(self, sim, number):
        """By how much each value of the parameter changes with one of the numbers."""
        if self.groups is None:
            return numpy.ones(max(sim._parameter_values(self.model, self.parameter), 1))
        return (self.groups == number).astype(float)

    def value(self, p):
        """What the parameter is set to."""
        return float(p[0]) if self.groups is None else p[self.groups]

    @property
    def labels(self):
        name = self.parameter or self.pointer
        return [name] if self.size == 1 else [f"{name} ({self.per} {i})" for i in range(self.size)]


class Unknowns:
    """All of them, with their numbers in one row."""

    def __init__(self, entries):
        self.all = [Unknown(pointer, options) for pointer, options in entries.items()]

    def prepare(self, sim):
        for unknown in self.all:
            unknown.prepare(sim)
        ends = numpy.cumsum([unknown.size for unknown in self.all])
        self._parts = [slice(end - unknown.size, end) for unknown, end in zip(self.all, ends)]
        self.size = int(ends[-1])

    def require_same(self, sim, where):
        """Raises ValueError unless another scene has the same numbers."""
        for unknown in self.all:
            other = Unknown(unknown.pointer, {"per": unknown.per, "log": unknown.is_log,
                                              "range": (unknown.low, unknown.high)})
            other.prepare(sim)
            if other.size != unknown.size:
                raise ValueError(
                    f"{where}: {unknown.pointer!r} has {other.size} values per {unknown.per} "
                    f"here, and {unknown.size} in the first scene; tests of other meshes can "
                    "share values, but not fields")

    def parts(self, row):
        """[(unknown, its numbers)]."""
        return [(unknown, row[part]) for unknown, part in zip(self.all, self._parts)]

    def join(self, function, row):
        """A row from a function (unknown, numbers)."""
        return numpy.concatenate([function(*part) for part in self.parts(row)])

    @property
    def start(self):
        return numpy.concatenate([unknown.start for unknown in self.all])

    @property
    def labels(self):
        names = [label for unknown in self.all for label in unknown.labels]
        if len(set(names)) == len(names):
            return names
        return [f"{unknown.pointer} {label}" for unknown in self.all for label in unknown.labels]

    @property
    def is_field(self):
        return any(unknown.per == "element" for unknown in self.all)

    @property
    def are_of_models(self):
        return all(unknown.model is not None for unknown in self.all)

    def q_at(self, p):
        return self.join(Unknown.q_at, p)

    def p_at(self, q):
        return self.join(Unknown.p_at, q)

    def slope(self, p):
        return self.join(Unknown.slope, p)

    def apply(self, sim, p):
        """Sets the parameters of models."""
        of_models = {}
        for unknown, numbers in self.parts(p):
            if unknown.model is not None:
                of_models.setdefault(unknown.model, {})[unknown.parameter] = unknown.value(numbers)
        for model, values in of_models.items():
            sim.parameters[sim._models()[model]].update(values)

    def sets(self, p):
        """What is not a parameter of a model, as values to build a scene with."""
        return {unknown.pointer: float(numbers[0]) for unknown, numbers in self.parts(p)
                if unknown.model is None}

    def of_scenes(self, p):
        """(pointer, value, small step) for each number that is not one of a model."""
        for unknown, numbers in self.parts(p):
            if unknown.model is None:
                value = float(numbers[0])
                size = max(abs(value), LEAST_SIZE * (unknown.high - unknown.low))
                yield unknown.pointer, value, STEP * size

    @property
    def order(self):
        """The places of the numbers where those of directions() come before those of
        of_scenes()."""
        is_of_scene = numpy.concatenate([numpy.full(unknown.size, unknown.model is None)
                                         for unknown in self.all])
        return numpy.argsort(numpy.argsort(is_of_scene, kind="stable"))

    def directions(self, sim):
        """(model, parameter, weights) for each number of a model."""
        for unknown in self.all:
            for number in range(unknown.size if unknown.model is not None else 0):
                yield unknown.model, unknown.parameter, unknown.weights(sim, number)


def require_options(pointer, options):
    """Raises ValueError for a mistake in an entry of "fit"."""
    where = f"/fit: {pointer!r}"
    if not MODEL.fullmatch(pointer) and options.get("per", "value") != "value":
        raise ValueError(f"{where} is not a parameter of a model ('/models/0/parameters/E'), "
                         "so per must be \"value\"")
    low, high = options["range"]
    if options.get("log", False) and low <= 0:
        raise ValueError(f"{where} has a logarithm, so its range must be > 0; is {[low, high]}")
    if options.get("per") != "element" and "regularise" in options:
        raise ValueError(f"{where}: only what is fitted per \"element\" is regularised")
    start = options.get("start")
    if start is not None and not is_number(start) and not isinstance(start, (list, numpy.ndarray)):
        raise ValueError(f"{where}: start must be a number or an array; is {name_of(start)}")
