// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "kernel/parts/division.hpp"

namespace suture {

/// Whether there is material at a place in the reference cube of an element. O(its tetrahedra).
bool has_material(const Parts& parts, Index element, const Vec3& at);

/// Elements in finer tetrahedra than before, and the surface in them.
struct RefinedParts {
  Parts parts;                 ///< without outer sides
  std::vector<Index> sources;  ///< by triangle: the one of the body's parts in which it lies
};

/// The materials of the elements of a body, from its parts.
class PartMaterials {
 public:
  /// `parts` must outlive this.
  explicit PartMaterials(const Parts& parts) : parts_(parts) {}

  /// From now on, the materials of these elements have the surface of the body inside them. Call
  /// once for each element. O(triangles of the surface).
  void find_surface(std::span<const Index> elements, Index element_count);

  bool is_part(Index element) const {
    return position_in(parts_.elements, element) < parts_.elements.size();
  }
  PartMoments moments_of(Index element) const {
    const std::size_t place = position_in(parts_.elements, element);
    return place < parts_.elements.size() ? parts_.moments[place] : PartMoments{};
  }
  /// `own`: holds the material if the element is a part.
  const Material& of(Index element, Material& own) const;
  /// With the surface that lies on sides of the cube, too. `numbers`: of its triangles in the
  /// parts. Triangles that are no faces of the tetrahedra are left out.
  Material with_surface(Index element, std::vector<Index>& numbers) const;

 private:
  std::span<const std::pair<Index, Index>> triangles_of(Index element) const;

  std::uint8_t is_cut(Index triangle) const {
    return parts_.is_cut.empty() ? 0 : parts_.is_cut[triangle];
  }

  const Parts& parts_;
  std::vector<std::pair<Index, Index>> triangles_;  ///< element, triangle; ascending
};

}  // namespace suture
