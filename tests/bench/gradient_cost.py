#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a gradient costs beside its equilibrium: the table of docs/gradients.md. Processor time of one
thread, which other programs on the machine disturb least."""

import sys
import time

import numpy

import suture


def block(model, n):
    """A block of n x n x 2n elements that hangs from one end."""
    return suture.Simulation({
        "suture": 1,
        "mesh": {"box": {"size": [1, 1, 2], "cells": [n, n, 2 * n]}},
        "models": [{"model": model, "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}}],
        "gravity": [0, -1, 0],
        "constraints": [{"fix": "xyz", "where": {"set": "z0"}}],
        "solver": {"static": {"frames": 1}, "threads": 1}})


def timed(call):
    """(seconds, result)."""
    start = time.process_time()
    result = call()
    return time.process_time() - start, result


def main(sizes):
    print("| model, elements | equilibrium | adjoint to 1e-6, gradient by element | to 1e-8 |\n"
          "|---|---|---|---|")
    for model in ("tm-faure", "neo-hookean", "mss-golec"):
        for n in sizes:
            sim = block(model, n)
            equilibrium, _ = timed(sim.run)
            end = numpy.flatnonzero(sim.rest[:, 2] == 2)
            miss = suture.Quantity.displacement(end, 1) ** 2
            costs = [timed(lambda: sim.adjoint(miss, tolerance).gradient(model, "E", "element"))[0]
                     for tolerance in (1e-6, 1e-8)]
            print(f"| {model}, {2 * n**3:,} | {equilibrium:.3f} s | "
                  + " | ".join(f"{cost / equilibrium:.2f}" for cost in costs) + " |")


if __name__ == "__main__":
    main([int(size) for size in sys.argv[1:]] or [10, 20])
