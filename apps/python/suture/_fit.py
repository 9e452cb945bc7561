# SPDX-License-Identifier: GPL-3.0-or-later
"""Fits parameters of a scene to measured data.

    python3 _start.py suture._fit STUDY.json [--jobs N]      what `suture fit` executes
"""

import argparse
import hashlib
import json
import os
import sys
import time
import warnings
from pathlib import Path

import numpy

from ._errors import exit_code_of_study
from ._fit_evaluation import STATE, Record, rho
from ._fit_field import fit_field
from ._fit_file import problem_of, read_fit
from ._fit_results import (FILE, FitResult, correlation_of, covariance_of, notes_of,
                           read_fit_result)
from ._fit_values import fit_values
from ._scene import to_json
from ._study_file import require_jobs

LEAST_MARGIN = 1e-9  # of the range, where the start is its end


def _key_of(problem):
    """What determines the result, but for how long the fit goes on."""
    from . import __version__

    parts = [__version__, problem.loss]
    for test in problem.tests:
        is_file = isinstance(test.scene, Path)
        scene = test.scene.read_text(errors="replace") if is_file else to_json(test.scene)
        parts += [scene, to_json(test.set), test.fingerprint,
                  to_json([test.labels, str(test.times), test.measured, test.deviation])]
    for unknown in problem.unknowns.all:
        parts.append(to_json([unknown.pointer, unknown.per, unknown.is_log, unknown.low,
                              unknown.high, unknown.regularise]))
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:16]


def _earlier(folder, key):
    """(q, outcome) of a fit of the same problem; (None, "") without one."""
    try:
        state = json.loads((folder / STATE).read_text())
        if state["key"] == key:
            return numpy.array(state["q"], float), state["outcome"]
    except (OSError, ValueError, KeyError):
        pass
    return None, ""


def _prepare(problem):
    """Reads the starts of the parameters, and checks that the scenes exist and have them."""
    from . import Simulation

    scenes = []
    for i, test in enumerate(problem.tests):
        if test.scene in scenes:
            continue
        sim = Simulation(test.scene, test.set)
        try:
            if scenes:
                problem.unknowns.require_same(sim, f"/data/{i}")
            else:
                problem.unknowns.prepare(sim)
        except KeyError as error:
            raise ValueError(f"/fit: {error.args[0]}") from None
        scenes.append(test.scene)
    _require_ends(problem)


def _require_ends(problem):
    """The scene takes both ends of each range."""
    from . import Error, Simulation

    test = problem.tests[0]
    for unknown in problem.unknowns.all:
        for end in (unknown.low, unknown.high):
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    if unknown.model is None:
                        Simulation(test.scene, {**test.set, unknown.pointer: end})
                    else:
                        sim = Simulation(test.scene, test.set)
                        sim.parameters[sim._models()[unknown.model]][unknown.parameter] = end
            except Error as error:
                raise ValueError(f"/fit: the range of {unknown.pointer!r} contains {end:g}, which "
                                 f"the scene refuses: {str(error).splitlines()[0]}") from None


def fit(scene, parameters, data, *, set=None, loss="linear", stop=None, folder=None, jobs=None,
        report=None):
    """Fit values of a scene to measured data; return a FitResult.

    scene       path, dict or JSON text; a test may have its own
    parameters  {pointer: {"range": [low, high], "log", "start", "per", "regularise"}}
    data        a list of tests: {"curve": file, "columns": {...}} or {"points": file}, with "set",
                "time", "deviation", "scene" and "name". A file may also be a dict of arrays in SI
                units. docs/fit.md explains both
    set         values for all tests
    loss        "linear", or one that outliers disturb less: "soft_l1", "huber", "cauchy"
    stop        {"evaluations": most, "tolerance": relative change of chi2 or of the values}
    folder      where the result is kept, and where a fit that was interrupted goes on
    jobs        processes at once (default: one per core)
    report      function (evaluation, chi2, values), called after each evaluation
    """
    study = {"scene": scene, "fit": parameters, "data": data, "set": set or {}, "loss": loss,
             "stop": stop or {}}
    return run_fit(problem_of(study, Path()), folder, jobs, report)


def run_fit(problem, folder=None, jobs=None, report=None):
    require_jobs(jobs)
    folder = None if folder is None else Path(folder).resolve()
    _prepare(problem)
    key = _key_of(problem) if folder else ""
    q, outcome = _earlier(folder, key) if folder else (None, "")
    if outcome == "converged" and (folder / FILE).exists():
        return read_fit_result(folder)
    if folder:
        folder.mkdir(parents=True, exist_ok=True)
    goes_on = q is not None
    if not goes_on:
        q = problem.unknowns.q_at(problem.unknowns.start)
    q = numpy.clip(q, LEAST_MARGIN, 1 - LEAST_MARGIN)
    began = time.monotonic()
    record = Record(problem, folder, key, report, goes_on)
    minimise = fit_field if problem.unknowns.is_field else fit_values
    outcome, reason = minimise(problem, q, jobs or os.cpu_count() or 1, record)
    result = _result_of(problem, record, outcome, reason, time.monotonic() - began)
    if folder:
        result.save(folder)
        record.save(outcome)
    return result


def _result_of(problem, record, outcome, reason, seconds):
    unknowns, best = problem.unknowns, record.best
    p = unknowns.p_at(best.q)
    errors, correlation, notes = {}, None, {}
    if best.jacobian is not None:
        slope = rho(problem.loss, best.residuals)[1]
        share = numpy.divide(slope, best.residuals, out=numpy.ones_like(slope),
                             where=best.residuals != 0)  # of outliers, little
        covariance = covariance_of(best.jacobian * numpy.sqrt(share)[:, None])
        if not problem.has_deviations:
            covariance *= best.chi2 / max(len(best.residuals) - unknowns.size, 1)
        spread = unknowns.slope(p) * numpy.sqrt(numpy.diag(covariance))
        errors = {unknown.pointer: _as_given(unknown, e) for unknown, e in unknowns.parts(spread)}
        correlation = correlation_of(covariance)
        notes = notes_of(unknowns.labels, best.q, covariance)
    return FitResult({
        "values": {unknown.pointer: _as_given(unknown, v) for unknown, v in unknowns.parts(p)},
        "fields": {unknown.pointer: unknown.mesh.as_dict() for unknown in unknowns.all
                   if unknown.per == "element"},
        "errors": errors, "names": unknowns.labels if correlation is not None else [],
        "correlation": correlation, "notes": notes, "chi2": best.chi2,
        "count": len(best.residuals), "has_deviations": problem.has_deviations,
        "outcome": outcome, "reason": reason, "evaluations": len(record.history),
        "history": record.history, "seconds": round(seconds, 3),
        "tests": [{"name": test.name, "labels": test.labels, "times": test.times,
                   "measured": test.measured, "fitted": values, "deviation": test.deviation}
                  for test, values in zip(problem.tests, best.values)]})


def _as_given(unknown, numbers):
    return float(numbers[0]) if unknown.groups is None else numbers


# ----------------------------------------------------------- the command line --


def _show(count, chi2, values):
    few = ", ".join(f"{v:.5g}" for v in values[:4]) + (", ..." if len(values) > 4 else "")
    print(f"evaluation {count}: chi2 = {chi2:.5g}, values {few}", file=sys.stderr, flush=True)


def _show_warning(message, *_):
    print(f"suture: warning: {message}", file=sys.stderr)


def main():
    parser = argparse.ArgumentParser("suture fit", description="Fit values to measured data.")
    parser.add_argument("study", help="JSON file: scene, fit, data, set, loss, stop, folder, jobs")
    parser.add_argument("--jobs", type=int, help="processes at once (default: one per core)")
    options = parser.parse_args()
    warnings.showwarning = _show_warning
    problem, folder, jobs = read_fit(options.study)
    result = run_fit(problem, folder, options.jobs or jobs, _show)
    for line in result.summary():
        print(line)
    print(folder / FILE)
    try:
        from ._plot import save

        save(result.plot(), folder / "fit.png")
    except ImportError:
        print("suture: no picture without python3-matplotlib", file=sys.stderr)
    return 0 if result.outcome == "converged" else 5


if __name__ == "__main__":
    sys.exit(exit_code_of_study(main, "fit"))
