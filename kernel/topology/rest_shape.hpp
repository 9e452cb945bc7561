// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <utility>

#include "kernel/base/types.hpp"

namespace suture {

/// Positions of the nodes X0..X7 of one hexahedron, m.
using Corners = std::array<Vec3, 8>;

/// Jacobian determinants of the trilinear map from the unit cube, m^3, at the 8
/// corners: the triple product of the three edges that meet there.
std::array<double, 8> corner_jacobians(const Corners& x);

/// The same at the 2x2x2 Gauss points. Their mean is exactly the volume, because det J has degree 2
/// in each local coordinate.
std::array<double, 8> gauss_jacobians(const Corners& x);

/// Converts to the numbering of the mirror image: X_i and X_(i xor 1) are exchanged.
template <class T>
void mirror(std::array<T, 8>& nodes) {
  for (int i = 0; i < 8; i += 2) std::swap(nodes[i], nodes[i + 1]);
}

/// How an element is numbered and distorted. It is mirrored if its volume is negative: single bad
/// corners do not decide it.
struct RestShape {
  bool mirrored = false;  ///< numbered as the mirror image; turned round for what follows
  bool inverted = false;  ///< a corner Jacobian <= 0
  bool unusable = false;  ///< and one at a Gauss point
};
RestShape rest_shape(const Corners& x);

}  // namespace suture
