# SPDX-License-Identifier: GPL-3.0-or-later
"""How values differ, and the fields of one mesh where the nodes of another are."""

import numpy


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


def without_lips(places):
    """Which places occur once: on both lips of a cut, the other mesh could not tell which is which.
    """
    _, inverse, counts = numpy.unique(places.round(12), axis=0, return_inverse=True,
                                      return_counts=True)
    return counts[inverse] == 1


class Probed:
    """The fields of one frame where the nodes and elements of another frame are, at rest."""

    def __init__(self, frame, other):
        points, centres = frame.rest(), frame.centres()
        self.at_points, inside = other.probe(points)
        self.at_centres, self.in_cells = other.probe(centres)
        self.in_points = inside & without_lips(points)
        self.count, self.outside = len(points), int(numpy.count_nonzero(~inside))
        if not self.in_points.any():
            raise ValueError(f"the bodies do not overlap at rest: no node of {frame.file} lies in "
                             f"{other.file}; are both in m, and at the same place?")

    def pairs(self, frame):
        """{name: (values, those of the other frame)} of the common fields."""
        found = {}
        for mask, fields, others in ((self.in_points, frame.point_fields, self.at_points),
                                     (self.in_cells, frame.cell_fields, self.at_centres)):
            for name in fields:
                if name in others and not name.endswith(("_id", " ids")):
                    found[name] = fields[name][mask], others[name][mask]
        return found
