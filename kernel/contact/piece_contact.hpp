// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "kernel/contact/neighbour_lists.hpp"
#include "kernel/contact/patch.hpp"
#include "kernel/contact/touch_sweeps.hpp"

// Contact between pieces
// ======================
//
//                 o  vertex of one piece, after the step without contact
//         n ^    /
//           |   /  gap: distance along n at the end of the step
//     o-----+--/-------o     face of another piece, a bilinear patch
//     w1    foot       w2    weights of the foot
//
// The law is that of obstacles (contact.hpp). The impulse along the normal of the face takes the
// gap at the end of the step to zero. It acts on the corners with the weights of the foot, so
// momentum is kept. Edges that cross are treated in the same way, with the direction at right
// angles to both.
//
// Which contacts, and why:
// - The face is a bilinear patch, not two triangles: it has no kink along a diagonal.
// - A near pair is a candidate if the vertex passes the mean plane of the face and a cylinder
//   around it, which contains all that may touch. A sphere holds twice as many candidates. Planes
//   and feet are found eight at a time; one by one, they took a third of the step of a pile.
// - The nearest face counts, not beside its rim (0.05 of an edge), and only if n_v . n_f <= 0.2.
//   Without these rules, flush edges of stacked blocks are lost. Faces are tried in the order of
//   the list until one is nearer than 0.02 of an edge, then only faces that look elsewhere. In a
//   packed pile four faces meet at most vertices.
// - In inner corners, the nearest face of each side counts. With one alone, lips like stairs carry
//   0.975 of the pressure.
// - Vertices whose constraints leave less than 0.001 of the mobility have no contact: a weight of
//   rounding would need an impulse without bound.
// - Lips are faces that were inside at the start, also of one and the same piece. They need no
//   state beside the map. Within a piece, a vertex does not touch faces of its own element, nor
//   faces that it lies behind at rest by less than 0.5 edge. A thin sheet would touch itself
//   through its material.
// - Edges touch edges of other pieces if both are convex by more than 18 degrees at rest. The
//   direction must lead out between the faces of one edge and in between those of the other. With
//   vertices alone, pieces that cross at edges enter each other by up to an element. All edges
//   would cost 30 times as much to find.
//
// Depth. Contacts are found up to 0.3 of an edge deep, which is always within the near pairs. They
// therefore depend on positions alone, and a checkpoint saves no list. A depth that existed before
// the step recovers by 20 %, at most 0.02 edge per step, between edges 0.002. Edges that slide
// across each other are found deep at once. With 0.02 they gained 0.4 to 6 J/s in a pile of 20
// letters (32 kg), about all that contacts of faces took out of it.
//
// Fast approach. An automatic dt is limited so that no pieces approach each other by more than
// 0.05 of an edge in a step. This is measured by the box around the velocities of the surface
// after contact. After 0.25 of an edge, edges have slid off each other and are lost. With 0.07 and
// 0.1, a slit closes wrongly at 2 of 10 starts. Velocities without contact contain what holds
// pressed pieces apart. With 0.1 of these, dt changed in nearly every step of a pile (5 % of the
// step), and 34 of 40 searches found rest instead of 36. Where something that touches got deeper
// than 0.08 of an edge in a step, the run goes back and halves dt. With a fixed dt it stops: at
// 0.3 the contact would be dropped.
//
// Known limits: an edge that slides over a node of another mesh can catch on it, as the node is
// then level with two faces. A vertex beside the rim of a face touches it, and the two forces are
// not on one line there.

namespace suture {

/// Contact between pieces and between the lips of cuts: vertices of one with faces of another. In
/// every step a vertex touches the nearest face of each piece, and in an inner corner the nearest
/// ones of its sides; impulses along their normals, with friction, by Gauss-Seidel sweeps over all
/// contacts. Where edges cross at which the surface bends outward, these touch each other, too.
///
/// Lips coincide when they are made: their gap is 0, so they do not repel.
///
/// Two rules keep flush surfaces apart that meet at edges: a vertex whose own surface looks the
/// same way as a face (n_v . n_f > 0.2) is on the far side of that face and does not touch it; nor
/// does a vertex beside a face, where another face is nearer or none is.
///
/// Contacts are found where the step would end with the impulses of the last one, from which the
/// sweeps begin. They do not depend on when the list of near pairs was made.
class PieceContact {
 public:
  struct Options {
    double friction = 0;
    bool self = false;  ///< all of a piece touches all of it
  };
  /// `edge`: a typical edge of the surface, m.
  PieceContact(const CellComplex& complex, const BoundarySurface& surface, Attributes& attributes,
               const Options& options, double edge);
  bool touches_self() const { return options_.self; }
  double friction() const { return options_.friction; }
  /// A vertex that is deeper inside another piece does not touch it; of a typical edge.
  static constexpr double max_depth = 0.3;
  /// False if there is only one piece, without lips, that does not touch itself.
  bool may_meet() const { return lists_.may_meet(); }
  /// Of the boundary, since begin().
  std::span<const FeatureEdge> feature_edges() const { return lists_.feature_edges(); }
  /// Whether a vertex and a face of the boundary, or two of these edges, touch each other where
  /// they meet; after begin().
  bool may_touch(const NearPair& pair) const { return lists_.may_meet(pair); }
  bool may_touch(const NearEdges& pair) const { return lists_.may_meet(pair); }

  using Touch = PieceTouch;
  /// Finds the contacts where a free step, which has been made, and the forces of the last one
  /// lead. In the step, dv = gain * force / mass. `moving`: vertices; what sleeps does not yield.
  void begin(double dt, double gain, const LiveMask& moving);
  /// Begins with the forces of the last step where contacts continue.
  void apply_last_forces();
  std::span<const Touch> touches() const { return touches_; }
  /// The vertices of touches; of each by PieceTouch::places.
  const DenseSet& touching() const { return sweeps_.vertices(); }
  /// Improves the impulses, and changes velocities by them; positions are up to the caller. True if
  /// some gap changed by more than 1e-4 of an edge, or by more than 0.3 of the change in the first
  /// sweep.
  bool sweep();
  /// An obstacle has moved a vertex in a sweep, m.
  void disturb(Index vertex, double way) { sweeps_.disturb(vertex, way); }
  /// After the sweeps: the touch that has become deepest in the step, if its depth is more than
  /// 0.08 of a typical edge; null otherwise.
  const Touch* too_deep() const;
  double depth(const Touch& touch) const;  ///< at the current positions, m

  /// Call when pieces fell asleep or woke. The forces between sleepers stay as they are until one
  /// of them wakes.
  void change_sleepers(const LiveMask& moving);
  /// Between two sleepers, with forces (N) in place of impulses.
  std::span<const Touch> asleep() const { return asleep_; }
  /// Calls visit(vertex, acceleration) for the vertices of sleepers that others touch: what the
  /// impulse of the last step, and that of the next one where a gap is about to close, would give
  /// it, m/s^2.
  template <class Visit>
  void for_each_pushed_sleeper(Visit visit) const {
    for (const Touch& touch : touches_)
      for (std::size_t i = 0; i < 5; ++i)
        if (touch.weights[i] != 0 && !(*moving_)[touch.vertices[i]])
          visit(touch.vertices[i], std::abs(touch.response[i]) * coming_impulse(touch) / gain_);
  }

  void follow(const TopologyChange& change);
  void state(Archive& archive);

 private:
  /// The foot of a vertex on a face of a piece.
  struct Found {
    Index piece, face;
    FaceFoot foot;
    Vec3 centre;  ///< of the face
    /// The faces form an inner corner, so that a vertex in it touches both.
    bool faces(const Found& other) const;
  };
  struct FreeEnd {
    Index vertex;
    Vec3 position, velocity;
  };
  bool is_settled(Index piece, const Vec3& face_normal) const;
  void add(const Found& found);
  char fixed_components(Index vertex) const;
  double coming_impulse(const Touch& touch) const;
  void wake(std::vector<Touch>& woken);
  void find_faces();
  void find_candidates();
  void find_nearest(std::span<const NearPair> of_vertex, std::span<const FaceFoot> feet);
  void add_nearest(std::span<const NearPair> of_vertex, std::span<const FaceFoot> feet);
  void add_crossing(const NearEdges& pair);
  bool may_leave(const FeatureEdge& edge, const Vec3& direction) const;
  Touch touch_of(const std::array<Index, 5>& places, const std::array<double, 5>& weights,
                 const Vec3& normal, double end) const;
  void move_by_last_forces();
  void find_touches();
  void take_back();

  const CellComplex& complex_;
  Attributes& attributes_;
  Options options_;
  double edge_, dt_ = 0, gain_ = 0;
  NeighbourLists lists_;
  // In the step in progress, by place in the lists:
  std::vector<double> ends_;   ///< of vertices, where contacts are sought; rows of 4
  std::vector<Vec3> normals_;  ///< of vertices: sums of area vectors
  std::vector<FacePlane> faces_;
  std::vector<Vec3> areas_;  ///< of faces
  std::vector<NearPair> candidates_;
  std::vector<FaceFoot> feet_;  ///< of candidates
  std::vector<Touch> touches_, last_;
  double precision_ = 0;       ///< of gaps, m; 0: before the first sweep
  std::vector<FreeEnd> free_;  ///< changed by move_by_last_forces()
  TouchSweeps sweeps_;
  std::vector<Found> nearest_;  ///< to one vertex
  const LiveMask* moving_ = nullptr;
  std::vector<Touch> asleep_;
};

}  // namespace suture
