// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/parts/face_contacts.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// What a suture does to elements that blades have divided: CellComplex::clone_volume() performs
/// the first part, and sew() the rest.
struct Reunion {
  Cloning cloning;          ///< each copy absorbs the other elements of its group
  Parts parts;              ///< of the copies, in their numbers
  std::vector<Seam> seams;  ///< still to be sewn, in the new numbers; each is possible on its own
  bool empty() const { return cloning.origins.empty(); }
};

/// The groups of existing elements that were one when the run began, in ascending order. `origin`:
/// of each element, as it was numbered then. `is_wanted`: by element. O(elements).
std::vector<std::vector<Index>> divided_groups(const CellComplex& complex,
                                               std::span<const Index> origin,
                                               const std::vector<std::uint8_t>& is_wanted);

/// Each group of divided_groups() becomes one element again, whose material is that of all of them;
/// it takes the values of the largest. At a face, it is joined to what touches it there; if that
/// is more than one element, to the one with the largest contact. `point_of_vertex`: of the user's
/// mesh; faces with the same points have been one. O(elements), and 20 us per element of a group.
Reunion reunite(const CellComplex& complex, const Parts& parts,
                std::span<const Index> point_of_vertex,
                const std::vector<std::vector<Index>>& groups);

}  // namespace suture
