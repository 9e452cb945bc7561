// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/output/frame.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// What a frame shows of a complex with holes: the vertices and elements that exist,
/// in their order, as points 0, 1, 2, ... and cells 0, 1, 2, ... (Without holes a
/// frame is a copy, and nothing of this is made.)
struct Shown {
  std::vector<Index> vertices, elements;
  std::vector<Index> point_of;  ///< by vertex; none for one that is gone

  static Shown of(const CellComplex& complex);
};

/// Leaves out what does not exist, from points and hexahedra or lines and from all
/// fields, which have a value per vertex, element or line of the complex until then.
/// `lines`: those that stay. O(frame).
void leave_out_holes(Frame& frame, const Shown& shown, const std::vector<Index>& lines);

}  // namespace suture
