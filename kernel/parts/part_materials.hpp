// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "kernel/parts/division.hpp"

namespace suture {

/// Whether there is material at a place in the reference cube of an element. O(its tetrahedra).
bool has_material(const Parts& parts, Index element, const Vec3& at);

/// The materials of the elements of a body, from its parts.
class PartMaterials {
 public:
  /// `parts` must outlive this.
  explicit PartMaterials(const Parts& parts) : parts_(parts) {}

  /// From now on, the materials of these elements have the surface of the body inside them. Call
  /// once. O(triangles of the surface).
  void find_surface(std::span<const Index> elements, Index element_count);

  bool is_part(Index element) const {
    return position_in(parts_.elements, element) < parts_.elements.size();
  }
  /// `own`: holds the material if the element is a part.
  const Material& of(Index element, Material& own) const;

 private:
  const Parts& parts_;
  std::vector<std::pair<Index, Index>> triangles_;  ///< element, triangle; ascending
};

}  // namespace suture
