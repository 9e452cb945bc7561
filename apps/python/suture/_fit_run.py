# SPDX-License-Identifier: GPL-3.0-or-later
"""One test of a fit: what its scene gives where it was measured, with derivatives.

Equilibria are kept. From one set of parameters to the next, each starts from its last shape, moved
along its derivatives. Other runs are repeated from their start.
"""

import contextlib
import math

import numpy

TOLERANCE = 1e-3  # of sensitivities: Gauss-Newton's method needs directions
ADJOINT_TOLERANCE = 1e-6
ROUNDING = 1e-9  # of times
EXTERNAL = ("/loads/", "/gravity/", "/constraints/")
FEW_ELEMENTS = 200_000  # of all equilibria together, some 2 kB each


class NoDerivatives(Exception):
    """The reason why there are only differences of runs."""


class Failed(Exception):
    """Why there is no result with these parameters."""


@contextlib.contextmanager
def _failures():
    """Turns errors of a simulation into Failed."""
    from . import Error

    try:
        yield
    except Error as error:
        raise Failed(str(error).splitlines()[0]) from None


class _Moment:
    """What was read of a run at a time."""

    def __init__(self, time, reading):
        self.time = time
        self.reading = reading


class _Equilibrium(_Moment):
    """A state that is kept, and found again with other parameters."""

    def __init__(self, sim, reading):
        super().__init__(sim.time, reading)
        self.state = sim.copy()
        self.sim = None  # one of its own, from the first visit on
        self.is_start = sim.steps == 0  # at rest, whatever the parameters are
        self.position = sim.position.copy()
        self.slopes = None
        self._p = self._origin = self._moves = None

    def guess(self, p):
        """Where the equilibrium is expected."""
        if self._moves is None:
            return self.position
        return self._origin + numpy.tensordot(p - self._p, self._moves, 1)

    def keep_moves(self, p, moves):
        """moves: (numbers, vertices, 3), the derivatives of the positions at p."""
        self._p, self._moves, self._origin = p.copy(), numpy.array(moves), self.position


class Runs:
    """A Test whose scene is run as a whole for every set of parameters."""

    def __init__(self, test, unknowns):
        self.test = test
        self.unknowns = unknowns

    def start(self, p, with_slopes):
        """(values (m, k), None). Raises Failed where the run does not reach its end."""
        self._gauge = self.test.make_gauge()
        with _failures():
            self._run(p)
        return self._at_times(lambda moment: moment.reading.values), None

    evaluate = start

    def _simulate(self, p):
        from . import Simulation

        sim = Simulation(self.test.scene, {"/solver/threads": 1, **self.test.set,
                                           **self.unknowns.sets(p)})
        self.unknowns.apply(sim, p)
        return sim

    def _run(self, p):
        self._sim = self._simulate(p)
        self._moments, self._parts = [], [None] * len(self.test.times)
        self._before, self._here = None, None
        for row in numpy.argsort(self.test.times, kind="stable"):
            self._reach(self.test.times[row], p)
            if self._sim.time < self.test.times[row] * (1 - ROUNDING) < math.inf:
                raise ValueError(
                    f"{self.test.place(row)}: the time {self.test.times[row]:g} s lies outside of "
                    f"the run, which goes from 0 to {self._sim.time:g} s; set /solver/end of the "
                    "scene")
            self._parts[row] = self._shares(self.test.times[row])

    def _reach(self, time, p):
        """Steps until this time lies between two moments."""
        sim = self._sim
        while sim.time < time * (1 - ROUNDING) and not sim.outcome:
            passes = math.isfinite(time) and sim.time + sim.dt > time * (1 + ROUNDING)
            self._before = (self._here or self._moment(p)) if passes else None
            sim.step()
            self._after_step(p)
            self._here = None
        self._here = self._here or self._moment(p)

    def _after_step(self, p):
        pass

    def _moment(self, p):
        return _Moment(self._sim.time, self._gauge.read(self._sim))

    def _shares(self, time):
        """[(number of a moment, share)]: values between two moments are interpolated."""
        share = 1.0
        if self._before is not None and time < self._here.time * (1 - ROUNDING):
            share = (time - self._before.time) / (self._here.time - self._before.time)
        parts = [(self._before, 1 - share), (self._here, share)]
        return [(self._number(moment), part) for moment, part in parts if part > 0]

    def _number(self, moment):
        if moment not in self._moments:
            self._moments.append(moment)
        return self._moments.index(moment)

    def _at_times(self, of):
        """(m, ...) of what moments give."""
        found = [of(moment) for moment in self._moments]
        return numpy.array([sum(part * found[place] for place, part in parts)
                            for parts in self._parts])


class Followed(Runs):
    """A Test whose scene is run as a whole, with the derivatives of the run."""

    def start(self, p, with_slopes):
        """(values (m, k), derivatives (m, k, numbers)). Raises NoDerivatives with the reason where
        there are none."""
        values, _ = super().start(p, with_slopes)
        return values, self._at_times(lambda moment: moment.slopes)

    evaluate = start

    def _simulate(self, p):
        from . import InputError

        sim = super()._simulate(p)
        try:
            self._others = [self._beside(p, *other) for other in self.unknowns.of_scenes(p)]
            sim._follow(list(self.unknowns.directions(sim)), self._others, ADJOINT_TOLERANCE)
        except InputError as error:
            raise NoDerivatives(str(error)) from None
        return sim

    def _beside(self, p, pointer, value, step):
        """Simulations with a number of the scene on both sides, and the step to each."""
        from . import Simulation

        if not pointer.startswith(EXTERNAL):
            raise NoDerivatives(f"{pointer} is no number of a load or a motion")
        sets = {"/solver/threads": 1, **self.test.set, **self.unknowns.sets(p)}
        return (*(Simulation(self.test.scene, {**sets, pointer: value + way})
                  for way in (step, -step)), step)

    def _reach(self, time, p):
        from . import InputError

        try:
            super()._reach(time, p)
        except InputError as error:
            raise NoDerivatives(str(error)) from None

    def _moment(self, p):
        moment = super()._moment(p)
        slopes = []
        for number in range(self.unknowns.size):
            moved, reaction = self._sim._followed(number)
            has_reaction = moment.reading.by_reaction is not None
            slopes.append(moment.reading.along(moved, reaction if has_reaction else None))
        moment.slopes = numpy.column_stack(slopes)[:, self.unknowns.order]
        return moment


class Equilibria(Runs):
    """A Test of equilibria, with derivatives."""

    def start(self, p, with_slopes):
        """(values (m, k), derivatives (m, k, numbers) or None). Raises NoDerivatives with the
        reason where there are none."""
        self._with_slopes = with_slopes
        super().start(p, with_slopes)
        self._current = None
        return self._result()

    def evaluate(self, p, with_slopes):
        """The same with other parameters; without slopes, those from before."""
        self._with_slopes = with_slopes
        with _failures():
            for equilibrium in self._moments:
                if not equilibrium.is_start:
                    self._visit(equilibrium, p)
                    self._read(equilibrium, p)
        return self._result()

    def _result(self):
        has_slopes = self._moments[-1].slopes is not None
        return (self._at_times(lambda e: e.reading.values),
                self._at_times(lambda e: e.slopes) if has_slopes else None)

    def gradient(self, p, weights):
        """The derivative by the numbers of the sum of weights (m, k) times values, at the
        parameters of the last evaluation."""
        total = numpy.zeros(self.unknowns.size)
        for i, equilibrium in enumerate(self._moments):
            shares = [sum(part for place, part in parts if place == i) for parts in self._parts]
            if equilibrium.is_start or not any(shares):
                continue
            with _failures():
                self._visit(equilibrium, p)
                total += self._adjoint(equilibrium.reading, shares @ weights)
        return total

    def _visit(self, equilibrium, p):
        """Finds the equilibrium with these parameters."""
        sim = self._go_to(equilibrium, p)
        self.unknowns.apply(sim, p)
        sim.position = equilibrium.guess(p)
        sim.equilibrate()
        equilibrium.position = sim.position.copy()
        self._current = equilibrium

    def _go_to(self, equilibrium, p):
        """A simulation in its state: its own one, which keeps its preconditioner, if all of them
        take little memory."""
        current, self._current = self._current, None
        if equilibrium.sim is None and current is not equilibrium:
            if len(self._moments) * len(self._sim.element_ids) <= FEW_ELEMENTS:
                self._sim = equilibrium.sim = self._simulate(p)
            self._sim.restore(equilibrium.state)
        elif equilibrium.sim is not None:
            self._sim = equilibrium.sim
        return self._sim

    def _after_step(self, p):
        """Whether there are derivatives is asked as early as possible."""
        from . import InputError

        if self._sim.steps != 1:
            return
        try:
            model, parameter, weights = next(self.unknowns.directions(self._sim))
            self._sim._sensitivity(self._sim._force_slope(model, parameter, weights), TOLERANCE)
        except InputError as error:
            raise NoDerivatives(str(error)) from None

    def _moment(self, p):
        equilibrium = _Equilibrium(self._sim, None)
        self._read(equilibrium, p)
        return equilibrium

    def _read(self, equilibrium, p):
        reading = equilibrium.reading = self._gauge.read(self._sim)
        if not self._with_slopes:
            return
        if equilibrium.is_start:
            equilibrium.slopes = numpy.zeros((len(reading.values), self.unknowns.size))
            return
        slopes, moves = zip(*[self._along(reading, *direction)
                              for direction in self.unknowns.directions(self._sim)])
        equilibrium.slopes = numpy.column_stack(slopes)
        equilibrium.keep_moves(p, moves)

    def _along(self, reading, model, parameter, weights):
        """The derivatives of a reading and of the positions."""
        forces = self._sim._force_slope(model, parameter, weights)
        moved, reaction = self._sim._sensitivity(forces, TOLERANCE)
        if reading.by_reaction is None:
            reaction = None
        return reading.along(moved, reaction), moved

    def _adjoint(self, reading, weights):
        sim = self._sim
        shape = sim.rest.shape
        of_reaction = (None if reading.by_reaction is None else
                       (reading.by_reaction.T @ weights).reshape(shape))
        load, _, _ = sim._adjoint((reading.by_displacement.T @ weights).reshape(shape), of_reaction,
                                  0.0, ADJOINT_TOLERANCE)
        found = []
        for unknown in self.unknowns.all:
            if unknown.groups is None:
                found.append([sim._gradient_along(unknown.model, unknown.parameter, load, 0.0,
                                                  unknown.weights(sim, 0))])
            else:
                each = sim._gradient(unknown.model, unknown.parameter, load, 0.0)
                found.append(numpy.bincount(unknown.groups, each, unknown.size))
        return numpy.concatenate(found)
