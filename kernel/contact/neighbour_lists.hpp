// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/contact/near_edges.hpp"
#include "kernel/topology/islands.hpp"

// How near pairs are found
// ========================
//
//   +-----------+        Vertices lie in the cubes of a hash grid. The cubes of a row along x
//   |  o    o   |        follow each other in memory, so a box is a few stretches of entries,
//   | +-------+ |        tested eight at a time (place_grid.hpp).
//   | | face  | |
//   | +-------+ |        The box around a face is enlarged by 0.8 of an edge: the depth of 0.3 and
//   |    o      |        a skin of 0.5. Lists are valid until something has moved by half the skin.
//   +-----------+
//
// What is near is numbered by its place in the lists: its vertices, faces and edges lie together,
// and each step gathers the positions once. A third of the surface is near something. In tables of
// the whole body the search waited for memory, and so did the forces that followed.
//
// Blocks of 5 x 5 x 5 elements packed face to face, 4.6 / 6.5 / 6.7 pairs per face:
//   faces          4,000     109,000   259,000
//   ns per face    204-207   165-202   172-210
// At 109,000 faces this is 18 ms at best.
//
// What was tried without gain: a skin of 0.35 or 0.8 of an edge instead of 0.5. Skipping cubes
// that hold only the face's own piece saves 40 % of the search, but 3 % of the step of a pile.

namespace suture {

/// What pieces and lips of cuts may touch in the next steps: Verlet lists of vertices near faces
/// and of edges near edges. They contain all that is nearer to each other than `depth`, and are
/// made again when something has moved by half of the skin. With itself a piece touches only at
/// lips, which are the faces that were inside when the object was made, unless `self`.
///
/// Cost: a pass over the vertices of the surface in each step; a search (near_pairs.hpp) when
/// something has moved.
class NeighbourLists {
 public:
  /// `edge`: a typical edge of the surface, m; `depth`: in such edges.
  NeighbourLists(const CellComplex& complex, const BoundarySurface& surface, Attributes& attributes,
                 bool self, double edge, double depth);

  /// `positions`: rows of 4. `moving`: vertices; pairs of two sleepers are left out.
  void update(const double* positions, const LiveMask& moving);
  /// Call when pieces fell asleep or woke.
  void discard() { is_stale_ = true; }
  /// False if there is only one piece, without lips, that does not touch itself.
  bool may_meet() const { return may_meet_; }

  /// All of the boundary.
  std::span<const FeatureEdge> feature_edges() const { return edges_; }
  /// Whether these may touch wherever they are; numbered as in the boundary and in feature_edges().
  bool may_meet(const NearPair& pair) const;
  bool may_meet(const NearEdges& pair) const;

  // The lists number vertices, faces and edges by their places here: what is near is a small part
  // of the body, and lies together.

  /// Those of pairs and faces, ascending.
  std::span<const Index> vertices() const { return vertices_; }
  /// Those of pairs of both kinds, and all around the vertices of pairs; sorted by corners.
  std::span<const BoundarySurface::Corners> faces() const { return faces_; }
  Index piece_of_face(Index i) const { return meeting_.piece_of[vertices_[faces_[i][0]]]; }
  std::span<const FeatureEdge> edges() const { return near_edges_; }
  std::span<const NearPair> pairs() const { return pairs_; }
  std::span<const NearEdges> edge_pairs() const { return edge_pairs_; }

  void follow(const TopologyChange& change);
  void state(Archive& archive);

 private:
  bool find_what_may_meet();
  bool has_moved(const double* positions) const;
  void rebuild(const double* positions, const LiveMask& moving);
  void find_pairs(const double* positions, const LiveMask& moving);
  void find_edge_pairs(const double* positions, const LiveMask& moving);
  void number_what_is_near();
  std::vector<Index> near_faces() const;
  bool is_behind_at_rest(const NearPair& pair) const;
  bool are_near_at_rest(const NearEdges& pair) const;

  const CellComplex& complex_;
  const BoundarySurface& surface_;
  Attributes& attributes_;
  bool self_;
  double edge_, reach_;  ///< m
  Islands islands_;
  std::vector<bool> was_outside_;  ///< by face, as in BoundarySurface::faces(): at the beginning
  bool is_stale_ = true;           ///< an operation came after the last rebuild
  // Since the last operation.
  std::vector<Index> ascending_;  ///< vertices of the surface, for fast access to their rows
  Meeting meeting_;
  bool may_meet_ = false;
  std::vector<FeatureEdge> edges_;
  // From the last rebuild:
  std::vector<NearPair> pairs_;
  std::vector<NearEdges> edge_pairs_;
  std::vector<Index> vertices_;
  std::vector<BoundarySurface::Corners> faces_;
  std::vector<FeatureEdge> near_edges_;
  std::vector<Vec3> built_at_;  ///< in the order of `ascending_`
};

}  // namespace suture
