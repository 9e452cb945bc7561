// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/mesh/mesh.hpp"

namespace suture {

struct BoxOptions {
  Vec3 origin{};                       ///< m, corner of smallest coordinates
  Vec3 size{1, 1, 1};                  ///< m
  std::array<Index, 3> cells{1, 1, 1};
  Vec3 grading{1, 1, 1};               ///< last cell / first cell along each axis
};

/// Regular grid, x index fastest. Point sets "x0", "x1", "y0", ... of the sides.
Mesh make_box(const BoxOptions& options);

}  // namespace suture
