# SPDX-License-Identifier: GPL-3.0-or-later
"""The parameters of the models of a simulation, which can be changed between two steps."""

import difflib
from collections.abc import Mapping

import numpy

from ._scene import to_json


def _missing(what, name, names):
    near = difflib.get_close_matches(str(name), names, 1)
    return KeyError(f"{what} {name!r}; " + (f"did you mean {near[0]!r}?" if near else
                                            f"it has {', '.join(names) or 'none'}"))


def _row(name, values):
    """A row of numbers."""
    try:
        row = numpy.asarray(values, float)
    except (TypeError, ValueError):
        raise TypeError(f"{name!r} must be a number, or an array of numbers; is {values!r}") from None
    if row.ndim != 1:
        raise ValueError(f"{name!r} must have one value per element; has the shape {row.shape}")
    return row


class ModelParameters(Mapping):
    """The parameters of one model by name. Assign to change one, update() to change several."""

    __slots__ = ("_simulation", "_place", "_name")  # other names cannot be assigned

    def __init__(self, simulation, place, name):
        self._simulation = simulation
        self._place = place
        self._name = name

    def _values(self):
        return self._simulation._parameters(self._place)

    def __getitem__(self, name):
        values = self._values()
        if name not in values:
            raise _missing(f"the model {self._name!r} has no parameter", name, list(values))
        return values[name]

    def __setitem__(self, name, value):
        self.update({name: value})

    def update(self, values=(), **more):
        """Change several parameters at once, from now on. Positions and velocities stay; the
        change of the stored energy is booked as that of an event. Raises SceneError for values
        that the scene could not have, and InputError for those that need what was not built.

        A parameter that may differ from element to element also takes an array, one value per row
        of the model's elements (column_cells(model, 3))."""
        values, before = {**dict(values), **more}, self._values()
        fields = {name: value for name, value in values.items()
                  if not isinstance(value, str) and numpy.ndim(value) > 0}
        fields.update((name, numpy.full(len(before[name]), value)) for name, value in values.items()
                      if name not in fields and numpy.ndim(before.get(name)) == 1)
        uniform = {name: value for name, value in values.items() if name not in fields}
        if uniform:
            self._simulation._set_parameters(self._place, to_json(uniform))
        for name, value in fields.items():
            self._simulation._set_field(self._place, name, _row(name, value))

    def __iter__(self):
        return iter(self._values())

    def __len__(self):
        return len(self._values())

    def __repr__(self):
        return f"<suture.ModelParameters of {self._name!r}: {self._values()}>"

    def _ipython_key_completions_(self):
        return list(self)


class Parameters(Mapping):
    """The parameters of the models of a simulation, by the names of the models."""

    def __init__(self, simulation):
        self._simulation = simulation
        self._places = {name: place for place, name in enumerate(simulation._models())}

    def __getitem__(self, name):
        if name not in self._places:
            raise _missing("the scene has no model", name, list(self._places))
        return ModelParameters(self._simulation, self._places[name], name)

    def __iter__(self):
        return iter(self._places)

    def __len__(self):
        return len(self._places)

    def __repr__(self):
        return f"<suture.Parameters of {', '.join(self._places)}>"

    def _ipython_key_completions_(self):
        return list(self)
