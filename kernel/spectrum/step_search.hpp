// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <random>
#include <vector>

#include "kernel/base/zeroed_vector.hpp"
#include "kernel/dynamics/body.hpp"
#include "kernel/forces/body_share.hpp"

namespace suture {

/// Finds the largest stable step of a body from the tangent of its forces, K = -df/dx and C =
/// -df/dv: the limit of stable_step.hpp for the whole system instead of the worst vertex. It is the
/// step at which the largest eigenvalue of
///   M^-1/2 (dt^2/4 K + dt/2 C) M^-1/2
/// on the free components is 1; without C it is 2 / omega_max.
///
/// The eigenvector is found by locally optimal descent: Rayleigh-Ritz on the current vector, its
/// residual and the last direction (Knyazev, SIAM J. Sci. Comput. 23 (2001) 517). It is kept, so
/// that the next search starts where the last one ended. Vertices that an operation changed may
/// carry a new mode: the next search also starts with random numbers there. Every 16th search
/// starts from a random vector, so as not to overlook a mode that grew in the meantime.
///
/// A search can be spread over the steps of a run: begin(), then advance() after each step until it
/// returns true. The body may move and be cut in between: the vectors follow, and images that are a
/// little old only make the next direction a little worse. The result belongs to the state of the
/// last call but one, as the Rayleigh quotient and the residual that decide are computed there.
///
/// Several processes each compute rows of their own vertices, unless a term besides the models is
/// stiff.
///
/// Memory while it runs: 116 B per vertex that this process computes; between searches 12 B.
class StepSearch {
 public:
  explicit StepSearch(Body& body) : body_(body) {}

  /// The step, s; infinite without forces. At most 1.5 % too short; from a random start, more than
  /// 1.5 % too long in one case in 10,000. Costs 5 (repeated), at least 9 (after an operation) or
  /// 50 (from random) directional derivatives, each about three evaluations of the forces. Needs
  /// body.models().has_tangent().
  double largest(double time);

  /// Begins a search that advance() continues, in place of one that is under way.
  void begin();
  /// One directional derivative in the present state, or three with damping at the end. True once
  /// result() is that of this search.
  bool advance(double time);
  double result() const { return result_; }  ///< of the last search, s

  /// Call before an operation: all processes get all rows.
  void complete();
  /// Follows a change of the cells: new vertices start with the motion of those that they separated
  /// from. O(change).
  void follow(const TopologyChange& change);
  /// The next search starts from a random vector, so that no mode is overlooked.
  void forget() { mode_.v.clear(); }
  void state(Archive& archive);

 private:
  using Vector = ZeroedVector<float>;  // 3 per vertex; seven digits for three
  struct Direction {
    Vector v, image;  // under the operator
    void follow(const Split& split);
  };
  struct Factors {
    const Vector &one, &other;
  };
  struct Eigenvalue {
    double value, upper;  ///< Rayleigh quotient, and the quotient plus its residual
  };
  /// What the eigenvalue under way is for. With damping, a search from random begins with the mode
  /// of K, then takes C into account, and then starts from random once more.
  enum class Stage { begun, undamped, approach, damped };

  void start();
  bool may_divide() const;
  void take_share();
  void set_scales();
  bool is_free() const;
  template <class Visit>
  void for_each_number(Visit visit) const;
  void combine(double s, Vector& a, double t, const Vector& b) const;
  void scale(Direction& direction, double s) const;
  void add(Direction& direction, double t, const Direction& other) const;
  std::vector<double> inner_products(std::span<const Factors> factors);
  double inner_product(const Vector& a, const Vector& b);
  double length(const Vector& a);
  void start_at_random();
  void start_at_last();
  float random_number();
  bool iterate();
  bool take_eigenvalue();
  bool finish(double dt);
  void begin_eigenvalue(double stiffness, double damping, int least);
  void begin_damped(double dt, int least);
  void apply(const Vector& x, double stiffness, double damping, Vector& image);
  void add_other_terms(double stiffness, double damping, Vector& image);
  void find_residual();
  bool is_good_enough() const;
  void step_to_best();
  double quotient(double stiffness, double damping);

  Body& body_;
  std::vector<loops::Rows> ranges_;  // of vertices: those of this process, or all
  bool is_divided_ = false;          // among processes
  bool has_all_rows_ = true;         // of the vectors that are kept
  double time_ = 0;
  unsigned searches_ = 0;
  double result_ = 0;
  std::mt19937 random_;         // the same numbers on every machine
  Direction mode_;              // in coordinates sqrt(m) x; its image only while a search runs
  std::vector<Index> changed_;  // vertices changed since the last search; may contain duplicates
  // The search under way:
  Stage stage_ = Stage::begun;
  double stiffness_ = 0, damping_ = 0;  // of the operator
  int least_ = 0;                       // iterations, of the eigenvalue under way
  int least_of_search_ = 0;             // of the one that counts
  int iteration_ = 0, round_ = 0;
  double dt_ = 0;                    // found so far, s
  int image_age_ = 0;                // calls of advance() since mode_.image was computed
  Direction residual_, difference_;  // the second one of the last two modes
  Eigenvalue found_{};
  Vector scale_;                           // 1/sqrt(m), 0 where fixed
  Vector rows_, image_rows_;               // a direction and its image, 4 per vertex
  std::vector<double> direction_, image_;  // for terms other than the models
};

}  // namespace suture
