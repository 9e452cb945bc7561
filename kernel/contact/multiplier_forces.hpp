// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kernel/contact/contact_regimes.hpp"
#include "kernel/contact/contact_term.hpp"
#include "kernel/contact/curvature.hpp"
#include "kernel/forces/nonsmooth_term.hpp"

// Contact in implicit steps and equilibria
// ========================================
//
//   solve the equations  ->  l = p, t = q  ->  solve again  ->  ...  until gaps < 1e-4 of an edge
//
// The stiffness k is s times the bound on that of the body, plus s m / dt^2 in steps. Without the
// second part, impacts do not settle in 50 updates, with any dt. In equilibria s is 4, in steps 1:
// there are more updates, but fewer iterations of linear solvers. A block of the diagonal takes k
// up in every preconditioner. Between pieces it is that of springs in series, 1/k = sum w^2/k_v
// over the vertices that move, plus that of the masses in the same way: the softer side rules.
//
// A depth that exists at the start of a step of a motion stays, and comes back slowly: gaps are
// those beyond a target of
//   min(0, gap at the start + c),   c = 0.0005 lever edge min(1, dt sqrt(k_body / m))
// Points are found deep at once where edges slide past each other, where a cut makes points inside
// of an obstacle, and where a lip is taken for another one. A step that took such a depth d back
// at once would do the work m (d / dt)^2 / 2, which throws other points out of their contacts and
// into others: half of dt made it four times as much. With c, the speed is at most 0.0005 of that
// of waves, for any dt. A larger c (0.02, or 0.002 per step) feeds contacts that are not real with
// energy. In equilibria the target is 0.
//
// Contacts of a step may not settle: in corners, points alternate between two triangles. A step is
// taken if after 12 updates no gap is more than 0.01 of an edge off its target; the largest such
// gap of a run is reported. If after 30 updates one is larger, half of dt follows.
//
// - Within a solve, vertices, weights and normals stay. Gaps are linear and only pressures change,
//   so nothing chatters.
// - The equations are solved again also where the point of a contact has moved by 1e-4 of an edge,
//   or where a contact with a force has ended. Forces thus act where the surfaces touch.
// - A multiplier continues with the same vertex or edge, where the normal turned by less than 18
//   degrees. A vertex that slides on to the next face keeps its force.
// - A contact with a force stays until its point has moved by 0.01 of an edge along the surface,
//   also beside those found since. In corners of stairs and over nodes of the other side, faces
//   are equally near, and rounding decides which is found. With friction, lips did not settle.
// - What touches without a force has the tangent, too, in equilibria: else a body that lies on a
//   floor would be free to move. In a step inertia holds the body. With the tangent of a force
//   that is not there, Newton's method gained 1e-4 per iteration on a floor, and 1 % between lips.
//   So that tangent fades by 10 per iteration, and ends where lips move away.
// - The tangent contains the curvature of round obstacles (curvature.hpp): p / R is as large as the
//   stiffness of a soft body on a sphere. Without it, 20 % were gained per iteration.
// - Contacts are links between coarse nodes of pieces (solvers/links.hpp). With each side as if
//   the other one did not move, there were 1.7 times as many linear iterations, in 2.5 times the
//   time.
// - Free pieces get no regularisation: a stiffness from nowhere would give a wrong answer
//   silently. If there is no equilibrium, the message names the motions that constraints leave.
// - A step is refused in which a point passes a triangle, or one convex edge another, and then has
// no
//   contact with it (swept_crossing.hpp): contact is found up to 0.3 of an edge deep. Load steps or
//   half of dt follow.
//
// Friction refers to the sliding since the start of the step. The tangent of sliding friction is
// not symmetric; that part is left to GMRES. There is no energy then that a line search could
// decrease: where Newton's method fails, it tries once more with the bounds of friction of the
// last update, which has one. The updates converge to the same law. It is not the first attempt: a
// body that only friction holds would have no first equilibrium. Nested iteration is not used,
// as points of coarse levels do not touch. Newmark's method is refused. With the mean of the forces
// at both ends of a step, a block dropped by half an element had three times the energy of its fall
// after 0.5 s.
//
// Measured with `static` unless said otherwise:
//   lips, plane / stairs, through the block or ending inside    0.9999 of the pressure uncut
//   the same, sheared without friction                          0.6 % of the force uncut
//   two blocks pressed by 2 %, finer above or below             uniform to 4e-4 of the way
//   block on a block on a slope, implicit-euler, 0.98 / 1.02    holds to 1e-10 m/s / slides at
//     of atan(0.3)                                                1.03 of a rigid block's speed
//   lips pressed by 2 % and sheared, 8,000 elements             1.5 s, 35 Newton iterations of 8
//     uncut                                                       0.12 s, 5 of 2

namespace suture {

/// The part of a vector along the surface of a normal.
inline Vec3 along_surface(const Vec3& a, const Vec3& normal) {
  return minus(a, scaled(dot(a, normal), normal));
}

/// Contact as forces with a tangent, for equations that are solved by Newton's method: implicit
/// steps and equilibria. By an augmented Lagrangian (Simo and Laursen, Comput. Struct. 42 (1992)
/// 97) at each vertex of an obstacle and each contact of PieceContact or PointPairs, with the gap g
/// and the sliding s since the start of the step, whose multipliers l and t converge to the forces:
///   p = max(0, l - k g),   q = t - k s,   |q| <= mu p,   f = p n + q
/// When the equations are solved, update() sets l = p and t = q, and they are solved again, until
/// gaps and sliding where it holds are below `tolerance` of an edge, and in equilibria gaps below
/// 1e-3 of the deformation. So the stiffness k, a multiple of a bound on that of the body there and
/// of mass / dt^2, affects the cost but not the result.
///
/// Contacts between pieces are found before the equations are solved and again in update(); in
/// between, their vertices, weights and normals do not change, so that Newton's method has a fixed
/// set of linear gaps.
class MultiplierForces final : public ContactTerm,
                               public CellTangentTerm,
                               public ConstraintTerm,
                               public NonsmoothTerm {
 public:
  /// The tolerance of gaps, in typical edges.
  static constexpr double tolerance = 1e-4;

  /// `is_static`: nothing has a velocity.
  MultiplierForces(Contact& contact, Attributes& attributes, BoundedTerm& models, bool is_static);

  void add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) override;
  bool is_conservative(double time) override;
  void add_tangent(const double* d, double dx, double dv, const TangentTime& at,
                   double* out) override;
  void add_skew_tangent(const double* d, double dx, const TangentTime& at, double* out) override;
  bool add_tangent_in_single(const float* d, double dx, double dv, const TangentTime& at,
                             float* out) override;
  void for_each_tangent(double dx, double dv, const TangentTime& at,
                        const VisitTangents& visit) override;
  /// Without that of friction.
  double work() const override { return work_ - contact_.friction_work(); }
  void forget_last() override;
  void restart() override;

  void begin_step(double time) override;
  void reject_step() override;
  void begin_iteration(unsigned number, double time) override;
  bool simplify() override;
  std::optional<Alternation> alternation() const override {
    return regimes_.alternation(contact_.obstacles());
  }
  std::string note() const override;
  bool update(double time) override;
  /// False with friction, and between pieces: the faces that touch turn with the body.
  bool hold(double time) override;
  void add_gap_tangent(const double* d, double time, double* out) override;
  void accept() override;
  void follow(const CellComplex& complex, const TopologyChange& change) override;
  void state(Archive& archive) override;

 private:
  struct Multiplier {
    double pressure = 0;  ///< N
    Vec3 friction{};      ///< N
  };
  using OfObstacles = std::vector<std::vector<Multiplier>>;  ///< by obstacle and ContactPoint
  /// A contact of PieceContact or of PointPairs.
  struct Pair : Multiplier {
    std::array<Index, 5> key{};  ///< the vertices of the former, the point of the latter
    std::vector<Index> vertices{};
    std::vector<double> weights{};
    Vec3 normal{};
    double stiffness = 0;   ///< of the body, N/m
    double mass = 0;        ///< that an impulse along the normal moves, kg
    double first_gap = -1;  ///< at the start of the step, if it touches then, m
    Vec3 beside{};          ///< of the point along the surface where it was found, m
    double start_gap = 0;   ///< along the normal, at the start of the step, m
    double recovery = 0;    ///< the length of which a depth comes back by a part in a step, m
  };
  using Pairs = std::vector<Pair>;
  /// A point of the body, the sum of vertices with weights, that something pushes: a point in an
  /// obstacle, or a vertex or edge less the point of another piece that it touches.
  struct Push {
    Multiplier* last;
    std::size_t obstacle;  ///< Contact::between_pieces: none
    std::span<const Index> vertices;
    std::span<const double> weights;
    Vec3 normal;
    double stiffness, gap, target, pressure;  ///< N/m, m, m, N
    Index point = none;                       ///< of the body, that an obstacle pushes
    double coefficient = 0;                   ///< of friction
    Vec3 sliding{}, friction{};               ///< m, N
    double pressing = 1;                      ///< -p' / k: 0 where it has let go
    double holding = 1;                       ///< q / its free value: 1 where friction holds
    Vec3 direction{};                         ///< of friction that slides
    Curvature curvature{};                    ///< of the obstacle

    /// Rows have `width` numbers.
    template <class Number>
    Vec3 sum(const Number* rows, std::size_t width) const;
    template <class Number>
    void add(const Vec3& force, Number* rows, std::size_t width) const;
    /// The change of the force for a motion d of the point.
    Vec3 tangent(const Vec3& d) const;
    Vec3 skew_tangent(const Vec3& d) const;
  };
  std::vector<Contact::Force> forces_at(double time) override;
  /// In multiples of the bounds on that of the body and of mass / dt^2.
  double stiffening() const;
  double target(double gap, double start_gap, double stiffness, double mass, double recovery,
                double time) const;
  double stiffness_per_mass(double time) const;
  template <class Visit>
  void for_each_push(double time, Visit visit);
  bool is_listed(double time) const;
  void list_pushes(double time);
  void list_pushes_of_obstacles(double time);
  void add_friction(Push& push, double coefficient, const Vec3& way) const;
  bool has_force(Push& push) const;
  void resize();
  Pair pair_of(const std::array<Index, 5>& key, const ContactPoint& offset, const Vec3& normal,
               double mass, double recovery) const;
  static void state_of(Archive& archive, Pairs& pairs);
  void improve(double time);
  Pairs find_pairs(double time);
  Vec3 offset_of(const Pair& pair) const;
  double start_gap_of(const Pair& pair) const;
  double target_of(const Pair& pair, double time) const;
  /// By how much contacts have changed, m.
  struct Change {
    double depth = 0;  ///< of what is found, below its target
    double other = 0;  ///< the way of the points where they act, and what ended forces pushed in
  };
  Change take_over(Pairs found, double time);
  void return_to_accepted();  ///< multipliers
  void note_places();
  bool has_pair(Index point, const Vec3& normal) const;
  bool has_pair_of_edges(const std::array<Index, 2>& first,
                         const std::array<Index, 2>& second) const;
  void refuse_crossings(double time);
  double deformation() const;
  [[noreturn]] void refuse_gap(double off, double time) const;
  void book_work(const std::vector<double>& forces, double dt);
  double heat(double time);

  bool is_static_;
  OfObstacles of_obstacles_, accepted_of_obstacles_;
  Pairs pairs_, accepted_pairs_;
  std::vector<double> found_at_;  ///< Contact::places_now() where the pairs were found
  std::vector<double> start_;     ///< positions at the start of the step, rows of 4
  double start_time_ = 0;
  /// The same of the step before, while a step is tried.
  std::optional<std::pair<std::vector<double>, double>> last_start_;
  double support_ = 1;  ///< of its stiffness, what touches without a force has
  bool bounds_stay_ = false, accepted_bounds_stay_ = false;  ///< of friction, while solving
  ContactRegimes regimes_;
  double work_ = 0;
  bool has_step_ = false;  ///< whose friction is not booked yet
  // All pushes, where they were looked for last:
  std::vector<Push> listed_;
  std::vector<double> listed_at_;  ///< positions, rows of 4
  double listed_time_ = 0;
  bool is_listed_ = false;  ///< and nothing else has changed
  unsigned updates_ = 0;    ///< since the step began
  // Of steps that were taken with a gap above the tolerance:
  double gap_left_ = 0;          ///< in the step in progress, m; 0: it settled
  double largest_gap_left_ = 0;  ///< m
  std::uint64_t inexact_steps_ = 0, accepted_steps_ = 0;
  // At the end of the last step, for its work: rows of 4; empty: no step yet.
  std::vector<double> last_force_, last_position_, last_velocity_;
};

template <class Number>
Vec3 MultiplierForces::Push::sum(const Number* rows, std::size_t width) const {
  Vec3 total{};
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      total[c] += weights[i] * double{rows[width * vertices[i] + c]};
  return total;
}

template <class Number>
void MultiplierForces::Push::add(const Vec3& force, Number* rows, std::size_t width) const {
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      rows[width * vertices[i] + c] += static_cast<Number>(weights[i] * force[c]);
}

/// visit(push) for everything that is pushed, and between equilibria for what touches without a
/// force: its tangent holds a body that lies there. Newton's method is slow with the tangent of a
/// force that is not there, so that it fades with the iterations; and between pieces it ends where
/// they move away, as lips often touch without a force.
template <class Visit>
void MultiplierForces::for_each_push(double time, Visit visit) {
  if (!is_listed(time)) list_pushes(time);
  for (const Push& push : listed_) visit(push);
}

}  // namespace suture
