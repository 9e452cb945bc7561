// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/contact/boundary_surface.hpp"
#include "kernel/contact/cutting_edges.hpp"
#include "kernel/contact/entered_sides.hpp"
#include "kernel/contact/piece_contact.hpp"
#include "kernel/contact/placed_obstacle.hpp"
#include "kernel/contact/point_pairs.hpp"
#include "kernel/contact/surface_points.hpp"
#include "kernel/contact/tool.hpp"
#include "kernel/forces/contact_law.hpp"

// Contact in an explicit step
// ===========================
//
//        x o                        where the vertex is before the step
//           \.
//            \.
//   ----------\-----o----------     the surface of the obstacle at the end of the step
//              \    ^
//               \   | h dv_n        the correction, along the normal of the obstacle
//                \  |
//                 o x'              where the step without contact ends: gap < 0
//
//   dv_n = -gap / h,   dv_t = -u_t min(1, mu dv_n / |u_t|),   v' += dv,   x' += h dv
//
// The gap is that at the end of the step, with the obstacle in its pose there. Nothing is
// therefore inside after any step, at any speed, and a resting vertex ends exactly on the surface.
// The sliding u_t is the displacement of the vertex less that of the point of the obstacle, over
// h. A moving or turning obstacle needs no velocity of its own. A vertex that sticks has u_t = 0
// exactly; no spring creeps.
//
// Velocity and position are corrected together. In a prototype, correcting positions alone added
// energy, 7 to 23 times.
//
// - Two obstacles at once are treated one after the other, in up to 16 sweeps. Each push has its
//   own friction. This is exact for one obstacle and converges in a wedge, and every sum of pushes
//   obeys Coulomb's law.
// - A vertex that is inside at the start is moved out by 2 % of its depth per step, by at most 1 %
//   of an element. Resolving the depth at once would eject the body at up to 0.6 of the wave
//   speed.
// - An automatic dt is limited so that no obstacle moves by more than a tenth of the shortest
//   edge. A fixed dt above one edge is refused: the obstacle could jump over a surface.
//
// Why Contact is no ForceTerm: an impulse depends on the velocity that all forces together give.
// Motion calls Contact before the pass over the vertices, which clears the forces, to keep those
// of the boundary. It calls Contact again after the pass, when all positions are known. Only then
// does Contact look for what touches, by boxes of 32 vertices first. The record of a vertex (152
// B) is filled only where something touches. Filling it for all near pairs made a step of a pile
// 15 % longer. Without obstacles, both calls are one test of a pointer. All loops are serial and
// follow the boundary's list, so results do not depend on the number of threads.
//
// Work: an impulse J does the work J . (v- + v+)/2, with the velocities before and after the whole
// kick. This is the exact change of the kinetic energy. It is booked as "contact" and "friction",
// and excluded from the sums of the passes, so that the apparent frequency stays that of the body.
// The kinetic energy at the time of the positions includes the contact forces of the last step.
// Without them, a block at rest would have the energy (h F)^2 / 8m.
//
// Known limits: velocities of a Verlet state that was synchronised for a frame lack half a step of
// the contact force at vertices that touch.

namespace suture {

/// Contact of a body with obstacles and, if wanted, between its separate pieces. It changes
/// velocities rather than adding forces: after a step without contact, every vertex of the boundary
/// that ended inside an obstacle is moved to its surface, by the impulse that would have taken it
/// there (PlacedObstacle::push). So nothing penetrates, whatever the step, no stiffness has to be
/// chosen, and the stable step is that of the body alone. Impacts are inelastic.
///
/// Only vertices touch, wherever their way in the step leads through an obstacle (swept_gap.hpp).
/// Faces do not detect obstacles smaller than themselves.
///
/// Cost: a pass over the vertices of the boundary in each step.
class Contact final : public ContactLaw {
 public:
  /// `thickness`: the distance from obstacles at which vertices touch them, m. `embedding`: of a
  /// body with partial elements; what touches obstacles is then the points of that surface.
  Contact(const CellComplex& complex, Attributes& attributes, std::vector<Obstacle> obstacles,
          double thickness, SurfacePoints::Source embedding = {});

  /// Lets pieces and the lips of cuts touch each other (PieceContact, or PointPairs of an embedded
  /// surface); call it before any operation.
  void touch_pieces(const PieceContact::Options& options);
  /// Null without them.
  const PieceContact* pieces() const { return pieces_.get(); }
  PieceContact* pieces() { return pieces_.get(); }
  /// Those of an embedded surface, where its points are now; null without them.
  const PointPairs* find_point_pairs();
  /// The coefficient of lips and pieces.
  double friction_of_pieces() const {
    return pieces_ ? pieces_->friction() : pairs_ ? pairs_->friction() : 0;
  }
  /// What may touch other pieces: rows of 4, of those of touching_places().
  const double* places_now();
  std::span<const Index> touching_places() const {
    return points_ ? points_->numbers() : surface_.vertices();
  }

  /// Tissue resists the edge of a blade that an obstacle carries.
  void add_edge(const CuttingEdges::Edge& edge);

  const BoundarySurface& surface() const { return surface_; }
  bool has_points() const { return points_.has_value(); }
  /// visit(ContactPoint) for all that obstacles may push: the vertices of surface(), or the points
  /// of an embedded surface.
  template <class Visit>
  void for_each_point(Visit visit) const;
  /// Their numbers are below.
  Index point_count() const { return points_ ? points_->size() : attributes_.vertex_count(); }
  double thickness() const { return thickness_; }
  /// The longest edge of the elements at the boundary, at rest, m.
  double longest_edge() const { return longest_edge_; }

  void prepare(const ContactStep& step) override;
  std::span<const Correction> resolve(const ContactStep& step) override;
  void restart() override;
  bool marks_vertices() const override { return !points_ && !edges_; }
  double* kept_forces() override { return forces_.data(); }
  void mark_vertices(std::vector<bool>& marks) const override {
    for (const Index v : surface_.vertices()) marks[v] = true;
  }

  /// The motion of a compliant obstacle, null of others.
  const Tool* tool(std::size_t obstacle) const {
    return tools_[obstacle] ? &*tools_[obstacle] : nullptr;
  }
  /// Its forces are a term of the body (ContactTerm), which says what they are.
  void use_forces() { is_term_ = true; }
  /// On a vertex, by an obstacle or by another piece.
  struct Force {
    Index vertex;
    Vec3 force;            ///< N
    std::size_t obstacle;  ///< `between_pieces`: none
    Index point;           ///< that the obstacle pushes (ContactPoint)
    Nearest gap{};         ///< of that point from the obstacle
  };
  static constexpr std::size_t between_pieces = std::size_t(-1);
  /// The forces of that term at the end of a step, and what friction has dissipated in it, J.
  void record(std::span<const Force> forces, double time, double heat);
  /// Those of that term, in the last step.
  const EnteredSides& sides() const { return sides_; }

  double power() const override;
  std::optional<Failure> failure() const override;
  Pose pose(std::size_t obstacle, double time) const override;
  std::optional<ToolState> tool_state(std::size_t obstacle) const override;
  std::vector<double> gaps(double time) const override;
  std::vector<Index> vertices_near(std::size_t obstacle, double time,
                                   double distance) const override;
  double longest_step(double time) const override;
  double top_speed(const Obstacle& obstacle, double time) const override;
  void forget_sides() override {
    sides_.clear();
    if (edges_) edges_->forget_places();
  }
  void change_sleepers(const LiveMask& moving) override;
  void edge_divided(std::size_t edge, Index first) override { edges_->divided(edge, first); }
  std::vector<Index> near_moving_obstacles(double time, double dt) const override;
  void for_each_pushed_sleeper(const VisitPushed& visit) const override;
  std::vector<Press> presses() const override;

  void follow(const CellComplex& complex, const TopologyChange& change) override;
  void state(Archive& archive) override;

 private:
  /// A push by less is rounding, and no reason for another sweep; in elements.
  static constexpr double least_push = 1e-9;

  // These three are no aggregates: g++ 12 would clear each by `rep stos`, which takes longer than
  // all else in add_near.
  /// A vertex that the step may push: near an obstacle, or where pieces touch.
  struct Near {
    Near(Index of, const Vec3& end, const Vec3& velocity)
        : vertex(of), free_end(end), free_velocity(velocity) {}
    Index vertex;
    Vec3 free_end, free_velocity;  ///< after the step without contact
    bool is_booked = false;
    Vec3 mean{};  ///< of the velocities before and after the step, if booked, m/s
  };
  /// A place in pushed_, and the first place in near_ of what shares vertices with it.
  struct Grouped {
    std::size_t group, place;
  };
  /// What obstacles have changed in the velocity of a vertex or point, and what it was then, m/s.
  struct Pushed {
    Pushed(Index of, std::size_t first_push) : vertex(of), first(first_push) {}
    Index vertex;
    std::size_t first, count = 0;  ///< in pushes_, of the obstacles near it
    Vec3 change{}, settled{};
  };
  /// An obstacle that may push a vertex or point, and what it did, if it did.
  struct PushBy {
    PushBy(Index of, Index by) : vertex(of), obstacle(by) {}
    Index vertex, obstacle;
    Push push{};
  };
  void find_near_obstacles(const ContactStep& step);
  void find_touching_pieces(const ContactStep& step);
  void add_near(Index vertex);
  std::span<PushBy> pushes_on(std::size_t near) {
    if (near >= pushed_.size()) return {};
    return std::span(pushes_).subspan(pushed_[near].first, pushed_[near].count);
  }
  void find_at_edges();
  void push(double dt);
  void push_out_of_obstacles(double dt);
  double sweep_edges(double dt);
  void settle_tools(const ContactStep& step);
  void release(const ContactStep& step);
  template <class Visit>
  void for_each_pushed_by(std::size_t obstacle, Visit visit) const;
  Vec3 place_of(std::size_t i) const;
  Vec3 mass_of(std::size_t i) const;
  Tool::Impulse answer_to(std::size_t obstacle) const;
  std::vector<Tool::Pushed> pushed_by(std::size_t obstacle) const;
  void move(const Near& near, double dt);
  void push_out(Pushed& pushed, std::span<PushBy> pushes, double dt);
  void push_path(VertexPath& path, std::span<PushBy> pushes) const;
  bool is_free(Index point, const LiveMask& moving) const;
  void add_near_point(Index number);
  void find_pairs();
  void push_points(double dt);
  void group_points();
  void push_group(std::span<const Grouped> group, double dt);
  void sweep_group(std::span<const Grouped> group, bool has_pairs, double dt);
  std::array<double, 2> sweep_points(std::span<const Grouped> group, double dt);
  Vec3 push_point(std::size_t i, double dt);
  void change_point(std::size_t i, const Vec3& by, double dt);
  double way_of_point(std::size_t i) const;
  std::span<const Index> near_of_point(std::size_t i) const {
    return std::span(near_of_points_).subspan(first_near_[i], first_near_[i + 1] - first_near_[i]);
  }
  double find_closing_speed();
  Vec3 change_of(std::size_t i, const Vec3& end, const Vec3& velocity, double dt);
  void add_point(const ContactPoint& point);
  void book_points(const ContactStep& step);
  void book_pairs(const ContactStep& step);
  void note_pairs(const ContactStep& step);
  void book_edges(const ContactStep& step);
  Vec3 mean_velocity(const ContactPoint& point, const ContactStep& step) const;
  void book(Near& near, std::span<const PushBy> pushes, const ContactStep& step);
  Vec3 free_force(const Near& near, const ContactStep& step) const;
  Vec3 mean_velocity(const Near& near, const Vec3& force, const ContactStep& step) const;
  void book_friction_of_pieces(const ContactStep& step);
  void sum_loads();

  const CellComplex& complex_;
  Attributes& attributes_;
  double thickness_;
  BoundarySurface surface_;
  std::optional<SurfacePoints> points_;
  std::vector<Index> vertices_;             ///< of the surface, ascending; empty: not known
  double longest_edge_ = 0;                 ///< m
  std::vector<std::optional<Tool>> tools_;  ///< by obstacle
  bool has_tools_ = false;
  bool has_solids_ = false;  ///< obstacles that vertices could pass
  // In the step in progress:
  std::vector<PlacedObstacle> placed_;
  std::vector<Index> near_placed_;  ///< near some vertices
  std::vector<Near> near_;          ///< first those of pushed_; of points, their vertices
  std::vector<Pushed> pushed_;      ///< of near_, those near obstacles
  std::vector<PushBy> pushes_;      ///< of pushed_
  std::vector<Correction> corrections_;
  std::unique_ptr<PieceContact> pieces_;
  std::optional<PointPairs> pairs_;
  std::size_t first_pair_ = 0;         ///< in pushed_: pairs follow what obstacles may push
  std::vector<Vec3> pair_tangential_;  ///< of the changes of pairs, m/s
  const LiveMask* moving_ = nullptr;   ///< vertices
  std::optional<CuttingEdges> edges_;
  std::vector<Vec3> before_edges_;  ///< velocities of their vertices before a sweep
  std::vector<double> forces_;      ///< without contact and acceleration, of boundary vertices, N
  std::vector<Index> near_place_;   ///< in near_, by place in PieceContact::touching()
  std::vector<PointMass> point_masses_;       ///< of pushed_, with points, as those below
  std::vector<Index> near_of_points_;         ///< places in near_ of the vertices of each
  std::vector<std::size_t> first_near_;       ///< of each, in these, and their number
  std::vector<Vec3> directions_, residuals_;  ///< of the changes, m/s
  std::vector<double> seen_;           ///< what the ways of its vertices were when it was pushed, m
  std::vector<Grouped> grouped_;       ///< all of them
  std::vector<double> ways_;           ///< by place in near_: how far pushes have taken a vertex, m
  std::vector<Index> near_of_vertex_;  ///< in near_, with points or edges; none outside a step
  std::vector<Index> shared_;          ///< places in pushed_ of those that pieces touch, too
  // Results of the last step.
  EnteredSides sides_;
  double last_dt_ = 0;        ///< s
  double closing_speed_ = 0;  ///< of pieces that may meet, at most, after contact, m/s
  /// The force of an obstacle on a vertex in the last step, N.
  struct ObstacleForce {
    Index vertex, obstacle;
    Vec3 force;
  };
  std::vector<ObstacleForce> obstacle_forces_;
  /// A vertex of each of two pieces with an embedded surface, in the last step or when both fell
  /// asleep.
  std::vector<Press> pair_presses_, presses_asleep_;
  /// A vertex of a sleeper, and how it would be accelerated, m/s^2.
  struct PushedSleeper {
    Index vertex;
    double acceleration;
  };
  std::vector<PushedSleeper> pushed_sleepers_;
};

template <class Visit>
void Contact::for_each_point(Visit visit) const {
  static constexpr double one = 1;
  if (points_) {
    for (Index p = 0; p < points_->size(); ++p) visit((*points_)[p]);
  } else {
    for (const Index& v : surface_.vertices()) visit(ContactPoint{v, {&v, 1}, {&one, 1}});
  }
}

}  // namespace suture
