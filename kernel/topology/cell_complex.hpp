// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kernel/base/types.hpp"
#include "kernel/topology/hexahedron_tables.hpp"

namespace suture {

/// One cell became two: `new_cell` is the number given to a component that
/// left `old_cell`. New numbers are consecutive from the previous count.
struct Split {
  Index old_cell;
  Index new_cell;
};

/// Incident elements of some cells, in compressed rows: cell i has the darts
/// darts[offsets[i]] .. darts[offsets[i+1]-1], one per incident element,
/// ascending (dimension 0: origin at the vertex; 1: on the edge; 2: on the face).
struct Stars {
  std::vector<Index> cells;
  std::vector<Index> offsets;
  std::vector<Dart> darts;
};

/// What an operation did to the cells. Attributes follow from this alone.
struct TopologyChange {
  std::array<std::vector<Split>, 3> splits;  ///< dimensions 0, 1, 2
  /// Old and new cells that lost or gained elements, per dimension.
  std::array<Stars, 3> stars;
  /// Elements incident to any of those stars, ascending.
  std::vector<Index> elements;
  Index faces_cut = 0;
  bool empty() const { return faces_cut == 0; }
};

/// The combinatorial 3-map of a set of hexahedra. Dart 24 e + 4 f + k is never
/// stored: beta0..beta2 are tables, beta3 is one word per face.
/// Memory per hexahedron: 24 B beta3, 32 B vertex ids, 48 B edge ids, 24 B face
/// ids; per vertex, edge and face one dart (4 B).
class CellComplex {
 public:
  CellComplex() = default;
  /// From conforming connectivity (import.hpp checks and repairs first).
  /// Throws TopologyError naming the elements and the reason.
  CellComplex(std::vector<Hexahedron> hexahedra, Index vertex_count);

  Index element_count() const { return static_cast<Index>(vertices_.size()); }
  /// Cells of a dimension: 0 vertices, 1 edges, 2 faces, 3 elements.
  Index count(int dimension) const;

  /// Ids of edges and faces are built on demand (idempotent).
  void require_edges();
  void require_faces();
  bool has_edges() const { return !edges_.empty() || element_count() == 0; }
  bool has_faces() const { return !faces_.empty() || element_count() == 0; }

  /// X0..X7 of element e; order of suture_hexahedron_edges / _faces.
  const Hexahedron& vertices_of(Index e) const { return vertices_[e]; }
  const std::array<Index, 12>& edges_of(Index e) const { return edges_[e]; }
  const std::array<Index, 6>& faces_of(Index e) const { return faces_[e]; }
  std::span<const Hexahedron> vertices() const { return vertices_; }
  std::span<const std::array<Index, 12>> edges() const { return edges_; }
  std::span<const std::array<Index, 6>> faces() const { return faces_; }

  /// The paper's dart[6][4] of element e.
  static std::array<std::array<Dart, 4>, 6> darts(Index e);
  static constexpr Dart beta0(Dart d);
  static constexpr Dart beta1(Dart d);
  static constexpr Dart beta2(Dart d);
  /// `none` on the boundary. O(1).
  Dart beta3(Dart d) const;
  /// Element on the other side of face f of element e, or `none`.
  Index neighbour(Index e, int f) const;

  Index origin(Dart d) const;      ///< vertex id
  Index edge(Dart d) const;        ///< edge id; needs require_edges()
  Index face(Dart d) const;        ///< face id; needs require_faces()
  /// Some dart of cell `id` (origin at it, on it, ...). O(1).
  Dart dart_of(int dimension, Index id) const;
  /// Elements around a cell: one dart per element, ascending. O(valence).
  void star(int dimension, Index id, std::vector<Dart>& out) const;

  /// 3-unsews all given faces (any dart of each; both sides allowed) in one
  /// batch. Throws TopologyError if !can_cut(). O(faces cut).
  TopologyChange cut(std::span<const Dart> faces);
  bool can_cut(Dart face) const { return beta3(face) != none; }

  /// Connected component of each element: ids 0.. in order of smallest element.
  std::vector<Index> islands(Index* count = nullptr) const;

  /// Checks every law of the map and of the ids; throws TopologyError naming
  /// the broken law and dart. O(elements).
  void validate() const;

 private:
  std::vector<Hexahedron> vertices_;
  std::vector<std::array<Index, 12>> edges_;
  std::vector<std::array<Index, 6>> faces_;
  std::vector<std::array<std::uint32_t, 6>> mates_;
  std::array<std::vector<Dart>, 3> some_dart_;
};

}  // namespace suture
