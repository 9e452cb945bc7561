#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`suture-bench static` with CalculiX's rows beside its own, where CalculiX is installed. Other options are passed on.

    static.py path/to/programs [--json FILE] [OPTIONS of suture-bench static]
"""
import math

import calculix
from harness import UNKNOWN, Report, from_suture_bench, option_parser, positive, run_script, write_tables
from solid_mesh import box_mesh
from work_cases import CANTILEVERS, bars, cantilever_scene, static_method


def calculix_row(name, element, across, before):
    """`before`: the row before of the same series, or None."""
    what, (cells,) = CANTILEVERS[name], bars(across)
    scene = cantilever_scene(what, cells, static_method("tm-faure", "", []))
    found = calculix.run(scene, box_mesh(**scene["mesh"]["box"]), element)
    elements, seconds, growth = math.prod(cells.counts), found.use.cpu, UNKNOWN
    if before and before["elements"] < elements:
        growth = math.log(seconds / before["seconds"]) / math.log(elements / before["elements"])
    error = abs(found.probe[1] / what.converged - 1) if what.converged else UNKNOWN
    return {"case": name, "model": "CalculiX", "element": element, "elements": elements, "seconds": seconds,
            "us_per_element": 1e6 * seconds / elements, "asked_us": UNKNOWN, "growth": growth, "coarse_steps": 0,
            "newton_steps": found.iterations, "krylov_iterations": UNKNOWN, "relative_error": error,
            "discrete_error": UNKNOWN, "with_mesh_s": seconds, "peak_mb": found.use.peak_bytes / 1e6}


def add_calculix(options, table):
    """CalculiX's rows behind those of each case."""
    report, rows = Report(), []
    report.begin("static", "the same cantilevers in CalculiX, the whole process")
    for name in dict.fromkeys(row["case"] for row in table["rows"]):
        rows += [row for row in table["rows"] if row["case"] == name]
        for element in options.calculix_elements:
            before = None
            for across in options.calculix:
                before = calculix_row(name, element, across, before)
                report.add(before)
                rows.append(before)
    table["rows"] = rows
    table["note"] += "; CalculiX: the whole process"


def read_options():
    parser = option_parser(__doc__)
    parser.add_argument("--calculix", nargs="+", type=positive, default=[5, 10],
                        help="Cells over the height for CalculiX")
    parser.add_argument("--calculix-elements", nargs="+", default=["C3D8", "C3D8I"], choices=calculix.ELEMENTS)
    parser.add_argument("--no-calculix", dest="beside", action="store_false", help="Leave out CalculiX")
    return parser.parse_known_args()


def main():
    options, others = read_options()
    data = from_suture_bench(options.programs, "static", *others)
    if options.beside and calculix.is_installed():
        add_calculix(options, data["tables"]["static"])
    elif options.beside:
        print("CalculiX (ccx) is not installed: its rows are left out")
    if options.json:
        write_tables(options.json, data["machine"], data["tables"])


run_script(main)
