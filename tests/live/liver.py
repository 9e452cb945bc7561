# SPDX-License-Identifier: GPL-3.0-or-later
"""A liver for the live view: a smooth closed surface, and a scene that hangs it at its back."""
import math

ROWS, COLUMNS = 30, 48

SCENE = {
    "suture": 1,
    "title": "a liver",
    "mesh": {"surface": "liver.obj", "cells": 5000},
    "models": [{"model": "corotational", "parameters": {"E": 2.5e4, "nu": 0.4, "rho": 1060}}],
    "gravity": [0, 0, -9.81],
    "constraints": [{"fix": "xyz", "where": {"box": {"min": [-0.02, 0.03, -1], "max": [0.06, 1, 1]}}}],
    # Elements are prepared for cuts along blades if some event is one.
    "events": [{"at": 1e6, "cut": {"plane": {"point": [9, 0, 0], "normal": [1, 0, 0]}, "along": "blade"}}],
    "solver": {"end": 1e6, "damping": 8},
    "output": {"every": 0.1, "fields": ["displacement"]},
}


def place(polar, azimuth):
    """On a ball whose right half is thick and left one flat, hollow below, with a notch in front."""
    x, y, z = math.cos(polar), math.sin(polar) * math.cos(azimuth), math.sin(polar) * math.sin(azimuth)
    z = (1 if z > 0 else 0.55) * z * (0.5 - 0.28 * x) + 0.12 * (1 - x * x)
    notch = 0.25 * math.exp(-8 * (x - 0.25) ** 2) if y < 0 else 0
    y = 0.9 * y * (1 - 0.3 * x) * (1 - notch) - 0.15 * x * x
    return 0.12 * x, 0.085 * y, 0.12 * z


def ring(row, column):
    return 1 + (row - 1) * COLUMNS + column % COLUMNS


def surface():
    """The text of an OBJ file: two poles and rings between them."""
    points = [place(0, 0)] + [place(math.pi * r / ROWS, 2 * math.pi * c / COLUMNS)
                              for r in range(1, ROWS) for c in range(COLUMNS)] + [place(math.pi, 0)]
    faces = []
    for c in range(COLUMNS):
        faces += [(0, ring(1, c), ring(1, c + 1)), (len(points) - 1, ring(ROWS - 1, c + 1), ring(ROWS - 1, c))]
        for r in range(1, ROWS - 1):
            faces += [(ring(r, c), ring(r + 1, c), ring(r + 1, c + 1)), (ring(r, c), ring(r + 1, c + 1), ring(r, c + 1))]
    return "".join(f"v {x:.6g} {y:.6g} {z:.6g}\n" for x, y, z in points) + "".join(
        f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces)
