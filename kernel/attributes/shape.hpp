// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "kernel/base/types.hpp"

namespace suture {

/// Nodes X0..X7 of a hexahedron, m.
using HexahedronNodes = std::array<Vec3, 8>;

/// SUTURE_PARALLELEPIPED of suture/plugin.h: the four edge vectors of each
/// direction agree, component by component, within 1e-12 of the element's size,
/// which is its longest edge from X0.
bool is_parallelepiped(const HexahedronNodes& x);

/// Its mean edge vectors lie along the axes exactly, summed as mean_edges() of the SDK sums them:
/// functors on parallelepipeds may compute such elements by shorter formulas.
bool is_box(const HexahedronNodes& x);

/// Volume of the trilinear hexahedron, m^3, exact; negative if it is mirrored.
/// With v0..v7 the nodes in the order of VTK (X0 X1 X3 X2 X4 X5 X7 X6):
///   12 V = [(v3-v1)+(v7-v2)] . (v6-v3) x (v2-v0) + [(v4-v3)+(v5-v7)] . (v6-v4) x (v7-v0)
///        + [(v1-v4)+(v2-v5)] . (v6-v1) x (v5-v0)
/// J. Grandy, Efficient computation of volume of hexahedral cells, UCRL-ID-128886
/// (1997). Checked in tests against the integral of det J.
double hexahedron_volume(const HexahedronNodes& x);

}  // namespace suture
