# SPDX-License-Identifier: GPL-3.0-or-later
"""What the benchmarks that are scripts share: processes with their use of the machine, and reports as suture-bench
prints and writes them."""
import argparse
import csv
import dataclasses
import json
import math
import os
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import time

UNKNOWN = math.nan  # in a report: no figure


class Failure(Exception):
    """Ends a script with its text, without a traceback."""


def run_script(main):
    """Runs a script. Where the user can do something, it ends with one message; one that is stopped leaves neither
    processes nor files behind."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    try:
        main()
    except (Failure, OSError) as error:
        sys.exit(f"{pathlib.Path(sys.argv[0]).name}: {error}")
    except KeyboardInterrupt:
        sys.exit(128 + signal.SIGINT)


@dataclasses.dataclass
class ProcessUse:
    """What a process took from its start to its end."""
    cpu: float  # s, user and system
    wall: float  # s
    peak_bytes: float  # NaN if it is below that of this process, with which the child begins
    code: int  # exit code; 128 + n if signal n ended it


def run_process(words, folder, log=os.devnull):
    """Runs a program in a folder; what it prints goes to the file `log`."""
    begin = time.monotonic()
    with open(log, "wb") as output:
        child = subprocess.Popen([str(w) for w in words], cwd=folder, stdin=subprocess.DEVNULL,
                                 stdout=output, stderr=output)
    try:
        _, status, used = os.wait4(child.pid, 0)
    except BaseException:  # the script is stopped
        child.kill()
        child.wait()
        raise
    code = os.waitstatus_to_exitcode(status)
    child.returncode = code  # so that Popen does not wait for it again
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    peak = 1024 * used.ru_maxrss if used.ru_maxrss > 1.01 * own else UNKNOWN
    return ProcessUse(used.ru_utime + used.ru_stime, time.monotonic() - begin, peak,
                      code if code >= 0 else 128 - code)


UNFIT = (2, 3, 4, 6)  # exit codes of `suture run`: the command, the scene, a plugin or a file is not as it should be


def run_scene(programs, scene, folder, name="out", level="-q"):
    """Runs `suture run` on a scene. Its results are in the folder `name` below `folder`, unless the scene wants none;
    what it prints is in `name`.log. Raises Failure if the scene cannot be run at all."""
    (folder / f"{name}.json").write_text(json.dumps(scene))
    log = folder / f"{name}.log"
    results = ["--output", name] if scene.get("output") is not False else []
    use = run_process([programs / "suture", "run", level, f"{name}.json", *results], folder, log)
    if use.code in UNFIT:
        raise Failure(f"a scene of this benchmark cannot be run (exit code {use.code}): {log.read_text().strip()}")
    return use


def probe_rows(file):
    """A table that `suture run` wrote: texts by the names of the columns, row by row."""
    with open(file, encoding="ascii") as table:
        return list(csv.DictReader(table))


def last_row(file):
    return probe_rows(file)[-1]


def written(value):
    """Four digits, as suture-bench shows them."""
    return value if isinstance(value, str) else f"{value:.4g}"


def folder_of_programs(text):
    folder = pathlib.Path(text).resolve()
    for name in ("suture", "suture-bench"):
        if not (folder / name).is_file():
            raise argparse.ArgumentTypeError(f"there is no program {name} in {folder}")
    return folder


def file_to_write(text):
    """Its folder is there before a run of hours begins."""
    file = pathlib.Path(text)
    if not file.absolute().parent.is_dir():
        raise argparse.ArgumentTypeError(f"there is no folder {file.parent}")
    return file


def positive(text):
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text} is not positive")
    return number


def option_parser(description):
    """Of a script: where the programs are, and --json."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=folder_of_programs, help="Folder of suture and suture-bench")
    parser.add_argument("--json", type=file_to_write, help="Write the figures to this file as well")
    return parser


def from_suture_bench(programs, *words):
    """The figures that suture-bench makes itself, as it writes them; it prints them, too. Ends the script as it ends
    if it fails: it has said why."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "figures.json"
        code = subprocess.run([programs / "suture-bench", *words, "--json", file], check=False).returncode
        if code != 0:
            sys.exit(code if code > 0 else 128 - code)
        return json.loads(file.read_text())


class Report:
    """Tables of figures, printed as they arise and kept for a JSON file, if one is named. `programs`: the folder of
    suture-bench, which knows the machine."""

    def __init__(self, file=None, programs=None):
        self.file = file
        self.machine = from_suture_bench(programs, "machine")["machine"] if file else None
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


def write_tables(file, of_machine, tables):
    """A figure that is not known is null, as is one that is not finite."""
    known = {name: {"note": table["note"], "rows": [
        {k: None if isinstance(v, float) and not math.isfinite(v) else v for k, v in row.items()}
        for row in table["rows"]]} for name, table in tables.items()}
    file.write_text(json.dumps({"machine": of_machine, "tables": known}, indent=2) + "\n")
