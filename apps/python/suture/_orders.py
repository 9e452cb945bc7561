# SPDX-License-Identifier: GPL-3.0-or-later
"""Observed orders of convergence, from three runs with finer and finer meshes or steps.

If u(h) = u + c h^p, then

    (u(h1) - u(h2)) / (u(h2) - u(h3)) = (h1^p - h2^p) / (h2^p - h3^p)

gives the order p, and u(h3) + (u(h3) - u(h2)) / ((h2 / h3)^p - 1) the limit u.
"""

import math
import sys

import numpy

from ._differences import Probed, difference
from ._frames import Frame
from ._results import TABLES, TIME, frames_of, table_of

SAME_SIZE = 1e-3  # relative


def observed_order(ratio, sizes):
    """The p of the formula above, by bisection; nan if there is none from -5 to 20."""
    one, two, three = (math.log(size) for size in sizes)

    def excess(p):  # of (h1^p - h2^p) / (h2^p - h3^p), which grows with p
        if abs(p) < 1e-9:
            return (one - two) / (two - three) - ratio
        return (math.expm1(p * (one - two)) / -math.expm1(p * (three - two))) - ratio

    low, high = -5.0, 20.0
    if not (math.isfinite(ratio) and excess(low) <= 0 <= excess(high)):
        return math.nan
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if excess(middle) <= 0 else (low, middle)
    return low


def limit_of(values, order, sizes):
    """What the values converge to."""
    factor = (sizes[1] / sizes[2]) ** order - 1
    return values[2] + (values[2] - values[1]) / factor if order > 0 else math.nan


def _require_descending(sizes, what):
    one, two, three = sizes
    if not (one > two * (1 + SAME_SIZE) and two > three * (1 + SAME_SIZE)):
        raise ValueError(f"three runs must be from coarse to fine: their {what} are "
                         f"{one:.6g}, {two:.6g} and {three:.6g}")


def _steps_of(folder):
    """The mean length of a step, s."""
    for name in TABLES:
        if (folder / name).exists():
            names, rows = table_of(folder / name)
            if rows[-1, 0] > 0:
                return rows[-1, names.index(TIME)] / rows[-1, 0]
    raise ValueError(f"{folder}: has no table from which the length of its steps is known; the "
                     "three runs have one mesh, so add \"energies\" or \"probes\" to /output")


def _sizes(folders, frames):
    """What is refined, and its sizes: edges of elements, m, or steps, s."""
    counts = [frame.cell_count for frame in frames]
    if frames and len(set(counts)) > 1:
        low, high = frames[0].rest().min(axis=0), frames[0].rest().max(axis=0)
        volume = numpy.prod(numpy.where(high > low, high - low, 1.0))
        return "elements", [(volume / count) ** (1 / 3) for count in counts]
    return "steps", [_steps_of(folder) for folder in folders]


def _last_common(series):
    """The latest time that all have."""
    return min(times[-1] for times in series)


def _field_rows(frames):
    """(name, first difference, second difference), each a root mean square."""
    coarse, *finer = frames
    probed = [Probed(coarse, frame) for frame in finer]
    for of, where in (("point_fields", "points"), ("cell_fields", "centres")):
        masks = [getattr(p, "in_points" if where == "points" else "in_cells") for p in probed]
        mask = masks[0] & masks[1]
        for name, values in getattr(coarse, of).items():
            others = [getattr(p, "at_" + where).get(name) for p in probed]
            if name.endswith(("_id", " ids")) or any(other is None for other in others):
                continue
            yield (name, difference(values[mask], others[0][mask])[0],
                   difference(others[0][mask], others[1][mask])[0])


def _table_rows(folders, name):
    """(column, the three values at the last common time)."""
    if not all((folder / name).exists() for folder in folders):
        return
    tables = [table_of(folder / name) for folder in folders]
    time = _last_common([rows[:, names.index(TIME)] for names, rows in tables])
    for column in tables[0][0]:
        if column in ("step", TIME, "dt [s]") or not all(column in names for names, _ in tables):
            continue
        yield column, [float(numpy.interp(time, rows[:, names.index(TIME)],
                                          rows[:, names.index(column)])) for names, rows in tables]


def _shown(value):
    return f"{value:12.5g}" if math.isfinite(value) else f"{'-':>12}"


def _print(title, heads, rows):
    if not rows:
        return
    width = max(len(row[0]) for row in rows)
    print(f"{title}\n{'':{width}} " + "".join(f"{head:>13}" for head in heads))
    for name, *values in rows:
        print(f"{name:{width}}  " + " ".join(map(_shown, values)))


def _frames(folders):
    """The frames of the last common time; none if a run has none."""
    series = [frames_of(folder) for folder in folders]
    if not all(series):
        return []
    time = _last_common([[time for time, _ in frames] for frames in series])
    found = [min(frames, key=lambda frame: abs(frame[0] - time)) for frames in series]
    if max(abs(other - time) for other, _ in found) > 1e-9 * (time or 1):
        print(f"no frame of all three runs is of the time {time:g} s: only tables are compared",
              file=sys.stderr)
        return []
    return [Frame(file) for _, file in found]


def orders(folders):
    """Prints the observed orders of the fields and table columns of three runs, from coarse to
    fine. Raises ValueError if there is none."""
    frames = _frames(folders)
    what, sizes = _sizes(folders, frames)
    _require_descending(sizes, "sizes of " + what)
    fields = [(name, first, second, observed_order(first / second if second else math.nan, sizes))
              for name, first, second in (_field_rows(frames) if frames else ())]
    tables = {}
    for name in TABLES:
        for column, values in _table_rows(folders, name):
            first, second = values[0] - values[1], values[1] - values[2]
            order = observed_order(first / second if second else math.nan, sizes)
            tables.setdefault(name, []).append(
                (column, *values, order, limit_of(values, order, sizes)))
    if not fields and not tables:
        raise ValueError("the three runs have no common fields or columns; give all scenes the same "
                         "fields, energies or probes")
    print(f"sizes of {what}: {sizes[0]:.4g}, {sizes[1]:.4g}, {sizes[2]:.4g} "
          f"{'m' if what == 'elements' else 's'}")
    _print("frames, at the nodes of the first run", ("|1 - 2|", "|2 - 3|", "order"), fields)
    for name, rows in tables.items():
        _print(name, ("1", "2", "3", "order", "limit"), rows)
    print("|1 - 2|: root mean square of the difference; order: observed order of convergence; "
          "limit: by Richardson's extrapolation; -: the values do not converge")
