// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/build/built_scene.hpp"
#include "kernel/operations/match_faces.hpp"

namespace suture {

/// What a suture selects in a body whose surface lies inside elements. Only what was one when the
/// run began is sewn.
class EmbeddedSewing {
 public:
  /// Positions are those of the body now.
  EmbeddedSewing(const SewFaces& sew, BuiltScene& built);
  /// Groups of elements that were one (divided_groups()), for reunite().
  std::vector<std::vector<Index>> groups() const;
  /// Faces between whole elements, and parts that touch there at rest.
  MatchedSeams seams(const Naming& naming) const;

 private:
  using Mask = std::vector<std::uint8_t>;  // by element
  Mask mask_of(const std::vector<Index>& elements) const;
  bool may_join(Index one, Index other) const;
  bool are_near(Index one, Index other) const;
  bool are_near(const Seam& seam) const;

  const SewFaces& sew_;
  BuiltScene& built_;
  const CellComplex& complex_;
  const double* rows_;  ///< positions
  Mask one_, other_;    ///< the two sides; the same if anything may be sewn to anything
};

}  // namespace suture
