// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/mesh/parts.hpp"

namespace suture {

/// The parts of a sample of eight elements, with fractions from 1 to 1e-9. Each is a tetrahedron at
/// a corner of its element, or what a tetrahedron leaves.
Parts sample_parts();

/// The integral of the gradient of shape function `node` over the part of element `element` of the
/// sample, in the reference cube. Computed by quadrature, not from moments.
Vec3 integral_of_gradient(Index element, int node);

}  // namespace suture
