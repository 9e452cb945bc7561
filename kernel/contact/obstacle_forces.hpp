// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/contact/contact_term.hpp"

namespace suture {

/// Contact with obstacles as forces with a tangent, for equations that are solved by Newton's
/// method: implicit steps and equilibria. By an augmented Lagrangian (Simo and Laursen, Comput.
/// Struct. 42 (1992) 97) at each vertex, with the gap g and the sliding s since the start of the
/// step, whose multipliers l and t converge to the forces:
///   p = max(0, l - k g),   q = t - k s,   |q| <= mu p,   f = p n + q
/// When the equations are solved, update() sets l = p and t = q, and they are solved again, until
/// gaps and sliding where it holds are below `tolerance` of an edge. So the stiffness k, a multiple
/// of a bound on that of the body at the vertex, affects the cost but not the result.
class ObstacleForces final : public ContactTerm {
 public:
  /// Of gaps, in typical edges.
  static constexpr double tolerance = 1e-4;

  /// `is_static`: nothing has a velocity.
  ObstacleForces(Contact& contact, Attributes& attributes, ForceTerm& models, bool is_static);

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
    double normal = 0;  ///< N
    Vec3 tangential{};  ///< N
  };
  /// A vertex that an obstacle pushes.
  struct Push {
    std::size_t obstacle;
    Index vertex;
    Vec3 normal;
    double gap, pressure;    ///< m, N
    Vec3 sliding, friction;  ///< m, N
    double holding;          ///< q / its free value: 1 where friction holds
    Vec3 direction;          ///< of friction that slides
  };
  std::vector<Contact::Force> forces_at(double time) override;
  template <class Visit>
  void for_each_push(double time, Visit visit);
  Push push_of(const PlacedObstacle& placed, std::size_t obstacle, Index vertex,
               const Nearest& nearest, double pressure) const;
  Vec3 apply(const Push& push, const Vec3& d) const;
  Vec3 apply_skew(const Push& push, const Vec3& d) const;
  Multiplier& multiplier(std::size_t obstacle, Index vertex);
  void resize();
  void book(const std::vector<double>& forces, double dt);
  double heat(double time);

  bool is_static_;
  std::vector<std::vector<Multiplier>> multipliers_, accepted_;  ///< by obstacle and vertex
  std::vector<double> start_;  ///< positions at the start of the step, rows of 4
  double start_time_ = 0;
  double work_ = 0;
  bool has_step_ = false;  ///< whose friction is not booked yet
  // At the end of the last step, for its work: rows of 4; empty: no step yet.
  std::vector<double> last_force_, last_position_, last_velocity_;
};

}  // namespace suture
