// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "kernel/geometry/surface.hpp"

namespace suture {

class SurfaceTree;

// Surfaces from files are repaired, oriented and searched for intersections with CGAL. Large ones
// are mostly sound, which takes less time to establish: 0.2 and 0.4 us per triangle, where CGAL
// takes 2 and 1.5, and 5.5 on flat sides.

/// True if the soup is a closed, oriented manifold of triangles, without equal or unused points.
/// Nothing of it has to be merged, dropped, split or turned, except inside out as a whole.
bool is_sound(const PolygonSoup& soup);

/// Returns the triangles of a sound soup in one piece, oriented outward: what CGAL makes of it.
/// None if the soup is not sound, has several pieces, of which some may be hollows, or encloses so
/// little that rounding hides which side is the inner one.
std::optional<TriangleSurface> sound_solid(const PolygonSoup& soup);

/// Returns the triangles that may intersect others, in ascending order. All triangles that
/// intersect others are among them; usually, the list is empty.
///
/// Triangles that share corners intersect if they share more than the edge or point between these.
/// A pair is ruled out by a plane that separates it, with margins for rounding error. `tree`: of
/// the surface.
std::vector<Index> find_doubtful(const TriangleSurface& surface, const SurfaceTree& tree);

}  // namespace suture
