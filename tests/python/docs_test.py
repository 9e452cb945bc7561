# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the code of the pages on Python as it stands there."""

import os
import re
import tempfile
import unittest
import warnings
from pathlib import Path

DOCS = Path(__file__).parents[2] / "docs"
FILES = ("python.md", "python-examples.md", "gradients.md")


def sections(file):
    """{heading: code}, with the lines where they are in the file."""
    found, heading, lines, is_code = {}, "", [], False
    for line in (DOCS / file).read_text().splitlines():
        if line.startswith("## "):
            heading = line[3:]
        is_fence = line.startswith("```")
        if is_fence:
            is_code = line == "```python"
        lines.append((heading, line if is_code and not is_fence else ""))
    for heading in dict.fromkeys(h for h, _ in lines):
        code = "\n".join(line if h == heading else "" for h, line in lines)
        if code.strip():
            found[heading] = code
    return found


class Documentation(unittest.TestCase):
    def test_there_are_six_examples(self):
        self.assertEqual(sum(heading.startswith("Example")
                             for heading in sections("python-examples.md")), 6)

    def run_section(self, file, heading):
        before = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("error", UserWarning)
                    exec(compile(sections(file)[heading], "docs/" + file, "exec"),
                         {"__name__": "example"})
            finally:
                os.chdir(before)


def _add(file, heading):
    name = "test_" + re.sub(r"\W+", "_", heading).lower()
    setattr(Documentation, name, lambda self: self.run_section(file, heading))


for _file in FILES:
    for _heading in sections(_file):
        _add(_file, _heading)

if __name__ == "__main__":
    unittest.main()
