# SPDX-License-Identifier: GPL-3.0-or-later
"""Processes that keep the experiments of a fit between its evaluations."""

import contextlib
import multiprocessing
import warnings

from . import _interrupts
from ._fit_run import Failed, NoDerivatives

# What the parent raises again; all else of a worker is a fault.
RAISED = {kind.__name__: kind for kind in (Failed, NoDerivatives, ValueError, OSError, KeyError)}


def _serve(experiments, pipe, others):
    """Answers until the parent closes the pipe. others: pipes that the fork has copied, too."""
    for other in others:
        other.close()
    warnings.simplefilter("ignore")  # the parent has shown those of the scene
    with contextlib.suppress(EOFError, ConnectionError, KeyboardInterrupt), _interrupts.taken():
        while True:
            method, arguments = pipe.recv()
            try:
                answer = None, [getattr(e, method)(*a) for e, a in zip(experiments, arguments)]
            except Exception as error:
                answer = type(error).__name__, str(error)
            pipe.send(answer)


class Workers:
    """Calls methods of experiments, in `jobs` processes. A context manager that ends them."""

    def __init__(self, experiments, jobs):
        self._experiments = experiments
        self._jobs = min(jobs, len(experiments))
        self._processes = []

    def __enter__(self):
        if self._jobs <= 1:
            return self
        try:
            for i in range(self._jobs):
                self._start(self._experiments[i::self._jobs])
        except BaseException:  # KeyboardInterrupt, too
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for process, pipe in self._processes:
            pipe.close()
            process.terminate()
            process.join()
        self._processes = []

    def _start(self, experiments):
        context = multiprocessing.get_context("fork")
        ours, theirs = context.Pipe()
        others = [ours, *(pipe for _, pipe in self._processes)]
        process = context.Process(target=_serve, args=(experiments, theirs, others), daemon=True)
        with _interrupts.delayed():
            process.start()
            self._processes.append((process, ours))
        theirs.close()

    def call(self, method, arguments):
        """The results of a method of each experiment, whose arguments are in a list."""
        if not self._processes:
            return [getattr(e, method)(*a) for e, a in zip(self._experiments, arguments)]
        for i, (_, pipe) in enumerate(self._processes):
            pipe.send((method, arguments[i::self._jobs]))
        answers = [self._answer(pipe) for _, pipe in self._processes]
        for name, text in answers:
            if name is not None:
                raise RAISED.get(name, RuntimeError)(text)
        results = [None] * len(self._experiments)
        for i, (_, found) in enumerate(answers):
            results[i::self._jobs] = found
        return results

    @staticmethod
    def _answer(pipe):
        try:
            return pipe.recv()
        except EOFError:
            return "RuntimeError", "a process of the fit ended early"
