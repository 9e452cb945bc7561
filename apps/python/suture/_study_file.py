# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the file of a study; every mistake is reported with its place in the file."""

import difflib
import json
import math
from pathlib import Path

KINDS = ("grid", "list", "latin_hypercube")
KEYS = ("scene", "set", *KINDS, "folder", "output", "jobs")
MOST_RUNS = 1_000_000


def name_of(value):
    """What a value of JSON is, for messages."""
    if value is None or isinstance(value, (bool, int, float, str)):
        return json.dumps(value)
    return "an object" if isinstance(value, dict) else f"an array of {len(value)}"


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def is_whole(value, least, most=math.inf):
    return isinstance(value, int) and not isinstance(value, bool) and least <= value <= most


def require_count(runs):
    if runs > MOST_RUNS:
        raise ValueError(f"the study has {runs:,} runs; at most {MOST_RUNS:,} are possible")


def require_jobs(jobs):
    if jobs is not None and not is_whole(jobs, 1):
        raise ValueError(f"jobs must be a whole number >= 1, is {name_of(jobs)}")


class Object:
    """An object of the file, with its path."""

    def __init__(self, value, path, keys):
        if not isinstance(value, dict):
            raise ValueError(f"{path or '/'}: must be an object, is {name_of(value)}")
        self.value, self.path = value, path
        for key in value:
            if keys is not None and key not in keys:
                near = difflib.get_close_matches(key, keys, 1)
                raise ValueError(f"{path}/{key}: unknown key {key!r}" + (
                    f" (did you mean {near[0]!r}?)" if near else f"; expected {', '.join(keys)}"))

    def take(self, key, default, is_good, expected):
        value = self.value.get(key, default)
        if key in self.value and not is_good(value):
            raise ValueError(f"{self.path}/{key}: must be {expected}, is {name_of(value)}")
        return value

    def require(self, key, is_good, expected):
        if key not in self.value:
            raise ValueError(f"{self.path or '/'}: {key!r} is missing: {expected}")
        return self.take(key, None, is_good, expected)


def is_object(value):
    return isinstance(value, dict)


def _is_list(value):
    return isinstance(value, list)


def _is_pointers(value):
    return isinstance(value, list) and all(isinstance(p, str) and p[:1] == "/" for p in value)


def pointer_values(value, path, is_good=None, expected=None):
    """An object whose keys are JSON pointers."""
    Object(value, path, None)
    for pointer, entry in value.items():
        if not pointer.startswith("/"):
            raise ValueError(f"{path}: {pointer!r} must be a JSON pointer into the scene, such as "
                             "'/models/0/parameters/E'")
        if is_good is not None and not is_good(entry):
            raise ValueError(f"{path}: {pointer!r} must have {expected}, has {name_of(entry)}")
    return value


def is_range(value):
    return (isinstance(value, list) and len(value) == 2 and all(map(is_number, value)) and
            value[0] < value[1])


def _grid(value, grid):
    pointer_values(value, "/grid", _is_list, "an array of values")
    require_count(math.prod(len(values) for values in value.values()))
    return grid(value)


def _list(value):
    if not isinstance(value, list):
        raise ValueError(f"/list: must be an array of points, is {name_of(value)}")
    require_count(len(value))
    return [pointer_values(point, f"/list/{i}") for i, point in enumerate(value)]


def _hypercube(value, latin_hypercube):
    cube = Object(value, "/latin_hypercube", ("ranges", "runs", "seed", "log"))
    ranges = cube.require("ranges", is_object, "an object {pointer: [low, high]}")
    pointer_values(ranges, "/latin_hypercube/ranges", is_range, "two numbers [low, high], low < high")
    expected = f"a whole number from 1 to {MOST_RUNS:,}"
    return latin_hypercube(ranges, cube.require("runs", lambda n: is_whole(n, 1, MOST_RUNS), expected),
                           cube.take("seed", 0, lambda n: is_whole(n, 0), "a whole number >= 0"),
                           cube.take("log", [], _is_pointers, "an array of JSON pointers"))


def results_folder(file, name):
    """The folder of the results. A study may come from a stranger: it writes beside itself only."""
    home = file.parent.resolve()
    folder = (home / name).resolve()
    if home not in folder.parents:
        raise ValueError(f"/folder: leads out of the folder of the study, {home}; name a folder "
                         "below it")
    return folder


def _no_constant(name):
    raise ValueError(f"{name} is no number of JSON")


def _once(pairs):
    values = dict(pairs)
    if len(values) != len(pairs):
        keys = [key for key, _ in pairs]
        raise ValueError(f"the key {next(k for k in keys if keys.count(k) > 1)!r} is given twice")
    return values


def parse(file):
    try:
        return json.loads(file.read_bytes(), parse_constant=_no_constant, object_pairs_hook=_once)
    except RecursionError:
        raise ValueError("is nested too deeply") from None


def _read(file, grid, latin_hypercube):
    study = Object(parse(file), "", KEYS)
    scene = study.require("scene", lambda s: isinstance(s, (str, dict)),
                          "the path of a scene, relative to the study, or a scene")
    given = [key for key in KINDS if key in study.value]
    if len(given) != 1:
        raise ValueError(f"give exactly one of 'grid', 'list' and 'latin_hypercube'; has "
                         f"{', '.join(given) or 'none'}")
    value = study.value[given[0]]
    try:
        points = {"grid": lambda: _grid(value, grid), "list": lambda: _list(value),
                  "latin_hypercube": lambda: _hypercube(value, latin_hypercube)}[given[0]]()
    except ValueError as error:
        text = str(error)
        raise ValueError(text if text.startswith("/") else f"/{given[0]}: {text}") from None
    name = study.take("folder", file.stem, lambda f: isinstance(f, str), "the name of a folder")
    return {"scene": file.parent / scene if isinstance(scene, str) else scene,
            "parameters": points,
            "set": pointer_values(study.take("set", {}, is_object, "an object {pointer: value}"), "/set"),
            "folder": results_folder(file, name),
            "output": study.take("output", True, lambda o: isinstance(o, bool), "true or false"),
            "jobs": study.take("jobs", None, lambda n: is_whole(n, 1), "a whole number >= 1")}


def read_study(file, grid, latin_hypercube):
    """The arguments of sweep() that a file gives. Raises ValueError for a mistake in it; the two
    functions make the points."""
    file = Path(file)
    try:
        return _read(file, grid, latin_hypercube)
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from None
