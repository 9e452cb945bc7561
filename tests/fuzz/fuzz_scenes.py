#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes scenes at random, and checks and runs them.

    fuzz_scenes.py PROGRAM [--seed N] [--count N | --seconds S] [--only I] [--jobs N] [--found DIR]

Mutant i of a seed depends on both numbers only. It is a scene of docs/scenes or tests/fuzz/scenes,
made small, in which numbers became extreme, values changed their type, keys were dropped or
misspelled, and parts of other scenes were put in. `suture check` must answer it, and if it is
accepted, so must `suture run` for a few steps. These are findings: a signal, a report of a
sanitizer, an exit code that is not documented, an error without a message, a traceback, values in
tables that are not finite, and more than two minutes of processor time.
"""

import argparse
import copy
import csv
import itertools
import json
import math
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]
SOURCES = (TREE / "docs/scenes", TREE / "tests/fuzz/scenes")
CPU_SECONDS = 120
STEPS = 20
CODES = {0, 2, 3, 4, 5, 6}
MOST_ELEMENTS = 900
TOO_MANY_ELEMENTS = 178_956_970  # these are refused before anything is built

NUMBERS = [0, -0.0, 1, -1, 2, 0.5, 1e-3, 1e3, 5e-324, 1e-320, 1e-170, 1e-100, 1e-31, 1e-30, 1e-12,
           1e12, 1e30, 1.1e30, 1e77, 1e150, 1e300, 1.7e308, -1e-170, -1e150, -1.7e308, 255, 65536,
           2**31 - 1, 2**31, 2**32, 2**53, 2**63, 2**64 - 1, 2**64, 1e-5, 90, 360, -3]
VALUES = [None, True, False, "", "all", "xyz", "auto", "rest", "a\u0000b", "\u03bc/~1", [], {}, [0, 0, 0],
          [1, 0], [[]], {"set": "x0"}, {"set": "x1"}, {"ids": [0]}, {"nearest": [0, 0, 0]},
          {"to": 1e-3}, {"from": 1, "to": 0}, {"array": "E"}, 7, 0.25]
WORDS = ["tm-faure", "hooke", "corotational", "neo-hookean", "mooney-rivlin", "fibres", "visco",
         "mss-baudet", "mss-golec", "damage", "damage-springs", "volume", "cohesive", "tie", "x0", "x1", "y0", "z1",
         "displacement", "velocity", "stress", "reaction", "contact_force", "gap", "nodal_stress",
         "symplectic-euler", "velocity-verlet", "implicit-euler", "newmark", "xpbd", "penalty",
         "impulses", "mean-gradient", "trilinear", "deformed", "warn", "stop", "split", "hold",
         "arc-length", "../out", "/", ".", "knife.obj", "gmsh-sling.msh", "nowhere.obj"]
# What the scenes of the documentation do not show; each is put into the object at its path.
PARTS = [
    ("solver", {"integrator": "implicit-euler", "dt": 1e-3, "end": 1e-2}),
    ("solver", {"integrator": "newmark", "end": 1e-2}),
    ("solver", {"integrator": "velocity-verlet", "step_error": 1e-3, "end": 1e-2}),
    ("solver", {"static": {"frames": 2}, "end": 1}),
    ("solver", {"static": {"path": "arc-length"}}),
    ("solver", {"until": "rest", "end": 1e-2}),
    ("contact", {"pieces": True, "self": True, "friction": 0.3}),
    ("contact", {"obstacles": [{"name": "a", "box": {"min": [-1, -1, -1], "max": [1, -0.01, 1]}}]}),
    ("contact", {"law": "penalty", "obstacles": [
        {"name": "a", "sphere": {"centre": [0, -0.2, 0], "radius": 0.1}}]}),
    ("contact", {"obstacles": [
        {"name": "a", "path": [{"at": 0}, {"at": 0.1, "translation": [0, -0.01, 0], "angle": 9}],
         "axis": [0, 0, 1], "surface": {"file": "knife.obj", "translation": [0.1, 0.6, 0]},
         "coupling": {"mass": 0.1, "stiffness": 100}}]}),
    ("events", [{"at": 0, "pierce": {"where": {"ids": [0]}}},
                {"every": 2, "remove_islands": {"below": 2}}]),
    ("constraints", [{"move": {"translation": [0.01, 0, 0]}, "ramp": 0.01, "where": {"set": "x1"}}]),
    ("loads", [{"pressure": 100, "ramp": 0.01, "where": {"set": "y1"}},
               {"volume": 1e4, "where": "all"},
               {"force": [0, 1, 0], "where": {"nearest": [0, 0, 0]}}]),
    ("output", {"directory": "out", "every_steps": 3, "energies": {}, "tools": {}, "cuts": True,
                "obstacles": True, "probes": {"at": [{"name": "p", "point": [0, 0, 0]}]}}),
]


def without_comments(text):
    strings = r'"(?:\\.|[^"\\])*"'
    return re.sub(rf"({strings})|//[^\n]*|/\*.*?\*/", lambda m: m.group(1) or "", text, flags=re.S)


def small(scene):
    """The same with few elements, which still has what makes it special."""
    mesh = scene.get("mesh", {})
    if "box" in mesh:
        cells = mesh["box"]["cells"]
        mesh["box"]["cells"] = [max(1, round(n * min(1, 8 / max(cells)))) for n in cells]
    if "voxels" in mesh:
        mesh["voxels"]["layers"] = 1
    if "surface" in mesh:
        mesh.pop("edge", None)
        mesh["cells"] = 400
    return scene


def corpus():
    files = sorted(file for folder in SOURCES for file in folder.glob("*.json"))
    return [small(json.loads(without_comments(file.read_text()))) for file in files]


def elements_of(scene):
    """The number that a scene asks for, if that can be said; else 0."""
    try:
        mesh = scene["mesh"]
        if "box" in mesh:
            return math.prod(float(n) for n in mesh["box"]["cells"])
        if "surface" in mesh:
            return float(mesh["cells"])
        return float(mesh["voxels"].get("layers", 1)) * sum(map(len, mesh["voxels"]["rows"]))
    except (AttributeError, KeyError, OverflowError, TypeError, ValueError):
        return 0


# ------------------------------------------------------------------- mutation --


class Mutator:
    def __init__(self, scenes, seed, number):
        self.random = random.Random(f"{seed} {number}")
        self.scenes = scenes

    def mutant(self):
        while True:
            scene = copy.deepcopy(self.random.choice(self.scenes))
            for _ in range(self.random.choice((1, 1, 1, 2, 2, 3, 5))):
                self.change(scene)
            if not MOST_ELEMENTS < elements_of(scene) <= TOO_MANY_ELEMENTS:
                return scene

    def places(self, value, found=None):
        """(container, key) of everything inside."""
        found = [] if found is None else found
        keys = value.keys() if isinstance(value, dict) else range(len(value))
        for key in keys:
            found.append((value, key))
            if isinstance(value[key], (dict, list)):
                self.places(value[key], found)
        return found

    def change(self, scene):
        places = self.places(scene)
        if not places or self.random.random() < 0.2:
            return self.combine(scene)
        is_number = lambda v: isinstance(v, (int, float)) and not isinstance(v, bool)  # noqa: E731
        numbers = [p for p in places if is_number(p[0][p[1]])]
        if numbers and self.random.random() < 0.6:
            return self.change_number(*self.random.choice(numbers))
        self.random.choice((self.replace, self.drop, self.repeat, self.rename))(
            *self.random.choice(places))

    def change_number(self, container, key):
        value = container[key]
        way = self.random.random()
        if way < 0.6:
            container[key] = self.random.choice(NUMBERS)
        elif way < 0.75:
            container[key] = -value
        else:
            try:
                container[key] = value * 10 ** self.random.uniform(-6, 6)
            except OverflowError:
                container[key] = 0

    def replace(self, container, key):
        if isinstance(container[key], str) and self.random.random() < 0.7:
            container[key] = self.random.choice(WORDS)
        else:
            container[key] = copy.deepcopy(self.random.choice(VALUES))

    def drop(self, container, key):
        del container[key]

    def repeat(self, container, key):
        if isinstance(container, list):
            container.insert(self.random.randrange(len(container) + 1),
                             copy.deepcopy(container[key]))
        else:
            self.replace(container, key)

    def rename(self, container, key):
        if isinstance(container, dict):
            name = self.random.choice([key[:-1], key + "s", key.upper(), self.random.choice(WORDS)])
            container[name] = container.pop(key)
        else:
            container.reverse()

    def combine(self, scene):
        """A part of another scene, or one of PARTS, in the place of its own or behind it."""
        if self.random.random() < 0.5:
            key, part = self.random.choice(PARTS)
        else:
            other = self.random.choice(self.scenes)
            key = self.random.choice(list(other))
            part = other[key]
        part = copy.deepcopy(part)
        if isinstance(part, list) and isinstance(scene.get(key), list) and self.random.random() < 0.5:
            scene[key] += part
        else:
            scene[key] = part


# ----------------------------------------------------------------- one mutant --


class Finding(Exception):
    pass


def limit():
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS + 5))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def answer(program, folder, *words):
    """The exit code of the program; raises Finding for what it must not do."""
    done = subprocess.run([program, *words], cwd=folder, capture_output=True, text=True,
                          errors="replace", preexec_fn=limit)
    code, said = done.returncode, done.stdout + done.stderr
    shown = f"suture {' '.join(words)}: exit code {code}\n{said[-3000:]}"
    if code not in CODES or re.search("Traceback|Sanitizer|runtime error:|unexpected: ", said):
        raise Finding(shown)
    if code != 0 and not done.stderr.strip():
        raise Finding("no message: " + shown)
    return code


# A probe has no value once its nodes or elements are removed; recovered stresses have none where
# no model has a stress, and the gap none inside the body.
OFTEN_UNDEFINED = re.compile(r" (nodal_|principal_|gap|stress|von_mises|energy|damage|strain|hour)")


def check_tables(folder, scene):
    removes = "pierce" in json.dumps(scene) or "remove_islands" in json.dumps(scene)
    for file in folder.rglob("*.csv"):
        with open(file, newline="") as table:
            names, *rows = [*csv.reader(table)] or [[]]
        for row in rows:
            for name, text in zip(names, row, strict=True):
                value = float(text)
                undefined = math.isnan(value) and file.name == "probes.csv" and (
                    removes or OFTEN_UNDEFINED.search(name))
                if not math.isfinite(value) and not undefined:
                    raise Finding(f"{file.name}: {name} is {text} in the row of step {row[0]}")


def try_mutant(program, scene):
    """(code of check, code of run or None); raises Finding."""
    with tempfile.TemporaryDirectory(prefix="suture-fuzz-") as name:
        folder = Path(name)
        for file in SOURCES[0].iterdir():
            if file.suffix in (".obj", ".msh"):
                shutil.copy(file, folder)
        (folder / "s.json").write_text(json.dumps(scene))
        checked = answer(program, folder, "check", "s.json")
        if checked != 0:
            return checked, None
        sets = ["--set", f"/solver/max_steps={STEPS}"]
        ran = answer(program, folder, "-q", "run", "s.json", *sets)
        if ran in (0, 5):
            check_tables(folder, scene)
        return checked, ran


# ----------------------------------------------------------------- all of them --


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("--seed", type=int, default=random.randrange(10**6))
    parser.add_argument("--count", type=int, default=10000 if os.environ.get("SUTURE_FULL") else 60)
    parser.add_argument("--seconds", type=float, default=math.inf, help="begin no mutant later")
    parser.add_argument("--only", type=int, help="this mutant")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--found", type=Path, default=Path("found"), help="folder for findings")
    return parser.parse_args()


def main():
    options = arguments()
    scenes, end = corpus(), time.monotonic() + options.seconds
    program = options.program.resolve()
    codes, findings = {}, 0

    def attempt(number):
        if time.monotonic() > end:
            return None
        scene = Mutator(scenes, options.seed, number).mutant()
        try:
            return number, scene, try_mutant(program, scene), ""
        except Finding as finding:
            return number, scene, None, str(finding)

    numbers = range(options.count) if options.only is None else [options.only]
    print(f"seed {options.seed}", flush=True)
    with ThreadPoolExecutor(options.jobs) as pool:
        batches = (numbers[i:i + 100] for i in range(0, len(numbers), 100))
        results = (result for batch in batches for result in pool.map(attempt, batch))
        for number, scene, found, text in itertools.takewhile(bool, results):
            codes[found] = codes.get(found, 0) + 1
            if not text:
                continue
            findings += 1
            options.found.mkdir(parents=True, exist_ok=True)
            file = options.found / f"scene-{options.seed}-{number}.json"
            file.write_text(json.dumps(scene, indent=1))
            print(f"--- {file} (--seed {options.seed} --only {number})\n{text}", flush=True)
    total = sum(codes.values())
    print(f"{total} scenes, {findings} findings; exit codes of check and run: " + ", ".join(
        f"{key}: {count}" for key, count in sorted(codes.items(), key=lambda c: -c[1])))
    return 1 if findings or total == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
