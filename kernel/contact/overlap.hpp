// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/contact/contact.hpp"

namespace suture {

/// An obstacle that lies partly or wholly inside a body.
struct Overlap {
  std::size_t obstacle;  ///< by place in Contact::obstacles()
  Index vertices = 0;    ///< of the body inside the obstacle; 0: the obstacle lies inside the body
  double depth = 0;      ///< of the deepest one, m
  Vec3 place{};          ///< its position, or a point of the obstacle
};

/// Overlaps with all obstacles at `time`; contacts to within rounding do not count. O(obstacles
/// times vertices).
std::vector<Overlap> find_overlaps(const Contact& contact, const CellComplex& complex,
                                   Attributes& attributes, double time);

/// Whether a place is inside a closed surface. O(faces).
bool is_inside(std::span<const BoundarySurface::Corners> surface, const double* positions,
               const Vec3& place);

}  // namespace suture
