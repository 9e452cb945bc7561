// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "kernel/attributes/mean_gradient.hpp"
#include "kernel/forces/symmetric3.hpp"
#include "kernel/topology/hexahedron_tables.hpp"

namespace suture {

/// The axis of the pair of opposite faces that a face belongs to, and the two faces.
inline constexpr std::array<int, 6> axis_of_face{0, 1, 0, 1, 2, 2};
inline constexpr std::array<std::array<int, 2>, 3> faces_of_axis{{{0, 2}, {1, 3}, {4, 5}}};

/// The value of an element, and the axis across whose faces it applies.
struct AxisValue {
  double value;
  int axis;
};

/// Largest principal Green-Lagrange strain at the centre, and the axis across whose
/// faces the element is strained the most: largest G_a . E G_a / |G_a|^2
inline AxisValue principal_strain(const HexahedronNodes& x, const std::array<Vec3, 3>& G) {
  const SymmetricTensor E = green_lagrange(mean_gradient(x, G));
  AxisValue result{largest_eigenvalue(E), 0};
  double most = -1;
  for (std::size_t a = 0; a < 3; ++a) {
    const double across = along(E, G[a]) / dot(G[a], G[a]);
    if (a > 0 && !(across > most)) continue;
    most = across;
    result.axis = static_cast<int>(a);
  }
  return result;
}

inline double edge_length(const HexahedronNodes& x, std::size_t edge) {
  const auto [a, b] = hexahedron::edge_vertices[edge];
  return std::hypot(x[b][0] - x[a][0], x[b][1] - x[a][1], x[b][2] - x[a][2]);
}

/// Per axis the largest l/L - 1 of its four edges.
inline std::array<double, 3> elongations(const HexahedronNodes& x, const HexahedronNodes& rest) {
  std::array<double, 3> most{-1, -1, -1};
  for (std::size_t e = 0; e < hexahedron::edges; ++e)
    most[e / 4] = std::max(most[e / 4], edge_length(x, e) / edge_length(rest, e) - 1);
  return most;
}

}  // namespace suture
