# SPDX-License-Identifier: GPL-3.0-or-later
"""Differences between two runs, field by field and time by time.

    python3 -m suture._compare A B [--common] [--tolerance T]      what `suture compare` executes
"""

import argparse
import sys

import numpy

from ._errors import report_error
from ._results import TABLES, folder_of, frames_of, table_of
from ._vtk import read_grid

SAME_TIME = 1e-9  # of the last time


def _pairs(a, b, common):
    """The frames of the same times, (time, file of a, file of b). `common`: others are skipped."""
    frames, others = frames_of(a), frames_of(b)
    if not frames or not others:
        return []
    near = SAME_TIME * (max(time for time, _ in frames) or 1)
    pairs = [(time, file, other) for time, file in frames for their_time, other in others
             if abs(time - their_time) <= near]
    if not pairs or not (common or len(frames) == len(pairs) == len(others)):
        raise ValueError(
            f"the frames are of other times: {a} has {len(frames)} from {frames[0][0]:g} to "
            f"{frames[-1][0]:g} s, {b} has {len(others)} from {others[0][0]:g} to "
            f"{others[-1][0]:g} s; give both scenes the same output 'every'"
            + (", or compare those of common times (--common)" if pairs else ""))
    return pairs


def _require_same_mesh(a, b, grids):
    (points, cells), (others, their_cells) = ((g["points"], g["cells"]) for g in grids)
    if points.shape != others.shape or not numpy.array_equal(cells, their_cells):
        raise ValueError(
            f"the meshes differ: {a} has {len(points)} nodes and {len(cells)} elements, {b} has "
            f"{len(others)} and {len(their_cells)}, or the same in another order; compare runs of "
            "one mesh, or probes of both")


def difference(first, second):
    """Root mean square and maximum of |first - second|, and the first of |first|.

    What is undefined (nan) in both is equal; in one of them, it is an infinite difference.
    """
    known = numpy.isfinite(first) & numpy.isfinite(second)
    equal = (first == second) | (numpy.isnan(first) & numpy.isnan(second))
    gap = numpy.where(equal, 0.0, numpy.inf)
    gap[known] = numpy.abs(first - second)[known]
    gap, size = (numpy.linalg.norm(v.reshape(len(first), -1), axis=1)
                 for v in (gap, numpy.where(numpy.isfinite(first), first, 0.0)))
    rms, scale = (numpy.sqrt(numpy.mean(v * v)) if v.size else 0.0 for v in (gap, size))
    return rms, gap.max(initial=0.0), scale


def _relative(rows):
    """Rows (name, time, rms, max, scale) with, instead of the scale, the rms relative to the
    largest scale of that name: a field that starts from zero has no other measure."""
    scales = {}
    for name, _, _, _, scale in rows:
        scales[name] = max(scale, scales.get(name, 0.0))
    return [(name, time, rms, largest,
             0.0 if rms == 0 else rms / scales[name] if scales[name] > 0 else numpy.inf)
            for name, time, rms, largest, _ in rows]


def compare_frames(a, b, common=False):
    """Rows (field, time, rms, max, relative), and the fields that only one run has."""
    rows, lonely = [], set()
    for time, file, other in _pairs(a, b, common):
        grids = read_grid(file), read_grid(other)
        _require_same_mesh(file, other, grids)
        fields, their_fields = (g["fields"] for g in grids)
        lonely |= set(fields) ^ set(their_fields)
        for name in [n for n in fields if n in their_fields]:
            rows.append((name, time, *difference(fields[name], their_fields[name])))
    return _relative(rows), lonely


def _at_times(times, own_times, values):
    """Each column of values at other times; the order of equal times is kept."""
    return numpy.array([numpy.interp(times, own_times, column) for column in values.T]).T


def compare_tables(file, other):
    """Rows (column, time of the largest difference, rms, max, relative) and those of one run."""
    names, rows = table_of(file)
    their_names, their_rows = table_of(other)
    common = [n for n in names if n in their_names and n not in ("step", "time [s]", "dt [s]")]
    time, their_time = (r[:, n.index("time [s]")] for n, r in ((names, rows), (their_names, their_rows)))
    inside = (time >= their_time.min(initial=0)) & (time <= their_time.max(initial=0))
    theirs = _at_times(time[inside], their_time, their_rows)
    result = []
    for name in common:
        first = rows[inside, names.index(name)]
        second = theirs[:, their_names.index(name)]
        if first.size:
            worst = time[inside][numpy.argmax(numpy.abs(first - second))]
            result.append((name, worst, *difference(first, second)))
    return _relative(result), set(names) ^ set(their_names)


def _print(title, time_title, rows):
    width = max(len(row[0]) for row in rows)
    print(f"{title}\n{'':{width}}  {time_title:>12} {'rms':>12} {'largest':>12} {'relative':>12}")
    for name, *values in rows:
        print(f"{name:{width}}  " + " ".join(f"{value:12.5g}" for value in values))


def compare(a, b, common=False, tolerance=None):
    """Prints the differences between two runs; False if one exceeds the tolerance. Raises
    ValueError if they have nothing in common."""
    a, b = folder_of(a), folder_of(b)
    parts = [("frames", "time [s]", *compare_frames(a, b, common))]
    for name in TABLES:
        if (a / name).exists() and (b / name).exists():
            parts.append((name, "worst at [s]", *compare_tables(a / name, b / name)))
    if not any(rows for _, _, rows, _ in parts):
        raise ValueError(f"{a} and {b} have no frames or tables with a common field; give both "
                         "scenes the same fields, energies or probes")
    for title, time_title, rows, lonely in parts:
        if rows:
            _print(title, time_title, rows)
        if lonely:
            print(f"{title}: only one of the runs has {', '.join(sorted(lonely))}", file=sys.stderr)
    print("rms: root mean square over nodes, elements or rows; relative: to the largest of the "
          "first run")
    if tolerance is None:
        return True
    beyond = sorted({f"{name} ({title})" for title, _, rows, _ in parts
                     for name, *_, relative in rows if not relative <= tolerance})
    if beyond:
        print(f"beyond {tolerance:g}: {', '.join(beyond)}")
    return not beyond


def _tolerance(text):
    value = float(text)
    if not value >= 0:
        raise ValueError(text)
    return value


def main():
    parser = argparse.ArgumentParser(prog="suture compare")
    parser.add_argument("runs", nargs=2)
    parser.add_argument("--common", action="store_true")
    parser.add_argument("--tolerance", type=_tolerance)
    options = parser.parse_args()
    try:
        return 0 if compare(*options.runs, options.common, options.tolerance) else 1
    except Exception as error:
        return report_error(error)


if __name__ == "__main__":
    sys.exit(main())
