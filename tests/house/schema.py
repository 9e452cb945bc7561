#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What `suture schema` prints is a JSON schema that the scenes of docs satisfy, that mistakes do
not, and that knows every key which the reader of scenes reads.
usage: schema.py SUTURE SOURCES"""
import copy
import json
import pathlib
import re
import subprocess
import sys

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


def properties_of(node):
    if isinstance(node, list):
        for item in node:
            yield from properties_of(item)
    elif isinstance(node, dict):
        yield from node.get("properties", {})
        for item in node.values():
            yield from properties_of(item)


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

read = re.compile(r'\b(?:find|require|require_vector|number|natural|boolean|string|choice|vector|'
                  r'read_direction|read_series)\((?:\w+, )?"([a-z_]+)"')
known = set(properties_of(schema))
for file in sorted((sources / "kernel/scene").glob("*.cpp")):
    problems += [f"{file.name}: key '{key}' is not in the schema"
                 for key in read.findall(file.read_text()) if key not in known]

print("\n".join(problems) or f"schema: {len(scenes)} scenes, {len(known)} keys: good")
sys.exit(1 if problems else 0)
