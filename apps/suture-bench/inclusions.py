#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Equilibria of a body whose stiffness jumps: a soft block with stiff balls at random places, whole processes of
`suture run`.

Beside the figures of D. Davydov et al., A matrix-free approach for finite-strain hyperelastic problems using geometric
multigrid, Int. J. Numer. Meth. Engng. 121 (2020), 2874-2895: matrix, load, load steps and tolerances are theirs. Their
block has one hole and two inclusions that its mesh follows; here a regular grid cuts through 60.

    inclusions.py path/to/programs [--json FILE]
"""
import pathlib
import random
import re
import tempfile

from harness import UNKNOWN, Failure, Report, option_parser, positive, run_scene, run_script
from work_cases import Cells, Method, box_scene, held

YOUNG = 2 * 1.3 * 0.4225e6  # of the matrix, Pa; nu 0.3
TRACTION = 12.5e3  # along x and y, Pa
LOAD_STEPS, BALLS = 5, 60
# CPU time of 20 cores per unknown, trilinear elements, 4.44 M unknowns, a jump of 100.
PUBLISHED_US, PUBLISHED_ITERATIONS = 833, 25


def mersenne_twister(seed):
    """Makes the numbers of C++'s std::mt19937: Python seeds the same generator in another way."""
    words = [seed]
    for i in range(1, 624):
        words.append(1812433253 * (words[-1] ^ words[-1] >> 30) + i & 0xffffffff)
    source = random.Random()
    source.setstate((3, (*words, 624), None))
    return source


def uniform(source, low, high):
    """As std::uniform_real_distribution of GCC makes it of two numbers of 32 bits."""
    value = source.getrandbits(32) + source.getrandbits(32) * 2.0**32
    return value / 2.0**64 * (high - low) + low


def random_balls(modulus, seed):
    """Balls in the unit cube, which may overlap and take an eighth of it, as regions of a table."""
    source = mersenne_twister(seed)
    regions = []
    for _ in range(BALLS):
        centre = [uniform(source, 0, 1) for _ in range(3)]
        sphere = {"centre": centre, "radius": uniform(source, 0.05, 0.11)}
        regions.append({"region": {"sphere": sphere}, "value": modulus})
    return regions


def block(across, jump, seed):
    """A cube of n^3 elements, fixed below, and pushed aside above."""
    method = Method("", "neo-hookean", {"element": "trilinear"}, {"static": {"frames": LOAD_STEPS}, "threads": 1}, ())
    stiffness = {"regions": random_balls(jump * YOUNG, seed), "elsewhere": YOUNG}
    return {**box_scene(Cells((across,) * 3), (1, 1, 1), method, E=stiffness, nu=0.3, rho=1000),
            "constraints": [held("z0")], "output": False,
            "loads": [{"traction": (TRACTION, TRACTION, 0), "where": {"set": "z1"}, "ramp": 1}]}


def solve(options, across, jump):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        use = run_scene(options.programs, block(across, jump, options.seed), folder, "block", "-v")
        text = (folder / "block.log").read_text()
    # Newton's iterations on the grid itself; those on coarser ones name no linear iterations.
    krylov = [int(n) for n in re.findall(r"Newton iteration .* (\d+) linear iterations", text)]
    if use.code != 0:
        raise Failure(f"no equilibrium of {across}^3 elements with a jump of {jump}: exit code {use.code}")
    if not krylov:
        raise Failure("suture run -v names no iterations of Newton's method with their linear iterations")
    unknowns = 3 * (across + 1) ** 3
    is_published = jump == 100
    return {"jump": jump, "elements": across**3, "unknowns": unknowns, "seconds": use.cpu,
            "us_per_unknown": 1e6 * use.cpu / unknowns, "published_us": PUBLISHED_US if is_published else UNKNOWN,
            "newton_steps": len(krylov), "krylov_iterations": sum(krylov),
            "iterations_per_step": sum(krylov) / len(krylov),
            "published_iterations": PUBLISHED_ITERATIONS if is_published else UNKNOWN, "peak_mb": use.peak_bytes / 1e6}


def read_options():
    parser = option_parser(__doc__)
    parser.add_argument("--across", nargs="+", type=positive, default=[32, 54], help="Elements along each edge of the cube")
    parser.add_argument("--jumps", nargs="+", type=positive, default=[1, 100, 10000],
                        help="Moduli of the balls over that of the matrix")
    parser.add_argument("--seed", type=int, default=1, help="Of the places of the balls")
    return parser.parse_args()


def main():
    options = read_options()
    report = Report(options.json, options.programs)
    report.begin("inclusions",
                 "cube of 1 m with 60 balls that are stiffer by the jump: neo-Hookean, trilinear, nu 0.3, fixed below, "
                 "pushed aside above in five load steps, equilibria to 1e-8; CPU s of the whole process, one thread. "
                 "Published: Davydov et al. 2020, 4.44 M unknowns on 20 cores")
    for jump in options.jumps:
        for across in options.across:
            report.add(solve(options, across, jump))
    report.write_json()


if __name__ == "__main__":
    run_script(main)
