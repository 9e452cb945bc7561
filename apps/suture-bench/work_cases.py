# SPDX-License-Identifier: GPL-3.0-or-later
"""Problems with known answers, and the methods that solve them (work_precision.py).

References of solids are CalculiX's own finest values, extrapolated (work_precision.py --references), published ones,
or solutions of other programs."""
import collections
import dataclasses
import functools
import math

from solid_mesh import Mesh, box_mesh, divided

MESH_FILE = "mesh.msh"

# The paper's cantilever (1 m x 0.25 m x 0.25 m, E = 400 kPa, rho = 1000) under its weight: m/s^2, -, and the
# deflection of its tip by DOLFINx and FreeFem++, m; None: there is no limit.
Cantilever = collections.namedtuple("Cantilever", "gravity nu converged")
CANTILEVERS = {"A": Cantilever(9.8, 0.3, None), "A0.25": Cantilever(2.45, 0.3, -0.1511616184928),
               "B": Cantilever(9.8e-3, 0.3, -6.1321068507931e-4), "H0.49": Cantilever(9.8e-3, 0.49, -5.943e-4),
               "H0.499": Cantilever(9.8e-3, 0.499, -5.936278505847e-4),
               "H0.499 full": Cantilever(9.8, 0.499, -0.5013062444400)}


@dataclasses.dataclass
class Cells:
    """Cells of a box and their grading along the first axis (last cell / first)."""
    counts: tuple
    grading: int = 1

    def name(self):
        """40x10x10, or 36x12x12 graded 8."""
        return "x".join(map(str, self.counts)) + (f" graded {self.grading}" if self.grading != 1 else "")


@dataclasses.dataclass
class Method:
    """A model with its parameters, and how the scene is solved, as members of a scene."""
    name: str
    model: str
    parameters: dict
    solver: dict
    meshes: list


@dataclasses.dataclass
class CalculixMethod:
    """What CalculiX solves beside Suture: the same scenes with its own elements."""
    element: str
    solver: str
    meshes: list


@dataclasses.dataclass
class Case:
    name: str
    reference: float
    source: str  # of the reference
    scene: object  # of cells and a method
    column: str  # of probes.csv, whose last value is compared
    scale: float  # of that value
    methods: list
    beside: list = ()
    mesh: object = None  # of cells: makes MESH_FILE of scenes that name it; None: scenes name a box
    finest: CalculixMethod = None  # on three meshes, from which the reference is extrapolated

    def mesh_of(self, cells):
        if self.mesh:
            return self.mesh(cells)
        box = self.scene(cells, self.methods[0])["mesh"]["box"]
        return box_mesh(**box)


# ------------------------------------------------------------------- meshes --

def bars(*sections):
    return [Cells((4 * n, n, n)) for n in sections]


def graded(*meshes):
    """Of (grading, cells): cells that grow from the clamp to the tip, where little happens."""
    return [Cells(cells, grading) for grading, cells in meshes]


GRADED = ((8, (9, 3, 3)), (8, (12, 4, 4)), (16, (16, 4, 4)), (16, (24, 6, 6)), (8, (24, 8, 8)), (8, (36, 12, 12)),
          (16, (48, 16, 16)), (16, (60, 20, 20)), (24, (60, 24, 24)), (16, (72, 24, 24)), (16, (84, 28, 28)))

# ------------------------------------------------------------------ methods --

STATIC = {"static": {"frames": 1}, "threads": 1}
# Still 50 times below the tolerance of CalculiX.
LOOSE_STATIC = {"static": {"frames": 1, "tolerance": 1e-4}, "threads": 1}
RELAXATION = {"until": "rest", "threads": 1}
LOOSE_RELAXATION = {"until": "rest", "tolerance": 1e-4, "threads": 1}


def static_method(model, element, meshes):
    """An equilibrium; `element` "": of models that have no choice of elements."""
    return Method(" ".join(filter(None, (model, element))) + ", static", model,
                  {"element": element} if element else {}, STATIC, meshes)


def both_elements(meshes, trilinear=None):
    return [static_method("tm-faure", "mean-gradient", meshes),
            static_method("tm-faure", "trilinear", trilinear or meshes)]


def relaxed_methods(largest):
    """Relaxation by explicit steps."""
    meshes = bars(3, 5, 8, 10, 14, *([20] if largest else []))
    gauss = {"element": "trilinear"}
    return [Method("tm-faure gauss2, explicit", "tm-faure", gauss, RELAXATION, meshes),
            Method("tm-faure gauss2, explicit to 1e-4", "tm-faure", gauss, LOOSE_RELAXATION, meshes),
            Method("tm-faure exact, explicit", "tm-faure", {"quadrature": "exact"}, RELAXATION, meshes),
            Method("mss-baudet, explicit", "mss-baudet", {}, RELAXATION, meshes),
            Method("mss-baudet corrected, explicit", "mss-baudet", {"correction": True}, RELAXATION, meshes)]


def solid_methods(largest):
    """Methods whose limit is that of St Venant and Kirchhoff's law at finite strain."""
    mean, trilinear = both_elements(bars(1, 2, 3, 4, 5, 8, 10, 14, 20, *([28] if largest else [])))
    fine = dataclasses.replace(mean, name=mean.name + ", graded", meshes=graded(*GRADED))
    loose = Method("tm-faure mean-gradient, static to 1e-4, graded", "tm-faure", mean.parameters, LOOSE_STATIC,
                   graded(*GRADED, (24, (56, 26, 20))))
    return [mean, fine, trilinear, loose]


def calculix_methods(*rows):
    """Of (element, solver, meshes)."""
    return [CalculixMethod(*row) for row in rows]


DIRECT, ITERATIVE = "SPOOLES", "ITERATIVE CHOLESKY"


def calculix_of_beams(largest):
    rows = [("C3D8", DIRECT, bars(3, 5, 8, 10)), ("C3D8I", DIRECT, bars(1, 2, 3, 5, 8, 10)),
            ("C3D20R", DIRECT, bars(1, 2, 3, 4, 5, 6)), ("C3D8", ITERATIVE, bars(10, 14)),
            ("C3D8I", ITERATIVE, bars(10)), ("C3D20R", ITERATIVE, bars(5, 6))]
    if largest:
        rows += [("C3D8", ITERATIVE, bars(20)), ("C3D8I", ITERATIVE, bars(14, 20)), ("C3D20R", ITERATIVE, bars(8))]
    coarse = graded(GRADED[0], GRADED[1], GRADED[3])
    return calculix_methods(*rows, ("C3D8I", DIRECT, coarse), ("C3D20R", DIRECT, coarse))


# -------------------------------------------------------------------- scenes --

def box_scene(cells, size, method, **material):
    """A box of this size, m, at the origin, without loads, constraints and output."""
    box = {"size": size, "cells": cells.counts}
    if cells.grading != 1:
        box["grading"] = (cells.grading, 1, 1)
    return {"suture": 1, "mesh": {"box": box}, "solver": method.solver,
            "models": [{"model": method.model, "parameters": {**method.parameters, **material}}]}


def tables(name, field, where):
    """Members of a scene's output for tables only, with rows at the beginning and at the end."""
    return {"frames": False, "probes": {"every_steps": 10**9, "at": [
        {"name": name, "fields": [field], "where": where}]}}


def box(low, high):
    return {"box": {"min": low, "max": high}}


def held(name, fix="xyz"):
    return {"fix": fix, "where": {"set": name}}


def moved(name, move, ramp):
    return {"move": move, "ramp": ramp, "where": {"set": name}}


def node_at(point):
    return tables("tip", "displacement", box([x - 1e-7 for x in point], [x + 1e-7 for x in point]))


def cantilever_scene(what, cells, method):
    """Its probe: the centre of the end face, one node or the mean of four."""
    reach = 0.6 * 0.25 / cells.counts[1]
    return {**box_scene(cells, (1, 0.25, 0.25), method, E=4e5, nu=what.nu, rho=1000),
            "gravity": (0, -what.gravity, 0), "constraints": [held("x0")],
            "output": tables("tip", "displacement", box((1 - 1e-6, 0.125 - reach, 0.125 - reach),
                                                        (1 + 1e-6, 0.125 + reach, 0.125 + reach)))}


def plate(scene, shift, ramp):
    """A block held below, whose upper plate moves along it."""
    return {**scene, "constraints": [held("y0"), moved("y1", {"translation": (shift, 0, 0)}, ramp)],
            "output": tables("plate", "reaction", {"set": "y1"})}


# --------------------------------------------------------------------- beams --

def beam_case(name, reference, source, methods, beside=()):
    return Case(f"cantilever {name}", reference, source, functools.partial(cantilever_scene, CANTILEVERS[name]),
                "tip displacement y [m]", 1, methods, beside)


DOLFINX = "DOLFINx on graded quadratic meshes, extrapolated; FreeFem++ agrees"


def loaded_beam(name, largest, other_laws=()):
    """`other_laws`: models that agree with St Venant and Kirchhoff's law at this load."""
    springs = static_method("mss-golec", "", bars(3, 5, 8, 10, 14))
    others = [static_method(model, "mean-gradient", bars(3, 5, 10, 20)) for model in other_laws]
    return beam_case(name, CANTILEVERS[name].converged, DOLFINX,
                     solid_methods(largest) + others + relaxed_methods(largest) + [springs],
                     calculix_of_beams(largest))


def full_load():
    return beam_case("A", -0.513, "extrapolated along the smooth branch, +-0.0015 m: meshes do not converge at this "
                     "load, so errors below 0.3 % mean nothing",
                     both_elements(bars(1, 2, 3, 5, 8, 10), bars(3, 5, 8, 10, 20)), calculix_of_beams(False))


def incompressible():
    return beam_case("H0.499", CANTILEVERS["H0.499"].converged,
                     "DOLFINx, Taylor-Hood elements on graded meshes, extrapolated",
                     both_elements(bars(1, 2, 3, 5, 8, 10, 14, 20), bars(3, 5, 10, 20)), calculix_of_beams(False))


def stepped(name, **members):
    return Method(name, "tm-faure", {"element": "trilinear"}, {"end": 0.5, "threads": 1, **members}, bars(5))


def dynamic():
    """The integrators on one mesh, at half a second of its fall."""
    methods = [stepped(f"{name}, auto", integrator=name) for name in ("symplectic-euler", "velocity-verlet")]
    for steps, names in ((("1e-3", "2.5e-4", "1e-4"), ("symplectic-euler", "velocity-verlet")),
                         (("0.05", "0.02", "0.01", "0.005", "0.002"), ("implicit-euler", "newmark"))):
        methods += [stepped(f"{name} {dt} s", integrator=name, dt=float(dt)) for dt in steps for name in names]
    methods += [stepped(f"implicit-euler, 10 iterations {dt} s", integrator="implicit-euler",
                        budget={"iterations": 10}, dt=float(dt)) for dt in ("0.02", "0.005", "0.002")]
    methods += [stepped(f"xpbd {dt} s", integrator="xpbd", dt=float(dt)) for dt in ("1e-3", "5e-4", "2e-4")]
    methods += [stepped(f"newmark, step error {error}", integrator="newmark", dt="auto", step_error=float(error))
                for error in ("1e-2", "1e-3", "1e-4")]
    what = beam_case("A0.25", -0.2651348699, "two other programs on the same mesh with 1e-5 s steps: the error is "
                     "that of the integrator", methods)
    return dataclasses.replace(what, name="cantilever A0.25, dynamic")


# --------------------------------------------------------------------- liver --

def shear():
    meshes = [Cells((3 * n, n, n)) for n in (2, 4, 6, 10, 15, 20)]
    return Case("shear of liver", 3.048694,
                "DOLFINx, Taylor-Hood elements on graded meshes, extrapolated; FreeFem++ agrees",
                lambda cells, method: plate(box_scene(cells, (0.03, 0.01, 0.01), method, E=1000, nu=0.499, rho=1000),
                                            1e-4, 1),
                "plate reaction x [N]", 1 / 3e-4, both_elements(meshes),
                calculix_methods(("C3D8", DIRECT, meshes[:3]), ("C3D8I", DIRECT, meshes[:3]),
                                 ("C3D20R", DIRECT, meshes[:2]), ("C3D8I", ITERATIVE, meshes[2:3])))


def power_law():
    """One element in simple shear at a constant rate for 10 s, so little that the law is linear."""
    stiffness, exponent, rate, end, side = 861, 0.1138, 0.67e-4, 10, 0.01
    return Case("power law of liver, 10 s",
                stiffness * rate * end ** (1 - exponent) / math.gamma(2 - exponent),
                "the law itself, K r t^(1-n) / Gamma(2-n), of which the model has five relaxation times",
                lambda cells, method: plate(
                    box_scene(cells, (side, side, side), method, K=stiffness, n=exponent, rho=1000,
                              **{"lambda": 166444.3}), rate * end * side, end),
                "plate reaction x [N]", 1e4,
                [Method(f"visco, {steps} steps", "visco", {},
                        {"end": end, "threads": 1, "static": {"frames": steps}}, [Cells((1, 1, 1))])
                 for steps in (30, 100, 300, 1000, 3000)])


# --------------------------------------------------------------------- twist --

def twist_scene(cells, method):
    scene = box_scene(cells, (1, 0.25, 0.25), method, E=4e5, nu=0.3, rho=1000)
    scene["mesh"]["box"]["origin"] = (0, -0.125, -0.125)
    turn = {"rotation": {"axis": (1, 0, 0), "angle": 90}}
    return {**scene, "constraints": [held("x0"), moved("x1", turn, 1)],
            "output": tables("grip", "reaction_moment", {"set": "x1"})}


def twist():
    """A bar twisted by 90 degrees: the torque."""
    return Case("twist by 90 degrees", 135.254,
                "CalculiX, C3D20R on 12x3x3 to 24x6x6 elements, extrapolated with their order of 2.3; the last is "
                "0.04 % above",
                twist_scene, "grip reaction_moment x [N m]", 1, both_elements(bars(1, 2, 3, 5, 8, 10, 14, 20)),
                calculix_methods(("C3D8", DIRECT, bars(3, 5, 8)), ("C3D8I", DIRECT, bars(1, 2, 3, 5, 8)),
                                 ("C3D20R", DIRECT, bars(2, 3, 4, 5)), ("C3D8I", ITERATIVE, bars(8)),
                                 ("C3D20R", ITERATIVE, bars(5))),
                finest=CalculixMethod("C3D20R", DIRECT, bars(3, 4, 6)))


# ------------------------------------------------------------------ membrane --

# A plate with corners (0, 0), (48, 44), (48, 60), (0, 44) mm, E = 70 MPa, nu = 1/3, plane strain, a shear traction of
# 6.25 MPa on its right side: here a hundred-thousandth of it, so that the problem is the linear one.
def membrane_mesh(cells):
    mesh = box_mesh((1, 1, 1), cells.counts)
    mesh.points = [(0.048 * x, 0.044 * x + (0.044 + 0.016 * x - 0.044 * x) * y, 1e-3 * z) for x, y, z in mesh.points]
    return mesh


def membrane_scene(cells, method):
    return {**box_scene(cells, (1, 1, 1), method, E=70e6, nu=1 / 3, rho=1000), "mesh": {"file": MESH_FILE},
            "constraints": [held("x0"), held("z0", "z"), held("z1", "z")],
            "loads": [{"traction": (0, 6.25e6 * 1e-5, 0), "where": {"set": "x1"}}],
            "output": node_at((0.048, 0.060, 0))}


def membrane():
    """Cook's membrane, a skew plate in plane strain under a small shear load: its corner."""
    meshes = [Cells((n, n, 1)) for n in (2, 4, 8, 16, 32, 64, 128)]
    return Case("Cook's membrane", 3.22998e-7,
                "CalculiX, C3D20 on 32x32 to 128x128 elements, extrapolated with their order of 1.1; the last is "
                "0.06 % below. Very fine meshes of CalculiX and Elmer by others: 3.227e-7 and 3.228e-7 (solids4foam, "
                "tutorial cooksMembrane)",
                membrane_scene, "tip displacement y [m]", 1, both_elements(meshes),
                calculix_methods(("C3D8", DIRECT, meshes[:-1]), ("C3D8I", DIRECT, meshes[:-1]),
                                 ("C3D20", DIRECT, meshes[:-2]), ("C3D8I", ITERATIVE, meshes[4:5])),
                membrane_mesh, CalculixMethod("C3D20", DIRECT, meshes[4:]))


# --------------------------------------------------------------------- slit --

def slit_scene(cells, method):
    """Cut are the faces of the middle section in its upper half, named by the elements on both sides."""
    nx, ny, nz = cells.counts
    left = [nx // 2 - 1 + nx * (y + ny * z) for z in range(nz) for y in range(ny // 2, ny)]
    return {**cantilever_scene(Cantilever(0.98, 0.3, None), cells, method),
            "events": [{"at": 0, "cut": {"faces": [(e, e + 1) for e in left]}}]}


def slit():
    """A cantilever with a slit from above to half its height: its tip."""
    return Case("cantilever with a slit", -0.0861762,
                "CalculiX, C3D20R on 16x4x4 to 40x10x10 elements, extrapolated with their order of 1.05 (theory, at "
                "the tip of a crack: 1); the last is 1.5 % below",
                slit_scene, "tip displacement y [m]", 1, both_elements(bars(2, 4, 6, 8, 10, 14, 20)),
                calculix_methods(("C3D8", DIRECT, bars(2, 4, 6, 8)), ("C3D8I", DIRECT, bars(2, 4, 6, 8)),
                                 ("C3D20R", DIRECT, bars(2, 4, 6)), ("C3D8I", ITERATIVE, bars(8)),
                                 ("C3D20R", ITERATIVE, bars(6))),
                finest=CalculixMethod("C3D20R", DIRECT, bars(4, 6, 10)))


# -------------------------------------------------------------------- organ --

# A bent ellipsoid, 11 x 6 x 4.4 cm, in 300 cubes: its layers from z0 upwards, x to the right, y downwards. The zero of
#   (x / 0.055)^2 + ((y + 0.01 - 10 x^2) / 0.03)^2 + (z / 0.022)^2 - 1
# in triangles of 4 mm, filled by `suture mesh voxelize --cells 300`.
KIDNEY = """
.............. .............. ......##...... ......##...... .............. ..............
.............. .....####..... ....######.... ....######.... .....####..... ..............
......#....... ...#######.... ...########... ...########... ...########... ......#.......
.....####..... ...########... ..##########.. ..##########.. ...########... .....####.....
....######.... ..##########.. .############. .############. ..##########.. ....######....
.....####..... ..##########.. .############. .############. .###########.. .....####.....
.............. .############. ############## ############## .############. ..............
.............. ..##.......#.. ############## ############## ..#.......##.. ..............
.............. .............. .#..........#. .#..........#. .............. ..............
"""
KIDNEY_EDGE = 0.007965299391366878  # m
KIDNEY_CORNER = (-0.05572977744011527, -0.04199115698040835, -0.023919838784708436)  # m


@functools.cache
def kidney():
    rows = [line.split() for line in KIDNEY.split("\n") if line]
    numbers, mesh = {}, Mesh([], [])
    for k in range(len(rows[0])):
        for j, row in enumerate(rows):
            for i, mark in enumerate(row[k]):
                if mark == "#":
                    corners = [(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)) for c in range(8)]
                    mesh.hexahedra.append(tuple(numbers.setdefault(at, len(numbers)) for at in corners))
    mesh.points = [tuple(low + KIDNEY_EDGE * n for low, n in zip(KIDNEY_CORNER, at)) for at in numbers]
    return mesh


def organ_scene(cells, method):
    """Held are the first two layers of voxels, loaded by a tenth of its weight, as in a liquid."""
    grip = box((-1, -1, -1), (KIDNEY_CORNER[0] + 2.01 * KIDNEY_EDGE, 1, 1))
    last = max(reversed(kidney().points), key=lambda p: p[0])
    return {**box_scene(cells, (1, 1, 1), method, E=4e4, nu=0.45, rho=1050), "mesh": {"file": MESH_FILE},
            "gravity": (0, 0, -0.98), "constraints": [{"fix": "xyz", "where": grip}], "output": node_at(last)}


def organ():
    """A kidney of voxels that hangs from one end, each voxel divided into equal cubes: its other end."""
    meshes = [Cells((n, n, n)) for n in (1, 2, 3, 4)]
    return Case("organ of voxels", -0.00349,
                "CalculiX, C3D20 with 1 and 2 and C3D8I with 2 and 3 cubes along the edge of a voxel, each "
                "extrapolated with the order 1.09 of a re-entrant edge: -0.003499 and -0.003485",
                organ_scene, "tip displacement z [m]", 1, both_elements(meshes),
                calculix_methods(("C3D8", DIRECT, meshes[:2]), ("C3D8I", DIRECT, meshes[:2]),
                                 ("C3D20", DIRECT, meshes[:1]), ("C3D8I", ITERATIVE, meshes[1:3])),
                lambda cells: divided(kidney(), cells.counts[0]), CalculixMethod("C3D8I", ITERATIVE, meshes[1:]))


def work_cases(largest=False):
    """`largest`: with the meshes that take longer than 5 s."""
    return [loaded_beam("A0.25", largest), loaded_beam("B", largest, ("hooke", "corotational", "neo-hookean")),
            full_load(), incompressible(), shear(), twist(), membrane(), slit(), organ(), power_law(), dynamic()]
