# SPDX-License-Identifier: GPL-3.0-or-later
"""Fits of fields, one value per element: L-BFGS-B with adjoints.

Data seldom determine a field, so differences of neighbours are added to what is minimised, with a
weight w. With the jump d of a field (of its logarithm, if it has one) across a face of area A,
between centroids at a distance h, in a body of volume V:

    tikhonov  w/2 sum A/h d^2 / V^(1/3)            smooth fields
    tv        w sum A (sqrt(d^2 + e^2) - e) / V^(2/3)    few jumps, between constant parts

Both keep their size when the mesh is refined.
"""

import numpy

from ._fit_evaluation import rho
from ._fit_mesh import FACES, cells_of, shared_faces, volumes_of
from ._fit_run import Failed, NoDerivatives
from ._fit_values import FAILED, NO_EFFECT, Derivatives, no_effect, start_at

CORNER = 0.02  # e, a jump that counts as none
FIRST_STEP = 0.05  # of the range: L-BFGS-B begins with a step as long as the gradient


class Neighbours:
    """Pairs of elements of a model that share a face at rest."""

    def __init__(self, sim, model):
        cells = cells_of(sim, model)
        corners = sim.rest[cells]
        shared = shared_faces(cells)
        self.pairs = shared // 6
        quads = corners[:, FACES].reshape(-1, 4, 3)[shared[:, 0]]
        area = 0.5 * numpy.linalg.norm(
            numpy.cross(quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1]), axis=1)
        centres = corners.mean(axis=1)
        distance = numpy.linalg.norm(centres[self.pairs[:, 0]] - centres[self.pairs[:, 1]], axis=1)
        size = volumes_of(corners).sum() ** (1 / 3)
        self.area = area / size**2
        self.stiffness = area / distance / size

    def penalty(self, kind, field):
        """(value, derivative) of the sum without its weight."""
        jump = field[self.pairs[:, 0]] - field[self.pairs[:, 1]]
        if kind == "tikhonov":
            value, slope = 0.5 * (self.stiffness * jump**2).sum(), self.stiffness * jump
        else:
            root = numpy.sqrt(jump**2 + CORNER**2)
            value, slope = (self.area * (root - CORNER)).sum(), self.area * jump / root
        count = len(field)
        return value, (numpy.bincount(self.pairs[:, 0], slope, count)
                       - numpy.bincount(self.pairs[:, 1], slope, count))


class _Objective:
    """Half the loss of the data, and the regularisation, with their derivative by q."""

    def __init__(self, problem, method, record, sim):
        self._problem, self._method, self._record = problem, method, record
        self._neighbours = {
            unknown: Neighbours(sim, unknown.model)
            for unknown in problem.unknowns.all if unknown.regularise}
        self._worst = None

    def __call__(self, q):
        try:
            evaluation = self._method.at(q)
            cost, of_data = self._of_data(q, evaluation)
        except Failed:
            self._record.add_failure()
            return self._worst, numpy.zeros_like(q)
        more, slope = self._of_fields(q)
        cost += more
        self._record.add(evaluation, cost)
        if self._worst is None:
            self._worst = FAILED * cost
            self._require_effect(of_data)
        return cost, of_data + slope

    def _require_effect(self, gradient):
        for unknown, slopes in self._problem.unknowns.parts(gradient):
            if abs(slopes).max() < NO_EFFECT:
                raise ValueError(no_effect(unknown.pointer))

    def _of_data(self, q, evaluation):
        cost, slope = rho(self._problem.loss, evaluation.residuals)
        weights, first = [], 0
        for test in self._problem.tests:
            part = slope[first:first + test.measured.size].reshape(test.measured.shape)
            weights.append(part / test.deviation)
            first += test.measured.size
        return cost, self._method.gradient(q, weights)

    def _of_fields(self, q):
        total, slopes = 0.0, []
        for unknown, numbers in self._problem.unknowns.parts(q):
            slopes.append(numpy.zeros_like(numbers))
            if unknown.regularise:
                (kind, weight), = unknown.regularise.items()
                unit = unknown.unit
                value, slope = self._neighbours[unknown].penalty(kind, unit * numbers)
                total += weight * value
                slopes[-1] = weight * unit * slope
        return total, numpy.concatenate(slopes)


def _unit(gradient):
    """The unit of q in which the first step is FIRST_STEP long."""
    return (FIRST_STEP / max(abs(gradient).max(), 1e-300)) ** 0.5


def fit_field(problem, q, jobs, record):
    """(outcome, reason)."""
    import scipy.optimize

    from . import Simulation

    if not problem.unknowns.are_of_models:
        raise ValueError("/fit: with a field, only parameters of models can be fitted")
    method = Derivatives(problem, jobs, with_slopes=False)
    sim = Simulation(problem.tests[0].scene, problem.tests[0].set)
    objective = _Objective(problem, method, record, sim)
    with method.workers:
        try:
            start_at(method, problem, q)
        except NoDerivatives as error:
            raise ValueError("/fit: a field needs derivatives, and there are none: "
                             f"{error}") from None
        unit = _unit(objective(q)[1])

        def scaled(y):
            cost, gradient = objective(y * unit)
            return cost, gradient * unit

        found = scipy.optimize.minimize(
            scaled, q / unit, jac=True, method="L-BFGS-B", bounds=[(0, 1 / unit)] * len(q),
            options={"maxfun": problem.most_evaluations, "maxiter": problem.most_evaluations,
                     "ftol": problem.tolerance, "gtol": 0, "maxcor": 20})
    if found.status == 0:
        return "converged", "what is minimised no longer changes"
    return "stopped", f"{problem.most_evaluations} evaluations, as /stop allows"
