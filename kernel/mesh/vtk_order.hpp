// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/base/types.hpp"

namespace suture {

/// Converts the nodes of a hexahedron from the order of VTK, Gmsh and Medit (around the lower face,
/// then around the upper face) to X0..X7 and back: the map is its own inverse.
constexpr Hexahedron swap_vtk_order(const Hexahedron& n) {
  return {n[0], n[1], n[3], n[2], n[4], n[5], n[7], n[6]};
}

}  // namespace suture
