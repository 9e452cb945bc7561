// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "kernel/mesh/parts.hpp"

namespace suture {

/// The parts of a sample of eight elements, with fractions of the cube from 1 to 1e-9. Each is a
/// tetrahedron at a corner of its element, or what a tetrahedron leaves.
Parts sample_parts();
/// The same in elements that are no parallelepipeds, with these corners at rest.
Parts sample_parts(std::span<const std::array<Vec3, 8>> rest);

/// The integral of the gradient of shape function `node` over the part of element `element` of the
/// sample, whose corners at rest are given, m^2. Computed by quadrature, not from what functors
/// read.
Vec3 integral_of_gradient(Index element, int node, const std::array<Vec3, 8>& rest);

}  // namespace suture
