#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What `suture schema` prints is a JSON schema that the scenes of docs satisfy and that mistakes do
not. Each object has the keys in it that the reader of scenes knows there, no more and no fewer. What
the keys mean is from docs/scene-format.md: `suture schema` ends with an error if a row of its tables
has no key in the schema.
usage: schema.py SUTURE SOURCES"""
import copy
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

try:
    from jsonschema import Draft202012Validator
except ImportError:
    print("no python3-jsonschema here")
    sys.exit(77)

program, sources = sys.argv[1], pathlib.Path(sys.argv[2])
schema = json.loads(subprocess.run([program, "schema"], check=True, capture_output=True).stdout)
Draft202012Validator.check_schema(schema)
validator = Draft202012Validator(schema)
problems = []


def without_comments(text):
    parts = re.compile(r'"(?:\\.|[^"\\])*"|//[^\n]*|/\*.*?\*/', re.S)
    return parts.sub(lambda m: m[0] if m[0][0] == '"' else " ", text)


docs = sources / "docs"
scenes = {str(file.relative_to(docs)): json.loads(without_comments(file.read_text()))
          for file in sorted(docs.glob("*/*.json")) if not file.stem.endswith("-fit")}  # a study
for name, scene in scenes.items():
    problems += [f"{name}: {error.json_path}: {error.message}" for error in validator.iter_errors(scene)]

mistakes = [
    (("gravty",), 1), (("models", 0, "parameters", "E"), -1), (("models", 0, "parameters", "Q"), 1),
    (("models", 0, "parameters"), {}), (("solver", "dt"), 0), (("solver", "integrator"), "newmrk"),
    (("mesh", "file"), "m.vtu"), (("constraints",), [{"fix": "xyz"}]),
    (("models", 0, "start"), {"mass": 1}), (("output",), True)]
beam = scenes["scenes/cut-beam.json"]
for path, value in mistakes:
    wrong = copy.deepcopy(beam)
    inner = wrong
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = value
    if validator.is_valid(wrong):
        problems.append(f"{'/'.join(map(str, path))} = {value} is accepted")


def kinds_of(node):
    """The schemas that a value may have: that of a node without references, and its alternatives."""
    while "$ref" in node:
        node = schema["$defs"][node["$ref"].rsplit("/", 1)[1]]
    inner = [kind for word in ("anyOf", "oneOf") for kind in node.get(word, [])]
    return [node] + [kind for each in inner for kind in kinds_of(each)]


def objects_of(value, kinds, path=""):
    """Each object of a scene whose keys the schema lists: (path, object, its schemas)."""
    if isinstance(value, list):
        for i, item in enumerate(value):
            inner = [kind for each in kinds if "items" in each for kind in kinds_of(each["items"])]
            yield from objects_of(item, inner, f"{path}/{i}")
    elif isinstance(value, dict):
        kinds = [kind for kind in kinds if "properties" in kind and not kind.get("additionalProperties", True)]
        if kinds:
            yield path, value, kinds
        for key, item in value.items():
            inner = [each["properties"][key] for each in kinds if key in each["properties"]]
            yield from objects_of(item, [kind for each in inner for kind in kinds_of(each)], f"{path}/{key}")


def report_on(name, scene):
    """The mistakes that the reader reports: [(path, text), ...]."""
    file = scratch / name
    file.unlink(missing_ok=True)
    file.write_text(json.dumps(scene))
    done = subprocess.run([program, "check", file], capture_output=True, text=True)
    return re.findall(r":\d+:\d+: (\S*): (.*)", done.stderr)


def read_keys(name, scene):
    """The keys that the reader knows in each object of a scene: {path: keys}. It lists them where it
    meets one that is like none of them."""
    wrong = copy.deepcopy(scene)
    for _, item, _ in list(objects_of(wrong, [schema])):
        item["q" * 24] = 0
    return {path.removesuffix("/" + "q" * 24): frozenset(re.findall(r"'(\$?[a-z_]+)'", text))
            for path, text in report_on(name, wrong) if "valid keys: " in text}


def beyond(kind):
    """A number that the schema just refuses, or None."""
    return (kind["exclusiveMinimum"] if "exclusiveMinimum" in kind else
            kind["exclusiveMaximum"] if "exclusiveMaximum" in kind else
            kind["minimum"] - 1 if "minimum" in kind else
            kind["maximum"] + 1 if "maximum" in kind else None)


def limits_of(scene):
    """Sets numbers beyond the limits of the schema: {path of such a number: what it is}."""
    changed = {}
    for path, item, kinds in list(objects_of(scene, [schema])):
        for key in item:
            for kind in [kind for each in kinds if key in each["properties"] for kind in kinds_of(each["properties"][key])]:
                if isinstance(item[key], (int, float)) and beyond(kind) is not None:
                    item[key] = beyond(kind)
                    changed[f"{path}/{key}"] = (frozenset(kinds[0]["properties"]), key)
    return changed


# What the scenes of docs do not contain. The reader looks at all of it, however little sense it makes.
rest = {
    "mesh": {"voxels": {}},
    "models": [{"model": "heat", "region": {"plane": {}}, "parameters": {}}],
    "fields": [{"field": "none of a model"}],
    "gravity": {"value": [0, 0, -9.81], "ramp": {"to": 1}},
    "constraints": [{"where": "all", "move": {"rotation": {}}}],
    "events": [{"when": {"where": "all"}, "cut": {"plane": {}}},
               {"cut": {"blade": {"obstacle": "tool", "resistance": {"toughness": {"regions": [{}]}}}}},
               {"every": 4, "remove_islands": {"outside": {"box": {}}}},
               {"at": 0, "grasp": {"obstacle": "tool"}}],
    "debris": {},
    "solver": {"sleep": {}, "budget": {}, "integrator": "implicit-euler"},
    "output": {"probes": {"at": [{"name": "tip"}]}},
    "checkpoint": {}}
known, refused = {}, {}
with tempfile.TemporaryDirectory() as folder:
    scratch = pathlib.Path(folder) / "docs"
    shutil.copytree(docs.resolve(), scratch, copy_function=os.symlink)
    for name, scene in (scenes | {"rest.json": rest}).items():
        kinds = {path: found for path, _, found in objects_of(scene, [schema])}
        for path, keys in read_keys(name, scene).items():
            listed = frozenset(key for kind in kinds[path] for key in kind["properties"])
            known[listed] = known.get(listed, frozenset()) | keys
        wrong = copy.deepcopy(scene)
        changed = limits_of(wrong)
        reported = {path for path, _ in report_on(name, wrong)}
        for path, what in changed.items():
            refused[what] = refused.get(what, False) or path in reported
problems += [f"reader and schema: only one of them knows {sorted(keys ^ read)}, beside {sorted(keys & read)}"
             for keys, read in known.items() if keys != read]
problems += [f"the reader accepts a number of '{key}' that the schema refuses"
             for (_, key), is_refused in refused.items() if not is_refused]

print("\n".join(problems) or f"schema: {len(scenes)} scenes, {len(known)} kinds of objects, {len(refused)} limits: good")
sys.exit(1 if problems else 0)
