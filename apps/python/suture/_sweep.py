# SPDX-License-Identifier: GPL-3.0-or-later
"""Studies: many runs of one scene with other values, one process per run.

    python3 _start.py suture._sweep STUDY.json      what `suture sweep` executes
"""

import argparse
import csv
import hashlib
import io
import itertools
import json
import math
import multiprocessing
import os
import re
import sys
import time
import traceback
import warnings
from multiprocessing import connection
from pathlib import Path

from . import _interrupts
from ._errors import exit_code_of_study
from ._results import TABLES
from ._scene import is_text, set_texts, source_of, to_json
from ._study_file import is_number, is_whole, read_study, require_count, require_jobs
from ._study_results import Results, run_folder, series_rows


def _require_pointers(parameters, where):
    for pointer in parameters:
        if not (isinstance(pointer, str) and pointer.startswith("/")):
            raise ValueError(f"{where}: {pointer!r} must be a JSON pointer into the scene, such as "
                             "'/models/0/parameters/E'")


def grid(parameters):
    """All combinations of {pointer: [values]}; the last parameter varies fastest."""
    _require_pointers(parameters, "grid")
    parameters = {pointer: list(values) for pointer, values in parameters.items()}
    require_count(math.prod(map(len, parameters.values())))
    return [dict(zip(parameters, values)) for values in itertools.product(*parameters.values())]


def latin_hypercube(ranges, runs, seed=0, log=()):
    """`runs` points in {pointer: (low, high)}: each of `runs` equal parts of every range (of its
    logarithm, for the pointers in `log`) is used once."""
    import numpy

    _require_pointers(ranges, "latin_hypercube")
    if not is_whole(runs, 1):
        raise ValueError(f"latin_hypercube: runs must be a whole number >= 1, is {runs!r}")
    require_count(runs)
    unknown = [pointer for pointer in log if pointer not in list(ranges)]
    if unknown:
        raise ValueError(f"latin_hypercube: log names {sorted(map(str, unknown))}, which have no "
                         "range")
    random = numpy.random.default_rng(seed)
    columns = {}
    for pointer, (low, high) in ranges.items():
        if not (is_number(low) and is_number(high) and low < high):
            raise ValueError(f"latin_hypercube: the range of {pointer} must be two numbers, low < "
                             f"high; is {[low, high]}")
        if pointer in log and low <= 0:
            raise ValueError(f"latin_hypercube: the logarithmic range of {pointer} must be > 0")
        part = (random.permutation(runs) + random.random(runs)) / runs
        if pointer in log:
            columns[pointer] = low * (high / low) ** part
        else:
            columns[pointer] = low + (high - low) * part
    return [{pointer: float(values[i]) for pointer, values in columns.items()}
            for i in range(runs)]


def _points(parameters):
    """The list of values of each run: a dict is a grid, anything else a list of dicts."""
    points = grid(parameters) if isinstance(parameters, dict) else [dict(p) for p in parameters]
    if not points:
        raise ValueError("the study has no run: give at least one value of every parameter")
    for point in points:
        _require_pointers(point, "parameters")
    return points


# -------------------------------------------------------------------- one run --


def write_whole(file, text):
    """The file appears complete or not at all."""
    part = file.with_name(f".{file.name}.{os.getpid()}")
    part.unlink(missing_ok=True)
    with open(part, "x", encoding="utf-8") as stream:  # follows no link
        stream.write(text)
    part.replace(file)


def _last_probes(folder):
    """The last row of probes.csv, if the scene has probes."""
    file = folder / "probes.csv"
    if not file.exists():
        return {}
    with open(file, newline="") as table:
        header, *rows = csv.reader(table)
    last = rows[-1] if rows else []
    return {name: float(value) for name, value in list(zip(header, last))[2:]}


def _text_of_code(code):
    """What a function does, wherever it stands in its file."""
    constants = [_text_of_code(c) if hasattr(c, "co_code") else repr(c) for c in code.co_consts]
    return " ".join([code.co_code.hex(), *code.co_names, *constants])


class _Study:
    def __init__(self, scene, points, sets, folder, measure, output):
        self.points = points
        self.folder = Path(folder)
        self.measure = measure
        self.output = output
        self.mesh = None
        # One thread per run: the runs are what is parallel.
        self.sets = {"/solver/threads": 1, **(sets or {})}
        _require_pointers(self.sets, "set")
        is_file = not isinstance(scene, dict) and not is_text(scene)
        self.scene = Path(scene).resolve() if is_file else scene
        if is_file:
            self.text = self.scene.read_text(encoding="utf-8", errors="replace")  # for the key
        else:
            self.text = scene if isinstance(scene, str) else to_json(scene)

    def run_folder(self, number):
        return run_folder(self.folder, number)

    def require_no_links(self, numbers):
        """A study may come from a stranger, with its folder."""
        for folder in (self.folder / "runs", *map(self.run_folder, numbers)):
            if folder.is_symlink():
                raise OSError(f"{folder}: is a link, and a study writes below its own folder only; "
                              "remove the link")

    def read_mesh(self, number):
        """Reads the mesh of a run, for all that have the same."""
        from . import Error, _suture

        text, file, is_text = source_of(self.scene, self._base())
        try:
            self.mesh = _suture.read_mesh(text, file, is_text,
                                          set_texts({**self.sets, **self.points[number]}))
        except Error:
            pass  # the run says why

    def _base(self):
        return None if isinstance(self.scene, Path) else os.getcwd()

    def key(self, number):
        """What determines the results of a run, except for functions that `measure` calls."""
        from . import __version__

        parts = [__version__, self.text, to_json(self.sets), to_json(self.points[number]),
                 _text_of_code(self.measure.__code__) if hasattr(self.measure, "__code__") else "",
                 str(self.output)]
        return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:16]

    def result(self, number):
        """The result of a run, or None."""
        try:
            result = json.loads((self.run_folder(number) / "result.json").read_text())
        except (OSError, ValueError):
            return None
        return result if result.get("key") == self.key(number) else None

    def is_finished(self, number):
        """True unless the run has to be made, as a function that failed may have been mended."""
        result = self.result(number)
        return result is not None and not result.get("again")

    def run(self, number):
        """Makes a run and writes its result. The working folder becomes that of the study."""
        from . import Error, __version__

        folder = self.run_folder(number)
        folder.mkdir(parents=True, exist_ok=True)
        for table in TABLES:  # of an earlier scene, which this one may not write
            (folder / table).unlink(missing_ok=True)
        result = {"key": self.key(number), "suture": __version__}
        start = time.monotonic()
        with warnings.catch_warnings(record=True) as caught:  # reported together at the end
            warnings.simplefilter("always")
            try:
                self._simulate(number, folder, result)
            except Error as error:
                result.update(outcome="failed", error=str(error))
            except Exception as error:
                if self.measure is not None:  # whose author wants to see where
                    traceback.print_exc()
                result.update(outcome="failed", error=f"{type(error).__name__}: {error}",
                              again=True)
        result["seconds"] = round(time.monotonic() - start, 3)
        result["warnings"] = [str(warning.message) for warning in caught]
        write_whole(folder / "result.json", to_json(result, indent=1))

    def _simulate(self, number, folder, result):
        from . import Simulation

        base = self._base()
        sets = {**self.sets, **self.points[number]}
        os.chdir(self.folder)
        sim = Simulation(self.scene, sets, output=self.output and folder, folder=base,
                         mesh=self.mesh)
        result["scene_hash"] = sim.hash
        if self.measure is None:
            sim.run()
            values = sim.energies()
        else:
            values = dict(self.measure(sim))
        values.update(_last_probes(folder) if sim._writes else {})
        result.update(outcome=sim.outcome or "stopped", steps=sim.steps, time=sim.time,
                      values=json.loads(to_json(values)))

    def row(self, number):
        result = self.result(number) or {"outcome": "failed", "error": "the process ended early"}
        values = result.pop("values", {})
        for internal in ("key", "again", "warnings"):
            result.pop(internal, None)
        return {"run": number, **self.points[number], **values, **result}


def _run_in_child(study, number):
    try:
        with _interrupts.taken():
            study.run(number)
    except KeyboardInterrupt:
        os._exit(130)


# ------------------------------------------------------------------ all runs --


def _run_all(study, numbers, jobs, report):
    """At most `jobs` processes at once; Ctrl-C ends them, and finished runs stay."""
    # Forked, so that functions of a notebook need not be importable.
    context = multiprocessing.get_context("fork")
    waiting, running, done = list(reversed(numbers)), {}, 0
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                process = context.Process(target=_run_in_child, args=(study, waiting.pop()))
                with _interrupts.delayed():
                    process.start()
                    running[process.sentinel] = process
            for sentinel in connection.wait(list(running)):
                running.pop(sentinel).join()
                done += 1
                report(done, len(numbers))
    finally:
        for process in running.values():
            process.terminate()
            process.join()


def _write_table(file, names, rows):
    text = io.StringIO()
    table = csv.DictWriter(text, names, lineterminator="\n")
    table.writeheader()
    table.writerows(rows)
    write_whole(file, text.getvalue())


def _write_tables(results):
    _write_table(results.file, results.columns, results.rows)
    probes = results.file.with_name("probes.csv")
    names, rows = series_rows(probes.parent, range(len(results)), probes.name)
    if names:
        _write_table(probes, names, rows)
    else:
        probes.unlink(missing_ok=True)
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        return
    columns = {name: [row.get(name) for row in results.rows] for name in results.columns}
    pyarrow.parquet.write_table(pyarrow.table(columns), results.file.with_suffix(".parquet"))


def _similar(texts):
    """Keep the first of the texts that differ in numbers only: "text (run 3, and 16 more)".
    `texts` are (run, text)."""
    found = {}
    for run, text in texts:
        found.setdefault(re.sub(r"\d[\d.e+-]*", "#", text), {}).setdefault(run, text)
    for runs in found.values():
        run, text = next(iter(runs.items()))
        yield f"{text} (run {run}" + (f", and {len(runs) - 1} more)" if len(runs) > 1 else ")")


def _warn_once(study, numbers):
    """One warning per text, however many runs had it."""
    for text in _similar((number, text) for number in numbers
                         for text in (study.result(number) or {}).get("warnings", [])):
        warnings.warn(text, stacklevel=3)


def sweep(scene, parameters, jobs=None, *, measure=None, set=None, folder="sweep", output=False,
          report=None):
    """Run a scene once for every point of a study; return the Results.

    scene       path, dict or JSON text
    parameters  {pointer: [values]} for all combinations, or a list of {pointer: value}, such as
                latin_hypercube() gives
    jobs        processes at once (default: one per core); every run has one thread
    measure     function of a Simulation that runs it and returns {name: value}; default: run to
                the end and return energies()
    set         values for all runs
    folder      where the study is kept: results.csv, results.parquet (with pyarrow), and
                runs/NNNN/result.json of every run. Runs that have a result are not repeated, unless
                the scene, the values or the code of `measure` changed, or `measure` failed
    output      True: each run writes its frames and tables to its folder. The last row of its
                probes.csv is part of its results; the rows of all runs are in probes.csv of the
                study, and in results.series()
    report      function (done, all), called after every run

    A warning that several runs have is shown once.
    """
    require_jobs(jobs)
    points = _points(parameters)
    study = _Study(scene, points, set, Path(folder).resolve(), measure, output)
    missing = [i for i in range(len(points)) if not study.is_finished(i)]
    study.require_no_links(missing)
    if missing:
        study.read_mesh(missing[0])
    _run_all(study, missing, jobs or os.cpu_count() or 1, report or (lambda done, every: None))
    results = Results([study.row(i) for i in range(len(points))], study.folder / "results.csv")
    study.folder.mkdir(parents=True, exist_ok=True)
    _write_tables(results)
    _warn_once(study, missing)
    return results


# ----------------------------------------------------------- the command line --

_job = """#!/bin/bash
#SBATCH --job-name={name}
#SBATCH --array=0-{last}
#SBATCH --cpus-per-task=1
# On a cluster: sbatch {script}
# On one machine: seq 0 {last} | parallel bash {script}
# Afterwards `suture sweep {study}` writes the table; it repeats nothing.
exec {command} --run "${{SLURM_ARRAY_TASK_ID:-$1}}"
"""


def _show(done, every):
    is_terminal = sys.stderr.isatty()
    sys.stderr.write(f"\r{done} of {every} runs" if is_terminal else
                     f"{done} of {every} runs\n" if done in (1, every) else "")
    if is_terminal and done == every:
        sys.stderr.write("\r\033[K")
    sys.stderr.flush()


def _show_warning(message, *_):
    print(f"suture: warning: {message}", file=sys.stderr)


def _arguments(words):
    parser = argparse.ArgumentParser("suture sweep", description="Run all runs of a study.")
    parser.add_argument("study", help="JSON file: scene, set, one of grid, list and "
                                      "latin_hypercube, folder, output, jobs")
    parser.add_argument("--jobs", type=int, help="processes at once (default: one per core)")
    parser.add_argument("--run", type=int, help="make this run only, from 0")
    parser.add_argument("--slurm", metavar="FILE",
                        help="write a job script for Slurm arrays and GNU parallel; run nothing")
    return parser.parse_args(words)


def _write_job(options, count, file):
    start = Path(__file__).with_name("_start.py")
    command = f"{sys.executable} {start} suture._sweep {Path(options.study).resolve()}"
    path = os.environ.get("PYTHONPATH")
    if path:
        command = f"env PYTHONPATH={path} {command}"
    write_whole(Path(file), _job.format(name=Path(options.study).stem, last=count - 1, script=file,
                                   study=options.study, command=command))


def main(words=None):
    options = _arguments(words)
    study = read_study(options.study, grid, latin_hypercube)
    count = len(study["parameters"])
    if options.slurm:
        _write_job(options, count, options.slurm)
        print(f"{count} runs; submit with: sbatch {options.slurm}")
        return 0
    if options.run is not None:
        if not 0 <= options.run < count:
            raise ValueError(f"--run {options.run}: the study has runs 0 to {count - 1}")
        one = _Study(study["scene"], study["parameters"], study["set"], study["folder"], None,
                     study["output"])
        one.require_no_links([options.run])
        if not one.is_finished(options.run):
            one.run(options.run)
        return 0
    require_jobs(options.jobs)
    study["jobs"] = options.jobs or study["jobs"]
    warnings.simplefilter("always")
    warnings.showwarning = _show_warning
    results = sweep(**study, report=_show)
    failed = [row for row in results.rows if row["outcome"] == "failed"]
    plural = "" if len(results) == 1 else "s"
    print(f"{len(results)} run{plural}, {len(failed)} failed; {results.file}")
    errors = [(row["run"], str(row["error"]).splitlines()[0]) for row in failed]
    for text in itertools.islice(_similar(errors), 10):
        print(f"  {text}")
    return 5 if failed else 0


if __name__ == "__main__":
    sys.exit(exit_code_of_study(main, "study"))
