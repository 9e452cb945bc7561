# SPDX-License-Identifier: GPL-3.0-or-later
"""Differences between runs, field by field and time by time.

    python3 _start.py suture._compare A B [C] [--common] [--tolerance T]   what `suture compare` executes
"""

import argparse
import sys

import numpy

from ._differences import Probed, difference
from ._errors import report_error
from ._frames import Frame
from ._orders import orders
from ._results import TABLES, TIME, folder_of, frames_of, table_of

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


def _is_same_mesh(first, second):
    return (first.points.shape == second.points.shape and
            numpy.array_equal(first.cells, second.cells))


def _field_pairs(frame, other, notes):
    """{name: (values, those of the other frame)}; fields of another mesh are interpolated."""
    if _is_same_mesh(frame, other):
        return {name: (values, other.fields[name]) for name, values in frame.fields.items()
                if name in other.fields}
    probed = Probed(frame, other)
    notes.add(f"the meshes differ ({frame.cell_count} and {other.cell_count} cells): fields of the "
              f"second run are interpolated at the nodes of the first" +
              (f", of which {probed.outside} of {probed.count} lie outside the second"
               if probed.outside else ""))
    return probed.pairs(frame)


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
    """Rows (field, time, rms, max, relative), the fields that only one run has, and notes."""
    rows, lonely, notes = [], set(), set()
    for time, file, other in _pairs(a, b, common):
        frame, second = Frame(file), Frame(other)
        lonely |= set(frame.fields) ^ set(second.fields)
        for name, values in _field_pairs(frame, second, notes).items():
            rows.append((name, time, *difference(*values)))
    return _relative(rows), lonely, notes


def _at_times(times, own_times, values):
    """Each column of values at other times; the order of equal times is kept."""
    return numpy.array([numpy.interp(times, own_times, column) for column in values.T]).T


def compare_tables(file, other):
    """Rows (column, time of the largest difference, rms, max, relative) and those of one run."""
    names, rows = table_of(file)
    their_names, their_rows = table_of(other)
    common = [n for n in names if n in their_names and n not in ("step", TIME, "dt [s]")]
    time, their_time = (r[:, n.index(TIME)] for n, r in ((names, rows), (their_names, their_rows)))
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
    rows, lonely, notes = compare_frames(a, b, common)
    parts = [("frames", "time [s]", rows, lonely)]
    for name in TABLES:
        if (a / name).exists() and (b / name).exists():
            parts.append((name, "worst at [s]", *compare_tables(a / name, b / name)))
    if not any(rows for _, _, rows, _ in parts):
        raise ValueError(f"{a} and {b} have no frames or tables with a common field; give both "
                         "scenes the same fields, energies or probes")
    for note in sorted(notes):
        print(note)
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
    parser.add_argument("runs", nargs="+")
    parser.add_argument("--common", action="store_true")
    parser.add_argument("--tolerance", type=_tolerance)
    options = parser.parse_args()
    try:
        if len(options.runs) == 3:
            orders([folder_of(run) for run in options.runs])
            return 0
        return 0 if compare(*options.runs, options.common, options.tolerance) else 1
    except Exception as error:
        return report_error(error)


if __name__ == "__main__":
    sys.exit(main())
