#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make docs/paper.md and its plots from the output of `paper.py --json`.

usage: paper_report.py FOLDER DOCS

FOLDER holds paper.json; without it, nothing is done. Fig. 5 and 8 are added from cut.json and
scaling.json, if they are there.
"""
import json
import pathlib
import sys

import matplotlib.pyplot as plt

from report import machine_text, save, shown, table_text

HEAD = """# The paper's experiments

Written by `./dev bench paper` (Fig. 5 and 8: `./dev bench cut scaling paper`). The paper: K. Golec, M. Coquet, F. Zara,
G. Damiand, WSCG 2015. Each value is that of a whole run of `suture run`, beside the formula or law that the paper compares
with and beside a solution of another program in three dimensions. `apps/suture-bench/paper.py build/bin --figure N` draws
one figure in less than two minutes: 6, 7, 13 or 14.

"""

BEAM = """## Fig. 6: the cantilever at rest

The formula is that of Euler and Bernoulli, for small deflections and without shear. At the paper's load it gives -0.588 m of
a beam of 1 m, far outside its range: the solution of the same law in three dimensions is -0.512 m (10x10x40 quadratic
elements; at this load finer meshes have no limit, see [accuracy.md](accuracy.md)). What comes close to the formula there is
wrong. At a thousandth of the load all laws are linear and the reference has a limit; the formula is 4 % short of it,
because it leaves out the shear.

`MSS` at the full load rests in a state of a lattice that has hourglassed: its deflection grows under refinement, past the
formula. TM approaches the reference from below, as a conforming element does.
"""

SCHEMES = """The same for the schemes that compute motion. The step of each is chosen so that its run costs about as much CPU time as
explicit steps do. Position based dynamics (`xpbd`) is too soft by what its steps leave out of the stiffness. Implicit Euler rests
where its forces do, whatever its step is, solved or on a budget of 10 iterations.
"""

SAME_SCHEMES = """The same schemes at equal time.
"""

EQUILIBRIA = """## Fig. 7: both equilibria

10x10x40 elements at the full load, coloured by the largest principal strain. `apps/suture-bench/paper.py build/bin
--pictures FOLDER`, then `xvfb-run -a docs/images/render.py --field principal_strain --beside FOLDER/TM/run.pvd
FOLDER/MSS/run.pvd docs/images/paper-equilibria.png`.

![MSS and TM](images/paper-equilibria.png)
"""

LIVER = """## Fig. 14: shear of liver

A block of 10x10x30 mm, 10x10x30 elements, between two plates; the upper one moves along the long side at the rates of the
measurement. E = 1000 Pa and nu = 0.499 for MSS and TM as in the paper, K = 861 Pa s^n and n = 0.1138 for `visco`. The runs
are quasi-static: inertia is negligible in the measurement. The paper's models are elastic: their stress is
proportional to the strain whatever the rate is, and at E = 1000 Pa it is less than half of what was measured.
At the largest rate the shear reaches 1.34; the law of TM (St Venant and Kirchhoff) stiffens without bound there.
"""

SMALL = """The law is linear; so is `visco` in ideal simple shear (asked: within 2 % from 0.1 to 10 s):
"""

RANGE = """The block has free sides and is softer than a plate without end: 0.914 times at small shear (DOLFINx). Asked: within
2 % of that up to a shear of 0.01. The first rows of each ramp, 10 and 20 equilibria after its start, have the largest error
of the steps. Beyond, the stress stays linear: the neo-Hookean law is linear in simple shear at any strain, and in this block
nearly so up to 0.1. In Fig. 14, at 20 equilibria until 2 s, `visco` stays about as far below the law of the plate without
end as the free sides make it softer, up to a shear of 1.3.
"""

# The paper's Table 1, ms on one core of an i5-4690, by its bodies.
PAPER_CUTS = {"frog": (4.0, 2.0), "elephant": (14.5, 7.6), "mushroom": (32.2, 17.7),
              "giraffe": (176.3, 91.6)}
PAPER_SPEED_UPS = {"MSS": 1.45, "TM": 2.73}


def plot_beam(rows):
    figure, axes = plt.subplots(1, 2, figsize=(10, 4))
    at = [0, 25, 50, 75, 100]
    for axis, load in zip(axes, dict.fromkeys(r["load"] for r in rows)):
        for i, row in enumerate(r for r in rows if r["load"] == load):
            y = [0] + [row[f"y at {x} cm, m"] for x in at[1:]]
            style = {"beam formula": "--", "3D reference": "-"}.get(row["model"])
            axis.plot(at, y, style or "o-", color="k" if style else plt.cm.tab20(i), markersize=3,
                      linewidth=1, label=f"{row['model']} {row['mesh']}".strip())
        axis.set_title(f"load: {load}")
        axis.set_xlabel("x, cm")
        axis.set_ylabel("y, m")
    axes[0].legend(fontsize=6)
    figure.tight_layout()


def plot_liver(rows):
    models = [name for name in rows[0] if name not in ("rate, 1/s", "t, s", "shear")]
    rates = list(dict.fromkeys(r["rate, 1/s"] for r in rows))
    figure, axes = plt.subplots(1, len(rates), figsize=(11, 3.6))
    for axis, rate in zip(axes, rates):
        mine = [r for r in rows if r["rate, 1/s"] == rate]
        for name in models:
            style = "k--" if name == "measured law" else "-"
            axis.plot([r["t, s"] for r in mine], [r[name] for r in mine], style, label=name)
        axis.set_ylim(0, 1.3 * max(r["measured law"] for r in mine))
        axis.set_title(f"{rate:g} 1/s")
        axis.set_xlabel("t, s")
    axes[0].set_ylabel("stress on the plate, Pa")
    axes[0].legend()
    figure.tight_layout()


def sample(rows):
    """The rows at a few times."""
    return {"rows": [r for r in rows if any(abs(r["t, s"] - t) < 1e-9 for t in (0.1, 0.5, 1, 2))]}


def schemes_text(tables, figure, introduction=SAME_SCHEMES):
    """The schemes at equal time, where they were run."""
    table = tables.get(f"{figure}, schemes")
    return table and f"{introduction}\n{table['note'][0].upper()}{table['note'][1:]}.\n\n{table_text(table)}\n"


def tables_of(file):
    return json.loads(file.read_text())["tables"] if file.exists() else {}


def cuts_text(tables):
    """The paper's Table 1 beside the same numbers of elements and faces here."""
    if "cut bodies" not in tables:
        return ""
    lines = ["## Fig. 5 and Table 1: cuts\n",
             "ms for a cut; the paper's bodies are not public, ours have as many elements and nearly as many faces\n",
             "| body | faces | method | ms, this machine | the paper's, i5-4690 | its predecessor there |",
             "|---|---|---|---|---|---|"]
    for row in tables["cut bodies"]["rows"]:
        if row["mesh"] in PAPER_CUTS:
            before, paper = PAPER_CUTS[row["mesh"]]
            lines.append(f"| {row['mesh']} | {shown(row['faces'])} | {row['method']} | {shown(row['ms'])} | {paper} | {before} |")
    return "\n".join(lines) + "\n"


def speed_ups_text(tables):
    text = ("## Fig. 8: speed-up\n\nThe paper: 1.45 (MSS) and 2.73 (TM) on the mean, 4 threads of an i5-4690. Here: "
            "[benchmarks.md](benchmarks.md#threads), by size, beside what threads that share nothing gain on that machine.\n")
    lines = []
    for name, table in tables.items():
        model = name.removeprefix("scaling: ")
        if model in PAPER_SPEED_UPS:
            best = max(table["rows"], key=lambda r: r["elements"])
            lines.append(f"| {model} | {shown(best['elements'])} | {shown(best['speed-up'])} | {PAPER_SPEED_UPS[model]} |")
    if lines:
        threads = shown(tables["scaling: the machine"]["rows"][0]["threads"])
        lines = [f"\n| model | elements | {threads} threads, this machine | the paper's mean |", "|---|---|---|---|"] + lines
    return text + "\n".join(lines)


def draw(number, rows, picture):
    """Figure 6 or 14 alone, of the rows of its table."""
    {"6": plot_beam, "14": plot_liver}[number](rows)
    plt.savefig(picture)


def main():
    folder, docs = map(pathlib.Path, sys.argv[1:3])
    file = folder / "paper.json"
    if not file.exists():
        return
    data = json.loads(file.read_text())
    tables = data["tables"]
    beam, liver = tables["Fig. 6"]["rows"], tables["Fig. 14"]["rows"]
    plot_beam(beam)
    beam_picture = save(docs, "paper-beam")
    plot_liver(liver)
    liver_picture = save(docs, "paper-liver")
    parts = [HEAD + machine_text(file, data["machine"]),
             BEAM, f"![deflection of the axis]({beam_picture})\n", table_text(tables["Fig. 6"]) + "\n",
             schemes_text(tables, "Fig. 6", SCHEMES), EQUILIBRIA, schemes_text(tables, "Fig. 7"),
             LIVER, f"![stress over time]({liver_picture})\n", table_text(sample(liver)) + "\n",
             schemes_text(tables, "Fig. 14"), SMALL, table_text(tables["power law, one element"]) + "\n",
             RANGE, table_text(tables["power law, block"]) + "\n",
             cuts_text(tables_of(folder / "cut.json")), speed_ups_text(tables_of(folder / "scaling.json"))]
    (docs / "paper.md").write_text("\n".join(p for p in parts if p))
    print(f"wrote {docs / 'paper.md'}")


if __name__ == "__main__":
    main()
