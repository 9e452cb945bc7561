# SPDX-License-Identifier: GPL-3.0-or-later
"""Derivatives of static equilibria: objectives, adjoints and sensitivities; _run_gradients.py has
those of runs."""

from typing import NamedTuple

import numpy


class Slopes(NamedTuple):
    """A value, and its partial derivatives by displacements, reactions and the elastic energy."""

    value: float
    displacement: "numpy.ndarray | float" = 0.0
    reaction: "numpy.ndarray | float" = 0.0
    energy: float = 0.0

    def scaled(self, value, factor):
        """Of a function of this one, with its value and its derivative."""
        return Slopes(value, *(factor * slope for slope in self[1:]))

    def plus(self, value, other):
        return Slopes(value, *(a + b for a, b in zip(self[1:], other[1:])))


class Quantity:
    """A scalar that an equilibrium gives, with its derivative: made by displacement(), reaction()
    and energy(), and by arithmetic of quantities and numbers.

        miss = (Quantity.displacement("tip", 1) + 0.02) ** 2
    """

    def __init__(self, slopes):
        self._slopes = slopes

    @classmethod
    def displacement(cls, at, component):
        """The mean displacement of vertices along an axis (0, 1 or 2), m. at: the name of a probe,
        or rows of the vertices in the simulation's arrays."""
        return cls._of_vertices("displacement", "mean", at, component)

    @classmethod
    def reaction(cls, at, component):
        """The sum of the forces of constraints on vertices along an axis, N."""
        return cls._of_vertices("reaction", "sum", at, component)

    @classmethod
    def energy(cls):
        """The energy that the models store, J: energies()["elastic"] without that of force
        functions."""
        return cls(lambda sim: Slopes(sim._stored_energy(), energy=1.0))

    @classmethod
    def _of_vertices(cls, field, usual, at, component):
        if component not in (0, 1, 2):
            raise ValueError(f"component must be 0 (x), 1 (y) or 2 (z), is {component!r}")

        def slopes(sim):
            vertices, of = sim._probe_vertices(at, field) if isinstance(at, str) else (at, usual)
            vertices = numpy.asarray(vertices)
            if len(vertices) == 0:
                raise ValueError(f"the {field} of no vertices")
            values = sim.reactions if field == "reaction" else sim.position - sim.rest
            weights = numpy.zeros(sim.rest.shape)
            weights[vertices, component] = 1 / len(vertices) if of == "mean" else 1
            return Slopes(float((weights * values).sum()), **{field: weights})

        return cls(slopes)

    def map(self, function, derivative):
        """function(self), for a function of a number and its derivative."""
        def slopes(sim):
            of = self._slopes(sim)
            return of.scaled(function(of.value), derivative(of.value))

        return Quantity(slopes)

    def value(self, sim):
        """Its value in the state of a simulation."""
        return self._slopes(sim).value

    def _with(self, other, slopes_of):
        other = _quantity(other)
        if other is NotImplemented:
            return other
        return Quantity(lambda sim: slopes_of(self._slopes(sim), other._slopes(sim)))

    def __add__(self, other):
        return self._with(other, lambda a, b: a.plus(a.value + b.value, b))

    def __mul__(self, other):
        def product(a, b):
            value = a.value * b.value
            return a.scaled(value, b.value).plus(value, b.scaled(value, a.value))

        return self._with(other, product)

    def __neg__(self):
        return self.map(lambda x: -x, lambda x: -1.0)

    def __sub__(self, other):
        return self + -other

    def __rsub__(self, other):
        return -self + other

    def __pow__(self, exponent):
        return self.map(lambda x: x**exponent, lambda x: exponent * x ** (exponent - 1))

    def __truediv__(self, other):
        return self * (other**-1 if isinstance(other, Quantity) else 1 / other)

    def __rtruediv__(self, other):
        return other * self**-1

    __radd__ = __add__
    __rmul__ = __mul__


def _quantity(value):
    if isinstance(value, Quantity):
        return value
    if isinstance(value, (int, float, numpy.number)):
        return Quantity(lambda sim: Slopes(float(value)))
    return NotImplemented


def slopes_of(objective, sim):
    """Of a Quantity, or of a function that returns a value with its derivative."""
    if isinstance(objective, Quantity):
        return objective._slopes(sim)
    result = objective(sim)
    try:
        value, derivative = result
    except (TypeError, ValueError):
        raise TypeError(
            "an objective returns (J, dJ/du), or (J, {'displacement': dJ/du, 'reaction': dJ/dR, "
            "'energy': dJ/dW}); this one returns " + type(result).__name__) from None
    if not isinstance(derivative, dict):
        return Slopes(float(value), numpy.asarray(derivative, float))
    unknown = set(derivative) - {"displacement", "reaction", "energy"}
    if unknown:
        raise ValueError(f"no objective has a derivative by {sorted(unknown)[0]!r}; there are "
                         "'displacement', 'reaction' and 'energy'")
    return Slopes(float(value), **derivative)


def full(slope, sim):
    """An array (vertices, 3) of a slope that may be 0."""
    return numpy.broadcast_to(slope, sim.rest.shape) if numpy.isscalar(slope) else slope


def place_of(sim, model):
    """The number of a model, by its name."""
    return sim.parameters[model]._place


def directions_of(sim, model, parameter, per):
    """(place of the model, weights of the values of a parameter): one row for each number that is
    asked for; a single row without an axis for one number; None for each value."""
    place = place_of(sim, model)
    per = usual_per(sim, model, parameter) if per is None else per
    count = sim._parameter_values(place, parameter)
    if isinstance(per, str) and per == "value":
        return place, numpy.ones(max(count, 1))
    if count == 0:
        raise ValueError(f"the parameter {parameter!r} is the same in all elements, so per must be "
                         "'value'")
    if isinstance(per, str):
        if per != "element":
            raise ValueError(f"per must be 'value', 'element' or an array of regions; is {per!r}")
        return place, None
    regions = numpy.asarray(per)
    if regions.shape != (count,) or not numpy.issubdtype(regions.dtype, numpy.integer):
        raise ValueError(f"regions must be {count} integers, one per row of the model's elements; "
                         f"has the shape {regions.shape} and the dtype {regions.dtype}")
    if regions.min(initial=0) < -1:
        raise ValueError("regions must be numbers from 0, or -1 for none")
    return place, (regions == numpy.arange(regions.max() + 1)[:, None]).astype(float)


def usual_per(sim, model, parameter):
    """What a scene gives: by element, or one value."""
    value = sim.parameters[model][parameter]
    return "element" if isinstance(value, numpy.ndarray) else "value"


def adjoint_of(sim, objective, tolerance, every_step, wrt=(), moments=False, then=None):
    """That of the kept steps, if there are any, or of the equilibrium. Errors add up over steps, so
    the usual tolerance is smaller."""
    if sim._kept_steps() is not None:
        from ._run_gradients import RunAdjoint

        return RunAdjoint(sim, objective, tolerance or 1e-9, every_step, wrt, moments, then)
    if every_step or moments or then is not None:
        raise ValueError("every_step, moments and then are for the steps that keep_steps() keeps; "
                         "call it before the run")
    return Adjoint(sim, objective, tolerance or 1e-6)


class Adjoint:
    """The derivative of an objective at an equilibrium by everything that determines it, from
    Simulation.adjoint(). Valid until the simulation changes."""

    def __init__(self, sim, objective, tolerance):
        slopes = slopes_of(objective, sim)
        has_reactions = not numpy.isscalar(slopes.reaction)
        self._sim = sim
        self._displacement = full(slopes.displacement, sim)
        self._energy = float(slopes.energy)
        self.value = slopes.value
        found = sim._adjoint(self._displacement, slopes.reaction if has_reactions else None,
                             self._energy, tolerance)
        self.load = found[0]
        self.motion = found[1]
        self.iterations = found[2]
        self._state = sim.position.copy()

    def _require_state(self):
        now = self._sim.position
        if now.shape != self._state.shape or not numpy.array_equal(now, self._state):
            raise RuntimeError("the simulation has left the state of this adjoint; take its "
                               "adjoint() again")

    @property
    def gravity(self):
        """dJ/dg, (3,): by the acceleration of gravity now, after its ramp."""
        return self._sim.mass @ self.load

    def along_rest(self, direction):
        """The derivative if all rest positions move along a direction, (vertices, 3): of shapes.
        Held vertices move along, and dead loads stay as they are."""
        self._require_state()
        return self._sim._along_rest(self._displacement, self._energy, self.load, self.motion,
                                     numpy.asarray(direction, float))

    @property
    def rest(self):
        """dJ/d(rest position) of every vertex, (vertices, 3), as along_rest(). Costs as much as
        some 160 forces of models that are built again."""
        self._require_state()
        return self._sim._by_rest(self._displacement, self._energy, self.load, self.motion)

    def gradient(self, model, parameter, per=None):
        """dJ/dp of a parameter of a model.

        per  "value": one number, as if all values changed by the same; "element": one number per
             row of the model's elements (column_cells(model, 3)); or an array of regions, one
             integer per row, which gives one number per region (-1: in none); default: as the scene
             gives the parameter
        """
        self._require_state()
        sim, about = self._sim, (self.load, self._energy)
        place, directions = directions_of(sim, model, parameter, per)
        if directions is not None and directions.ndim == 1:
            return sim._gradient_along(place, parameter, *about, directions)
        each = sim._gradient(place, parameter, *about)
        return each if directions is None else directions @ each


class Sensitivity:
    """The derivative of an equilibrium by a parameter, from Simulation.sensitivity(): one linear
    solve per number. With several, the arrays have a leading axis."""

    def __init__(self, sim, model, parameter, per, tolerance):
        place, directions = directions_of(sim, model, parameter, per)
        if directions is None:
            directions = numpy.eye(sim._parameter_values(place, parameter))
        found = [self._along(sim, place, parameter, weights, tolerance)
                 for weights in numpy.atleast_2d(directions)]
        fields = [numpy.array(values) if directions.ndim == 2 else values[0]
                  for values in zip(*found)]
        self.displacement = fields[0]
        self.reaction = fields[1]
        self.energy = fields[2]
        self._sim = sim

    @staticmethod
    def _along(sim, place, parameter, weights, tolerance):
        """du/dp, dR/dp and dW/dp in a direction."""
        forces = sim._force_slope(place, parameter, weights)
        moved, reaction = sim._sensitivity(forces, tolerance)
        stiffer = sim._gradient_along(place, parameter, numpy.zeros_like(moved), 1.0, weights)
        return moved, reaction, stiffer - (sim._elastic_forces() * moved).sum()

    def of(self, objective):
        """The derivative of an objective: one number, or one for each of several."""
        slopes = slopes_of(objective, self._sim)
        return ((slopes.displacement * self.displacement).sum(axis=(-2, -1))
                + (slopes.reaction * self.reaction).sum(axis=(-2, -1))
                + slopes.energy * self.energy)


def gradient(sim, objective, wrt, tolerance=None, every_step=False):
    """The value of an objective and the list of its derivatives: at the equilibrium of a simulation,
    or by the run since Simulation.keep_steps().

    objective  a Quantity, or a function of the simulation that returns (J, dJ/du), with dJ/du of
               the shape (vertices, 3), or (J, {"displacement": dJ/du, "reaction": dJ/dR,
               "energy": dJ/dW})
    wrt        a list: (model, parameter) or (model, parameter, per), see Adjoint.gradient(); or the
               name of another derivative of the Adjoint: "load", "motion", "gravity"; of a
               RunAdjoint: "load", "gravity", "loads", "motions", "initial_position",
               "initial_velocity"
    tolerance  relative residual of the linear solve, 1e-6, or of that of each step, 1e-9
    every_step the objective is that of the final state (False), or the sum over the kept steps

    sim may be a list of simulations with kept steps, each of which starts where the one before has
    ended, after a cut: see Simulation.adjoint(then=...).
    """
    if isinstance(wrt, tuple):
        raise TypeError(f"wrt must be a list, such as [{wrt!r}]")
    runs = [sim] if not isinstance(sim, (list, tuple)) else sim
    names = {name for name in wrt if isinstance(name, str)}
    adjoint = None
    for run in reversed(runs):
        adjoint = adjoint_of(run, objective, tolerance, every_step, wrt,
                             moments=bool({"loads", "motions"}.intersection(names)), then=adjoint)
    return adjoint.value, [getattr(adjoint, name) if isinstance(name, str)
                           else adjoint.gradient(*name) for name in wrt]


class GradientCheck(NamedTuple):
    """A derivative and the same by differences of whole equilibria."""

    adjoint: float
    differences: float
    error: float
    """Their difference over the larger one."""


def check_gradient(sim, objective, wrt, step=1e-3, tolerance=1e-9):
    """Compare the derivative of an objective by a parameter with differences of four equilibria
    around this one; return a GradientCheck.

    wrt   (model, parameter); of values by element, along a random direction (fixed seed)
    step  of the differences, relative to the parameter

    The differences are as good as the equilibria: give the scene a tolerance of 1e-12
    (/solver/static/tolerance). Ends at this equilibrium, up to its tolerance.
    """
    model, parameter = wrt
    values = sim.parameters[model][parameter]
    direction = numpy.array(values, float)
    if direction.ndim:
        direction *= numpy.random.default_rng(0).uniform(0.5, 1.5, direction.shape)
    found = float(numpy.sum(direction * Adjoint(sim, objective, tolerance).gradient(
        model, parameter)))

    def value_at(part):
        sim.parameters[model][parameter] = values + part * direction
        sim.equilibrate()
        return slopes_of(objective, sim).value

    try:
        far_back, back, near, far = (value_at(k * step) for k in (-2, -1, 1, 2))
    finally:
        value_at(0)
    differences = (8 * (near - back) - (far - far_back)) / (12 * step)
    scale = max(abs(found), abs(differences))
    return GradientCheck(found, differences, abs(found - differences) / scale if scale else 0.0)
