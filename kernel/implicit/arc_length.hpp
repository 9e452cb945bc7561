// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kernel/implicit/load_path.hpp"

// Through a limit point
// =====================
//
//   s |      limit point         Load steps follow s and end at the limit point. ArcLength follows
//     |       .-o-.              the distance along the path, so that s may fall and rise again.
//     |     o      `o      o
//     |    /          `-o-'
//     |   o
//     +----------------------> displacement
//
// The predictor is the secant through the last two equilibria, which needs no solve. The rank-one
// term k n n^T costs an iteration or two, and leaves the solution of the bordered system as it is.

namespace suture {

/// Follows a LoadPath through limit points, where the part s of the change that the body can carry
/// has a maximum or a minimum (snap-through), by pseudo-arc-length continuation (Riks, Int. J.
/// Solids Struct. 15 (1979) 529). From two equilibria with the distance n, |n| = 1 over the free
/// components, the next one is sought at a distance l:
///   r(x, s) = 0,   n . (x - x_last) = l
/// Newton's method for x and s solves, with A = -dr/dx and g = dr/ds,
///   A d = r + g ds,   n . d = 0
/// A is singular at a limit point and indefinite beyond. A + k n n^T is positive definite there, if
/// k is large enough and the equilibrium would be stable with n . x held; as n . d = 0, the same
/// solution follows from
///   (A + k n n^T) a = r,   (A + k n n^T) b = g,   ds = -n . a / n . b,   d = a + ds b
/// by conjugate gradients with the usual preconditioners.
class ArcLength {
 public:
  explicit ArcLength(LoadPath& path);

  /// Moves the vertices to the first equilibrium on the path with the equations of the end of the
  /// step. Throws NumericalError if the path does not lead there, with its limit points; positions
  /// are those of the last equilibrium then. Passes on StepRejected. Two linear solves and two
  /// evaluations of the forces per iteration.
  void solve(const StepEquations& equations);

 private:
  void follow(const StepEquations& end, double start);
  struct Segment {
    double length = 0;  ///< |x - x_last|, m
    double rate = 0;    ///< ds / length, 1/m
  };
  void begin(const std::vector<double>& rate);
  bool advance();
  unsigned correct(double& part);
  std::vector<double> way();
  void append(double part);
  std::optional<double> find_limit(const Segment& next);
  void note(double limit, bool is_largest);
  void shorten(double step);
  bool arrive(double length);
  [[noreturn]] void refuse(const std::string& how) const;
  void report(unsigned iterations) const;

  static constexpr double small_difference = 1e-6;  ///< of s, for g = dr/ds

  double* position();
  void move(const std::vector<double>& direction, double length);
  std::vector<double> residual_at(double part);
  std::vector<double> rate_at(double part, const std::vector<double>& residual,
                              double difference = small_difference);
  void set_matrix(double part);
  std::vector<double> solve_linear(std::span<const double> right);

  LoadPath& path_;
  TangentMatrix matrix_;
  PreconditionerChoice choice_;
  ConjugateGradients linear_;
  double part_ = 0;                   ///< s of the last equilibrium
  std::vector<double> direction_;     ///< n, 3 numbers per vertex, of the last segment of the path
  Segment segment_;                   ///< the same
  double step_ = 0, least_step_ = 0;  ///< l, m
  double stiffness_ = 0, largest_stiffness_ = 0;  ///< k, N/m
  std::string limits_;                            ///< ", 77 %, 31 %": s of the limit points
};

}  // namespace suture
