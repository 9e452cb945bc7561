#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make docs/benchmarks.md and its plots from the output of suture-bench.

usage: report.py FOLDER DOCS NAME...

FOLDER holds NAME.json from `suture-bench NAME --json`, the commit in NAME.commit, and the time
that the benchmark took in NAME.seconds. Each
NAME becomes a section, in the order of SECTIONS; other sections stay as they are. To add a
section, add a line there, and a plot function if tables are not enough.
Runs with Debian's interpreter and python3-matplotlib.
"""
import json
import math
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

plt.rcParams.update({"figure.figsize": (6.4, 3.6), "figure.dpi": 90, "font.size": 9,
                     "axes.grid": True, "grid.alpha": 0.3, "legend.fontsize": 8,
                     "savefig.bbox": "tight"})


# ---------------------------------------------------------------- tables --

def shown(value):
    """Three or four significant digits; whole numbers without decimals."""
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    if value == int(value) and abs(value) < 1e15:
        return f"{int(value):,}" if abs(value) >= 10000 else str(int(value))
    if abs(value) >= 1000:
        return f"{value:,.0f}"
    return f"{value:.3g}"


def table_text(table):
    """A Markdown table; rows may have different sets of columns."""
    columns = list(dict.fromkeys(name for row in table["rows"] for name in row))
    lines = ["| " + " | ".join(columns) + " |", "|---" * len(columns) + "|"]
    for row in table["rows"]:
        lines.append("| " + " | ".join(shown(row.get(c)) for c in columns) + " |")
    return "\n".join(lines)


def column(table, name):
    return [row.get(name, math.nan) for row in table["rows"]]


# ----------------------------------------------------------------- plots --
# Each plots the tables of one file and returns the name of the picture, or None.

def save(docs, name):
    folder = docs / "images"
    folder.mkdir(exist_ok=True)
    plt.savefig(folder / f"bench-{name}.png")
    plt.close()
    return f"images/bench-{name}.png"


def plot_force(tables, docs):
    for name, table in tables.items():
        if "elements" in table["rows"][0]:
            plt.semilogx(column(table, "elements"), column(table, "force M el/s"), "o-", label=name,
                         markersize=3)
    plt.xlabel("elements")
    plt.ylabel("forces, M elements/s")
    plt.ylim(bottom=0)
    plt.legend()
    return save(docs, "force")


def plot_scaling(tables, docs):
    for i, (name, table) in enumerate(t for t in tables.items() if "sequential ms/step" in t[1]["rows"][0]):
        for kind, style in (("sequential", "--"), ("parallel", "-")):
            plt.loglog(column(table, "elements"), column(table, f"{kind} ms/step"), "o" + style,
                       color=f"C{i}", markersize=3, label=f"{name.split(': ')[1]}, {kind}")
    plt.xlabel("elements of 0.025 m")
    plt.ylabel("ms per step")
    plt.legend()
    return save(docs, "scaling")


def plot_step(tables, docs):
    for name, table in tables.items():
        if "step/force" in table["rows"][0]:
            plt.semilogx(column(table, "elements"), column(table, "step/force"), "o-",
                         markersize=3, label=name)
    plt.xlabel("elements")
    plt.ylabel("a whole step over its forces")
    plt.legend()
    return save(docs, "step")


def plot_skip(tables, docs):
    table = tables["skip"]
    names = [f"{r['skipped']} ({r['scene']})" for r in table["rows"]]
    plt.figure(figsize=(6.4, 0.36 * len(names) + 0.6))
    plt.barh(names, column(table, "saves %"))
    plt.gca().invert_yaxis()
    plt.xlabel("% saved")
    return save(docs, "skip")


def plot_cut(tables, docs):
    rows = tables["cut"]["rows"]
    for method in dict.fromkeys(r["method"] for r in rows):
        mine = [r for r in rows if r["method"] == method]
        plt.loglog([r["faces"] for r in mine], [r["ms"] / 1000 for r in mine], "o-", markersize=3,
                   label=method)
    plt.xlabel("faces disconnected")
    plt.ylabel("s")
    plt.legend()
    return save(docs, "cut")


def plot_static(tables, docs):
    """Error of the tip over time: what an accuracy costs."""
    rows = [r for r in tables["static"]["rows"]
            if r["case"] == "A0.25" and r.get("relative_error") is not None]
    series = dict.fromkeys((r["model"], r["element"]) for r in rows)
    for model, element in series:
        mine = [r for r in rows if (r["model"], r["element"]) == (model, element)]
        plt.loglog([r["with_mesh_s"] for r in mine], [100 * r["relative_error"] for r in mine],
                   "o-" if model != "CalculiX" else "s--", markersize=3, label=f"{model} {element}")
    plt.xlabel("CPU s, mesh included")
    plt.ylabel("error of the tip, %")
    plt.legend()
    return save(docs, "static")


def plot_quasi_static(tables, docs):
    rows = tables["quasi-static"]["rows"]
    names = [f"{shown(r['elements'])}, {r['element']}" for r in rows]
    plt.figure(figsize=(6.4, 0.36 * len(names) + 0.6))
    plt.barh(names, [r["slowest_ms"] for r in rows], label="slowest frame")
    plt.plot([r["asked_ms"] for r in rows], names, "k|", markersize=14, label="time of a frame")
    plt.gca().invert_yaxis()
    plt.xlabel("ms")
    plt.legend()
    return save(docs, "quasi-static")


# (NAME of NAME.json, title, introduction, plot or None)
SECTIONS = [
    ("force", "Forces", "Throughput of the models through the SDK, by size: whole steps, forces alone, "
     "and the fraction of this machine's roofline reached. `B/el` is the memory traffic without any "
     "cache reuse, so small bodies, which stay in a cache, may exceed the stream bandwidth.", plot_force),
    ("step", "A step", "Where the time of a step goes.", plot_step),
    ("scaling", "Threads", "The paper's Fig. 8: sequential and parallel. The first table shows the "
     "largest gain that two threads can bring on this machine.", plot_scaling),
    ("realtime", "Real time", "The largest block that is simulated in real time, and the largest "
     "that also delivers every frame of 1/30 s on time while it is cut.", None),
    ("skip", "What is skipped", "Time with and without each piece of work that a scene may not need "
     "(`suture explain` shows what is skipped).", plot_skip),
    ("startup", "Start-up and memory", "From a scene to its first step.", None),
    ("frame", "Frames", "The cost of a frame to the simulating thread; the rest is written in the "
     "background.", None),
    ("build", "The map", "Checks, renumbering, matching and ids of a mesh.", None),
    ("cut", "Cuts", "The paper's Fig. 5 and Table 1, including everything that follows a cut, compared with two "
     "baselines on CGAL's linear cell complex with the same attributes: the paper's model "
     "(`unsew<3>` with split functors), and its predecessor (Flechon 2013: springs point to "
     "particles, particles list their inner springs, and both are updated after each face). The "
     "paper found the second 1.9 times slower than the first. Here it is 1.2 to 1.3 times slower: "
     "lists are contiguous arrays of pointers that are split in one pass, elements around a "
     "particle are visited once, and most of the time is `unsew<3>` itself, which both share.", plot_cut),
    ("blade", "Blades", "Finding the faces that a blade cuts.", None),
    ("event-runs", "Runs with events", "Whole runs with events relative to runs without, in turn. With an "
     "automatic dt, events shorten the step: the last column is the part of the ratio due to the "
     "larger number of steps.", None),
    ("event-costs", "Single operations", "One operation in a run of 1.26 M elements and of 10,000.", None),
    ("rest", "Rest", "The paper's cantilever under its weight, to rest.", None),
    ("static", "Static equilibria", "Newton's method with conjugate gradients and multigrid, CalculiX "
     "beside it where it is installed. At the full load (A) the law has no solution to which meshes "
     "converge, so there are only errors beside the same discrete problem (plugins/tm-faure/README.md).",
     plot_static),
    ("inclusions", "Stiffness that jumps", "Static equilibria of a soft block with stiff balls, beside a "
     "published geometric multigrid.", None),
    ("implicit", "Implicit steps", "Steps far above the stable one.", None),
    ("quasi-static", "Quasi-static runs at frame rate", "An equilibrium for every frame while the "
     "body is pulled and cut.", plot_quasi_static),
    ("modes", "Natural modes", "By LOBPCG with the multigrid as preconditioner.", None),
    ("contact", "Contact", "Near pairs of packed blocks, and steps with contact beside steps of the "
     "same bodies without.", None),
    ("haptic", "Haptic rate", "The force on the hand that holds a knife, after every millisecond of a "
     "cut.", None),
]


def machine_text(file, machine):
    """What was measured where, in one line: documents hold figures of several machines."""
    commit = file.with_suffix(".commit")
    at = commit.read_text().strip() if commit.exists() else ""
    suture = f"Suture {machine['suture']}" + (f" (commit {at})" if at else "")
    seconds = file.with_suffix(".seconds")
    took = [f"{seconds.read_text().strip()} s"] if seconds.exists() else []
    size = f"{machine['cores']} cores, {shown(machine['memory_GB'])} GB"
    return "*" + "; ".join([suture, f"{machine['processor']}, {size}", f"loops for {machine['isa']}",
                            machine["compiler"], machine["system"], machine["libraries"], *took]) + "*\n"


# Sections that other programs make: shape_precision.py, processes.py.
BY_OTHERS = ["Shape", "Processes"]


def sections_of(document):
    """The sections that it has, by title."""
    if not document.exists():
        return {}
    parts = ("\n" + document.read_text()).split("\n## ")[1:]
    return {part.split("\n", 1)[0]: f"## {part.rstrip()}\n" for part in parts}


def section_text(file, title, text, plot, docs):
    data = json.loads(file.read_text())
    parts = [f"## {title}\n", f"{text}\n", machine_text(file, data["machine"])]
    if picture := plot and plot(data["tables"], docs):
        parts.append(f"![{title}]({picture})\n")
    for name, table in data["tables"].items():
        parts.append(f"**{name}**: {table['note']}\n\n{table_text(table)}\n")
    return "\n".join(parts)


def main():
    folder, docs = map(pathlib.Path, sys.argv[1:3])
    document = docs / "benchmarks.md"
    sections = sections_of(document)
    for name, title, text, plot in SECTIONS:
        file = folder / f"{name}.json"
        if name in sys.argv[3:] and file.exists():
            sections[title] = section_text(file, title, text, plot, docs)
    titles = [title for _, title, _, _ in SECTIONS] + BY_OTHERS
    written = [sections[title] for title in titles if title in sections]
    if not written:
        return
    head = ("# Benchmarks\n\nWritten by `./dev bench`. To update one section, run `./dev bench NAME`; the "
            "others are kept. Other processes may have been running during the measurements. The summary is "
            "apps/suture-bench/summary.md.in.\n")
    summary = pathlib.Path(__file__).with_name("summary.md.in").read_text()
    document.write_text("\n".join([head, summary, *written]))
    print(f"wrote {document}")


if __name__ == "__main__":
    main()
