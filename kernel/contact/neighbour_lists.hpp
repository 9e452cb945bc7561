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

  // The lists number vertices, faces and edges by their places here: what is near is a small part
  // of the body, and lies together.

  /// Of pairs and faces, ascending.
  std::span<const Index> vertices() const { return vertices_; }
  /// Of pairs of both kinds, and all around the vertices of pairs; sorted by corners.
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
  // Of the last rebuild.
  std::vector<NearPair> pairs_;
  std::vector<NearEdges> edge_pairs_;
  std::vector<Index> vertices_;
  std::vector<BoundarySurface::Corners> faces_;
  std::vector<FeatureEdge> near_edges_;
  std::vector<Vec3> built_at_;  ///< in the order of `ascending_`
};

}  // namespace suture
