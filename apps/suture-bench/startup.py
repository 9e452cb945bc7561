#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How long the program takes from start to exit, before the parts of a start-up that `suture-bench startup` measures.
Other options are passed on.

    startup.py path/to/programs [--json FILE] [OPTIONS of suture-bench startup]
"""
import pathlib
import tempfile

from harness import (Failure, Report, from_suture_bench, option_parser, positive, run_scene, run_script,
                     write_tables)
from work_cases import Cells, Method, box_scene, held

# A block of cubes under gravity, one end held, for 10 steps.
BLOCK = {**box_scene(Cells((5, 2, 1)), (0.125, 0.05, 0.025),
                     Method("", "tm-faure", {}, {"end": 1e-3, "dt": 1e-4}, ()), E=1e5, nu=0.3, rho=1000),
         "gravity": (0, -9.8, 0), "constraints": [held("z0")]}


def best_time(options, output):
    """Seconds of `suture run` on the block, start to exit."""
    best = float("inf")
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(4 * options.rounds):
            use = run_scene(options.programs, {**BLOCK, "output": output}, pathlib.Path(folder))
            if use.code != 0:
                raise Failure(f"the run of the block stopped: exit code {use.code}")
            best = min(best, use.wall)
    return best


def main():
    parser = option_parser(__doc__)
    parser.add_argument("--rounds", type=positive, default=5, help="Repetitions")
    options, others = parser.parse_known_args()
    report = Report()
    report.begin("startup: the program", "suture run from start to exit, best wall-clock time")
    for name, output in {"none": False, "2 frames": {}}.items():
        report.add({"scene": "10 elements, 10 steps", "output": name, "ms": 1e3 * best_time(options, output)})
    data = from_suture_bench(options.programs, "startup", "--rounds", str(options.rounds), *others)
    if options.json:
        write_tables(options.json, data["machine"], {**report.tables, **data["tables"]})


run_script(main)
