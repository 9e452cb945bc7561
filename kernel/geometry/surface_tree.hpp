// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <span>

#include "kernel/geometry/surface.hpp"

namespace suture {

/// A place as the weights of the corners of a triangle.
struct Weights {
  double a, b, c;
};

/// The point of a triangle that is nearest to `p`. A weight is exactly 0 if the point lies on the
/// opposite edge. Source: Ericson, Real-Time Collision Detection (2005), 5.1.5.
Weights nearest_in(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p);

/// A hierarchy over the triangles of a surface that finds the nearest one, and those that may
/// intersect.
///
/// It is a complete binary tree: the children of node i are 2i and 2i + 1, each with half of its
/// triangles along the longest axis, and a leaf holds 3 to 6 triangles. Each node stores a box, in
/// single precision and rounded outward. The lowest nodes also store the two planes, across their
/// mean normal, that enclose their triangles. Without the planes, a ball that touches the surface
/// would meet the boxes of hundreds of triangles around the point where it touches.
class SurfaceTree {
 public:
  /// `surface` must outlive the tree. Cost: 0.25 us per triangle.
  explicit SurfaceTree(const TriangleSurface& surface);

  /// The triangle nearest to a place, the first of those that are as near, or none if all are
  /// `within` or farther away. The nearer the triangle `start`, the faster the search.
  Index nearest(const Vec3& place, Index start,
                double within = std::numeric_limits<double>::infinity()) const;
  /// A triangle that may be farther away than the nearest, which is at `least_part` of its distance
  /// or more. Where many triangles are about as far away as the nearest, with a part of 0.98 in a
  /// third of the time.
  Index nearly_nearest(const Vec3& place, Index start, double least_part) const;
  /// Whether a triangle is nearer than `distance`.
  bool is_within(const Vec3& place, double distance) const;
  /// Calls visit(some, others) with lists of a few triangles, so that each pair of triangles whose
  /// boxes overlap is in one call. In the calls with some = others, these are the pairs among them.
  template <class Visit>
  void for_overlaps(Visit&& visit) const {
    for (Index leaf = 0; leaf < leaves_; ++leaf) {
      visit(triangles_of(leaf), triangles_of(leaf));
      // The leaf in the left child of the common ancestor of two finds the other.
      for (Index node = leaves_ + leaf; node > 1; node /= 2)
        if (node % 2 == 0) leaves_overlapping(leaf, node + 1, visit);
    }
  }
  /// All triangles, neighbours near each other.
  std::span<const Index> order() const { return order_; }

 private:
  struct Node {
    std::array<float, 3> low, high;
    std::array<float, 3> normal;  ///< of length below 1, or 0 if the node has no planes
    float below, above;           ///< of normal . x over its points
  };
  struct Search;
  struct Middle;

  std::span<const Index> triangles_of(Index leaf) const { return triangles_in(leaf, leaf + 1); }
  std::span<const Index> triangles_in(Index first_leaf, Index last_leaf) const;
  void sort_triangles();
  void halve(std::span<Middle> middles, Index first_leaf, Index last_leaf) const;
  void make_leaf(Index leaf);
  void add_planes(std::span<const Index> triangles, Node& node) const;
  double squared_gap(Index node, const Vec3& place) const;
  void descend(Index node, Search& search) const;
  void examine(std::span<const Index> triangles, Search& search) const;
  static bool overlap(const Node& a, const Node& b);

  template <class Visit>
  void leaves_overlapping(Index leaf, Index node, Visit& visit) const {
    if (!overlap(nodes_[leaves_ + leaf], nodes_[node])) return;
    if (node >= leaves_) return visit(triangles_of(leaf), triangles_of(node - leaves_));
    leaves_overlapping(leaf, 2 * node, visit);
    leaves_overlapping(leaf, 2 * node + 1, visit);
  }

  const TriangleSurface& surface_;
  Index leaves_ = 1;  ///< a power of two
  std::vector<Index> order_;
  std::vector<Node> nodes_;  ///< from 1; the leaves come last
};

}  // namespace suture
