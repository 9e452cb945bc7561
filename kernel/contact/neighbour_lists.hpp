// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/contact/near_edges.hpp"
#include "kernel/topology/islands.hpp"

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

  std::span<const NearPair> pairs() const { return pairs_; }
  /// Of edge(first) and edge(second).
  std::span<const NearEdges> edge_pairs() const { return edge_pairs_; }
  const FeatureEdge& edge(Index i) const { return edges_[i]; }
  /// Those of both lists, and all around the vertices of pairs; by place, sorted by corners.
  std::span<const Index> faces() const { return faces_; }
  /// Of a face, by place.
  Index piece_of(Index face) const { return meeting_.piece_of[surface_.corners()[face][0]]; }

  void follow(const TopologyChange& change);
  void state(Archive& archive);

 private:
  bool find_what_may_meet();
  bool has_moved(const double* positions) const;
  void rebuild(const double* positions, const LiveMask& moving);
  void find_pairs(const double* positions, const LiveMask& moving);
  void find_edge_pairs(const double* positions, const LiveMask& moving);
  void find_faces();
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
  // Of the last rebuild.
  std::vector<NearPair> pairs_;
  std::vector<NearEdges> edge_pairs_;
  std::vector<Index> faces_;
  std::vector<Vec3> built_at_;  ///< in the order of `ascending_`
};

}  // namespace suture
