# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a module of this package as a program, whatever files are in the working folder.

    python3 _start.py suture._compare A B      what `suture compare` executes

`python3 -m` would look there first: a file json.py would be taken for Python's own.
"""

import os
import runpy
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path = [os.path.dirname(folder), *(path for path in sys.path if path != folder)]
del sys.argv[0]
runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
