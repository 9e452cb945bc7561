# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the compiled half of the package with CMake, and takes the kernel's modules and the
plugins into the package: suture/lib/suture, where the module looks for them.

The build folder is build/wheel of the repository. SUTURE_BUILD_FOLDER names another one, such as
that of ./dev build, in which little is left to compile.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parents[2]
FOLDER = Path(os.environ.get("SUTURE_BUILD_FOLDER", ROOT / "build" / "wheel")).resolve()


def version():
    return re.search(r"project\(Suture VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]


def cmake(*words):
    # What pip puts in front of the interpreter's own packages hides numpy's headers.
    environment = {key: value for key, value in os.environ.items()
                   if key not in ("PYTHONPATH", "PYTHONNOUSERSITE")}
    subprocess.run(["cmake", *map(str, words)], check=True, cwd=ROOT, env=environment)


class BuildWithCMake(build_ext):
    def build_extension(self, extension):
        if not (FOLDER / "CMakeCache.txt").exists():
            interpreter = getattr(sys, "_base_executable", sys.executable)  # of a venv
            cmake("--preset", "release", "-B", FOLDER, f"-DSUTURE_PYTHON={interpreter}",
                  "-DSUTURE_BUILD_TESTS=OFF", "-DSUTURE_BUILD_BENCH=OFF")
        cmake("--build", FOLDER, "--target", "suture_python")
        module = Path(self.get_ext_fullpath(extension.name))
        built = FOLDER / "python" / "suture" / module.name
        if not built.exists():
            raise SystemExit(f"{FOLDER} builds no module for this interpreter, {sys.executable} "
                             f"({module.name}); install python3-dev, python3-numpy and "
                             "pybind11-dev, or remove the folder")
        module.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(built, module)
        shutil.copytree(FOLDER / "lib" / "suture", module.parent / "lib" / "suture",
                        dirs_exist_ok=True)


for folder in ("setuptools", "egg"):
    (FOLDER / folder).mkdir(parents=True, exist_ok=True)
setup(
    version=version(),
    ext_modules=[Extension("suture._suture", sources=[])],
    cmdclass={"build_ext": BuildWithCMake},
    options={"build": {"build_base": str(FOLDER / "setuptools")},  # nothing beside the sources
             "egg_info": {"egg_base": str(FOLDER / "egg")}},
)
