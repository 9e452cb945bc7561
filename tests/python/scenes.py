# SPDX-License-Identifier: GPL-3.0-or-later
"""Small scenes for the tests of the module."""


def bar(cells=(6, 2, 2), model="tm-faure", dt=1e-4, end=0.02, integrator=None, **more):
    """A bar along x that is clamped at x0 and sags."""
    solver = {"dt": dt, "end": end, "threads": 1}
    if integrator:
        solver["integrator"] = integrator
    scene = {
        "suture": 1,
        "mesh": {"box": {"size": [3, 1, 1], "cells": list(cells)}},
        "models": [{"model": model, "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}}],
        "gravity": [0, -9.8, 0],
        "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
        "solver": solver,
    }
    scene.update(more)
    return scene


def free_block(n=2, **more):
    """A block that nothing holds, without gravity."""
    return bar((n, n, n), **{"constraints": [], "gravity": [0, 0, 0], **more})
