# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the code of docs/python.md as it stands there, section by section."""

import os
import re
import tempfile
import unittest
import warnings
from pathlib import Path

TEXT = (Path(__file__).parents[2] / "docs" / "python.md").read_text()


def sections():
    """{heading: code}, with the lines where they are in the file."""
    found, heading, lines, is_code = {}, "", [], False
    for line in TEXT.splitlines():
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
        self.assertEqual(sum(heading.startswith("Example") for heading in sections()), 6)

    def run_section(self, heading):
        before = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("error", UserWarning)
                    exec(compile(sections()[heading], "docs/python.md", "exec"),
                         {"__name__": "example"})
            finally:
                os.chdir(before)


def _add(heading):
    name = "test_" + re.sub(r"\W+", "_", heading).lower()
    setattr(Documentation, name, lambda self: self.run_section(heading))


for _heading in sections():
    _add(_heading)

if __name__ == "__main__":
    unittest.main()
