#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Error against run time where the shape matters: a round rod in torsion, a thick sphere under
pressure and a bar after an oblique cut, as parts of cubes, as whole cubes, and on meshes that follow the
surface in CalculiX (needs `gmsh` and `ccx`). Prints a table in Markdown.

    shape_precision.py path/to/suture
"""

import json
import math
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile

from harness import last_row

E, NU, DENSITY = 1000.0, 0.3, 1000  # Pa, 1, kg/m^3
MATERIAL = {"model": "hooke", "parameters": {"E": E, "nu": NU, "rho": DENSITY, "element": "mean-gradient"}}
ROUNDS = 3

# The rod: radius and length, m, about x; what lies between the ends that are held is twisted.
RADIUS, LENGTH, GRIP, ANGLE = 0.1, 0.6, 0.1, 0.1  # m, m, m, degrees
# Rods whose axis is turned against the grid.
TURNED_AXES = ((2 / 3, 1 / 3, 2 / 3), (1 / 3, 2 / 3, -2 / 3), (-2 / 3, 2 / 3, 1 / 3))
TURNED_LENGTHS, TURNED_ANGLE = (0.6, 1.2), 0.01  # m, degrees
# The sphere: radii and pressure inside.
INNER, OUTER, PRESSURE = 0.5, 1.0, 1e-3  # m, m, Pa
# The bar of 1 m: its other sides, the tilt of the cut, and its weight, m/s^2.
SIDE, TILT, GRAVITY = 0.25, math.pi / 6, 1e-5  # m, radians, m/s^2


def timed(*command, folder):
    """CPU seconds of a process and its output."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(c) for c in command], cwd=folder, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        raise RuntimeError(f"{command[0]}: {done.stderr or done.stdout}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def write_obj(file, points, triangles):
    with open(file, "w", encoding="ascii") as out:
        for point in points:
            out.write("v %.12g %.12g %.12g\n" % point)
        for triangle in triangles:
            out.write("f %d %d %d\n" % tuple(corner + 1 for corner in triangle))


def rod_surface(file, length=LENGTH, axes=((1, 0, 0), (0, 1, 0), (0, 0, 1)), around=192):
    """`axes`: along the rod, and two across it."""
    ring = [(RADIUS * math.cos(a), RADIUS * math.sin(a))
            for a in (2 * math.pi * j / around for j in range(around))]
    local = [(x, y, z) for x in (0.0, length) for y, z in ring] + [(0.0, 0.0, 0.0), (length, 0.0, 0.0)]
    points = [tuple(sum(u * axis[c] for u, axis in zip(at, axes)) for c in range(3)) for at in local]
    triangles = []
    for j in range(around):
        a, b = j, (j + 1) % around
        triangles += [(a, b, b + around), (a, b + around, a + around),
                      (2 * around, b, a), (2 * around + 1, a + around, b + around)]
    write_obj(file, points, triangles)


def ball(radius, rings, first, inward):
    """Points and triangles of a sphere, numbered from `first`."""
    m = 2 * rings
    points = [(0.0, 0.0, radius)]
    for i in range(1, rings):
        t = math.pi * i / rings
        points += [(radius * math.sin(t) * math.cos(2 * math.pi * j / m),
                    radius * math.sin(t) * math.sin(2 * math.pi * j / m), radius * math.cos(t))
                   for j in range(m)]
    points.append((0.0, 0.0, -radius))

    def at(i, j):
        return first + 1 + (i - 1) * m + j % m

    triangles = []
    for j in range(m):
        triangles += [(first, at(1, j), at(1, j + 1)),
                      (first + len(points) - 1, at(rings - 1, j + 1), at(rings - 1, j))]
        for i in range(1, rings - 1):
            triangles += [(at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1))]
    return points, [t[::-1] if inward else t for t in triangles]


def sphere_surface(file, rings=120):
    points, triangles = ball(OUTER, rings, 0, False)
    hollow, inside = ball(INNER, rings, len(points), True)
    write_obj(file, points + hollow, triangles + inside)


def run_scene(suture, folder, scene):
    """The median of the CPU seconds; once if it takes more than one."""
    (folder / "scene.json").write_text(json.dumps({"suture": 2, "models": [MATERIAL], **scene}))
    times = []
    while len(times) < ROUNDS and sum(times) < 1:
        times.append(timed(suture, "run", "-q", "scene.json", "--output", "out", folder=folder))
    return statistics.median(times)


def whole_cubes(suture, folder, surface, edge):
    """Makes m.mesh; returns the CPU seconds, and the planes of its nodes across x."""
    cpu = timed(suture, "mesh", "voxelize", surface, "--edge", edge, "-o", "m.mesh", folder=folder)
    lines = iter((folder / "m.mesh").read_text().splitlines())
    count = next(int(line.split()[1]) for line in lines if line.startswith("Vertices"))
    return cpu, sorted({round(float(next(lines).split()[0]), 9) for _ in range(count)})


def torsion(low, high):
    """The moment of the rod between two planes."""
    return E / (2 + 2 * NU) * math.pi * RADIUS**4 / 2 * math.radians(ANGLE) / (high - low)


def rod_in_suture(suture, folder, edge, is_whole):
    mesh, cpu = {"surface": "rod.obj", "edge": edge}, 0.0
    planes = [edge * (i - 0.5) for i in range(round(LENGTH / edge) + 2)]
    if is_whole:
        cpu, planes = whole_cubes(suture, folder, "rod.obj", edge)
        mesh = {"file": "m.mesh"}
    low = min(x for x in planes if x > GRIP - 1e-9)
    high = max(x for x in planes if x < LENGTH - GRIP + 1e-9)
    left = {"box": {"min": [-1, -1, -1], "max": [low + 1e-6, 1, 1]}}
    right = {"box": {"min": [high - 1e-6, -1, -1], "max": [1, 1, 1]}}
    turn = {"rotation": {"axis": [1, 0, 0], "angle": ANGLE, "centre": [0, 0, 0]}}
    cpu += run_scene(suture, folder, {
        "mesh": mesh,
        "constraints": [{"fix": "xyz", "where": left}, {"move": turn, "ramp": 1, "where": right}],
        "solver": {"static": {"tolerance": 1e-4}, "threads": 1},
        "output": {"frames": False, "probes": {"every_steps": 1, "at": [
            {"name": "grip", "where": left, "fields": ["reaction_moment"]}]}}})
    row = last_row(folder / "out/probes.csv")
    moment = abs(float(next(v for k, v in row.items() if "moment x" in k)))
    return cpu, moment / torsion(low, high) - 1


def turned_rods_in_suture(suture, folder, edge, axis, exact):
    """CPU seconds of two rods, and the error of the compliance per length. The second rod is longer by whole
    cells in each direction, so that what the ends do is the same in both. `axis`: of the turn of an end."""
    cpu, compliances = 0.0, []
    along = TURNED_AXES[0]
    for length in TURNED_LENGTHS:
        rod_surface(folder / "turned.obj", length, TURNED_AXES, 768)
        left, right = ({"sphere": {"centre": [s * a for a in along], "radius": 2 * RADIUS}}
                       for s in (-RADIUS, length + RADIUS))
        turn = {"rotation": {"axis": axis, "angle": TURNED_ANGLE, "centre": [length / 2 * a for a in along]}}
        cpu += run_scene(suture, folder, {
            "mesh": {"surface": "turned.obj", "edge": edge},
            "constraints": [{"fix": "xyz", "where": left}, {"move": turn, "ramp": 1, "where": right}],
            "solver": {"static": {"tolerance": 1e-6}, "threads": 1},
            "output": {"frames": False, "energies": {}}})
        energy = float(last_row(folder / "out/energies.csv")["elastic [J]"])
        compliances.append(math.radians(TURNED_ANGLE) ** 2 / (2 * energy))
    way = TURNED_LENGTHS[1] - TURNED_LENGTHS[0]
    return cpu, (compliances[1] - compliances[0]) / way / exact - 1


def sphere_energy():
    """Lame's solution."""
    moved = PRESSURE * INNER**3 / (E * (OUTER**3 - INNER**3)) * (
        (1 - 2 * NU) * INNER + (1 + NU) * OUTER**3 / (2 * INNER**2))
    return 0.5 * PRESSURE * moved * 4 * math.pi * INNER**2


def sphere_in_suture(suture, folder, edge, is_whole):
    mesh, cpu = {"surface": "sphere.obj", "edge": edge}, 0.0
    if is_whole:
        cpu, _ = whole_cubes(suture, folder, "sphere.obj", edge)
        mesh = {"file": "m.mesh"}
    side = edge / 2
    cpu += run_scene(suture, folder, {
        "mesh": mesh,
        "constraints": [{"fix": "xyz", "where": {"nearest": [0.75, side, side]}},
                        {"fix": "yz", "where": {"nearest": [-0.75, side, side]}},
                        {"fix": "z", "where": {"nearest": [side, 0.75, side]}}],
        "loads": [{"pressure": PRESSURE, "where": {"sphere": {"centre": [0, 0, 0], "radius": 0.75}}}],
        "solver": {"static": {"tolerance": 1e-5}, "threads": 1},
        "output": {"frames": False, "energies": {}}})
    return cpu, float(last_row(folder / "out/energies.csv")["elastic [J]"]) / sphere_energy() - 1


GAUGE = LENGTH - 2 * GRIP
ROD_OF_TETRAHEDRA = f"""Cylinder(1) = {{0, 0, 0, {GAUGE}, 0, 0, {RADIUS}}};
"""
ROD_OF_HEXAHEDRA = f"""Disk(1) = {{0, 0, 0, {RADIUS}, {RADIUS}}};
Rotate {{{{0, 1, 0}}, {{0, 0, 0}}, Pi / 2}} {{ Surface{{1}}; }}
Recombine Surface{{1}};
Mesh.SecondOrderIncomplete = 1;
Mesh.SubdivisionAlgorithm = 1;
Extrude {{{GAUGE}, 0, 0}} {{ Surface{{1}}; Layers{{Ceil({GAUGE} / EDGE)}}; Recombine; }}
"""
# Two boxes, each without what lies on the other side of the plane.
CUT_BAR = "".join(f"""Box({i}) = {{0, 0, 0, 1, {SIDE}, {SIDE}}};
Box({i + 2}) = {{{x}, -4, -4, 8, 8, 8}};
Rotate {{{{0, 1, 0}}, {{0, 0, 0}}, {-TILT}}} {{ Volume{{{i + 2}}}; }}
Translate {{0.5, {SIDE / 2}, {SIDE / 2}}} {{ Volume{{{i + 2}}}; }}
BooleanDifference {{ Volume{{{i}}}; Delete; }}{{ Volume{{{i + 2}}}; Delete; }}
""" for i, x in ((1, 0), (2, -8)))
# gmsh's numbers of element types, and its order of nodes in that of CalculiX
TYPES = {"C3D10": (11, [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]),
         "C3D20R": (17, [0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15])}


def read_gmsh(file, element):
    number, order = TYPES[element]
    lines = iter(file.read_text().splitlines())
    while next(lines) != "$Nodes":
        pass
    nodes = {}
    for _ in range(int(next(lines))):
        name, *at = next(lines).split()
        nodes[int(name)] = [float(x) for x in at]
    while next(lines) != "$Elements":
        pass
    cells = []
    for _ in range(int(next(lines))):
        values = [int(v) for v in next(lines).split()]
        if values[1] == number:
            corners = values[3 + values[2]:]
            cells.append([corners[i] for i in order])
    used = {n for cell in cells for n in cell}
    return {n: at for n, at in nodes.items() if n in used}, cells


def run_calculix(folder, geometry, edge, element, step):
    """CPU seconds of gmsh and ccx, and the nodes. `step`: from the nodes to what follows the mesh."""
    (folder / "c.geo").write_text('SetFactory("OpenCASCADE");\n' + geometry)
    cpu = timed("gmsh", "-3", "-order", 2, "-clmax", edge, "-clmin", edge, "-format", "msh22",
                "-o", "c.msh", "c.geo", folder=folder)
    nodes, cells = read_gmsh(folder / "c.msh", element)
    with open(folder / "c.inp", "w", encoding="ascii") as out:
        out.write("*NODE, NSET=ALL\n")
        out.writelines("%d, %.12g, %.12g, %.12g\n" % (n, *at) for n, at in nodes.items())
        out.write(f"*ELEMENT, TYPE={element}, ELSET=BODY\n")
        for i, cell in enumerate(cells):
            values = [str(v) for v in [i + 1, *cell]]
            out.write(", ".join(values[:11]) + "".join(f",\n{v}" for v in values[11:]) + "\n")
        out.write(f"*MATERIAL, NAME=M\n*ELASTIC\n{E}, {NU}\n*DENSITY\n{DENSITY}\n"
                  "*SOLID SECTION, ELSET=BODY, MATERIAL=M\n" + step(nodes))
    return cpu + timed("ccx", "-i", "c", folder=folder), nodes


def rod_in_calculix(folder, edge, element):
    angle = math.radians(ANGLE)

    def step(nodes):
        text = "*NSET, NSET=LEFT\n" + "".join(f"{n},\n" for n, at in nodes.items() if at[0] < 1e-9)
        text += "*STEP\n*STATIC\n*BOUNDARY\nLEFT, 1, 3\n"
        for n, (x, y, z) in nodes.items():
            if x > GAUGE - 1e-9:
                text += f"{n}, 1, 1, 0\n{n}, 2, 2, {-angle * z:.12g}\n{n}, 3, 3, {angle * y:.12g}\n"
        return text + "*NODE PRINT, NSET=LEFT\nRF\n*END STEP\n"

    geometry = ROD_OF_TETRAHEDRA if element == "C3D10" else ROD_OF_HEXAHEDRA.replace("EDGE", str(edge))
    cpu, nodes = run_calculix(folder, geometry, edge, element, step)
    moment = 0.0
    for line in (folder / "c.dat").read_text().splitlines():
        values = line.split()
        if len(values) == 4 and values[0].isdigit():
            _, y, z = nodes[int(values[0])]
            moment += y * float(values[3]) - z * float(values[2])
    return cpu, abs(moment) / torsion(0, GAUGE) - 1


def bar_in_suture(suture, folder, across, along):
    """The energy of a bar of 1 m whose ends are held, cut right through at 30 degrees."""
    cpu = run_scene(suture, folder, {
        "mesh": {"box": {"size": [1, SIDE, SIDE], "cells": [4 * across, across, across]}},
        "gravity": [0, 0, -GRAVITY],
        "constraints": [{"fix": "xyz", "where": {"set": end}} for end in ("x0", "x1")],
        "events": [{"at": 0.5, "cut": {"along": along, "plane": {
            "point": [0.5, SIDE / 2, SIDE / 2], "normal": [math.cos(TILT), 0, math.sin(TILT)]}}}],
        "solver": {"static": {"frames": 2, "tolerance": 1e-6}, "end": 1, "threads": 1},
        "output": {"frames": False, "energies": {}}})
    return cpu, float(last_row(folder / "out/energies.csv")["elastic [J]"])


def bar_in_calculix(folder, edge):
    def step(nodes):
        held = (n for n, at in nodes.items() if min(at[0], 1 - at[0]) < 1e-9)
        return ("*NSET, NSET=ENDS\n" + "".join(f"{n},\n" for n in held)
                + f"*STEP\n*STATIC\n*BOUNDARY\nENDS, 1, 3\n*DLOAD\nBODY, GRAV, {GRAVITY}, 0, 0, -1\n"
                "*EL PRINT, ELSET=BODY, TOTALS=ONLY\nELSE\n*END STEP\n")

    cpu, _ = run_calculix(folder, CUT_BAR, edge, "C3D10", step)
    return cpu, float((folder / "c.dat").read_text().split()[-1])


def print_table(title, rows):
    print(f"**{title}**\n\n| program | method | edge m | cpu_s | relative_error |\n|---|---|---|---|---|")
    for program, method, edge, (cpu, error) in rows:
        shown = f"{error:.3g}" if error != 0 else "the reference"
        print(f"| {program} | {method} | {edge:.3g} | {cpu:.3g} | {shown} |")
    print(flush=True)


def main():
    suture = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        rod_surface(folder / "rod.obj")
        sphere_surface(folder / "sphere.obj")
        edges = [RADIUS / n for n in (2, 4, 8, 16)]
        rows = [("Suture", method, h, rod_in_suture(suture, folder, h, is_whole))
                for method, is_whole in (("parts of cubes", False), ("whole cubes", True)) for h in edges]
        rows += [("CalculiX with gmsh", element, h, rod_in_calculix(folder, h, element))
                 for element in TYPES for h in (RADIUS, RADIUS / 2, RADIUS / 4)]
        print_table("Round rod in torsion, moment", rows)
        bending, torsion = (4 * factor / (E * math.pi * RADIUS**4) for factor in (1, 1 + NU))
        rows = [("Suture", f"parts of cubes, {case}", h, turned_rods_in_suture(suture, folder, h, axis, exact))
                for case, axis, exact in (("bending", TURNED_AXES[1], bending),
                                          ("torsion", TURNED_AXES[0], torsion)) for h in edges[1:]]
        print_table("Round rods turned against the grid, compliance", rows)
        rows = [("Suture", method, OUTER / n, sphere_in_suture(suture, folder, OUTER / n, is_whole))
                for method, is_whole in (("parts of cubes", False), ("whole cubes", True)) for n in (8, 16, 32)]
        print_table("Thick sphere under pressure, energy", rows)
        calculix = [(h, bar_in_calculix(folder, h)) for h in (SIDE / 2, SIDE / 4, SIDE / 8, SIDE / 12)]
        exact = calculix[-1][1][1]
        rows = [("Suture", method, SIDE / n, bar_in_suture(suture, folder, n, along))
                for method, along in (("parts of cubes", "blade"), ("whole cubes", "faces"))
                for n in (4, 8, 16)]
        rows += [("CalculiX with gmsh", "C3D10", h, run) for h, run in calculix]
        print_table("Bar cut at 30 degrees under its weight, energy",
                    [(*row[:3], (row[3][0], row[3][1] / exact - 1)) for row in rows])


if __name__ == "__main__":
    main()
