// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/mesh/parts.hpp"
#include "kernel/operations/blade.hpp"
#include "kernel/parts/part_materials.hpp"

namespace suture {

/// A face at the front of a blade: two copies touch an element that is whole, and only one can be
/// joined to it. `side`: of the other copy; `mate`: of the element.
struct Tie {
  Dart side, mate;
};

/// What a cut along a blade does to a body: CellComplex::clone_volume() performs it, and sew() the
/// rest.
struct BladeCut {
  Cloning cloning;
  /// The parts of the copies, in their numbers, and the surface that they bring.
  Parts parts;
  RefinedParts refined;  ///< elements that stay
  Index divided = 0;     ///< elements
  CutArea area;
  std::vector<Seam> seams;      ///< of copies that were tied, in the new numbers
  std::vector<Tie> ties;        ///< afterwards, in the new numbers
  std::vector<double> heights;  ///< above the blade, by vertex, m; NaN: far from it
  bool empty() const { return divided == 0 && cloning.cut.empty(); }
};

/// The cut along a blade. An element that it crosses becomes one copy per connected part of its
/// material, and copies of neighbours stay joined where parts on the same side of the blade touch.
/// Where the blade lies within 0.02 edges of all corners of a face, it separates the elements
/// there. Heights above the blade are those of the vertices (Blade::heights), and trilinear
/// between.
///
/// Parts of an element on one side of the blade that touch the same part of a neighbour through
/// one face become one copy: the map has no face with three elements. An element is divided only if
/// the blade holds its whole section, to within reach_in_edges of the shortest edge at the blade.
/// Where one that is crossed is left whole, its face is joined to the copy that covers more of it.
///
/// `ties`: left by earlier steps of the same blade. They are resolved when it has divided the
/// element, too.
///
/// `parts`: of the complex, whose elements are a lattice (first_off_lattice()). O(elements), and 6
/// us per element that is divided.
BladeCut cut_along(const CellComplex& complex, const Parts& parts, const double* rows,
                   const Blade& blade, std::size_t stride = 4, std::span<const Tie> ties = {});

}  // namespace suture
