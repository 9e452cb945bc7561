// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/mesh/parts.hpp"

namespace suture {

/// The part of the element at `place` in parts.elements, whose corners at rest are given.
/// Parallelepipeds need it only beside other hexahedra. Throws NumericalError if its volume at rest
/// is not positive. O(tetrahedra).
GeneralPart general_part(const Parts& parts, std::size_t place, const std::array<Vec3, 8>& rest);

}  // namespace suture
