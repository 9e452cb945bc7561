# SPDX-License-Identifier: GPL-3.0-or-later
"""Random surgical scenes: soft bodies of any shape and law that are pulled, pushed, cut, torn and sewn.

scene(seed, folder, is_small) writes FOLDER/SEED.json with its files; everything about it follows from
the seed and `is_small`. Small scenes have up to 400 elements and last 0.1 s; others up to 20,000 and
0.8 s."""

import json
import math
import random


def write_surface(path, place, around, along, is_torus):
    """A closed surface through place(u, v), u around, v along; without is_torus, both ends are points."""
    points, triangles = [], []
    rows = along if is_torus else along - 1
    for j in range(rows):
        v = 2 * math.pi * j / along if is_torus else math.pi * (j + 1) / along
        points += [place(2 * math.pi * i / around, v) for i in range(around)]
    for j in range(rows if is_torus else rows - 1):
        for i in range(around):
            a, b = j * around + i, j * around + (i + 1) % around
            c, d = ((j + 1) % rows) * around + i, ((j + 1) % rows) * around + (i + 1) % around
            triangles += [(a, b, d), (a, d, c)]
    if not is_torus:
        first, last = len(points), len(points) + 1
        points += [place(0, 0), place(0, math.pi)]
        for i in range(around):
            j = (i + 1) % around
            triangles += [(first, j, i), (last, (rows - 1) * around + i, (rows - 1) * around + j)]
    volume = 0
    for t in triangles:
        (a, b, c), (d, e, f), (g, h, i) = (points[k] for k in t)
        volume += a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    with open(path, "w") as out:
        for p in points:
            out.write("v %.9g %.9g %.9g\n" % p)
        for a, b, c in triangles:
            out.write("f %d %d %d\n" % ((a + 1, c + 1, b + 1) if volume < 0 else (a + 1, b + 1, c + 1)))
    return box_of(points)


def box_of(points):
    return [min(p[k] for p in points) for k in range(3)], [max(p[k] for p in points) for k in range(3)]


# The six tetrahedra of a cube whose corners are numbered x + 2 y + 4 z.
TETRAHEDRA = [(0, 1, 3, 7), (0, 3, 2, 7), (0, 2, 6, 7), (0, 6, 4, 7), (0, 4, 5, 7), (0, 5, 1, 7)]


def write_tetrahedra(path, size, bend):
    """A bent bar of tetrahedra, as a VTK file."""
    n = (6, 4, 4)
    number = lambda i, j, k: i + (n[0] + 1) * (j + (n[1] + 1) * k)
    points = []
    for k in range(n[2] + 1):
        for j in range(n[1] + 1):
            for i in range(n[0] + 1):
                x, y, z = (size[a] * c / n[a] for a, c in enumerate((i, j, k)))
                points.append((x, y, z + bend * math.sin(math.pi * x / size[0])))
    cells = []
    for k in range(n[2]):
        for j in range(n[1]):
            for i in range(n[0]):
                corners = [number(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)) for c in range(8)]
                cells += [[corners[c] for c in cell] for cell in TETRAHEDRA]
    with open(path, "w") as out:
        out.write("# vtk DataFile Version 3.0\nbar\nASCII\nDATASET UNSTRUCTURED_GRID\n")
        out.write("POINTS %d double\n" % len(points))
        out.writelines("%.9g %.9g %.9g\n" % p for p in points)
        out.write("CELLS %d %d\n" % (len(cells), 5 * len(cells)))
        out.writelines("4 %d %d %d %d\n" % tuple(c) for c in cells)
        out.write("CELL_TYPES %d\n" % len(cells) + "10\n" * len(cells))
    return box_of(points)


def write_labels(path, size, layer):
    """An ellipsoid of label 1 with a core of label 2, as an image of labels."""
    n = 20
    spacing = [1000 * s / n for s in size]  # mm
    voxels = bytearray()
    for k in range(n):
        for j in range(n):
            for i in range(n):
                r = math.sqrt(sum(((c + 0.5) / n * 2 - 1) ** 2 for c in (i, j, k))) / 0.9
                voxels.append(0 if r > 1 else 2 if r < layer else 1)
    header = ("NRRD0004\ntype: uint8\ndimension: 3\nsizes: %d %d %d\nencoding: raw\n" % (n, n, n)
              + "space: right-anterior-superior\nspace directions: (%.9g,0,0) (0,%.9g,0) (0,0,%.9g)\n" % tuple(spacing)
              + "space origin: (0,0,0)\n\n")
    with open(path, "wb") as out:
        out.write(header.encode() + bytes(voxels))
    # Voxels at the middle of their places, and half a voxel of smoothing.
    return [0.03 * s for s in size], [0.92 * s for s in size]


def lame(young, nu):
    return young / (2 * (1 + nu)), young * nu / ((1 + nu) * (1 - 2 * nu))


def law_of(choose, uniform, is_box, is_implicit):
    young, nu = math.exp(uniform(math.log(1.5e3), math.log(4e4))), uniform(0.3, 0.49)
    shear, first = lame(young, nu)
    laws = ["neo-hookean"] * 3 + ["corotational", "tm-faure", "mooney-rivlin", "fibres"]
    if not is_implicit:
        laws.append("visco")
    if is_box:
        laws.append("mss-baudet")
    law = choose(laws)
    parameters = {"E": young, "nu": nu, "rho": 1050}
    if law == "mooney-rivlin":
        parameters = {"C10": 0.35 * shear, "C01": 0.15 * shear, "K": first + 2 * shear / 3, "rho": 1050}
    elif law == "fibres":
        parameters = {"mu": shear, "lambda": first, "k1": shear * uniform(0.2, 2), "k2": uniform(0.5, 2),
                      "rho": 1050, "fibre": [uniform(-1, 1), uniform(-1, 1), 1]}
    elif law == "visco":
        parameters = {"K": 0.6 * shear, "n": uniform(0.1, 0.4), "lambda": first, "rho": 1050, "tau": 0.002}
    elif law == "mss-baudet":
        parameters["nu"] = 0.3
    elif law == "tm-faure":
        parameters["element"] = "mean-gradient"
    return law, parameters


def scene(seed, folder, is_small):
    chance = random.Random(seed * 2 + is_small)
    uniform, choose = chance.uniform, chance.choice
    cells = int(math.exp(uniform(math.log(60 if is_small else 400), math.log(400 if is_small else 20000))))
    kinds = ["ellipsoid", "lobes", "torus", "tube", "box", "box", "tetrahedra", "labels"]
    kind = choose(kinds)
    long = uniform(0.05, 0.12)
    a, b, c = long * uniform(0.6, 1), long * uniform(0.4, 0.8), long * uniform(0.25, 0.5)
    waves, phase = chance.randint(2, 4), uniform(0, 6)
    mesh = {"cells": cells, "repair": True}
    if kind == "box":
        edge = (8 * a * b * c / cells) ** (1 / 3)
        size = [2 * a, 2 * b, 2 * c]
        mesh = {"box": {"size": size, "cells": [max(2, round(s / edge)) for s in size]}}
        low, high = [0, 0, 0], size
    elif kind == "tetrahedra":
        mesh["file"] = f"{seed}.vtk"
        low, high = write_tetrahedra(folder / mesh["file"], [2 * a, 2 * b, 2 * c], uniform(0, 0.5) * c)
    elif kind == "labels":
        mesh = {"file": f"{seed}.nrrd", "labels": {"1": "organ", "2": "core"}, "cells": cells}
        low, high = write_labels(folder / mesh["file"], [2 * a, 2 * b, 2 * c], uniform(0.3, 0.6))
    else:
        places = {
            "ellipsoid": lambda u, v: (a * math.sin(v) * math.cos(u), b * math.sin(v) * math.sin(u), c * math.cos(v)),
            "lobes": lambda u, v: tuple(
                (1 + 0.25 * math.sin(waves * u + phase) * math.sin(v) ** 2) * x
                for x in (a * math.sin(v) * math.cos(u), b * math.sin(v) * math.sin(u), c * math.cos(v))),
            "torus": lambda u, v: ((a + 0.9 * c * math.cos(v)) * math.cos(u), (b + 0.9 * c * math.cos(v)) * math.sin(u),
                                   0.9 * c * math.sin(v)),
            "tube": lambda u, v: (a * (2 * v / math.pi - 1), 0.6 * b * math.cos(u) * min(1, 3 * math.sin(v)),
                                  0.6 * b * math.sin(u) * min(1, 3 * math.sin(v)))}
        mesh["surface"] = f"{seed}.obj"
        low, high = write_surface(folder / mesh["surface"], places[kind], 32, 24, kind == "torus")
    size = [h - l for l, h in zip(low, high)]
    middle = [(l + h) / 2 for l, h in zip(low, high)]
    largest = max(size)

    is_implicit = chance.random() < 0.3
    law, parameters = law_of(choose, uniform, kind == "box", is_implicit)
    end = uniform(0.06, 0.12) if is_small else uniform(0.3, 0.8)
    result = {
        "suture": 2, "mesh": mesh, "models": [{"model": law, "parameters": parameters}],
        "gravity": {"value": [0, 0, -9.81], "ramp": 0.2 * end}, "solver": {"end": end, "damping": uniform(1, 8)},
        "output": {"frames": False, "energies": {"every_steps": 1000000}}, "events": []}
    wanted_dt = choose([0.002, 0.005, 0.01])
    is_held = chance.random() < 0.6
    half = lambda x, normal: {"half_space": {"point": [x, middle[1], middle[2]], "normal": [normal, 0, 0]}}
    if is_held:
        result["constraints"] = [{"fix": "xyz", "where": half(low[0] + 0.15 * size[0], -1)}]

    obstacles = []
    if not is_held or chance.random() < 0.6:
        gap = uniform(1e-4, 0.2) * size[2] if is_held else 1e-4
        obstacles.append({"name": "table", "friction": uniform(0, 0.5),
                          "half_space": {"point": [0, 0, low[2] - gap], "normal": [0, 0, 1]}})
    if chance.random() < 0.5:
        radius = largest * uniform(0.08, 0.2)
        centre = [middle[0] + size[0] * uniform(-0.2, 0.3), middle[1] + size[1] * uniform(-0.3, 0.3),
                  high[2] + 1.05 * radius]
        obstacles.append({"name": "ball", "sphere": {"centre": centre, "radius": radius}, "path": [
            {"at": 0.05 * end}, {"at": 0.5 * end, "translation": [0, 0, -size[2] * uniform(0.1, 0.4)]},
            {"at": 0.9 * end, "translation": [size[0] * uniform(-0.2, 0.2), 0, -size[2] * uniform(0, 0.2)]}]})
    events = result["events"]

    # ---- grasps ----
    side = chance.random() < 0.2
    for name, is_there, where in (("right", chance.random() < 0.4, half(high[0] - 0.15 * size[0], 1)),
                                  ("left", side and not is_held, half(low[0] + 0.15 * size[0], -1))):
        if not is_there:
            continue
        at = uniform(0.02, 0.3) * end
        way = [size[0] * uniform(0, 0.2) * (1 if name == "right" else -1), size[1] * uniform(-0.1, 0.1),
               size[2] * uniform(0, 0.3)]
        events.append({"at": at, "grasp": {"name": name, "where": where, "move": {
            "path": [{"at": 0}, {"at": 0.5 * end, "translation": way}]}}})
        if chance.random() < 0.5:
            events.append({"at": uniform(at + 0.1 * end, end), "release": name})

    # ---- cuts ----
    cuts = chance.randint(1, 3 if is_small else 6)
    for k in range(cuts):
        at = uniform(0, 0.85) * end
        through = [middle[i] + size[i] * uniform(-0.3, 0.3) for i in range(3)]
        angle, tilt, what = uniform(0, math.pi), uniform(-0.6, 0.6), chance.random()
        along = [math.cos(angle) * largest, math.sin(angle) * largest]
        top = high[2] + 0.3 * size[2]
        deep = low[2] - 0.3 * size[2] if chance.random() < 0.6 else middle[2] + size[2] * uniform(-0.3, 0.2)
        ends = [[through[0] - along[0], through[1] - along[1]], [through[0] + along[0], through[1] + along[1]]]
        if what < 0.3:
            plane = {"point": through, "normal": [math.cos(angle), math.sin(angle), tilt]}
            if chance.random() < 0.4:
                plane["radius"] = largest * uniform(0.2, 0.6)
            events.append({"at": at, "cut": {"plane": plane}})
        elif what < 0.8:
            shift, last = uniform(-0.2, 0.2) * size[0], min(end, at + uniform(0.1, 0.5) * end)
            edge = lambda z, dx: [[x + dx, y, z] for x, y in ends]
            path = [{"at": at, "points": edge(top, 0)}]
            for i in range(1, 5):  # an arc
                part = i / 4
                path.append({"at": at + part * (last - at),
                             "points": edge(top + part * (deep - top), shift * math.sin(part * math.pi / 2))})
            if chance.random() < 0.3 and last < 0.9 * end:
                path.append({"at": 0.98 * end, "points": edge(top, shift)})
            events.append({"cut": {"blade": {"path": path}}})
        else:  # carried by an obstacle, which follows the edge and touches nothing
            name = f"knife{k}"
            centre = [through[0], through[1], high[2] + largest]
            obstacles.append({"name": name, "sphere": {"centre": centre, "radius": 0.02 * largest}, "path": [
                {"at": at}, {"at": min(end, at + 0.5 * end), "translation": [0, 0, deep - top]}]})
            blade = {"obstacle": name, "points": [[x, y, top] for x, y in ends]}
            if not is_implicit and chance.random() < 0.5:
                blade["resistance"] = {"toughness": uniform(1, 20)}
            events.append({"cut": {"blade": blade}})
    if chance.random() < 0.15:
        events.append({"every": 5, "tear": {"by": "principal-strain", "above": uniform(0.3, 0.8)}})
    if chance.random() < 0.25:
        events.append({"at": uniform(0.5, 0.95) * end, "suture": {}})

    pieces = chance.random() < 0.7
    if obstacles or pieces:
        result["contact"] = {"friction": uniform(0, 0.5)}
        if obstacles:
            result["contact"]["obstacles"] = obstacles
        if pieces:
            result["contact"]["pieces"] = True
    if is_implicit:  # an obstacle must not move by more than an element in a step
        edge = (0.3 * size[0] * size[1] * size[2] / cells) ** (1 / 3)
        speeds = [math.dist(p.get("translation", [0, 0, 0]), q.get("translation", [0, 0, 0])) / (q["at"] - p["at"])
                  for o in obstacles for p, q in zip(o.get("path", []), o.get("path", [])[1:])]
        dt = min([wanted_dt] + [0.2 * edge / speed for speed in speeds if speed > 0])
        result["solver"].update({"integrator": "implicit-euler", "dt": dt})
    is_resumed = chance.random() < 0.3
    if is_resumed:
        result["checkpoint"] = {"every": 0.5 * end}
    (folder / f"{seed}.json").write_text(json.dumps(result, indent=1))
    kinds_of_run = "implicit" if is_implicit else "explicit"
    return {"kind": kind, "law": law, "run": kinds_of_run, "pieces": pieces, "cuts": cuts, "is_resumed": is_resumed}
