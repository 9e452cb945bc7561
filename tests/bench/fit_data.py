#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the data of docs/fits: results of finer meshes with noise. Prints the deviations.

    PYTHONPATH=build/python tests/bench/fit_data.py docs/fits
"""

import json
import math
import sys
from pathlib import Path

import numpy

import suture

FACTORS = numpy.array([1, 3, 0.4])  # of the modulus: background, stiff ball, soft block


def material(places):
    """The number of the factor at places (n, 3) of the block."""
    kind = numpy.zeros(len(places), int)
    kind[numpy.linalg.norm(places - [0.03, 0.05, 0.03], axis=1) < 0.02] = 1
    kind[(abs(places - [0.07, 0.05, 0.035]) < [0.015, 0.015, 0.01]).all(axis=1)] = 2
    return kind


def refined(scene):
    scene["mesh"]["box"]["cells"] = [2 * n for n in scene["mesh"]["box"]["cells"]]
    return scene


def tension(folder, random):
    scene = refined(json.loads((folder / "tension.json").read_text()))
    scene["models"][0]["parameters"].update(E=3.1e4, nu=0.44)
    sim = suture.Simulation(scene)
    lines = ["# Synthetic: neo-Hookean, E = 31 kPa, nu = 0.44, on a mesh of half the size, with "
             "noise of 20 mN and 10 um.", "time [s],force [N],side [mm]"]
    while sim.step():
        probes = sim.probes()
        force = probes["grip"]["reaction"][0] + 0.02 * random.normal()
        side = probes["side"]["displacement"][1] + 1e-5 * random.normal()
        lines.append(f"{sim.time:g},{force:.4f},{1e3 * side:.4f}")
    (folder / "tension.csv").write_text("\n".join(lines) + "\n")


def on_surface(rest, spacing):
    """Rows of the nodes of the coarse mesh on the faces that are free."""
    top = rest.max(axis=0)
    outside = (numpy.isclose(rest[:, :2], 0) | numpy.isclose(rest[:, :2], top[:2])).any(axis=1)
    free = (outside | numpy.isclose(rest[:, 2], top[2])) & (rest[:, 2] > spacing / 4)
    return numpy.flatnonzero(
        free & numpy.isclose(rest, spacing * numpy.round(rest / spacing)).all(axis=1))


def block(folder, random):
    study = json.loads((folder / "block-fit.json").read_text())
    for test in study["data"]:
        scene = refined(json.loads((folder / "block.json").read_text()))
        sim = suture.Simulation(scene, test.get("set"))
        mesh = sim.mesh()
        centres = mesh.points[mesh.hexahedra].mean(axis=1)
        sim.parameters["neo-hookean"]["E"] = 1e4 * FACTORS[material(centres)]
        sim.run()
        rows = on_surface(sim.rest, 0.005)
        moved = (sim.position - sim.rest)[rows]
        deviation = 0.01 * numpy.linalg.norm(moved, axis=1).mean()
        moved += deviation * random.normal(size=moved.shape)
        lines = ["# Synthetic: a block with a stiff ball and a soft block inside, on a mesh of half "
                 "the size, with 1 % noise.",
                 "x [mm],y [mm],z [mm],ux [mm],uy [mm],uz [mm]"]
        lines += [",".join(f"{value:.4g}" for value in (*place, *shift))
                  for place, shift in zip(1e3 * sim.rest[rows], 1e3 * moved)]
        (folder / test["points"]).write_text("\n".join(lines) + "\n")
        print(f"{test['points']}: deviation {deviation:.3g} m")


def liver(folder):
    """The law of liver, K r t^(1-n) / Gamma(2-n), which was measured at three rates r (Nicolle,
    Noguier, Palierne 2012), on a plate of 30 mm x 10 mm."""
    K, n, area = 861, 0.1138, 3e-4
    for name, rate in (("slow", 0.0151), ("medium", 0.133), ("fast", 0.67)):
        lines = [f"# The law that was measured of liver, at a shear of {rate} 1/s, on 3 cm2.",
                 "time [s],force [mN]"]
        for time in numpy.arange(1, 11) / 5:
            stress = K * rate * time ** (1 - n) / math.gamma(2 - n)
            lines.append(f"{time:g},{1e3 * area * stress:.4g}")
        (folder / f"liver-{name}.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    block(Path(sys.argv[1]), numpy.random.default_rng(1))
    tension(Path(sys.argv[1]), numpy.random.default_rng(4))
    liver(Path(sys.argv[1]))
