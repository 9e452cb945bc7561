# SPDX-License-Identifier: GPL-3.0-or-later
"""What a fit evaluates, and what it keeps of that."""

import numpy

from ._scene import to_json
from ._sweep import write_whole

STATE = "fit-state.json"


def rho(loss, residuals):
    """(sum of the losses / 2, its derivative), as SciPy defines them."""
    z = residuals**2
    if loss == "linear":
        return 0.5 * z.sum(), residuals
    if loss == "soft_l1":
        root = numpy.sqrt(1 + z)
        return (root - 1).sum(), residuals / root
    if loss == "huber":
        size = numpy.maximum(abs(residuals), 1)
        return 0.5 * numpy.where(z > 1, 2 * size - 1, z).sum(), residuals / size
    return 0.5 * numpy.log1p(z).sum(), residuals / (1 + z)


class Evaluation:
    """All tests at q: residuals / deviations, and their derivatives by q (None for fields)."""

    def __init__(self, q, values, problem, jacobian=None):
        self.q = q
        self.values = values  # of each test, (m, k)
        self.residuals = numpy.concatenate(
            [((v - t.measured) / t.deviation).ravel() for v, t in zip(values, problem.tests)])
        self.jacobian = jacobian
        self.chi2 = float(self.residuals @ self.residuals)


class Record:
    """What happens from evaluation to evaluation: the best one is kept, and reported."""

    def __init__(self, problem, folder=None, key="", report=None, goes_on=False):
        self.problem = problem
        self.goes_on = goes_on  # from an earlier fit
        self.best = None
        self.history = []
        self._least = numpy.inf
        self._folder, self._key, self._report = folder, key, report

    def add(self, evaluation, cost=None):
        """cost: what is minimised, if it is more than the loss."""
        cost = rho(self.problem.loss, evaluation.residuals)[0] if cost is None else cost
        self.history.append(evaluation.chi2)
        if cost < self._least:
            self._least, self.best = cost, evaluation
            self.save("")
        if self._report:
            self._report(len(self.history), evaluation.chi2,
                         self.problem.unknowns.p_at(evaluation.q))

    def add_failure(self):
        self.history.append(numpy.inf)

    def save(self, outcome):
        if self._folder is not None:
            write_whole(self._folder / STATE, to_json({"key": self._key, "outcome": outcome,
                                                         "q": self.best.q}))
