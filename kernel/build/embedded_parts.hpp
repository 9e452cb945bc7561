// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <unordered_map>

#include "kernel/forces/follower.hpp"
#include "kernel/parts/embedding.hpp"
#include "kernel/parts/lip_triangle.hpp"
#include "kernel/parts/part_materials.hpp"
#include "kernel/topology/cell_complex.hpp"
#include "kernel/topology/dart.hpp"

namespace suture {

/// The partial elements of a body, and their embedding, which follows operations.
class EmbeddedParts final : public Follower {
 public:
  explicit EmbeddedParts(Parts parts) : parts_(std::move(parts)) {}
  /// From the numbers of the mesh to those of the complex.
  void renumber(const Renumbering& element_of) {
    parts_ = renumbered(std::move(parts_), element_of);
  }

  const Parts& parts() const { return parts_; }
  /// Call before cuts along blades: remembers which faces are the surface of the body now.
  void let_grow(const CellComplex& complex);
  /// Adds the parts of new elements, which follow all others, and their surface. `origins`: of the
  /// new elements; `cut`: the number of the cut that makes them.
  void append(const Parts& added, std::span<const Index> origins, Index cut = none);
  /// Elements have finer tetrahedra now. O(parts).
  void refine(const RefinedParts& refined);
  /// Describes those of the elements that consist of more than `most` tetrahedra by as few as their
  /// geometry needs (coarse_parts.hpp). Call within the operation that has made them.
  void coarsen(const CellComplex& complex, std::span<const Index> elements, std::size_t most);
  /// A cut has laid open this side of an element.
  void open(Dart side, Index cut) { cut_of_side_[face_of(side)] = cut; }
  /// The number of the cut that has made each triangle of embedding(); none of others.
  std::vector<Index> cuts(const CellComplex& complex);
  /// Elements are joined by these seams, or will be: of their sides, the surface is what they do
  /// not cover of each other. O(triangles).
  void join(std::span<const Seam> seams);
  /// Saves which cuts have opened sides, and the parts if some were appended.
  void state(Archive& archive);
  /// O(parts) at first and after an operation, else free.
  const Embedding& embedding(const CellComplex& complex) {
    if (!is_current_) embedding_ = Embedding(parts_, complex);
    is_current_ = true;
    return embedding_;
  }
  void follow(const CellComplex&, const TopologyChange&) override { is_current_ = false; }

 private:
  LipTriangle triangle(std::size_t t) const;
  /// The element of the mesh of which an element is a copy, or the element itself.
  Index lattice_element(Index element) const {
    return element < lattice_.size() ? element : lattice_origin_[element - lattice_.size()];
  }
  void inherit_cuts(std::size_t first_triangle, Index first_copy, std::span<const Index> origins,
                    Index cut);
  void inherit_sides(Index first, std::span<const Index> origins);
  void close(std::vector<Dart> sides);
  void replace_tetrahedra(const Parts& refined, Index first_point);

  Parts parts_;
  std::vector<Hexahedron> lattice_;     ///< the vertices of the elements before all operations
  std::vector<Index> lattice_origin_;   ///< of copies
  std::vector<Index> cut_of_triangle_;  ///< of the parts; none: of no cut
  std::unordered_map<Dart, Index> cut_of_side_;  ///< by first dart
  bool has_grown_ = false;
  Embedding embedding_;
  bool is_current_ = false;
};

}  // namespace suture
