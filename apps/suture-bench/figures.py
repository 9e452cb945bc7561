#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the figures of README.md from the tables of docs/benchmarks.md.

usage: figures.py ROOT [--check]

With --check, nothing is written. Exit code 1 if README.md has other figures than the tables, or
if the summary of docs/benchmarks.md differs from summary.md.in.
"""
import pathlib
import re
import sys

HEAD = "| on one core | Suture | others |\n"


class Tables:
    """The tables of a document by their names, **name**: rows of {column: cell}."""

    def __init__(self, document):
        self.rows = {}
        for name, lines in re.findall(r"^\*\*(.+?)\*\*.*\n\n((?:\|.*\n)+)", document, re.M):
            head, _, *body = ([cell.strip() for cell in line.strip()[1:-1].split("|")]
                              for line in lines.splitlines())
            self.rows[name] = [dict(zip(head, cells)) for cells in body]

    def numbers(self, name, column, **wanted):
        """The numbers of a column in the rows that have these cells."""
        if name not in self.rows:
            sys.exit(f"docs/benchmarks.md: there is no table '{name}'")
        rows = [row for row in self.rows[name] if wanted.items() <= row.items()]
        if not rows or not all(row.get(column) for row in rows):
            sys.exit(f"docs/benchmarks.md, table '{name}': there is no '{column}' where {wanted}")
        return [float(row[column].replace(",", "")) for row in rows]

    def number(self, name, column, **wanted):
        """The number in the last of these rows: sizes grow."""
        return self.numbers(name, column, **wanted)[-1]


def two_digits(value):
    return f"{float(f'{value:.2g}'):,.10g}"


def figures(tables):
    """The table of README.md."""
    step = tables.number("step tm-faure", "step ns/el", elements="4000")
    cut, cgal = (tables.number("cut", "median_us_per_face", method=method)
                 for method in ("Suture, tm-faure", "CGAL unsew<3>"))
    static, calculix = (tables.number("static", "with_mesh_s", case="A", elements="4000", element=element)
                        for element in ("trilinear", "C3D8"))
    in_time = tables.numbers("realtime, cut", "elements", **{"threads": "1", "frames missed": "0"})
    memory = tables.number("memory: tm-faure", "B/el")
    rows = [
        ("a step of `tm-faure`", f"{two_digits(1e3 / step)} million elements/s", ""),
        ("a cut, per face", f"{two_digits(cut)} us", f"CGAL {two_digits(cgal)} us"),
        ("a static equilibrium of 4,000 elements", f"{two_digits(static)} s", f"CalculiX {two_digits(calculix)} s"),
        ("real time, with a cut every 0.1 s", f"{max(in_time):,.0f} elements", ""),
        ("memory per element", f"{memory:.0f} B", ""),
    ]
    return HEAD + "|---|---|---|\n" + "".join(f"| {what} | {ours} | {f'{others} ' * bool(others)}|\n"
                                            for what, ours, others in rows)


def main():
    root, checks = pathlib.Path(sys.argv[1]), sys.argv[2:] == ["--check"]
    readme = root / "README.md"
    document, text = (root / "docs/benchmarks.md").read_text(), readme.read_text()
    table = re.compile(re.escape(HEAD) + r"(?:\|.*\n)+")
    if len(table.findall(text)) != 1:
        sys.exit(f"README.md: there must be one table with this head: {HEAD}")
    written = table.sub(lambda _: figures(Tables(document)), text)
    if not checks:
        readme.write_text(written)
        return
    if written != text:
        sys.exit("README.md has other figures than docs/benchmarks.md: run apps/suture-bench/figures.py .")
    summary = (root / "apps/suture-bench/summary.md.in").read_text()
    if f"\n{summary}\n## " not in document:
        sys.exit("the summary of docs/benchmarks.md differs from apps/suture-bench/summary.md.in")


if __name__ == "__main__":
    main()
