# SPDX-License-Identifier: GPL-3.0-or-later
"""Derivatives of runs of implicit steps."""

import numpy

from . import _suture
from ._gradients import full, gradient_by, slopes_of


class RunAdjoint:
    """The derivative of an objective of a run by everything that determines it, from
    Simulation.adjoint() after keep_steps(). Valid until the simulation goes on."""

    def __init__(self, sim, objective, tolerance, every_step):
        last = sim._kept_steps()

        def slopes_at(step):
            if step < last and not every_step:
                return None
            slopes = slopes_of(objective, sim)
            if numpy.any(slopes.reaction):
                raise _suture.InputError(
                    "there is no derivative of reactions by a run, but by an equilibrium; choose "
                    "an objective of displacements and the energy")
            self.value += slopes.value
            return full(slopes.displacement, sim), float(slopes.energy)

        self.value = 0.0
        self._sim = sim
        found = sim._run_adjoint(slopes_at, tolerance)
        self.loads = found[0]
        self._energies = found[1]
        self.initial_position = found[2]
        self.initial_velocity = found[3]
        self.iterations = found[4]

    @property
    def load(self):
        """dJ/d(a force on each vertex in all steps), (vertices, 3)."""
        return self.loads.sum(axis=0)

    @property
    def gravity(self):
        """dJ/dg, (3,): by an acceleration in all steps."""
        return self._sim.mass @ self.load

    def gradient(self, model, parameter, per=None):
        """dJ/dp of a parameter of a model; per as in Adjoint.gradient()."""
        sim, about = self._sim, (self.loads, self._energies)
        if self.loads.shape != (sim._kept_steps(), *sim.rest.shape):
            raise RuntimeError("the simulation has left the run of this adjoint; take its adjoint() "
                               "again")
        return gradient_by(
            sim, model, parameter, per,
            along=lambda place, weights: sim._run_gradient_along(place, parameter, *about, weights),
            each=lambda place: sim._run_gradient(place, parameter, *about))
