# SPDX-License-Identifier: GPL-3.0-or-later
"""Derivatives of runs."""

import numpy

from ._gradients import directions_of, full, slopes_of


class RunAdjoint:
    """The derivative of an objective of a run by everything that determines it, from
    Simulation.adjoint() after keep_steps(). Valid until the simulation goes on."""

    def __init__(self, sim, objective, tolerance, every_step, wrt, moments, then):
        last = sim._kept_steps()

        def slopes_at(moment):
            if not every_step and (moment < last or then is not None):
                return None
            slopes = slopes_of(objective, sim)
            self.value += slopes.value
            reaction = slopes.reaction if numpy.any(slopes.reaction) else None
            return full(slopes.displacement, sim), reaction, float(slopes.energy)

        self.value = 0.0 if then is None else then.value
        self._sim, self._then, self._count = sim, then, last
        self._end = None if then is None else then._before(sim)
        self._slopes_at, self._tolerance = slopes_at, tolerance
        self._wanted = []  # [((model, parameter, per), directions, slopes)]
        found = self._sweep([entry for entry in wrt if not isinstance(entry, str)], moments)
        self.load = found["load"]
        self.loads = found["loads"] if moments else None
        self.motions = found["motions"] if moments else None
        self.initial_position = found["initial_position"]
        self.initial_velocity = found["initial_velocity"]
        self.initial_states = found["initial_states"]
        self._start_position = found["start_position"][:, :3]
        self.iterations = found["iterations"]

    def _sweep(self, entries, moments=False):
        """Backward over the run; keeps the derivatives by (model, parameter, per)."""
        sim = self._sim
        if sim._kept_steps() != self._count:
            raise RuntimeError("the simulation has left the run of this adjoint; take its adjoint() "
                               "again")
        asked = []
        for model, parameter, *per in entries:
            per = per[0] if per else None
            asked.append(((model, parameter, per), *directions_of(sim, model, parameter, per)))
        one = [d if d is not None and d.ndim == 1 else None for _, _, d in asked]
        found = sim._run_adjoint(
            self._slopes_at, self._tolerance,
            [(place, key[1], weights) for (key, place, _), weights in zip(asked, one)], moments,
            self._end)
        for (key, _, directions), slopes in zip(asked, found["parameters"]):
            if directions is not None:
                slopes = float(slopes[0]) if directions.ndim == 1 else directions @ slopes
            self._wanted.append((key, slopes))
        return found

    def _before(self, sim):
        """dJ/d(the state at the start) by the vertices that another simulation had, before a cut
        has split them."""
        now, then = self._sim._hexahedra(), sim._hexahedra()
        if now.shape != then.shape or self._sim.rest.shape < sim.rest.shape:
            raise ValueError("a run goes on with the same elements: start it with "
                             "restore(other.copy())")
        if not sim._is_implicit():
            raise ValueError("a cut changes the velocities of an explicit scheme, so a derivative "
                             "ends there; choose an implicit scheme")
        parents = numpy.empty(len(self._sim.rest), int)
        parents[now.ravel()] = then.ravel()
        if not numpy.array_equal(self._start_position, sim.position[parents]):
            raise ValueError("the run does not start where the other one has ended")
        return (*[_summed(slopes, parents, len(sim.rest))
                  for slopes in (self.initial_position, self.initial_velocity)],
                self.initial_states)

    @property
    def gravity(self):
        """dJ/dg, (3,): by an acceleration in all steps."""
        later = 0 if self._then is None else self._then.gravity
        return self._sim.mass @ self.load + later

    def gradient(self, model, parameter, per=None):
        """dJ/dp of a parameter of a model; per as in Adjoint.gradient(). One that was not named
        when the adjoint was taken costs another one."""
        def is_it(key):
            return key[:2] == (model, parameter) and numpy.array_equal(key[2], per)

        if not any(is_it(key) for key, _ in self._wanted):
            self._sweep([(model, parameter, per)])
        own = next(slopes for key, slopes in reversed(self._wanted) if is_it(key))
        return own if self._then is None else own + self._then.gradient(model, parameter, per)


def _summed(slopes, parents, count):
    """Of the vertices that each one became."""
    sums = numpy.zeros((count, 3))
    numpy.add.at(sums, parents, slopes)
    return sums
