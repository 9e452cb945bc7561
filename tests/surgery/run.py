#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs random surgical scenes (scenes.py), and reports explicit and implicit ones apart.

    run.py PROGRAM [--first N] [--count N] [--full] [--jobs N] [--explicit SHARE] [--implicit SHARE] [--keep DIR]

A scene ends well if the program reaches its end, and in the last row of energies.csv the mass of the
body and of its debris is that of the first row to 1e-9 of it, and all numbers are finite. Otherwise
the line of the scene says what happened. The test fails if a smaller share than asked ends well, or
if any scene ends by a signal. With SUTURE_FULL=1, as with --full: 1,000 scenes of full size.
"""

import argparse
import collections
import csv
import math
import os
import resource
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import scenes  # noqa: E402

WORDS = ["not finite", "collapsed", "inverted", "passed through", "does not settle", "no solution", "tetrahedra",
         "alternates", "stable step"]


def run(program, arguments, limit):
    def set_limit():
        resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5))
    return subprocess.run([program, "run", "-q", "--threads", "1", *arguments], capture_output=True, text=True,
                          preexec_fn=set_limit)


def verdict(result, out):
    """"ok", or what happened."""
    lines = (result.stderr + result.stdout).strip().split("\n")
    if result.returncode in (-9, -24):
        return "slow", ""
    if result.returncode < 0:
        return f"signal {-result.returncode}", lines[-1]
    if result.returncode:
        error = next((line for line in lines if "error:" in line), lines[-1])
        return next((word for word in WORDS if word in error), f"exit {result.returncode}"), error
    with open(out / "energies.csv", newline="") as table:
        rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(table)]
    if not all(math.isfinite(value) for value in rows[-1].values()):
        return "not finite", "energies.csv"
    mass = [row["body mass [kg]"] + row["debris mass [kg]"] for row in (rows[0], rows[-1])]
    if abs(mass[1] - mass[0]) > 1e-9 * mass[0]:
        return "mass", f"{mass[0]} kg at first, {mass[1]} kg at last"
    return "ok", ""


def try_scene(arguments, seed, folder):
    info = scenes.scene(seed, folder, not arguments.full)
    out = folder / f"{seed}.out"
    limit = 600 if arguments.full else 60
    result = run(arguments.program, [str(folder / f"{seed}.json"), "-o", str(out)], limit)
    states = sorted(out.glob("checkpoint*")) if out.is_dir() else []
    if result.returncode == 0 and info["is_resumed"] and states:  # from the middle, to the same end
        again = run(arguments.program, ["--resume", str(states[0])], limit)
        if again.returncode:
            result = again
    what, why = verdict(result, out)
    if not arguments.keep:
        shutil.rmtree(out, ignore_errors=True)
    return seed, info, what, why


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=os.path.abspath)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--count", type=int)
    parser.add_argument("--full", action="store_true", default=os.environ.get("SUTURE_FULL") == "1")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--explicit", type=float, default=0)
    parser.add_argument("--implicit", type=float, default=0)
    parser.add_argument("--keep", type=Path)
    arguments = parser.parse_args()
    count = arguments.count or (1000 if arguments.full else 40)
    tallies = {"explicit": collections.Counter(), "implicit": collections.Counter()}
    with tempfile.TemporaryDirectory() as scratch, ThreadPoolExecutor(arguments.jobs) as pool:
        folder = arguments.keep or Path(scratch)
        folder.mkdir(exist_ok=True)
        seeds = range(arguments.first, arguments.first + count)
        for seed, info, what, why in pool.map(lambda s: try_scene(arguments, s, folder), seeds):
            tallies[info["run"]][what] += 1
            print(seed, what, info["kind"], info["law"], info["run"], "pieces" if info["pieces"] else "",
                  info["cuts"], "cuts", why[:250], flush=True)
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"{count} scenes, {spent.ru_utime + spent.ru_stime:.0f} s of processor time")
    fails = False
    for kind, tally in tallies.items():
        share = tally["ok"] / max(1, sum(tally.values()))
        print(f"{kind}: {100 * share:.1f} % end well", dict(tally))
        fails |= share < getattr(arguments, kind) or any(what.startswith("signal") for what in tally)
    sys.exit(1 if fails else 0)


if __name__ == "__main__":
    main()
