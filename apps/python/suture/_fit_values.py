# SPDX-License-Identifier: GPL-3.0-or-later
"""Fits of a few numbers: Gauss-Newton steps in a trust region, with derivatives of equilibria or
differences of runs."""

import warnings

import numpy

from ._fit_evaluation import Evaluation, Record
from ._fit_run import Equilibria, Failed, Followed, NoDerivatives, Runs
from ._fit_workers import Workers

DIFFERENCE = 1e-3  # of the range
NO_EFFECT = 1e-6  # of the deviations, where a number goes through its range
FEW_TIMES = 5  # of a test, for a start
ROUGH = 1e-2  # tolerance of the start
SAME_SLOPES = 5e-3  # of the range: after shorter steps, derivatives are kept
FAILED = 10.0  # what a failed evaluation counts, as a multiple of the first one


class Derivatives:
    """Evaluates the tests by equilibria that are kept, or by runs whose derivatives are followed
    (kind). The times of a test of equilibria are shared between processes."""

    def __init__(self, problem, jobs, with_slopes=True, kind=Equilibria):
        self.problem = problem
        self._with_slopes = with_slopes
        shares = max(1, jobs // len(problem.tests)) if kind is Equilibria else 1
        self._chunks = [(t, slice(i, None, shares)) for t, test in enumerate(problem.tests)
                        for i in range(min(shares, len(test.times)))]
        self.workers = Workers([kind(problem.tests[t].rows(rows), problem.unknowns)
                                for t, rows in self._chunks], jobs)
        self._method = "start"
        self._slopes_at = None

    def at(self, q):
        unknowns = self.problem.unknowns
        p = unknowns.p_at(q)
        needs_slopes = self._needs_slopes(q)
        found = self.workers.call(self._method, [(p, needs_slopes)] * len(self._chunks))
        self._method = "evaluate"
        if needs_slopes:
            self._slopes_at = q
        values = [numpy.empty(test.measured.shape) for test in self.problem.tests]
        slopes = [numpy.empty((*test.measured.shape, unknowns.size if self._with_slopes else 0))
                  for test in self.problem.tests]
        for (t, rows), (value, slope) in zip(self._chunks, found):
            values[t][rows] = value
            if self._with_slopes:
                slopes[t][rows] = slope
        jacobian = None
        if self._with_slopes:
            jacobian = numpy.concatenate(
                [(s / t.deviation[..., None]).reshape(-1, unknowns.size)
                 for s, t in zip(slopes, self.problem.tests)]) * unknowns.slope(p)
        return Evaluation(q, values, self.problem, jacobian)

    def _needs_slopes(self, q):
        if not self._with_slopes or self._slopes_at is None:
            return self._with_slopes
        return abs(q - self._slopes_at).max() >= SAME_SLOPES

    def gradient(self, q, weights):
        """The derivative by q of the sum of weights times values; weights: of each test, (m, k)."""
        p = self.problem.unknowns.p_at(q)
        found = self.workers.call("gradient", [(p, weights[t][rows]) for t, rows in self._chunks])
        return sum(found) * self.problem.unknowns.slope(p)


class Differences:
    """Evaluates the tests by whole runs: one at q, and one with each number changed."""

    def __init__(self, problem, jobs):
        self.problem = problem
        self._count = problem.unknowns.size + 1
        self.workers = Workers([Runs(test, problem.unknowns)
                                for test in problem.tests for _ in range(self._count)], jobs)

    def at(self, q):
        steps = numpy.where(q + DIFFERENCE < 1, DIFFERENCE, -DIFFERENCE)
        places = [q, *(q + numpy.diag(steps))]
        arguments = [(self.problem.unknowns.p_at(place), False) for place in places]
        found = [values for values, _ in
                 self.workers.call("start", arguments * len(self.problem.tests))]
        tests = [found[i:i + self._count] for i in range(0, len(found), self._count)]
        columns = [Evaluation(q, [values[i] for values in tests], self.problem).residuals
                   for i in range(self._count)]
        jacobian = (numpy.array(columns[1:]) - columns[0]).T / steps
        return Evaluation(q, [values[0] for values in tests], self.problem, jacobian)


def no_effect(name):
    """The text of a mistake."""
    return (f"/fit: {name} has no effect on the data of any test; leave it out, or add a test that "
            "depends on it")


def require_effect(evaluation, names):
    """Raises ValueError for a number that changes nothing."""
    for name, column in zip(names, evaluation.jacobian.T):
        if abs(column).max() < NO_EFFECT:
            raise ValueError(no_effect(name))


def start_at(method, problem, q):
    """The first evaluation. If the body has no equilibrium at the start, the ends of the ranges
    are tried, to say more."""
    try:
        return method.at(q)
    except Failed as error:
        why = str(error)
    names = ", ".join(unknown.pointer for unknown in problem.unknowns.all)
    for end in (0.999, 0.001):
        try:
            method.at(numpy.full_like(q, end))
        except Failed:
            continue
        values = problem.unknowns.p_at(numpy.full_like(q, end))
        raise ValueError(f"/fit: the run at the start of {names} fails ({why}); it succeeds at the "
                         f"{'upper' if end > 0.5 else 'lower'} ends of the ranges: start near "
                         f"{', '.join(f'{v:.4g}' for v in values[:4])}")
    raise ValueError(f"/fit: the ranges of {names} exclude every stable body: the runs at the "
                     f"start and at both ends fail; at the start: {why}")


class _Converged(Exception):
    """The next evaluation would change nothing."""


class _Cached:
    """An evaluation per q, as SciPy asks for residuals and derivatives one after the other."""

    def __init__(self, method, record):
        self._method, self._record = method, record
        self._loss, self._little = record.problem.loss, record.problem.tolerance
        self._last = None

    def at(self, q):
        if self._last is None or not numpy.array_equal(self._last.q, q):
            if self._promises_little(q):
                raise _Converged
            self._last = self._method.at(q)
            self._record.add(self._last)
        return self._last

    def _promises_little(self, q):
        """Whether the linear model expects chi2 to stay as it is where the optimiser goes from the
        best place."""
        best = self._record.best
        if self._loss != "linear" or best is not self._last or len(self._record.history) < 2:
            return False
        expected = best.residuals + best.jacobian @ (q - best.q)
        return best.chi2 - expected @ expected < self._little * best.chi2

    def residuals(self, q):
        try:
            return self.at(q).residuals
        except Failed:
            self._record.add_failure()
            return FAILED * self._worst

    def jacobian(self, q):
        return self.at(q).jacobian

    def keep(self, first):
        self._last = first
        self._worst = abs(first.residuals) + 1
        self._record.add(first)


def _least_squares(problem, q, method, record):
    import scipy.optimize

    with method.workers:
        cached = _Cached(method, record)
        first = start_at(method, problem, q)
        require_effect(first, problem.unknowns.labels)
        cached.keep(first)
        try:
            found = scipy.optimize.least_squares(
                cached.residuals, q, cached.jacobian, bounds=(0, 1), x_scale="jac",
                loss=problem.loss, ftol=10 * problem.tolerance, xtol=problem.tolerance, gtol=1e-12,
                max_nfev=problem.most_evaluations)
        except _Converged:
            return "converged", "chi2 can no longer change"
    reasons = {1: "the gradient is zero", 2: "chi2 no longer changes",
               3: "the values no longer change", 4: "neither chi2 nor the values change"}
    if found.status in reasons:
        return "converged", reasons[found.status]
    return "stopped", f"{problem.most_evaluations} evaluations, as /stop allows"


def _some_times(test):
    """A few of the times of a test, evenly spread, with the last one."""
    places = numpy.linspace(0, len(test.times) - 1, FEW_TIMES + 1).round().astype(int)[1:]
    return test.rows(numpy.argsort(test.times)[places])


def _better_start(problem, q, jobs):
    """Fits a few of the times roughly: the first steps need no more."""
    if min(len(test.times) for test in problem.tests) < 2 * FEW_TIMES:
        return q
    rough = problem._replace(tests=[_some_times(test) for test in problem.tests], tolerance=ROUGH)
    record = Record(rough)
    try:
        _least_squares(rough, q, Derivatives(rough, jobs), record)
    except ValueError:
        return q  # the whole fit says why
    return record.best.q


def fit_values(problem, q, jobs, record):
    """(outcome, reason)."""
    for kind in (Equilibria, Followed) if problem.unknowns.are_of_models else (Followed,):
        try:
            if kind is Equilibria and not record.goes_on:
                q = _better_start(problem, q, jobs)
            return _least_squares(problem, q, Derivatives(problem, jobs, kind=kind), record)
        except NoDerivatives as error:
            reason = str(error)
    warnings.warn(f"the fit uses differences of whole runs: {reason}", stacklevel=3)
    return _least_squares(problem, q, Differences(problem, jobs), record)
