// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/fields/value_path.hpp"
#include "kernel/forces/dead_loads.hpp"
#include "kernel/forces/force_loop.hpp"
#include "kernel/solvers/conjugate_gradients.hpp"

namespace suture {

/// What became of a field since the start: content = that at the start + inflow + produced +
/// changed, but for rounding. In the unit of the capacity times that of the field (J/K . K = J).
struct FieldBalance {
  double content = 0;   ///< sum C u
  double inflow = 0;    ///< by fluxes, and through vertices whose value is prescribed
  double produced = 0;  ///< by models; 0 for conduction
  double changed = 0;   ///< by operations, and between equilibria
  /// If rates are derivatives of an energy, J: that of field and deformation, and what the field
  /// has lost of it on its way.
  double energy = 0, dissipated = 0;
};

/// The equation of one field, by vertices:
///   C du/dt = r(u) + q      r: rates of the models, q: fluxes
/// with the values of some vertices prescribed. It has its own steps between those of the motion,
/// at the positions that the motion has reached. The same bits for any number of threads. Vertices
/// without a capacity and a rate keep their value.
class FieldEquation {
 public:
  /// `threads`: as for ForceLoop.
  FieldEquation(Attributes& attributes, const CellComplex& complex, const VertexField& field,
                unsigned threads);

  const VertexField& field() const { return field_; }
  ForceLoop& rates() { return rates_; }
  const ForceLoop& rates() const { return rates_; }

  // ---- conditions ----

  /// Sets values at the start.
  void set(std::span<const Index> vertices, double value);
  /// From now on, the values of these vertices follow a path. Where two paths differ at a vertex,
  /// that vertex is returned, and nothing has changed; otherwise `none`.
  Index prescribe(std::span<const Index> vertices, const ValuePath& path);
  /// Flows into faces, per rest area: the first component of a traction.
  DeadLoads& fluxes() { return fluxes_; }
  bool is_prescribed(Index vertex) const { return paths_of_[vertex] != 0; }

  // ---- steps ----

  enum class Steps { explicit_, implicit, steady };
  /// Starts at `time`. Throws InputError if these steps need what models do not give: a capacity
  /// where a vertex takes part, or rates that depend on the present alone.
  void start(double time, Steps steps);
  /// A step from `time` on, in steps of forward Euler that are short enough to be stable. Throws
  /// NumericalError if a value is not finite, and the errors of models.
  void advance_explicitly(double time, double dt);
  /// The step of backward Euler from the state of keep() that ends at `end`; again, if the motion
  /// has changed. Throws NumericalError if its equations are not solved.
  void advance_implicitly(double end, double dt) { solve(end, 1 / dt); }
  /// The steady state at `time`. Throws as that.
  void settle(double time) { solve(time, 0); }
  /// The largest change in the last of these calls, as a part of the largest value.
  double relative_change() const;
  bool feels_motion() const { return rates_.reads_motion(); }
  /// The longest stable step, s: 1 / lambda, lambda a bound on the eigenvalues of -C^-1 dr/du.
  double stable_step(double time);

  /// The models have other parameters.
  void forget_models() { stable_ = 0; }

  FieldBalance balance(double time);
  /// Whether models say the energy of which its rates are derivatives.
  bool has_energy() const { return rates_.has(ForceLoop::Part::with_energy); }
  /// When the last path or ramp ends, s.
  double last_change() const;
  /// "temperature: content 12 J; since the start, 3 J came in, ...", at `time`.
  std::string balance_text(double time);
  /// The unit of its content: "J".
  std::string unit_of_content() const;

  // ---- operations and states ----

  void before_operation() { content_ = sum_content(); }
  void follow(const CellComplex& complex, const TopologyChange& change);
  /// The state before a step, from which implicit steps start and to which restore() returns.
  void keep();
  void restore();
  void state(Archive& archive);

 private:
  struct Held {
    Index vertex;
    std::uint32_t path;
  };
  void find_held();
  double prescribed(const Held& held, double time) const { return paths_[held.path].value(time); }
  void evaluate(double time);
  void explicit_step(double time, double dt);
  void require_capacities(Steps steps) const;
  void require_finite() const;
  double sum_content() const;
  double capacity(Index v) const { return field_.capacity ? field_.capacity->rows()[v] : 0; }
  double relaxation(Index v) const { return field_.relaxation ? field_.relaxation->rows()[v] : 0; }
  // As evaluated:
  double rate(Index v) const { return rate_rows_[std::size_t{v} * 4]; }
  double flux(Index v) const { return has_fluxes_ ? flux_rows_[std::size_t{v} * 4] : 0; }
  // Newton's method (field_newton.cpp)
  void solve(double time, double per_dt);
  void find_diagonal(double time, double per_dt);
  double find_residual(double time, double per_dt);
  bool solve_linear(double time, double per_dt);
  void apply(const double* d, double* out, double time, double per_dt);
  double taken_up(Index v, double per_dt) const;
  double rounding(double per_dt) const;
  void book(double per_dt);

  Attributes& attributes_;
  const VertexField& field_;
  ForceLoop rates_;
  DeadLoads fluxes_;
  std::vector<ValuePath> paths_;
  std::vector<std::uint32_t> paths_of_;          ///< by vertex: 1 + the number of its path; 0: none
  std::vector<Held> held_;                       ///< the same, ascending
  AlignedVector<double> rate_rows_, flux_rows_;  ///< of 4 per vertex, the first counts
  bool has_fluxes_ = false;
  FieldBalance balance_;  ///< without the content
  double start_ = 0;      ///< the content then
  double content_ = 0;    ///< before an operation
  double stable_ = 0;     ///< s; 0: to be found
  std::uint64_t steps_since_ = 0;
  // Newton's method works with these, by vertex:
  std::vector<double> before_, diagonal_, sums_, residual_, change_, direction_, product_;
  std::vector<char> is_free_;
  ConjugateGradients solver_;
  std::vector<double> kept_;  ///< values at the start of the step
  FieldBalance kept_balance_;
};

}  // namespace suture
