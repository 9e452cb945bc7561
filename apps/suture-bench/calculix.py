# SPDX-License-Identifier: GPL-3.0-or-later
"""What another program, CalculiX (Debian: calculix-ccx), makes of a static scene.

Solved are scenes on their mesh with one model with E, nu and rho (as St Venant and Kirchhoff's law), gravity,
constraints, tractions and cuts of named faces, all at the end of their ramps. Nodes are selected by sets and boxes. The
first probe shows displacement (one node, or the centre of four), reaction or reaction_moment."""
import dataclasses
import math
import os
import pathlib
import shutil
import tempfile

import harness
from solid_mesh import SolidMesh, cross, dot, with_slit

ELEMENTS = ("C3D8", "C3D8I", "C3D20", "C3D20R")


@dataclasses.dataclass
class Run:
    dofs: int  # unknowns, those of constrained nodes included
    use: object  # ProcessUse of the whole process, one thread
    iterations: int  # of Newton's method, in all increments
    probe: tuple  # the field of the scene's first probe; seven digits


class Failure(harness.Failure):
    """What ccx did not solve."""


def is_installed():
    return shutil.which("ccx") is not None


# ------------------------------------------------------------------- selections --

def nodes_in(where, mesh, solid):
    """A node between two corners is in a set if both are."""
    if "set" in where:
        marked = set(mesh.sets[where["set"]])
        found = [n for n, (a, b) in enumerate(solid.nodes) if a in marked and b in marked]
    elif "box" in where:
        low, high = where["box"]["min"], where["box"]["max"]
        found = [n for n, p in enumerate(solid.points) if all(l <= x <= h for l, x, h in zip(low, p, high))]
    else:
        raise ValueError(f"CalculiX cannot select {where}")
    if not found:
        raise ValueError(f"no node of the mesh is in {where}")
    return found


def nodes_of_probe(where, mesh, solid):
    """The node in the middle of the probe's box, if there is one, else all nodes in it."""
    found = nodes_in(where, mesh, solid)
    if "box" in where:
        middle = [(l + h) / 2 for l, h in zip(where["box"]["min"], where["box"]["max"])]
        for n in found:
            if all(abs(x - m) < 1e-9 for x, m in zip(solid.points[n], middle)):
                return [n]
    return found


# --------------------------------------------------------------------- deck --

def text_of(number):
    """ccx reads at most 20 characters of a number."""
    return f"{number:.13g}"


def list_of(numbers):
    return ", ".join(text_of(x) for x in numbers)


def displacement_of(move, point, part):
    """Where a part of a prescribed motion takes a point: c + R(angle) (X - c) + t."""
    u = [part * x for x in move.get("translation", (0, 0, 0))]
    if "rotation" not in move:
        return u
    rotation = move["rotation"]
    r = [x - c for x, c in zip(point, rotation.get("centre", (0, 0, 0)))]
    length = math.sqrt(dot(rotation["axis"], rotation["axis"]))
    n = [x / length for x in rotation["axis"]]
    angle, side = part * rotation["angle"] * math.pi / 180, cross(n, r)
    # Rodrigues: R r - r = sin a (n x r) + (1 - cos a) (n (n . r) - r)
    return [u[c] + math.sin(angle) * side[c] + (1 - math.cos(angle)) * (n[c] * dot(n, r) - r[c])
            for c in range(3)]


def constraint_lines(scene, mesh, solid, part):
    yield "*BOUNDARY"
    for constraint in scene.get("constraints", ()):
        for n in nodes_in(constraint["where"], mesh, solid):
            u = displacement_of(constraint.get("move", {}), solid.points[n], part)
            for axis in constraint.get("fix", "xyz"):
                c = "xyz".index(axis)
                yield f"{n + 1}, {c + 1}, {c + 1}, {text_of(u[c])}"


def load_lines(scene, mesh, solid):
    g = scene.get("gravity", (0, 0, 0))
    size = math.sqrt(dot(g, g))
    if size > 0:
        yield "*DLOAD"
        yield "BODY, GRAV, " + list_of([size] + [x / size for x in g])
    for load in scene.get("loads", ()):
        selected = set(nodes_in(load["where"], mesh, solid))
        yield "*CLOAD"
        for n, area in solid.loaded_nodes(selected.__contains__):
            for c, traction in enumerate(load["traction"], 1):
                yield f"{n + 1}, {c}, {text_of(area * traction)}"


def mesh_lines(solid, element):
    yield "*NODE, NSET=ALL"
    for n, point in enumerate(solid.points, 1):
        yield f"{n}, {list_of(point)}"
    yield f"*ELEMENT, TYPE={element}, ELSET=BODY"
    for e, nodes in enumerate(solid.elements, 1):
        numbers = [str(n + 1) for n in nodes]
        yield ", ".join([str(e)] + numbers[:10]) + (",\n" + ", ".join(numbers[10:]) if numbers[10:] else "")


def step_count(scene):
    """ccx moves nodes along straight lines: it takes a rotation in steps of at most 15 degrees."""
    angles = [abs(c["move"]["rotation"]["angle"]) for c in scene.get("constraints", ())
              if "rotation" in c.get("move", {})]
    return max(1, math.ceil(max(angles, default=0) / 15))


def deck_lines(scene, mesh, solid, probe, element, solver, precise):
    material = scene["models"][0]["parameters"]
    yield from mesh_lines(solid, element)
    yield "*NSET, NSET=PROBE"
    for n in probe:
        yield f"{n + 1},"
    yield f"*MATERIAL, NAME=SOLID\n*ELASTIC\n{list_of((material['E'], material['nu']))}"
    yield f"*DENSITY\n{text_of(material['rho'])}\n*SOLID SECTION, ELSET=BODY, MATERIAL=SOLID"
    steps = step_count(scene)
    for step in range(1, steps + 1):
        yield f"*STEP, NLGEOM, INC=1000\n*STATIC, SOLVER={solver}\n1., 1."
        if precise:
            yield "*CONTROLS, PARAMETERS=FIELD\n1e-9, 1e-9"
        yield from constraint_lines(scene, mesh, solid, step / steps)
        yield from load_lines(scene, mesh, solid)
        yield "*NODE PRINT, NSET=PROBE\nU\n*NODE PRINT, NSET=PROBE\nRF\n*END STEP"


# ----------------------------------------------------------------- results --

def rows_of(file):
    """Rows of at least four numbers, as ccx writes them; other lines are skipped."""
    rows = []
    for line in file.read_text().splitlines():
        row = []
        for word in line.split():
            try:
                row.append(float(word))
            except ValueError:
                break
        if len(row) >= 4:
            rows.append(row)
    return rows


def mean_displacement(displacements, probe, solid):
    """One node, or the centre of a square of four: of quadratic elements, whose corners count -1/4 and whose nodes
    between them 1/2 each."""
    weights = [1 / len(probe)] * len(probe)
    if solid.quadratic and len(probe) == 8:
        weights = [-0.25 if len(set(solid.nodes[n])) == 1 else 0.5 for n in probe]
    return [sum(w * u[c] for w, u in zip(weights, displacements)) for c in range(3)]


def value_of(field, rows, probe, solid):
    """`rows`: displacements, then reactions, of the nodes of the probe at the end of the last increment."""
    count = len(probe)
    displacements, forces = ([row[1:4] for row in part] for part in (rows[-2 * count:-count], rows[-count:]))
    if field == "displacement":
        return mean_displacement(displacements, probe, solid)
    if field == "reaction_moment":
        places = [[x + d for x, d in zip(solid.points[n], u)] for n, u in zip(probe, displacements)]
        forces = [cross(place, force) for place, force in zip(places, forces)]
    return [sum(force[c] for force in forces) for c in range(3)]


def run(scene, mesh, element, solver="SPOOLES", precise=False):
    """`solver`: SPOOLES (CalculiX's default) or ITERATIVE CHOLESKY; `precise`: Newton's method to 1e-9 instead of
    CalculiX's 0.5 %. Raises Failure if ccx fails."""
    if element not in ELEMENTS:
        raise ValueError(f"CalculiX element '{element}' must be one of {', '.join(ELEMENTS)}")
    cut = with_slit(mesh, [pair for event in scene.get("events", ()) for pair in event["cut"]["faces"]])
    solid = SolidMesh(cut, element.startswith("C3D20"))
    asked = scene["output"]["probes"]["at"][0]
    probe = nodes_of_probe(asked["where"], cut, solid)
    os.environ["OMP_NUM_THREADS"] = "1"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        with open(folder / "job.inp", "w", encoding="ascii") as deck:
            deck.writelines(line + "\n" for line in deck_lines(scene, cut, solid, probe, element, solver, precise))
        use = harness.run_process(["ccx", "-i", "job"], folder)
        if use.code != 0:
            raise Failure(f"ccx failed on {len(solid.elements)} {element}: exit code {use.code}")
        rows = rows_of(folder / "job.dat")
        if len(rows) < 2 * len(probe):
            raise Failure("job.dat: no values of the probe")
        return Run(3 * len(solid.nodes), use, len(rows_of(folder / "job.cvg")),
                   value_of(asked["fields"][0], rows, probe, solid))
