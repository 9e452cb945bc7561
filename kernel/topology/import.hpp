// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "kernel/base/diagnostics.hpp"
#include "kernel/mesh/mesh.hpp"
#include "kernel/topology/cell_complex.hpp"
#include "kernel/topology/element_parts.hpp"

namespace suture {

struct ImportOptions {
  enum class NonManifold { split, refuse };
  NonManifold non_manifold = NonManifold::split;
  bool allow_inverted_rest = false;
  bool renumber = true;  ///< renumber elements and vertices for locality (user ids do not change)
};

/// A map from numbers to other numbers. Nothing is stored if it is the identity.
class Renumbering {
 public:
  Renumbering() = default;
  /// Number i becomes `of[i]`.
  explicit Renumbering(std::vector<Index> of);

  Index operator[](Index i) const { return of_.empty() ? i : of_[i]; }
  std::span<const Index> list() const { return of_; }  ///< empty for the identity
  Renumbering inverse() const;
  /// Number `count` + i becomes extra[i], where `count` numbers exist so far.
  void append(Index count, std::span<const Index> extra);

 private:
  std::vector<Index> of_;
};

/// A mesh converted to a complex, whose numbers differ from the user's.
struct Imported {
  CellComplex complex;
  std::vector<Vec3> rest;              ///< per vertex of the complex
  std::vector<Index> user_vertex;      ///< vertex of the complex -> point of the Mesh
  Renumbering user_element;            ///< element of the complex -> hexahedron of the Mesh
  Renumbering element_of;              ///< inverse of user_element
  ElementParts parts;                  ///< elements of the complex that are not full
  std::vector<Index> vertex_of_point;  ///< point -> its first vertex; none if unused
  /// (point, additional vertex) where non-manifold cells were split, ascending.
  std::vector<std::pair<Index, Index>> split_points;
  /// The vertices of a point of the Mesh: none if it is unused, several where non-manifold cells
  /// were split.
  std::vector<Index> vertices_of_point(Index point) const;
};

/// Checks, repairs, renumbers and matches. Unused points are dropped, mirrored elements are flipped
/// (X_i and X_(i xor 1) are exchanged in their numbering) and non-manifold cells are split, each
/// with one warning that gives their number. Any other mesh that is not a 3-map throws
/// TopologyError listing all elements at fault (indices out of range, repeated nodes, a face in
/// three elements, two elements on the same side of a face, ...), as do elements with a corner
/// Jacobian <= 0, unless allow_inverted_rest is set and the Jacobian is positive at all 2x2x2 Gauss
/// points. A mesh without hexahedra or with points that are not finite throws InputError. Elements
/// keep their order if it is local (ordering.hpp); otherwise they follow a space-filling curve.
/// Elements of which only a part is material follow all others.
/// Vertices are numbered by first use. Cost: at most 0.5 us per hexahedron, including edge and face
/// ids.
Imported import_mesh(Mesh mesh, const ImportOptions& options, Diagnostics& diagnostics);

}  // namespace suture
