# SPDX-License-Identifier: GPL-3.0-or-later
"""What the benchmarks that are scripts share: processes with their use of the machine, and reports as suture-bench
prints and writes them."""
import csv
import dataclasses
import json
import math
import os
import pathlib
import resource
import subprocess
import tempfile
import time

UNKNOWN = math.nan  # in a report: no figure


@dataclasses.dataclass
class ProcessUse:
    """What a process took from its start to its end."""
    cpu: float  # s, user and system
    wall: float  # s
    peak_bytes: float  # NaN if it is below that of this process, with which the child begins
    code: int  # exit code; 128 + n if signal n ended it


def run_process(words, folder):
    """Runs a program silently in a folder."""
    begin = time.monotonic()
    child = subprocess.Popen([str(w) for w in words], cwd=folder, stdin=subprocess.DEVNULL,
                             stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, used = os.wait4(child.pid, 0)
    code = os.waitstatus_to_exitcode(status)
    child.returncode = code  # so that Popen does not wait for it again
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    peak = 1024 * used.ru_maxrss if used.ru_maxrss > 1.01 * own else UNKNOWN
    return ProcessUse(used.ru_utime + used.ru_stime, time.monotonic() - begin, peak,
                      code if code >= 0 else 128 - code)


def last_row(file):
    """Of a table that `suture run` wrote: texts by the names of the columns."""
    with open(file, encoding="ascii") as table:
        return list(csv.DictReader(table))[-1]


def written(value):
    """Four digits, as suture-bench shows them."""
    return value if isinstance(value, str) else f"{value:.4g}"


class Report:
    """Tables of figures, printed as they arise and kept for a JSON file, if one is named. `programs`: the folder of
    suture-bench, which knows the machine."""

    def __init__(self, file=None, programs=None):
        self.file = file
        self.machine = machine(programs) if file else None
        self.tables, self.rows, self.head = {}, None, None

    def begin(self, name, note):
        print(("\n" if self.tables else "") + f"{name}: {note}")
        self.rows, self.head = [], None
        self.tables[name] = {"note": note, "rows": self.rows}

    def add(self, row):
        """A dictionary by the names of the columns."""
        if list(row) != self.head:
            self.head = list(row)
            print("  ".join(f"{name:>10}" for name in row))
        print("  ".join(f"{written(v):>{max(len(n), 10)}}" for n, v in row.items()), flush=True)
        self.rows.append(row)

    def write_json(self):
        """As suture-bench does."""
        if self.file:
            write_tables(self.file, self.machine, self.tables)


def machine(programs):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "machine.json"
        subprocess.run([programs / "suture-bench", "machine", "--json", file], check=True)
        return json.loads(file.read_text())["machine"]


def write_tables(file, of_machine, tables):
    """A figure that is not known is null."""
    known = {name: {"note": table["note"], "rows": [
        {k: None if isinstance(v, float) and math.isnan(v) else v for k, v in row.items()}
        for row in table["rows"]]} for name, table in tables.items()}
    file.write_text(json.dumps({"machine": of_machine, "tables": known}, indent=2) + "\n")
