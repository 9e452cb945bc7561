// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/output/frame.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// The numbering of a frame for a complex with holes: the existing vertices and elements, in order,
/// become points 0, 1, 2, ... and cells 0, 1, 2, ... (Without holes a frame is a plain copy and
/// needs no numbering.)
struct DisplayedIds {
  std::vector<Index> vertices, elements;
  std::vector<Index> point_of;  ///< by vertex; none for a removed one

  static DisplayedIds of(const CellComplex& complex);
};

/// Keeps the values of these cells only, in this order.
void keep(std::vector<FrameField>& fields, const std::vector<Index>& cells);

/// Drops points and hexahedra that do not exist, and their values in all fields, which before that
/// have one value per vertex or element of the complex. O(frame).
void leave_out_holes(Frame& frame, const DisplayedIds& ids);

}  // namespace suture
