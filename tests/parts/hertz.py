#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The force on a ball between two rigid plates, over that of Hertz.

An independent solution for surface_contact_test.cpp: a quarter of the section, with elements of four
nodes that are symmetric about the axis, the law of St. Venant and Kirchhoff at finite strains, and
nodes that may not pass the plate.
usage: hertz.py [ELEMENTS ALONG AN EDGE] [DEPTH OVER RADIUS] [RADIUS THAT IS HELD SIDEWAYS]
"""
import sys

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sl

E, NU = 1.0, 0.3
LAMBDA, MU = E * NU / ((1 + NU) * (1 - 2 * NU)), E / 2 / (1 + NU)
GAUSS = 1 / np.sqrt(3)


def quarter_disc(count):
    """Places (r, z) and elements, finer towards the pole r = 0, z = 1."""
    s = np.linspace(0, 1, count + 1)
    u, v = np.meshgrid(s**1.6, 1 - (1 - s) ** 1.6, indexing="ij")
    radius = np.maximum(u, v)
    ratio = np.minimum(u, v) / np.where(radius > 0, radius, 1)
    angle = np.where(u >= v, np.pi / 4 * ratio, np.pi / 2 - np.pi / 4 * ratio)
    places = np.stack([radius * np.cos(angle), radius * np.sin(angle)], -1).reshape(-1, 2)
    number = np.arange((count + 1) ** 2).reshape(count + 1, -1)
    corners = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    return places, np.stack([c.ravel() for c in corners], -1)


def forces(places, elements, u):
    """Forces of the nodes, and their derivative."""
    dof = np.stack([2 * elements, 2 * elements + 1], -1).reshape(-1, 8)
    moved, count = u[dof], len(elements)
    force, tangent = np.zeros((count, 8)), np.zeros((count, 8, 8))
    law = np.full((4, 4), LAMBDA)  # of S_rr, S_zz, S_tt, S_rz by E_rr, E_zz, E_tt, 2 E_rz
    law[3], law[:, 3] = 0, 0
    law += np.diag([2 * MU, 2 * MU, 2 * MU, MU])
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    for point in GAUSS * signs:
        shape = np.prod(1 + signs * point, 1) / 4
        slope = signs * (1 + signs * point)[:, ::-1] / 4
        jacobian = np.einsum("eka,kb->eab", places[elements], slope)
        gradient = np.einsum("kb,eba->eka", slope, np.linalg.inv(jacobian))
        r = places[elements][:, :, 0] @ shape
        weight = np.abs(np.linalg.det(jacobian)) * 2 * np.pi * r
        d = np.zeros((count, 5, 8))  # of F_rr, F_rz, F_zr, F_zz, F_tt by u
        d[:, 0, 0::2], d[:, 1, 0::2] = gradient[:, :, 0], gradient[:, :, 1]
        d[:, 2, 1::2], d[:, 3, 1::2] = gradient[:, :, 0], gradient[:, :, 1]
        d[:, 4, 0::2] = shape / r[:, None]
        rr, rz, zr, zz, tt = (np.array([1, 0, 0, 1, 1]) + np.einsum("eij,ej->ei", d, moved)).T
        strain = np.stack([(rr**2 + zr**2 - 1) / 2, (rz**2 + zz**2 - 1) / 2, (tt**2 - 1) / 2,
                           rr * rz + zr * zz], -1)
        stress = strain @ law
        b = np.zeros((count, 4, 5))  # of the strain by F
        b[:, 0, 0], b[:, 0, 2], b[:, 1, 1], b[:, 1, 3], b[:, 2, 4] = rr, zr, rz, zz, tt
        b[:, 3, 0], b[:, 3, 1], b[:, 3, 2], b[:, 3, 3] = rz, rr, zz, zr
        a = np.einsum("eai,ab,ebj->eij", b, law, b)
        for i, j, s in ((0, 0, 0), (2, 2, 0), (1, 1, 1), (3, 3, 1), (4, 4, 2), (0, 1, 3), (1, 0, 3),
                        (2, 3, 3), (3, 2, 3)):
            a[:, i, j] += stress[:, s]
        force += np.einsum("eij,eai,ea,e->ej", d, b, stress, weight)
        tangent += np.einsum("eia,eij,ejb,e->eab", d, a, d, weight)
    rows, columns = np.repeat(dof, 8, 1).ravel(), np.tile(dof, (1, 8)).ravel()
    return (np.bincount(dof.ravel(), force.ravel(), u.size),
            sp.coo_matrix((tangent.ravel(), (rows, columns)), shape=(u.size, u.size)).tocsr())


def over_hertz(count=80, depth=0.04, core=0.25, steps=4):
    places, elements = quarter_disc(count)
    r, z = places.T
    distance = np.hypot(r, z)
    u = np.zeros(places.size)
    held = np.union1d(2 * np.flatnonzero((r < 1e-12) | (distance < core)),
                      2 * np.flatnonzero(z < 1e-12) + 1)
    outside = np.abs(distance - 1) < 1e-9
    touching = np.zeros(len(r), bool)
    for step in range(1, steps + 1):
        plate = 1 - depth * step / steps
        change = 1.0
        while change > 1e-11:
            force, tangent = forces(places, elements, u)
            before = touching
            touching = outside & ((z + u[1::2] > plate + 1e-12) | (before & (force[1::2] < 0)))
            given = np.union1d(held, 2 * np.flatnonzero(touching) + 1)
            free = np.setdiff1d(np.arange(u.size), given)
            du = np.zeros(u.size)
            du[1::2][touching] = (plate - z - u[1::2])[touching]
            du[free] = sl.spsolve(tangent[free][:, free], -force[free] - tangent[free][:, given] @ du[given])
            u += du
            change = np.abs(du).max() + np.any(touching != before)
    force, _ = forces(places, elements, u)
    return -force[1::2][touching].sum() / (4 / 3 * E / (1 - NU**2) * depth**1.5)


if __name__ == "__main__":
    words = sys.argv[1:]
    print(over_hertz(*[int(w) for w in words[:1]], *[float(w) for w in words[1:]]))
