// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "kernel/base/diagnostics.hpp"
#include "kernel/mesh/mesh.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

struct ImportOptions {
  enum class Pinched { split, refuse };
  Pinched pinched = Pinched::split;
  bool allow_inverted_rest = false;
  bool renumber = true;  ///< elements and vertices for locality (user ids stay)
};

/// What number a thing has elsewhere. Nothing is stored where all numbers stay.
class Renumbering {
 public:
  Renumbering() = default;
  /// Number i becomes `of[i]`.
  explicit Renumbering(std::vector<Index> of);

  Index operator[](Index i) const { return of_.empty() ? i : of_[i]; }
  std::span<const Index> list() const { return of_; }  ///< empty where all numbers stay
  Renumbering inverse() const;

 private:
  std::vector<Index> of_;
};

/// A mesh turned into a complex: numbers of the complex are not the user's.
struct Imported {
  CellComplex complex;
  std::vector<Vec3> rest;              ///< per vertex of the complex
  std::vector<Index> user_vertex;      ///< vertex of the complex -> point of the Mesh
  Renumbering user_element;            ///< element of the complex -> hexahedron of the Mesh
  Renumbering element_of;              ///< inverse of user_element
  std::vector<Index> vertex_of_point;  ///< point -> its first vertex; none if unused
  /// (point, further vertex) where pinched cells were split, ascending.
  std::vector<std::pair<Index, Index>> split_points;
  /// The vertices of a point of the Mesh: none if it is unused, several where
  /// pinched cells were split.
  std::vector<Index> vertices_of_point(Index point) const;
};

/// Checks, repairs, renumbers and matches. Unused points are dropped, mirrored
/// elements flipped (their numbering: X_i and X_(i xor 1) change places), pinched
/// cells split: each with one counting warning.
/// Everything else that is no 3-map throws TopologyError listing all elements
/// at fault (indices out of range, repeated nodes, a face in three elements,
/// two elements on the same side of a face, ...), and so do elements with a
/// corner Jacobian <= 0, unless allow_inverted_rest and all 2x2x2 Gauss points
/// are positive. A mesh without hexahedra or with points that are not finite throws
/// InputError. Elements keep their order if it is local (ordering.hpp), else they follow
/// a space-filling curve; vertices are numbered by first touch.
/// Cost: at most 0.5 us per hexahedron, edge and face ids included.
Imported import_mesh(Mesh mesh, const ImportOptions& options, Diagnostics& diagnostics);

}  // namespace suture
