#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's experiments (Golec, Coquet, Zara, Damiand, WSCG 2015), Fig. 6, 7, 13 and 14, by whole runs of
`suture run`: beside the formula or law that the paper compares with, and references of other programs.

    paper.py path/to/programs [--json FILE]
    paper.py path/to/programs --figure 6|7|13|14 [-o PICTURE]

(Fig. 5: suture-bench cut; 8: suture-bench scaling; 9, 10: suture run and plot of the scenes cut-beam and letters.)
"""
import argparse
import collections
import math
import pathlib
import tempfile

from harness import (UNKNOWN, Failure, Report, file_to_write, option_parser, positive, probe_rows, run_process,
                     run_scene, run_script)
from work_cases import (CANTILEVERS, Cells, Method, bars, box, box_scene, cantilever_scene, plate,
                        static_method)


def note_of(code):
    return {0: "", 5: "no equilibrium was found (exit code 5)"}.get(code, f"exit code {code}")


class ProbeTable:
    """A whole run of `suture run`, and the columns of its probes.csv, by name."""

    def __init__(self, programs, scene):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            use = run_scene(programs, scene, folder)
            self.code, self.cpu = use.code, use.cpu
            table = folder / "out/probes.csv"
            self.rows = probe_rows(table) if table.exists() else []

    def last(self, column):
        """NaN if the run has no such column."""
        return float(self.rows[-1].get(column, UNKNOWN)) if self.rows else UNKNOWN

    def at(self, time, column):
        """The value at a time, NaN if the run has no row there."""
        near = (float(row[column]) for row in self.rows if abs(float(row["time [s]"]) - time) < 1e-9 * time)
        return next(near, UNKNOWN)


# ------------------------------------------------------------ schemes in motion --

# Members of a solver, and a step for the first try, s; None: the scheme's own.
Scheme = collections.namedtuple("Scheme", "name members step")
SCHEMES = [Scheme("explicit", {"integrator": "velocity-verlet"}, None),
           Scheme("implicit-euler", {"integrator": "implicit-euler"}, 1 / 60),
           Scheme("implicit-euler, 10 iterations", {"integrator": "implicit-euler", "budget": {"iterations": 10}},
                  1 / 60),
           Scheme("xpbd", {"integrator": "xpbd"}, 1 / 240)]
# A moving run of a scene for `end` seconds, and the value in which it ends: s, 1/s, -, times `scale`, and as that.
Motion = collections.namedtuple("Motion", "scene end damping column scale equilibrium")


def run_scheme(programs, motion, scheme, step):
    solver = {**scheme.members, "end": motion.end, "damping": motion.damping, "threads": 1}
    return ProbeTable(programs, {**motion.scene, "solver": {**solver, "dt": step} if step else solver})


def report_schemes(programs, model, motion, report):
    """One row for each scheme: explicit steps, and others with steps of which a run costs as much time as explicit
    steps do."""
    wanted = None
    for scheme in SCHEMES:
        step = scheme.step
        found = run_scheme(programs, motion, scheme, step)
        wanted = wanted or found.cpu
        for _ in range(2 if step else 0):
            step *= found.cpu / wanted
            found = run_scheme(programs, motion, scheme, step)
        value = motion.scale * found.last(motion.column) if found.code == 0 else UNKNOWN
        report.add({"model": model, "scheme": scheme.name, "dt, s": step or UNKNOWN, "CPU, s": found.cpu,
                    "value": value, "value / equilibrium - 1": value / motion.equilibrium - 1,
                    "note": f"stopped, exit code {found.code}" if found.code else ""})


# -------------------------------------------------------------------- Fig. 6 --

STATIONS = (0.25, 0.5, 0.75, 1)  # m

# The paper's beam at one load, with a reference in three dimensions: uy at the stations, m.
BeamLoad = collections.namedtuple("BeamLoad", "name cantilever reference source")
BEAM_LOADS = [
    BeamLoad("full", CANTILEVERS["A"], (-0.0701141807, -0.2018940808, -0.3553193745, -0.5119929186),
             "DOLFINx, 10x10x40 quadratic"),
    BeamLoad("1/1000", CANTILEVERS["B"], (-7.545390421e-5, -2.301885932e-4, -4.186071992e-4, -6.131836275e-4),
             "DOLFINx, 12x12x36 quadratic, graded")]

RELAXED = {"until": "rest", "on_inversion": "warn"}
BALANCED = {"static": {}}
BEAM_MODELS = [Method("MSS", "mss-baudet", {}, RELAXED, ()),
               Method("MSS, corrected", "mss-baudet", {"correction": True}, RELAXED, ()),
               Method("MSS with volume (mss-golec)", "mss-golec", {}, BALANCED, ()),
               Method("TM", "tm-faure", {}, BALANCED, ()),
               Method("TM, mean gradient", "tm-faure", {"element": "mean-gradient"}, BALANCED, ())]


def beam_formula(gravity, x):
    """y = rho g l h / (24 E I) (4 L x^3 - 6 L^2 x^2 - x^4), I = l h^3 / 12."""
    rho, young, h, length = 1000, 4e5, 0.25, 1
    return rho * gravity / (2 * young * h * h) * (4 * length * x**3 - 6 * length * length * x * x - x**4)


def station_name(x):
    return f"y{100 * x:.0f}"


def beam_scene(what, model, across, solver=None):
    scene = cantilever_scene(what, bars(across)[0], model)
    return {**scene, "solver": solver or model.solver}


def beam_probes(across):
    """The mean displacement of the nodes nearest to the axis of the beam, at each station."""
    reach = 0.6 * 0.25 / across
    return [{"name": station_name(x), "fields": ["displacement"],
             "where": box((x - 1e-6, 0.125 - reach, 0.125 - reach), (x + 1e-6, 0.125 + reach, 0.125 + reach))}
            for x in STATIONS]


def beam_row(load, model, mesh, y, note):
    return {"load": load.name, "model": model, "mesh": mesh,
            **{f"y at {100 * x:.0f} cm, m": value for x, value in zip(STATIONS, y)},
            "tip / formula - 1": y[-1] / beam_formula(load.cantilever.gravity, 1) - 1,
            "tip / 3D reference - 1": y[-1] / load.reference[-1] - 1, "note": note}


def run_beam(options, load, model, across):
    scene = beam_scene(load.cantilever, model, across)
    scene["output"]["probes"]["at"] = beam_probes(across)
    found = ProbeTable(options.programs, scene)
    y = [found.last(f"{station_name(x)} displacement y [m]") for x in STATIONS]
    return beam_row(load, model.name, f"{across}x{across}x{4 * across}", y, note_of(found.code))


def run_beams(options, report):
    report.begin("Fig. 6", "the cantilever at rest, deflection of its axis")
    for load in BEAM_LOADS:
        y = [beam_formula(load.cantilever.gravity, x) for x in STATIONS]
        report.add(beam_row(load, "beam formula", "", y, "of small deflections, without shear"))
        report.add(beam_row(load, "3D reference", "", load.reference, load.source))
        for model in BEAM_MODELS:
            for across in options.across:
                report.add(run_beam(options, load, model, across))


def run_beams_by_scheme(options, report):
    """Until all is at rest but for 1e-3 of the tip."""
    across, column = options.across[0], "tip displacement y [m]"
    report.begin("Fig. 6, schemes",
                 f"the cantilever at a quarter of the paper's load, {across} elements over its height; it moves for "
                 "8 s with a damping of 2/s. Tip in the end, m, beside the equilibrium of the same mesh")
    for model in BEAM_MODELS:
        scene = beam_scene(CANTILEVERS["A0.25"], model, across, BALANCED)
        equilibrium = ProbeTable(options.programs, scene).last(column)
        report_schemes(options.programs, model.name, Motion(scene, 8, 2, column, 1, equilibrium), report)


# -------------------------------------------------------------------- Fig. 7 --

# The largest principal strain of any element, by which the figure is coloured.
STRAIN_COLUMN = "strain principal_strain 1"
STRAIN_PROBE = {"name": "strain", "fields": ["principal_strain"], "of": "max", "where": box((-1, -1, -1), (2, 2, 2))}


def shapes():
    """(name, scene) of the models of the figure, at the paper's load."""
    return [(model.name, beam_scene(CANTILEVERS["A"], model, 10)) for model in BEAM_MODELS
            if model.name in ("MSS", "TM")]


def write_equilibria(programs, folder):
    """The equilibria of MSS and TM as frames, in the folders MSS and TM."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, scene in shapes():
        run_scene(programs, {**scene, "output": {"fields": ["displacement", "principal_strain"]}}, folder, name)


def run_shapes_by_scheme(options, report):
    report.begin("Fig. 7, schemes",
                 "the cantilever at the paper's load, 10x10x40 elements; it moves for 4 s with a damping of 4/s. "
                 "Largest principal strain of any element in the end, beside the equilibrium of the same mesh")
    for name, scene in shapes():
        scene["output"]["probes"]["at"].append(STRAIN_PROBE)
        equilibrium = ProbeTable(options.programs, scene).last(STRAIN_COLUMN)
        report_schemes(options.programs, name, Motion(scene, 4, 4, STRAIN_COLUMN, 1, equilibrium), report)


# ------------------------------------------------------------------- Fig. 14 --

CONSISTENCY, EXPONENT = 861, 0.1138  # Pa s^n, -
RATES = (0.0151, 0.133, 0.67)  # 1/s
STRESS_COLUMN = "plate reaction x [N]"

ELASTIC = {"E": 1000, "nu": 0.499, "rho": 1000}
VISCO = static_method("visco", "", ())


def power_law(tau):
    """Parameters of `visco`."""
    return {"K": CONSISTENCY, "n": EXPONENT, "lambda": 166444.3, "rho": 1000, "tau": tau}


LIVER_MODELS = {"MSS": (static_method("mss-baudet", "", ()), ELASTIC),
                "TM": (static_method("tm-faure", "trilinear", ()), ELASTIC),
                "TM, mean gradient": (static_method("tm-faure", "mean-gradient", ()), ELASTIC),
                "visco": (VISCO, power_law(1e-3))}


def measured_law(rate, time):
    """sigma = K r t^(1-n) / Gamma(2-n)"""
    return CONSISTENCY * rate * time ** (1 - EXPONENT) / math.gamma(2 - EXPONENT)


def shear_scene(block, method, material, rate, end, frames):
    """A block between two plates, one of which moves at a constant rate of shear until `end`. One element is in
    ideal simple shear."""
    size = [1e-3 * n for n in block]
    scene = plate(box_scene(Cells(tuple(block)), size, method, **material), rate * end * size[1], end)
    scene["solver"] = {"static": {"frames": frames}, "end": end, "on_inversion": "warn"}
    scene["output"]["probes"]["every_steps"] = 1
    return scene


def area(block):
    """Of the plate, m^2."""
    return 1e-6 * block[0] * block[2]


def stress_at(table, time, block):
    """Mean shear stress on the moved plate at a time, Pa."""
    return table.at(time, STRESS_COLUMN) / area(block)


def run_liver(options, report):
    end = 2
    report.begin("Fig. 14", "shear of a block of liver at three rates, quasi-static: stress on the plate, Pa, and the "
                 "law that was measured, K r t^(1-n) / Gamma(2-n)")
    for rate in RATES:
        found = {name: ProbeTable(options.programs, shear_scene(options.block, *model, rate, end, options.frames))
                 for name, model in LIVER_MODELS.items()}
        for i in range(1, options.frames + 1):
            time = end * i / options.frames
            report.add({"rate, 1/s": rate, "t, s": time, "shear": rate * time,
                        "measured law": measured_law(rate, time),
                        **{name: stress_at(table, time, options.block) for name, table in found.items()}})


def run_liver_by_scheme(options, report):
    end, rate = 0.5, RATES[1]
    report.begin("Fig. 14, schemes",
                 "the block of liver sheared at 0.133/s for 0.5 s with a damping of 20/s: stress on the plate in the "
                 "end, Pa, beside the equilibrium of the same block")
    for name, model in LIVER_MODELS.items():
        if name == "visco":
            continue  # 5 equilibria are too few for its rate
        scene = shear_scene(options.block, *model, rate, end, 5)
        equilibrium = stress_at(ProbeTable(options.programs, scene), end, options.block)
        motion = Motion(scene, end, 20, STRESS_COLUMN, 1 / area(options.block), equilibrium)
        report_schemes(options.programs, name, motion, report)


def run_small_rates(options, report):
    """One element at rates so small that the law is linear."""
    report.begin("power law, one element", "ideal simple shear at the paper's rates times 1e-4, 1,000 equilibria "
                 "until the time of the row: stress of visco / law - 1")
    one = (1, 1, 1)
    for time in (0.1, 0.3, 1.0, 3.0, 10.0):
        row = {"t, s": time}
        for rate in RATES:
            found = ProbeTable(options.programs, shear_scene(one, VISCO, power_law(1e-3), 1e-4 * rate, time, 1000))
            row[f"rate {1e-4 * rate:g} 1/s"] = stress_at(found, time, one) / measured_law(1e-4 * rate, time) - 1
        report.add(row)


def run_linear_range(options, report):
    """Sides that are free make the block softer than a plate without end: 0.914 times as stiff."""
    of_free_sides = 0.913770  # DOLFINx, linear, nu = 0.499
    frames = 40
    report.begin("power law, block",
                 "the block at the paper's rates, visco with tau a hundredth of the time to a shear of 0.01, 40 "
                 "equilibria to a shear of 0.01 and 40 to 0.1: stress / (0.914 times the law) - 1")
    for most in (0.01, 0.1):
        found = {rate: ProbeTable(options.programs, shear_scene(options.block, VISCO, power_law(1e-4 / rate), rate,
                                                                most / rate, frames)) for rate in RATES}
        for i in (frames // 4, frames // 2, frames):
            row = {"shear": most * i / frames}
            for rate, table in found.items():
                time = most * i / frames / rate
                law = of_free_sides * measured_law(rate, time)
                row[f"rate {rate:g} 1/s"] = stress_at(table, time, options.block) / law - 1
            report.add(row)


# ------------------------------------------------------------------- Fig. 13 --

def write_block(options, folder):
    """The block of springs between the plates, sheared at the second rate for a second."""
    scene = shear_scene(options.block, *LIVER_MODELS["MSS"], RATES[1], 1, 10)
    scene["output"].update(frames=True, fields=["displacement"])
    run_scene(options.programs, scene, folder, "MSS")


# ----------------------------------------------------------------- one figure --

def plot_runs(options, folder, names, picture):
    """Draws runs of a folder by `suture plot`."""
    log = folder / "plot.log"
    if run_process([options.programs / "suture", "plot", *names, "-o", picture], folder, log).code != 0:
        raise Failure(f"{picture}: could not be drawn: {log.read_text().strip()}")


def plot_table(options, report, picture):
    try:
        import paper_report  # needs matplotlib, which the runs do not
        paper_report.draw(options.figure, report.tables[f"Fig. {options.figure}"]["rows"], picture)
    except (ImportError, OSError) as error:
        raise Failure(f"{picture}: could not be drawn ({error}); pictures need python3-matplotlib") from error


def draw_figure(options, report, picture):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        if options.figure == "7":
            write_equilibria(options.programs, folder)
            plot_runs(options, folder, ["MSS", "TM"], picture)
        elif options.figure == "13":
            write_block(options, folder)
            plot_runs(options, folder, ["MSS"], picture)
        else:
            {"6": run_beams, "14": run_liver}[options.figure](options, report)
            plot_table(options, report, picture)
    print(picture)


def run_tables(options, report):
    for run in (run_beams_by_scheme, run_shapes_by_scheme, run_liver_by_scheme):
        run(options, report)
    if options.schemes:
        return
    for run in (run_beams, run_small_rates, run_linear_range, run_liver):
        run(options, report)
    if options.pictures:
        write_equilibria(options.programs, options.pictures)


def picture_file(text):
    if pathlib.Path(text).suffix not in (".png", ".pdf", ".svg"):
        raise argparse.ArgumentTypeError("pictures end in .png, .pdf or .svg")
    return file_to_write(text)


def read_options():
    parser = option_parser(__doc__)
    parser.add_argument("--across", nargs="+", type=positive, default=[5, 10],
                        help="Elements over the height of the beam")
    parser.add_argument("--block", nargs=3, type=positive, default=[30, 10, 10], help="Elements of the block of liver")
    parser.add_argument("--schemes", action="store_true", help="Only the tables of integrators at equal time")
    parser.add_argument("--frames", type=positive, default=20, help="Equilibria of the shear of liver")
    parser.add_argument("--figure", choices=("6", "7", "13", "14"), help="Only this figure, with its picture")
    parser.add_argument("-o", "--output", type=picture_file, help="The picture of it; default: figure-N.png")
    parser.add_argument("--pictures", type=pathlib.Path,
                        help="Folder for the frames of Fig. 7, for docs/images/render.py --beside")
    return parser.parse_args()


def main():
    options = read_options()
    report = Report(options.json, options.programs)
    if options.figure:
        draw_figure(options, report, (options.output or pathlib.Path(f"figure-{options.figure}.png")).resolve())
    else:
        run_tables(options, report)
    report.write_json()


run_script(main)
