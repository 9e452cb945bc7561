#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the tables of docs/stability.md from the rows of `test_stability`.

usage: stability.py FOLDER DOCS

FOLDER/stability holds one table of rows per family (SUTURE_STABILITY_OUT); without it, nothing is
done. What stands between `<!-- NAME -->` and `<!-- end of NAME -->` is replaced.
"""
import collections
import csv
import pathlib
import re
import sys

from report import table_text

VERDICTS = ["good", "held", "reported", "beyond the law", "known limit"]
SOLVERS = {"symplectic-euler": "Euler", "velocity-verlet": "Verlet",
           "implicit-euler": "implicit Euler", "newmark": "Newmark", "static": "static",
           "quasi-static": "quasi-static", "rest": "rest"}


def families(folder):
    """Rows by family, in the order of the files' first rows as the program made them."""
    files = sorted(folder.glob("*.csv"), key=lambda file: file.stat().st_mtime_ns)
    return {file.stem: list(csv.DictReader(file.open())) for file in files}


def counts(found):
    """How the runs of each family of loads ended."""
    rows, total = [], collections.Counter()
    for name, runs in found.items():
        if runs[0]["model"]:
            continue
        count = collections.Counter("known limit" if r["limit"] and r["verdict"].isupper()
                                    else r["verdict"] for r in runs)
        count["runs"] = len(runs)
        count["of 10,000 steps"] = sum(int(r["steps"]) >= 10_000 for r in runs)
        total += count
        rows.append((name, count))
    columns = ["runs", "of 10,000 steps", *VERDICTS]
    return table_text({"rows": [{"family": name, **{c: count[c] or "" for c in columns}}
                                for name, count in [*rows, ("all", total)]]})


def verdict_of(row):
    """In the words of the table."""
    return {"good": "right", "held": "right"}.get(row["verdict"], row["verdict"])


def cell(rows, notes):
    """The verdicts of one solver under one stress: the usual one, and the models with others."""
    groups = collections.defaultdict(list)
    for row in rows:
        groups[verdict_of(row)].append(row)
    nothing = groups.pop("-", [])
    if not groups:
        return "-" if nothing else ""
    usual = "right" if "right" in groups else max(groups, key=lambda v: len(groups[v]))
    parts = [usual + note(groups.pop(usual), notes)]
    for verdict, members in sorted(groups.items()):
        names = ", ".join(r["model"] for r in members)
        parts.append(f"{verdict}{note(members, notes)}: {names}")
    return "; ".join(parts)


def note(rows, notes):
    """The number of the message with which these runs ended, or nothing."""
    row = next((r for r in rows if r["reason"]), None)
    if row is None:
        return ""
    stress, text = row["case"].rsplit(".", 2)[0], shortened(row["reason"])
    key = (stress, verdict_of(row), re.sub(r"[^a-z ]", "", text)[:30])
    notes.setdefault(key, f"`{row['case']}`: {text}")
    return f" [{list(notes).index(key) + 1}]"


def shortened(reason):
    """The first words of the first message, without the time and paths of one machine."""
    text = re.sub(r"\s+", " ", reason.split("'/")[0])
    text = re.sub(r"^((step \d+, )?t = [\d.e+-]+ s: |/\S*\.json:[\d:]+ )| \(/\S*\.so\)", "", text)
    return text if len(text) <= 160 else text[:157] + "..."


def cells(found):
    """The table model x solver x stress, and the reasons of what is not right."""
    table, notes = [], {}
    for name, rows in found.items():
        if not rows[0]["model"]:
            continue
        what = next((r["title"] for r in rows if r["verdict"] != "-"), "")
        line = {"stress": f"`{name}`", "of": what, "compared with": rows[0]["law"]}
        for solver, title in SOLVERS.items():
            line[title] = cell([r for r in rows if r["solver"] == solver], notes)
        table.append(line)
    text = table_text({"rows": table})
    return text + "\n\n" + "\n".join(f"{i}. {n}" for i, n in enumerate(notes.values(), 1)) + "\n"


def replaced(text, name, table):
    begin, end = f"<!-- {name} -->", f"<!-- end of {name} -->"
    head, rest = text.split(begin)
    return f"{head}{begin}\n\n{table.rstrip()}\n\n{end}{rest.split(end)[1]}"


def main():
    folder, docs = pathlib.Path(sys.argv[1]) / "stability", pathlib.Path(sys.argv[2])
    if not folder.is_dir():
        return
    found = families(folder)
    text = pathlib.Path("docs/stability.md").read_text()
    text = replaced(text, "counts", counts(found))
    (docs / "stability.md").write_text(replaced(text, "cells", cells(found)))


if __name__ == "__main__":
    main()
