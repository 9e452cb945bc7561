# SPDX-License-Identifier: GPL-3.0-or-later
"""Obstacles of a simulation as tools: their forces, their poses, and how to move them."""

import difflib
from collections.abc import Mapping


def _vector(values, what):
    if values is None:
        return None
    vector = [float(value) for value in values]
    if len(vector) != 3:
        raise ValueError(f"{what} must be three numbers; there are {len(vector)}")
    return vector


class Tool:
    """An obstacle of the scene, as it is now. All arrays are copies of three numbers."""

    __slots__ = ("_simulation", "_place", "_name")  # other names cannot be assigned

    def __init__(self, simulation, place, name):
        self._simulation = simulation
        self._place = place
        self._name = name

    def _state(self, what):
        return self._simulation._tool_state(self._place)[what]

    def __repr__(self):
        return f"<suture.Tool {self._name!r}>"

    @property
    def name(self):
        """Its name in the scene."""
        return self._name

    @property
    def force(self):
        """The force of the body on it in the last step, N."""
        return self._state(0)

    @property
    def torque(self):
        """The torque of the body on it in the last step, about the centre of its shape, N m."""
        return self._state(1)

    @property
    def translation(self):
        """How far it is from where the scene gives it, m."""
        return self._state(2)

    @property
    def rotation(self):
        """How it is turned about the centre of its motion: by the length of this vector, rad,
        about its direction."""
        return self._state(3)

    @property
    def hand_force(self):
        """What the hand of a compliant tool feels, N; None of others."""
        return self._state(4)

    @property
    def hand_torque(self):
        """What the hand of a compliant tool feels, about the centre of its motion, N m; None of
        others."""
        return self._state(5)

    def move_to(self, translation=None, rotation=None, *, at):
        """Move it from where it is to a pose, which it reaches at the time `at` (s), at a constant
        velocity and, the short way round, at a constant spin. It stays there. This replaces the
        rest of its path in the scene or of an earlier call.

        translation, rotation  as the attributes; what is left out stays as it is now

        Of a compliant tool, the hand moves. With "dt": "auto", a step ends at `at`.
        """
        self._simulation._steer(self._name, _vector(translation, "translation"),
                                _vector(rotation, "rotation"), float(at))


class Tools(Mapping):
    """The obstacles of a simulation by name."""

    def __init__(self, simulation):
        self._simulation = simulation
        self._places = {name: place for place, name in enumerate(simulation._tool_names())}

    def __getitem__(self, name):
        if name not in self._places:
            near = difflib.get_close_matches(str(name), self._places, 1)
            raise KeyError(f"the scene has no obstacle {name!r}; " +
                           (f"did you mean {near[0]!r}?" if near else
                            f"it has {', '.join(self._places) or 'none'}"))
        return Tool(self._simulation, self._places[name], name)

    def __iter__(self):
        return iter(self._places)

    def __len__(self):
        return len(self._places)

    def _ipython_key_completions_(self):
        return list(self)

    def __repr__(self):
        return f"<suture.Tools {', '.join(self._places)}>"
