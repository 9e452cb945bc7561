#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make docs/accuracy.md and its plots from the output of `work_precision.py --json`.

usage: accuracy.py FOLDER DOCS

FOLDER holds work-precision.json; without it, nothing is done.
"""
import json
import pathlib
import sys

import matplotlib.pyplot as plt

from report import machine_text, save, table_text

HEAD = """# Accuracy: error against run time

Written by `./dev bench work-precision`. Each row is a whole process from start to exit (`suture run` of a scene that
writes one table, or `ccx`) on one thread: CPU time, user and system, the median of one to five runs. `relative_error` is
signed: (value - reference) / reference. Rows with `*` are on the Pareto front of their table: nothing else in it is both
faster and more accurate. Dashed in the plots.

"""

# What each accuracy of the tip may cost, CPU s: (error, asked, best of CalculiX on 2026-11-21).
ASKED = [(0.03, 0.009, 0.009), (0.01, 0.015, 0.060), (0.006, 0.02, 0.21), (0.003, 0.04, 1.5),
         (0.0015, 0.2, 15), (0.0006, 2, None)]

TAIL = """
## Where the comparison ends

- Models have different laws. At the full load and at a quarter of it (`A`, `A0.25`) the reference is the solution of
  St Venant and Kirchhoff's law, which is that of `tm-faure` and of CalculiX's `*ELASTIC`; springs follow another law
  at finite strain. At a thousandth of the load (`B`) all laws agree.
- At a quarter of the load, `mss-baudet` does not converge, with or without its correction: its lattice has motions that
  cost no energy and hourglasses under refinement. At a thousandth it does, without the correction to a wrong value.
  `mss-golec` has no such motions; its law, too, is another one at finite strain.
- The reference of `A` is an extrapolation along the smooth branch of solutions, -0.513 +- 0.0015 m: no limit of meshes is
  known there, the clamped edge is pressed together ever further under refinement. An error below 0.3 % in that table
  says nothing.
- References of CalculiX are extrapolated from its own finest quadratic meshes (`apps/suture-bench/work_precision.py
  build/bin --references`). Rows within the stated distance of the finest one say little; errors of CalculiX's quadratic elements
  have the sign that the extrapolation gives them.
- CalculiX takes a rotation in steps of 15 degrees, because it moves nodes along straight lines; Suture in steps of
  at most 45.
- The organ is the same body for all meshes: its 300 voxels are divided. The staircase of the voxels is part of it.
- Cook's membrane is the linear problem in plane strain with nu = 1/3; other versions of it in the literature (plane
  stress: 23.96 times the load over E; nu close to 1/2; finite strain) have other values.
- At the small load of the membrane, the rounding of positions leaves more than 1e-8 of the forces on 128x128 trilinear
  elements, so that this run ends without an equilibrium (exit code 5).
- Newton's method: Suture to 1e-8 of the forces, or to 1e-4 where a method says so; CalculiX to 0.5 %, its default.
- Graded meshes have cells that grow from the clamp to the tip by the factor named; CalculiX solves the same meshes.
- The errors of one to three elements over the height are not those of a series that converges: with the mean gradient,
  4x1x1 elements are closer to the reference than 8x2x2. The row of 3 % rests on such a mesh, for both programs.
- CalculiX prints displacements with seven digits.
"""


def points(rows):
    return [r["cpu_s"] for r in rows], [100 * abs(r["relative_error"]) for r in rows]


def series(rows):
    """Rows by program and method, uniform meshes apart from graded ones."""
    result = {}
    for row in rows:
        method = row["method"]
        if "graded" in row["mesh"] and "graded" not in method:
            method += ", graded"
        result.setdefault((row["program"], method), []).append(row)
    return result


def plot_case(name, rows, docs):
    rows = [r for r in rows if r["relative_error"]]
    plt.figure(figsize=(7.2, 4.4))
    for i, ((program, method), mine) in enumerate(series(rows).items()):
        style = "s:" if program == "CalculiX" else "o-"
        plt.loglog(*points(mine), style, color=plt.cm.tab20(i % 20), markersize=3, linewidth=1,
                   label=f"{program}: {method}")
    front = sorted((r for r in rows if r["front"]), key=lambda r: r["cpu_s"])
    plt.loglog(*points(front), "k--", linewidth=2, alpha=0.4, label="front")
    plt.title(name)
    plt.xlabel("CPU s of the whole process")
    plt.ylabel("error, %")
    plt.legend(fontsize=6, loc="center left", bbox_to_anchor=(1, 0.5))
    letters = "".join(c for c in name.lower() if c.isalnum() or c == " ")
    return save(docs, "work-" + letters.replace(" ", "-"))


def cheapest(rows, program, error):
    """The fastest row of a program within an error, or None."""
    good = [r for r in rows if r["program"] == program and r["relative_error"] is not None
            and abs(r["relative_error"]) <= error]
    return min(good, key=lambda r: r["cpu_s"], default=None)


def found_text(row):
    return "-" if row is None else f"{row['cpu_s']:.3g} ({row['method']}, {row['mesh']})"


def asked_text(rows):
    lines = ["| error | Suture, CPU s | asked | CalculiX, same run | CalculiX, 2026-11-21 |",
             "|---|---|---|---|---|"]
    for error, asked, before in ASKED:
        found = [found_text(cheapest(rows, program, error)) for program in ("Suture", "CalculiX")]
        lines.append(f"| {100 * error:g} % | {found[0]} | {asked:g} | {found[1]} | {before or '-'} |")
    return "\n".join(lines) + "\n"


def main():
    folder, docs = map(pathlib.Path, sys.argv[1:3])
    file = folder / "work-precision.json"
    if not file.exists():
        return
    data = json.loads(file.read_text())
    parts = [HEAD + machine_text(file, data["machine"])]
    for name, table in data["tables"].items():
        picture = plot_case(name, table["rows"], docs)
        parts.append(f"## {name[0].upper() + name[1:]}\n\nErrors are {table['note']}.\n\n![{name}]({picture})\n")
        if name == "cantilever A0.25":
            parts.append(asked_text(table["rows"]))
        short = [{k: v for k, v in row.items() if k != "case"} for row in table["rows"]]
        parts.append(table_text({"rows": short}) + "\n")
    (docs / "accuracy.md").write_text("\n".join(parts) + TAIL)
    print(f"wrote {docs / 'accuracy.md'}")


main()
