// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/contact/contact_in_progress.hpp"
#include "kernel/contact/cutting_edges.hpp"
#include "kernel/contact/kept_contact.hpp"
#include "kernel/contact/piece_contact.hpp"
#include "kernel/contact/point_pairs.hpp"
#include "kernel/contact/tool.hpp"
#include "kernel/contact/touching_points.hpp"
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
// - Depths in obstacles and of embedded surfaces come back at a speed that does not grow as dt
//   falls: a step that is a tenth of the longest one so far takes back a tenth of that. Small
//   pieces that are squeezed make dt short, and so does fast approach. With a fixed way per step,
//   shorter steps threw them ever faster.
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

class ContactBooks;
class PointPushes;
class VertexPushes;

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
///
/// What may touch is TouchingPoints, and what pushes it VertexPushes or PointPushes. The data of
/// the step in progress are ContactInProgress, results ContactLaw::Results, and what later steps
/// need is KeptContact. It has more than 25 functions, since 22 of them are those of ContactLaw.
class Contact final : public ContactLaw {
 public:
  /// `thickness`: the distance from obstacles at which vertices touch them, m. `embedding`: of a
  /// body with partial elements; what touches obstacles is then the points of that surface.
  Contact(const CellComplex& complex, Attributes& attributes, std::vector<Obstacle> obstacles,
          double thickness, SurfacePoints::Source embedding = {});
  ~Contact() override;

  /// Lets pieces and the lips of cuts touch each other (PieceContact, or PointPairs of an embedded
  /// surface); call it before any operation.
  void touch_pieces(const PieceContact::Options& options);
  /// Null without them.
  const PieceContact* pieces() const { return pieces_.get(); }
  PieceContact* pieces() { return pieces_.get(); }
  /// Those of an embedded surface, where its points are now; null without them.
  const PointPairs* find_point_pairs();
  bool has_point_pairs() const { return pairs_.has_value(); }
  /// As they were found last; null without them.
  const PointPairs* point_pairs() const { return pairs_ ? &*pairs_ : nullptr; }
  /// The coefficient of lips and pieces.
  double friction_of_pieces() const {
    return pieces_ ? pieces_->friction() : pairs_ ? pairs_->friction() : 0;
  }
  /// What may touch obstacles and pieces.
  const TouchingPoints& points() const { return points_; }
  /// Rows of 4, by number of points().
  const double* places_now();
  const BoundarySurface& surface() const { return points_.surface(); }

  /// Tissue resists the edge of a blade that an obstacle carries.
  void add_edge(const CuttingEdges::Edge& edge);

  double thickness() const { return thickness_; }
  /// The longest edge of the elements at the boundary, at rest, m.
  double longest_edge() const { return longest_edge_; }

  void prepare(const ContactStep& step) override;
  std::span<const Correction> resolve(const ContactStep& step) override;
  void restart() override;
  bool marks_vertices() const override { return !points_.are_embedded() && !edges_; }
  double* kept_forces() override { return step_.forces.data(); }
  void mark_vertices(std::vector<bool>& marks) const override {
    for (const Index v : surface().vertices()) marks[v] = true;
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
  const EnteredSides& sides() const { return kept_.sides; }

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
    kept_.sides.clear();
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
  using Near = ContactInProgress::Near;
  using Pushed = ContactInProgress::Pushed;
  using PushBy = ContactInProgress::PushBy;
  void ease_recovery(double dt);
  void find_near_obstacles(const ContactStep& step);
  void add_if_near(Index number, const ContactStep& step, double margin, double reach);
  bool is_free(const ContactPoint& point) const;
  void find_at_edges();
  void push(double dt);
  void push_out_of_obstacles(double dt);
  double sweep_edges(double dt);
  void settle_tools(const ContactStep& step);
  void release(const ContactStep& step);
  template <class Visit>
  void for_each_pushed_by(std::size_t obstacle, Visit visit) const;
  Vec3 mass_of(std::size_t i) const;
  Tool::Impulse answer_to(std::size_t obstacle) const;
  std::vector<Tool::Pushed> pushed_by(std::size_t obstacle) const;
  double find_closing_speed();
  void book(const ContactStep& step);
  void book_pairs(ContactBooks& books);
  void note_pairs(const ContactStep& step);
  void book_edges(ContactBooks& books);
  void book_pieces(ContactBooks& books);

  const CellComplex& complex_;
  Attributes& attributes_;
  double thickness_;
  TouchingPoints points_;
  double longest_edge_ = 0;                 ///< m
  std::vector<std::optional<Tool>> tools_;  ///< by obstacle
  bool has_tools_ = false;
  bool has_solids_ = false;  ///< obstacles that vertices could pass
  std::unique_ptr<PieceContact> pieces_;
  std::optional<PointPairs> pairs_;
  std::optional<CuttingEdges> edges_;
  ContactInProgress step_;
  std::vector<Correction> corrections_;
  std::unique_ptr<VertexPushes> vertex_pushes_;  ///< of whole elements
  std::unique_ptr<PointPushes> point_pushes_;    ///< of an embedded surface
  KeptContact kept_;
};

}  // namespace suture
