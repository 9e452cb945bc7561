// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "kernel/contact/neighbour_lists.hpp"
#include "kernel/contact/patch.hpp"
#include "kernel/contact/touch_sweeps.hpp"

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
  // Of the step in progress, by place in the lists.
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
