// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/contact/near_pairs.hpp"
#include "kernel/contact/piece_contact.hpp"
#include "kernel/contact/surface_points.hpp"

// Lips and pieces of an embedded surface
// ======================================
//
//            p o            a point of one lip
//              |  n         the normal of a triangle of the other one
//        a ----x---- b      its place x that is nearest to p
//
// The offset p - x is a combination of vertices, as a point is: those of p with their weights,
// those of the corners of the triangle with theirs, negative. So the impulses of PointMass, which
// act on all of them, conserve momentum, and the sweeps over points (point_pushes.cpp) take pairs
// like points: n . (p - x) must not be negative at the end of the step, and Coulomb's law holds for
// sliding.
//
// Which triangle a point touches:
// - The nearest one that looks at the point: the sum of the normals at the point, weighted by
// angles,
//   is at more than 78 degrees from the normal of the triangle. With areas as weights, large outer
//   faces hid the lip at whose rim a point lies.
// - A triangle through which the point cannot have come does not count: where the way from the
//   triangle to the point leaves the material behind the triangle again, the point is outside.
//   Without this rule, a point on the lip of a thin wedge was pushed out of the face behind it.
// - A point beside a triangle, near its rim, touches it, but an earlier depth does not come back:
// the
//   point is not inside. With both rules, nothing moves where random planes cut a body at rest
//   (3,000 of 3,000 cubes and bars); before, 8 of 40 moved, with up to 66 J.
// - In explicit steps pairs are those at the start of the step. At its end without contact, blocks
//   that lie on each other are in each other by p / M edges, p the pressure and M the modulus: with
//   coarse elements, by more than the depth at which pairs are given up.
//
// Most points and triangles that a search finds near each other are too far apart to touch. Where
// they are d apart, they are not looked at again before the fastest points have moved by d / 2.

namespace suture {

/// The points of an embedded surface that may touch triangles: those of other pieces, lips those of
/// the lips opposite, and with `self` all that are not their neighbours.
class PointPairs {
 public:
  /// `edge`: a typical edge of the elements, m.
  PointPairs(const CellComplex& complex, Attributes& attributes, const SurfacePoints& points,
             const PieceContact::Options& options, double edge)
      : complex_(complex),
        attributes_(attributes),
        points_(points),
        options_(options),
        edge_(edge) {}

  /// How deep a point may be behind a triangle if it touches it, in edges; 0.1 at first.
  void set_depth(double depth) {
    max_depth_ = depth;
    apart_until_.assign(apart_until_.size(), 0);
  }
  /// Call after an operation, and after loading a state.
  void follow() { is_stale_ = true; }
  /// False if there is one piece without lips that does not touch itself; after find().
  bool may_meet() const { return may_meet_; }
  /// The points of pairs and the corners of their triangles, in any order. They depend on the
  /// places now alone, not on when pairs were last sought: a resumed run takes the same steps.
  std::span<const Index> near_points() const { return near_points_; }

  /// Finds the pairs that may touch where the points were `back` seconds ago (s), by their
  /// positions and velocities now (SurfacePoints::gather). In each step a pass over the surface; a
  /// search when a point has moved by an eighth of an edge. `moving`: vertices; pairs of which none
  /// moves are left out. Null: all.
  ///
  /// At the end of an explicit step without contact, pieces that press on each other are in each
  /// other by about the part of an edge that the pressure is of their modulus, which may be too
  /// deep: pairs are those at its start. In a step in which something approaches by more than
  /// `margin`, they are those at its end.
  void find(double back, const LiveMask* moving = nullptr);
  /// How much points may approach triangles in a step for which pairs are found at its start, m.
  double reach() const { return margin * edge_; }
  std::size_t size() const { return pairs_.size(); }
  /// The offset of the point of pair i from its triangle.
  ContactPoint operator[](std::size_t i) const {
    const Pair& pair = pairs_[i];
    return {static_cast<Index>(i), std::span(vertices_).subspan(pair.first, pair.end - pair.first),
            std::span(weights_).subspan(pair.first, pair.end - pair.first)};
  }

  const SurfacePoints& surface() const { return points_; }
  /// Whether a point and a triangle touch each other where they meet; after find().
  bool may_touch(Index point, Index triangle) const;
  Index point(std::size_t i) const { return pairs_[i].point; }
  Index triangle(std::size_t i) const { return pairs_[i].triangle; }
  const Vec3& normal(std::size_t i) const { return pairs_[i].normal; }
  /// By how much an earlier depth of pair i may come back in a step, m: in proportion to how far
  /// its vertices move for it, and not at all where the point lies beside the triangle. It is then
  /// outside of the piece, and only near its rim.
  double scale_of_recovery(std::size_t i) const {
    return pairs_[i].is_beside ? 0 : pairs_[i].lever * edge_;
  }
  /// Of what a step may take back of an earlier depth, it takes this part back.
  void ease_recovery(double part) { eased_ = part; }
  double friction() const { return options_.friction; }

  /// The way by which the offset of pair i at the end of a step misses its
  /// target, m.
  double lacking(std::size_t i, const Vec3& offset, const Vec3& velocity, double dt) const;
  /// Changes of a relative velocity, m/s.
  struct Change {
    Vec3 normal{}, tangential{};
  };
  /// What keeps pair i apart, for its offset at the end of a step, its relative velocity, and the
  /// components in which nothing can move (bits).
  Change change(std::size_t i, const Vec3& offset, const Vec3& velocity, unsigned fixed,
                double dt) const;

 private:
  // In edges: how far things move before pairs are sought again; how far in front of a triangle and
  // beside it a point may yet be pushed; rounding at rest.
  static constexpr double skin = 0.25, margin = 0.1, beside = 0.05, level = 1e-4;
  /// In edges: what is farther apart at rest may touch although material is in between.
  static constexpr double far_apart = 2;
  /// Cosine of the angle of two normals above which their surfaces face the same way.
  static constexpr double same_side = 0.2;
  /// The part of an earlier depth that a step takes back, and at most, in edges: edges slide past,
  /// and the points behind them are found deep at once.
  static constexpr double recovered = 0.2, max_recovery = 0.002;
  /// Near the end of a slit, a point and its triangle depend on almost the same vertices: these
  /// must move by d / lever for an offset of d. Below this lever, they do not touch.
  static constexpr double least_lever = 0.05;
  /// Squared, of a normal along which hardly anything can move.
  static constexpr double least_free = 1e-3;
  using Near = NearPair;  // of a point and a triangle
  struct Pair {
    std::size_t first, end;  ///< in vertices_ and weights_
    Index point, triangle;
    Vec3 normal;
    double lever;  ///< half the sum of the magnitudes of its weights; 1 without common vertices
    bool is_beside;
  };
  void gather_places(double back);
  void find_pieces();
  void find_triangles_at_points();
  bool has_moved();
  void find_near();
  /// That of a triangle.
  struct Plane {
    Vec3 normal;     ///< of unit length; 0 of a triangle without an area
    double offset;   ///< of the plane from the origin, along the normal, m
    Index step = 0;  ///< in which all this is known
  };
  const Plane& plane(Index triangle);
  Vec3 normal_at(Index point);
  /// A triangle as seen from a point.
  struct Close {
    Index triangle;
    Vec3 weights;  ///< of its corners, of the foot
    Vec3 foot;     ///< its place that is nearest to the point
    double gap;    ///< of the point from its plane, negative behind it, m
    double distance;
  };
  void find_close(std::size_t first, std::size_t last);
  bool is_behind_material(const Close& close, const Vec3& at);
  void add_nearest(std::size_t first, std::size_t last, const LiveMask* moving);
  void add_pair(Index point, const Close& close, const LiveMask* moving);
  void add(Index point, double weight);
  Vec3 place(Index point) const { return row(places_.data(), point); }
  Vec3 rest(Index point) const { return points_[point].sum(attributes_.rest().rows()); }

  const CellComplex& complex_;
  Attributes& attributes_;
  const SurfacePoints& points_;
  const PieceContact::Options options_;
  const double edge_;
  double max_depth_ = 0.1, eased_ = 1;
  bool is_stale_ = true, may_meet_ = false;
  // Since the last operation.
  std::vector<Index> piece_of_;       ///< by point
  std::vector<Index> first_at_, at_;  ///< triangles at each point, ascending
  // From the last search:
  std::vector<Vec3> searched_at_;            ///< by point
  std::vector<Near> near_;                   ///< ascending
  std::vector<std::size_t> first_of_point_;  ///< in near_, and its size
  /// Most of near_ is too far apart to touch, each of them until way_ is this.
  std::vector<double> apart_until_;
  // From step to step:
  std::vector<double> places_;    ///< where pairs are found, rows of 4
  std::vector<Vec3> last_place_;  ///< by point
  double way_ = 0;                ///< of the fastest points since the search, at most, m
  Index step_ = 0;
  std::vector<Plane> planes_;  ///< by triangle
  std::vector<Close> close_;   ///< to the point that is looked at
  std::vector<Pair> pairs_;
  std::vector<Index> near_points_;
  std::vector<Index> vertices_;
  std::vector<double> weights_;
};

}  // namespace suture
