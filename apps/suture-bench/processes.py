#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A model of the efficiency of a run on 1 to 1,024 processes (docs/distributed.md).

The parts are counted exactly, for a cube of elements in the order in which the import numbers it:
elements that a process computes, vertices that it steps, and vertices at its borders. Each costs
what was measured on one machine (--element, --vertex, --pack); messages cost what a network does
(--latency, --bandwidth). Prints a table in Markdown.

    processes.py --side 216
"""
import argparse
import math

import numpy as np

CHUNK = 1024  # vertices: MotionSums::chunk, of 8 numbers
GRID_LAYER = 16384  # elements of a layer up to which a grid keeps its order (ordering.hpp)
CHECKED = 64  # steps from check to check, at which positions at summed cells are exchanged


def spread(x):
    """The bits of x at every third place."""
    result = np.zeros_like(x)
    for bit in range(10):
        result |= (x >> bit & 1) << 3 * bit
    return result


def places(side):
    """The place in the order of each element of a cube, by (i, j, k)."""
    if side * side <= GRID_LAYER:
        return np.arange(side**3, dtype=np.int64).reshape(side, side, side)
    along = spread((np.arange(side, dtype=np.int64) * 1023) // (side - 1))
    key = along[:, None, None] << 2 | along[None, :, None] << 1 | along[None, None, :]
    place = np.empty(side**3, dtype=np.int64)
    place[np.argsort(key.ravel(), kind="stable")] = np.arange(side**3)
    return place.reshape(side, side, side)


def corner_slices(side, corner):
    return tuple(slice(c, c + side) for c in corner)


CORNERS = [(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]


def count(place, processes):
    """The largest numbers of elements computed and of border vertices, and the most neighbours."""
    side = len(place)
    owner_of_element = (place * processes // side**3).astype(np.int16)
    first = np.full((side + 1,) * 3, np.iinfo(np.int16).max, dtype=np.int16)
    for corner in CORNERS:
        at = first[corner_slices(side, corner)]
        np.minimum(at, owner_of_element, out=at)
    owners = np.stack([first[corner_slices(side, c)].ravel() for c in CORNERS], axis=1)
    vertex = np.arange(first.size).reshape(first.shape)
    mixed = np.flatnonzero((owners != owners[:, :1]).any(axis=1))
    inside = np.bincount(np.delete(owners[:, 0], mixed), minlength=processes)
    owners = owners[mixed]
    corners = np.stack([vertex[corner_slices(side, c)].ravel()[mixed] for c in CORNERS], axis=1)
    read = []
    computed = np.zeros(processes, dtype=np.int64)
    ordered = np.sort(owners, axis=1)
    is_new = np.ones_like(ordered, dtype=bool)
    is_new[:, 1:] = ordered[:, 1:] != ordered[:, :-1]
    np.add.at(computed, ordered[is_new], 1)
    for a in range(8):
        by = owners[:, a]
        for b in range(8):
            other = owners[:, b] != by
            read.append(by[other].astype(np.int64) * first.size + corners[other, b])
    read = np.unique(np.concatenate(read)) if len(mixed) else np.empty(0, dtype=np.int64)
    reader, what = read // first.size, read % first.size
    borders = np.bincount(reader, minlength=processes)
    pairs = np.unique(reader * processes + first.ravel()[what])
    neighbours = np.bincount(pairs // processes, minlength=processes)
    return (inside + computed).max(), borders.max(), neighbours.max()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--side", type=int, default=216, help="elements per side of the cube")
    parser.add_argument("--element", type=float, default=27, help="ns per element and step")
    parser.add_argument("--vertex", type=float, default=3.8, help="ns per vertex and step")
    parser.add_argument("--pack", type=float, default=3.3, help="ns to pack and unpack a vertex")
    parser.add_argument("--latency", type=float, default=2, help="us per message")
    parser.add_argument("--bandwidth", type=float, nargs="+", default=[2, 12],
                        help="GB/s per process; a column for each")
    args = parser.parse_args()
    place = places(args.side)
    elements, vertices = args.side**3, (args.side + 1) ** 3
    print("| processes | more elements | KB to neighbours | messages | KB of sums | computing, ms |"
          + "".join(f" efficiency at {b:g} GB/s |" for b in args.bandwidth))
    print("|---" * (6 + len(args.bandwidth)) + "|")
    alone = elements * args.element + vertices * args.vertex
    for processes in 2 ** np.arange(11):
        computed, borders, neighbours = count(place, processes)
        work = computed * args.element + vertices / processes * args.vertex + borders * args.pack
        sums = 64 * vertices / CHUNK if processes > 1 else 0
        positions = 24 * borders / CHECKED  # summed cells reach about as far as those of forces
        waits = (neighbours + 3 * math.log2(processes)) * args.latency * 1e3
        steps = [work + waits + (24 * borders + sums + positions) / b for b in args.bandwidth]
        print(f"| {processes} | {100 * (computed * processes / elements - 1):.0f} % "
              f"| {24 * borders / 1e3:.0f} | {neighbours} | {sums / 1e3:.0f} | {work / 1e6:.2f} |"
              + "".join(f" {alone / step / processes:.2f} |" for step in steps))


if __name__ == "__main__":
    main()
