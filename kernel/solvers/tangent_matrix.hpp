// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/base/parallel.hpp"
#include "kernel/forces/term_capabilities.hpp"

namespace suture {

/// Loads at a time, with a factor.
struct LoadTime {
  double time, factor;
};

/// The matrix of a Newton step on the free components of a body, matrix-free:
///   A = mass M + K + velocity C,   K = -df/dx,   C = -df/dv   of all terms at (x, v, time)
/// without what TangentTerm::add_skew_tangent() adds, which only apply_whole() includes. Symmetric
/// if all terms are conservative. The loads, which are all terms but the first, can be a sum of
/// those at several times.
/// Static equilibrium: mass = velocity = 0. Implicit Euler: mass = 1/dt^2, velocity = 1/dt.
///
/// Vectors have 3 numbers per vertex. Components that are constrained, and those of removed
/// vertices, are 0 in every vector and in every product.
class TangentMatrix {
 public:
  TangentMatrix(Attributes& attributes, const std::vector<std::unique_ptr<ForceTerm>>& terms,
                const Workers& workers);

  /// The matrix at the current state from now on. Call again after cells or constraints changed.
  /// O(vertices). `loads`: none stands for those at the same time.
  void set(const TangentTime& at, double mass = 0, double velocity = 0,
           std::span<const LoadTime> loads = {});

  /// The same for unknowns other than positions: which components are free, and the diagonal of the
  /// mass term by vertex; empty: there is none.
  void set(const TangentTime& at, double velocity, std::vector<std::uint8_t> free,
           std::vector<double> masses);

  /// Components that are held besides those that are constrained, from the next set() on.
  void support(std::vector<std::size_t> components) { supports_ = std::move(components); }

  /// Adds stiffness n n^T to the matrix in double precision, until the next set(). A direction of
  /// no size adds nothing.
  void stiffen(std::span<const double> direction, double stiffness);

  std::size_t size() const { return free_.size(); }
  /// The threads that share its loops, and those of the solvers.
  const Workers* workers() const { return &workers_; }
  /// Whether each component is free.
  const std::vector<std::uint8_t>& free() const { return free_; }
  /// y = A x. About three evaluations of the forces. Throws the errors of terms.
  void apply(const double* x, double* y) const;
  /// The same with all parts of tangents, or their transpose (set_transposed()).
  void apply_whole(const double* x, double* y) const;
  /// Whether apply_whole() is A^T x, for terms that have a transpose (TangentTerm).
  void set_transposed(bool is_transposed) { skew_ = is_transposed ? -1 : 1; }
  /// The same as apply() in single precision, in rows of 4 numbers, the fourth 0, 16-byte aligned;
  /// terms without such a tangent are computed in double.
  void apply(const float* x, float* y) const;
  bool has_mass() const { return !masses_.empty(); }
  /// The diagonal of the mass term at a vertex, N/m.
  double mass_at(Index vertex) const { return masses_.empty() ? 0 : masses_[vertex]; }
  /// Visits the matrices of all cells, K + velocity C, with the opposite sign: see
  /// CellTangentTerm::for_each_tangent. The mass term is not included.
  void for_each_cell(const CellTangentTerm::VisitTangents& visit) const;
  void for_each_cell(TangentPieces& pieces) const;
  /// The same for a selection: see CellTangentTerm::for_some_tangents.
  void for_some_cells(const CellTangentTerm::SelectCell& select,
                      const CellTangentTerm::VisitTangents& visit) const;
  /// Sets the components of a vector that are not free to 0.
  void restrict(std::span<double> x) const;

 private:
  void add_in_double(TangentTerm& term, double factor, const TangentTime& at, const float* x,
                     float* y) const;
  template <class Capability, class Visit>
  void for_each_term(Visit visit) const;
  template <class Real>
  void multiply_by_mass(const Real* x, Real* y) const;

  Attributes& attributes_;
  const std::vector<std::unique_ptr<ForceTerm>>& terms_;
  const Workers& workers_;
  std::vector<std::uint8_t> free_;
  std::vector<Index> held_;     ///< the components that are not free
  std::vector<double> masses_;  ///< the diagonal of the mass term; empty if there is none
  TangentTime at_ = 0;
  std::vector<std::size_t> supports_;  ///< components that are held, too
  double velocity_ = 0;
  double skew_ = 1;  ///< what the parts that are not symmetric count
  std::vector<LoadTime> loads_;
  std::span<const double> direction_;  ///< n of stiffen()
  double stiffness_ = 0;
};

}  // namespace suture
