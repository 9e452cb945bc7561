// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/contact/contact_term.hpp"

namespace suture {

/// Contact as forces with a tangent, for equations that are solved by Newton's method: implicit
/// steps and equilibria. By an augmented Lagrangian (Simo and Laursen, Comput. Struct. 42 (1992)
/// 97) at each vertex of an obstacle and each contact of PieceContact, with the gap g and the
/// sliding s since the start of the step, whose multipliers l and t converge to the forces:
///   p = max(0, l - k g),   q = t - k s,   |q| <= mu p,   f = p n + q
/// When the equations are solved, update() sets l = p and t = q, and they are solved again, until
/// gaps and sliding where it holds are below `tolerance` of an edge. So the stiffness k, a multiple
/// of a bound on that of the body there and of mass / dt^2, affects the cost but not the result.
///
/// Contacts between pieces are found before the equations are solved and again in update(); in
/// between, their vertices, weights and normals do not change, so that Newton's method has a fixed
/// set of linear gaps.
class MultiplierForces final : public ContactTerm {
 public:
  /// Of gaps, in typical edges.
  static constexpr double tolerance = 1e-4;

  /// `is_static`: nothing has a velocity.
  MultiplierForces(Contact& contact, Attributes& attributes, ForceTerm& models, bool is_static);

  void add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) override;
  bool is_constraint() const override { return true; }
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
  bool update(double time) override;
  void accept() override;
  void follow(const CellComplex& complex, const TopologyChange& change) override;
  void state(Archive& archive) override;

 private:
  struct Multiplier {
    double pressure = 0;  ///< N
    Vec3 friction{};      ///< N
  };
  using OfObstacles = std::vector<std::vector<Multiplier>>;  ///< by obstacle and vertex
  /// A contact of PieceContact.
  struct Pair : Multiplier {
    std::array<Index, 5> vertices{};
    std::array<double, 5> weights{};
    Vec3 normal{};
    double stiffness = 0;   ///< of the body, N/m
    double mass = 0;        ///< that an impulse along the normal moves, kg
    double first_gap = -1;  ///< at the start of the step, if it touches then, m
    Vec3 beside{};          ///< of the point along the surface where it was found, m
  };
  using Pairs = std::vector<Pair>;
  /// A point of the body, the sum of vertices with weights, that something pushes: a vertex in an
  /// obstacle, or a vertex or edge less the point of another piece that it touches.
  struct Push {
    Multiplier* last;
    std::size_t obstacle;  ///< Contact::between_pieces: none
    std::span<const Index> vertices;
    std::span<const double> weights;
    Vec3 normal;
    double stiffness, gap, pressure;  ///< N/m, m, N
    double coefficient = 0;           ///< of friction
    Vec3 sliding{}, friction{};       ///< m, N
    double holding = 1;               ///< q / its free value: 1 where friction holds
    Vec3 direction{};                 ///< of friction that slides

    /// Rows have `width` numbers.
    template <class Number>
    Vec3 sum(const Number* rows, std::size_t width) const;
    template <class Number>
    void add(const Vec3& force, Number* rows, std::size_t width) const;
    /// Of the force for a motion d of the point.
    Vec3 tangent(const Vec3& d) const;
    Vec3 skew_tangent(const Vec3& d) const;
  };
  std::vector<Contact::Force> forces_at(double time) override;
  double stiffness_per_mass(double time) const;
  template <class Visit>
  void for_each_push(double time, Visit visit);
  template <class Visit>
  void for_each_push_of_obstacles(double time, Visit visit);
  void add_friction(Push& push, double coefficient, const Vec3& way) const;
  void resize();
  double stiffness_of(const std::array<Index, 5>& vertices,
                      const std::array<double, 5>& weights) const;
  void improve(double time);
  Pairs find_pairs(double time);
  Vec3 offset_of(const Pair& pair) const;
  double take_over(Pairs found);
  void refuse_long_ways(double time) const;
  void book_work(const std::vector<double>& forces, double dt);
  double heat(double time);

  bool is_static_;
  OfObstacles of_obstacles_, accepted_of_obstacles_;
  Pairs pairs_, accepted_pairs_;
  std::vector<double> found_at_;  ///< positions where the pairs were found, rows of 4
  std::vector<double> start_;     ///< positions at the start of the step, rows of 4
  double start_time_ = 0;
  double work_ = 0;
  bool has_step_ = false;  ///< whose friction is not booked yet
  // At the end of the last step, for its work: rows of 4; empty: no step yet.
  std::vector<double> last_force_, last_position_, last_velocity_;
};

}  // namespace suture
