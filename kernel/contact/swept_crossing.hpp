// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>

#include "kernel/base/types.hpp"

// Whether anything passes through a surface
// =========================================
//
// On straight ways from one set of places to another, a point p meets the plane of a triangle abc
// where the volume of the four is 0, and so do the lines of two edges:
//
//   f(t) = (b - a) x (c - a) . (p - a) = 0,   0 <= t <= 1
//
// f is a cubic. Its root is found by halving, as only the side at both ends matters. The point has
// passed if it is then within the triangle; edges, if the places where their lines meet are within
// both.
//
// Ways are relative to the mean way, which many points share. Each way is divided into stretches of
// at most a cell of a grid, so the cost is in proportion to the number of points and triangles,
// plus the sum of their ways over an edge: long ways have no large boxes.

namespace suture {

struct SweptCrossing {
  std::array<Index, 4> places;  ///< the point and the corners of the triangle, or two edges
  double depth;                 ///< at the end, m
};

/// Places that move on straight ways; rows of 4.
struct SweptPlaces {
  const double *from, *to;
  double edge;  ///< a typical distance between neighbours, m
};

/// A point that has passed a triangle from its front to its back, and is behind its plane by more
/// than `depth` (m) at the end, for which counts(point, triangle) is true; the first one in the
/// order of triangles.
std::optional<SweptCrossing> find_passed_triangle(
    const SweptPlaces& places, std::span<const Index> points,
    std::span<const std::array<Index, 3>> triangles, double depth,
    const std::function<bool(Index point, Index triangle)>& counts);

/// Two edges that have passed each other, and whose lines are more than `depth` (m) apart at the
/// end, for which counts(first, second) is true.
std::optional<SweptCrossing> find_passed_edges(
    const SweptPlaces& places, std::span<const std::array<Index, 2>> edges, double depth,
    const std::function<bool(Index first, Index second)>& counts);

}  // namespace suture
