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

/// Volume of the trilinear hexahedron, m^3, exact; negative if it is mirrored.
///   12 V = [x7-x1 + x6-x0] . (x7-x2) x (x3-x0) + two more of the kind
/// J. Grandy, Efficient computation of volume of hexahedral cells, UCRL-ID-128886
/// (1997), eq. (17), nodes there in the order of VTK.
double hexahedron_volume(const HexahedronNodes& x);

}  // namespace suture
