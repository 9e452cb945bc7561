#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compiles sources by themselves that the release build compiles together, where one may use what only
another includes: each day one of TURNS shares (SUTURE_DAY, as ./dev test sets it). The preset dev builds all
of them so.

usage: alone.py BUILD
"""
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

TURNS = 40
SOURCE_OF_UNITY = re.compile(r'^#include "(.*)"$', re.MULTILINE)


def sources_and_commands(build):
    """Of each source that is compiled with others: its path, and the folder and options of its unit."""
    for unit in json.loads((build / "compile_commands.json").read_text()):
        if "/Unity/unity_" not in unit["file"]:
            continue
        sources = SOURCE_OF_UNITY.findall(pathlib.Path(unit["file"]).read_text())
        if len(sources) > 1:
            for source in sources:
                yield source, unit


def command_alone(source, unit):
    words = iter(shlex.split(unit["command"]))
    command = []
    for word in words:
        if word in ("-include", "-o"):  # precompiled headers hide what is missing
            next(words)
        elif word not in ("-c", "-Winvalid-pch", unit["file"]) and not word.endswith("ccache"):
            command.append(word)
    return command + ["-fsyntax-only", source]


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    turn = int(os.environ.get("SUTURE_DAY", "0")) % TURNS
    share = sorted(sources_and_commands(pathlib.Path(sys.argv[1])), key=lambda pair: pair[0])[turn::TURNS]
    if not share:
        sys.exit(f"no source is compiled with others in {sys.argv[1]}")
    bad = 0
    for source, unit in share:
        bad += subprocess.run(command_alone(source, unit), cwd=unit["directory"]).returncode != 0
    print(f"turn {turn} of {TURNS}: {len(share)} sources compiled by themselves, {bad} failed")
    sys.exit(bad > 0)


if __name__ == "__main__":
    main()
