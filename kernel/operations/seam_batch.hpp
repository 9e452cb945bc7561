// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "kernel/topology/face_matching.hpp"
#include "kernel/topology/seam.hpp"

namespace suture {

/// Seams that CellComplex::sew() accepts in one batch, collected one by one: the vertices merged by
/// earlier seams restrict the later ones.
class SeamBatch {
 public:
  explicit SeamBatch(const CellComplex& complex) : complex_(complex) {}

  /// Adds the seam to the batch; if that is not possible, returns the reason, as the end of a
  /// sentence, and leaves the batch unchanged. Both faces must be on the boundary and belong to
  /// different elements. O(elements around the four corners).
  std::optional<std::string> add(Seam seam, const Naming& naming = {});
  const std::vector<Seam>& seams() const { return seams_; }
  /// Whether the face (any dart of it) is in a seam of the batch.
  bool has(Dart face) const { return faces_.contains(face_of(face)); }

 private:
  using Elements = std::vector<Index>;
  Index joined(Index vertex) const;
  Elements around(Index vertex) const;
  std::string fold_text(Index element, const std::vector<Index>& group, const Naming& naming) const;

  const CellComplex& complex_;
  std::vector<Seam> seams_;
  std::unordered_set<Dart> faces_;                ///< identified by their first darts
  std::unordered_map<Index, Index> joined_;       ///< vertex -> a vertex that it merges into
  std::unordered_map<Index, Elements> elements_;  ///< elements of vertices that others merged into
};

}  // namespace suture
