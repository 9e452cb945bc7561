# SPDX-License-Identifier: GPL-3.0-or-later
"""The wheel: made by pip without a network, used in a virtual environment."""

import importlib.util
import os
import subprocess
import sys
import tempfile
import textwrap
import unittest
from pathlib import Path

import suture

SOURCE = Path(__file__).parents[2] / "apps" / "python"
BUILT = Path(suture.__file__).parents[2]


@unittest.skipUnless(all(importlib.util.find_spec(name) for name in
                         ("pip", "setuptools", "wheel", "venv")),
                     "python3-pip, python3-setuptools, python3-wheel or python3-venv is missing")
class Wheel(unittest.TestCase):
    def test_in_a_virtual_environment(self):
        program = textwrap.dedent("""
            import os, sys, suture
            assert suture.__file__.startswith(sys.prefix), suture.__file__
            scene = {
                "suture": 1,
                "mesh": {"box": {"size": [2, 1, 1], "cells": [4, 2, 2]}},
                "models": [{"model": "tm-faure", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1e3}}],
                "solver": {"dt": 1e-4, "end": 0.001},
                "output": {"fields": ["stress"]},
            }
            sim = suture.Simulation(scene, output="out")
            triangle = [[1, -9, -9], [1, 99, -9], [1, -9, 99]]
            assert sim.cut(surface=(triangle, [(0, 1, 2)])).faces_cut == 4
            sim.run()
            assert any(name.endswith(".vtu") for name in os.listdir("out"))
            loaded = {line.split()[-1] for line in open("/proc/self/maps") if "suture" in line}
            assert len(loaded) > 3, loaded  # the module, a plugin, modules for surfaces and frames
            assert all(name.startswith(sys.prefix) for name in loaded), loaded
        """)
        with tempfile.TemporaryDirectory() as folder:
            place = Path(folder).resolve() / "venv"
            environment = {key: value for key, value in os.environ.items()
                           if key not in ("PYTHONPATH", "SUTURE_PLUGIN_PATH")}
            environment["SUTURE_BUILD_FOLDER"] = str(BUILT)

            def call(*words):
                done = subprocess.run([str(word) for word in words], cwd=folder, env=environment,
                                      text=True, capture_output=True)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

            call(sys.executable, "-m", "venv", "--system-site-packages", "--without-pip", place)
            call(place / "bin" / "python", "-m", "pip", "install", "--no-index",
                 "--no-build-isolation", "--disable-pip-version-check", SOURCE)
            call(place / "bin" / "python", "-c", program)
        self.assertFalse((SOURCE / "build").exists())
        self.assertEqual(list(SOURCE.glob("*.egg-info")), [])


if __name__ == "__main__":
    unittest.main()
