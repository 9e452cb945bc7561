// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/attributes/cell_nodes.hpp"
#include "kernel/attributes/instance.hpp"
#include "suture/lips.h"

namespace suture {

// Functors between two regions (suture/lips.h). The pairs of faces are those of the instance
// (Instance::lips); they are visited while both are open.

inline bool acts_on_lips(const suture_functor& functor) { return functor.cell_type == SUTURE_LIPS; }
bool acts_on_lips(const suture_model& model);  ///< whether one of its functors does

/// Number of nodes of a functor's cells.
inline int nodes_of(const suture_functor& functor) {
  return acts_on_lips(functor) ? 8 : nodes_of_cell(static_cast<int>(functor.dimension));
}

/// The faces that elements of `a` (the first) share with those that `is_other` marks, by ascending
/// faces; no element may be in both. O(elements).
std::vector<Seam> faces_between(const CellComplex& complex, std::span<const Index> a,
                                const std::vector<bool>& is_other);

/// The faces of all instances that are to be opened at the start of a run, ascending and each once.
std::vector<Dart> faces_to_open(const Attributes& attributes);

/// The face of the first lip, whose row in the instance's table of faces is that of the pair; none
/// if its element was removed.
inline Index face_of_lips(const CellComplex& complex, const Seam& lips) {
  const Index element = element_of(lips.one);
  return complex.exists(3, element) ? complex.faces_of(element)[local_face(lips.one)] : none;
}

/// The pair of lips whose first one is `face`; null if there is none, or if it is not open.
/// O(log lips).
const Seam* lips_at(const Instance& instance, const CellComplex& complex, Index face);

/// A node of a cell as a corner of an element that has the cell.
struct FunctorCorner {
  Index element;
  hexahedron::Local corner;
};
using FunctorCorners = std::array<FunctorCorner, 8>;

/// The nodes of open lips, in the order of batches.
FunctorCorners corners_of(const Seam& lips);
/// Those of a cell that the functor visits; the first nodes_of(functor) count. O(log lips).
FunctorCorners corners_of(const Instance& instance, const suture_functor& functor,
                          const CellComplex& complex, Index cell);

}  // namespace suture
