#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Error against run time: whole processes of `suture run`, with CalculiX beside them where it is installed, compared
with solutions of other programs.

    work_precision.py path/to/programs [--json FILE]
"""
import math
import pathlib
import statistics
import tempfile

import calculix
from harness import UNKNOWN, Report, last_row, option_parser, positive, run_scene, run_script
from solid_mesh import write_gmsh
from work_cases import MESH_FILE, work_cases

CPU_BUDGET = 1  # s after which a row is not repeated


def repeat(rounds, run):
    """Median times of a process that is repeated while that is cheap, and what the last run returned; `run` returns
    its use and what else it found."""
    uses = []
    while not uses or (len(uses) < rounds and sum(u.cpu for u in uses) < CPU_BUDGET):
        use, found = run()
        uses.append(use)
    return statistics.median_high(u.cpu for u in uses), statistics.median_high(u.wall for u in uses), found


def new_row(what, program, method, cells, mesh):
    return {"case": what.name, "program": program, "method": method, "mesh": cells.name(),
            "dofs": 3 * len(mesh.points), "cpu_s": 0.0, "wall_s": 0.0, "relative_error": UNKNOWN, "front": "",
            "note": ""}


def run_suture(options, what, method, cells, mesh):
    row = new_row(what, "Suture", method.name, cells, mesh)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scene = what.scene(cells, method)
        if what.mesh:
            write_gmsh(folder / MESH_FILE, mesh)

        def run():
            use = run_scene(options.programs, scene, folder)
            return use, use.code

        row["cpu_s"], row["wall_s"], code = repeat(options.rounds, run)
        if code == 0:
            value = float(last_row(folder / "out/probes.csv")[what.column])
            row["relative_error"] = what.scale * value / what.reference - 1
        elif code == 5:
            row["note"] = "no equilibrium was found (exit code 5)"
        else:
            row["note"] = f"stopped, exit code {code}"
    return row


def value_of(what, found):
    """The value that a column "tip displacement y [m]" shows, scaled."""
    return what.scale * found.probe["xyz".index(what.column.split(" [")[0][-1])]


def scene_for_calculix(what, cells):
    """Of any of a case's methods: CalculiX needs the mesh, the material and the loads only."""
    return what.scene(cells, what.methods[0])


def run_ccx(options, what, method, cells, mesh):
    row = new_row(what, "CalculiX", f"{method.element} {method.solver}", cells, mesh)

    def run():
        found = calculix.run(scene_for_calculix(what, cells), mesh, method.element, method.solver)
        return found.use, found

    try:
        row["cpu_s"], row["wall_s"], found = repeat(options.rounds, run)
        row["dofs"] = found.dofs
        row["relative_error"] = value_of(what, found) / what.reference - 1
    except calculix.Failure as failure:
        row["note"] = str(failure)
    return row


def mark_front(rows):
    """Nothing else in the case is both faster and more accurate."""
    least = math.inf
    for row in sorted((r for r in rows if math.isfinite(r["relative_error"])), key=lambda r: r["cpu_s"]):
        row["front"] = "*" if abs(row["relative_error"]) < least else ""
        least = min(least, abs(row["relative_error"]))


def run_case(options, what, report):
    report.begin(what.name, f"relative to {what.reference:.6g}: {what.source}")
    rows = []

    def run_all(methods, run):
        for method in methods:
            for cells in method.meshes:
                mesh = what.mesh_of(cells)
                if 3 * len(mesh.points) <= options.dofs:
                    row = run(options, what, method, cells, mesh)
                    rows.append(row)
                    print(f"{row['program']}, {row['method']}, {row['mesh']}: {row['cpu_s']:.4g} s, "
                          f"{100 * row['relative_error']:.3g} %  {row['note']}", flush=True)

    run_all(what.methods, run_suture)
    if options.beside and calculix.is_installed():
        run_all(what.beside, run_ccx)
    mark_front(rows)
    for row in rows:
        report.add(row)


# --------------------------------------------------------------- references --

def extrapolated(h, values):
    """The limit for h -> 0 of values c + a h^p on three meshes, and p."""
    ratio = (values[0] - values[1]) / (values[1] - values[2])
    low, high = 0.01, 20
    for _ in range(100):
        p = (low + high) / 2
        if (h[0]**p - h[1]**p) / (h[1]**p - h[2]**p) < ratio:
            low = p
        else:
            high = p
    part = h[2]**low / (h[1]**low - h[2]**low)
    return values[2] - part * (values[1] - values[2]), low


def run_reference(what, report):
    """CalculiX's own values on the finest meshes that it solves, with the limit that they approach."""
    finest = what.finest
    if finest is None:
        return
    report.begin("reference: " + what.name, f"CalculiX, {finest.element}, Newton's method to 1e-9")
    values = []
    for cells in finest.meshes:
        found = calculix.run(scene_for_calculix(what, cells), what.mesh_of(cells), finest.element, finest.solver,
                             precise=True)
        values.append(value_of(what, found))
        report.add({"mesh": cells.name(), "dofs": found.dofs, "value": values[-1]})
    limit, order = extrapolated([1 / cells.counts[0] for cells in finest.meshes], values)
    report.add({"limit": limit, "order": order, "finest_is_off": values[-1] / limit - 1})
    print(" ".join(f"{v:.8g}" for v in values) + f": limit {limit:.8g}")


def read_options():
    names = [what.name for what in work_cases()]
    parser = option_parser(__doc__)
    parser.add_argument("--cases", nargs="+", choices=names, default=names, metavar="NAME",
                        help="Problems; default: all")
    parser.add_argument("--largest", action="store_true", help="With meshes that take longer than 5 s")
    parser.add_argument("--no-calculix", dest="beside", action="store_false", help="Leave out CalculiX")
    parser.add_argument("--references", action="store_true",
                        help="Only CalculiX's values that references are extrapolated from")
    parser.add_argument("--dofs", type=float, default=math.inf, help="Largest number of unknowns of a mesh")
    parser.add_argument("--rounds", type=positive, default=5, help="Repetitions")
    return parser.parse_args()


def main():
    options = read_options()
    report = Report(options.json, options.programs)
    if options.beside and not calculix.is_installed():
        print("CalculiX (ccx) is not installed: its rows are left out")
    for what in work_cases(options.largest):
        if what.name in options.cases and options.references:
            run_reference(what, report)
        elif what.name in options.cases:
            run_case(options, what, report)
    report.write_json()


run_script(main)
