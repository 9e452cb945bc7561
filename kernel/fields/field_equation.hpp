// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/fields/exchange.hpp"
#include "kernel/fields/value_path.hpp"
#include "kernel/forces/dead_loads.hpp"
#include "kernel/forces/force_loop.hpp"
#include "kernel/solvers/conjugate_gradients.hpp"

namespace suture {

/// What became of a component of a field since the start: content = that at the start + inflow +
/// produced + changed, but for rounding. In the unit of the capacity times that of the field (J/K .
/// K = J).
struct FieldBalance {
  double content = 0;   ///< sum C u
  double inflow = 0;    ///< by fluxes, and through vertices whose value is prescribed
  double produced = 0;  ///< by models; 0 for conduction
  double changed = 0;   ///< by operations, and between equilibria
};

/// The energy of a field and of the deformation, where models say it, J.
struct FieldEnergy {
  double stored = 0;
  double dissipated = 0;  ///< since the start
  double supplied = 0;    ///< since the start, by what flowed in; 0 unless has_dissipation()
};

/// The equation of one field, by vertices and components:
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
  std::size_t components() const { return components_; }
  ForceLoop& rates() { return rates_; }
  const ForceLoop& rates() const { return rates_; }

  // ---- conditions ----

  /// Sets values of a component at the start.
  void set(std::span<const Index> vertices, double value, std::size_t component = 0);
  /// From now on, the values of these vertices follow a path. Where two paths differ at a vertex,
  /// that vertex is returned, and nothing has changed; otherwise `none`.
  Index prescribe(std::span<const Index> vertices, const ValuePath& path,
                  std::size_t component = 0);
  /// Flows into faces, per rest area: as the components of a traction.
  DeadLoads& fluxes() { return fluxes_; }
  /// Coefficients of films on faces, by which a flux falls with the value.
  DeadLoads& film_coefficients() { return exchange_.coefficients(); }

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
  /// Iterations of conjugate gradients in the steps that were made, and how many of them used the
  /// multigrid.
  struct Iterations {
    std::uint64_t all = 0, with_multigrid = 0;
  };
  const Iterations& iterations() const { return iterations_; }

  /// The models have other parameters.
  void forget_models() { stable_ = 0; }

  FieldBalance balance(std::size_t component = 0) const;
  /// Whether models say the energy of field and deformation.
  bool has_energy() const { return rates_.has(ForceLoop::Part::with_energy); }
  /// Whether rates are no derivatives of it, and models say what they dissipate.
  bool has_dissipation() const { return has_dissipation_; }
  FieldEnergy energy(double time);
  /// When the last path or ramp ends, s.
  double last_change() const;
  /// "temperature: content 12 J; since the start, 3 J came in, ...", at `time`.
  std::string balance_text(double time);
  /// The name of a component: "temperature", or "species 1" where there are several.
  std::string name(std::size_t component) const;
  /// The unit of its content: "J".
  std::string unit_of_content() const;

  // ---- operations and states ----

  void before_operation();
  void follow(const CellComplex& complex, const TopologyChange& change);
  /// The state before a step, from which implicit steps start and to which restore() returns.
  void keep();
  void restore();
  void state(Archive& archive);

 private:
  using Contents = std::array<double, 3>;  ///< by component
  /// What balance() and energy() say, without contents and what is stored.
  struct Booked {
    std::array<FieldBalance, 3> of;  ///< by component
    double dissipated = 0, supplied = 0;
  };
  struct Held {
    Index vertex;
    std::uint32_t component, path;
  };

  Index vertices() const { return attributes_.vertex_count(); }
  double& value(Index v, std::size_t c) const {
    return field_.values->rows()[v * static_cast<std::size_t>(field_.values->stride()) + c];
  }
  double& rate_of_change(Index v, std::size_t c) const {
    return field_.rate->rows()[v * static_cast<std::size_t>(field_.rate->stride()) + c];
  }
  std::uint32_t& path_of(Index v, std::size_t c) { return paths_of_[v * components_ + c]; }
  bool is_prescribed(Index v, std::size_t c) const { return paths_of_[v * components_ + c] != 0; }
  /// visit(vertex, component, place in the vectors of Newton's method, which have 3 per vertex)
  template <class Visit>
  void for_each_value(Visit visit) const {
    for (Index v = 0; v < vertices(); ++v)
      for (std::size_t c = 0; c < components_; ++c) visit(v, c, std::size_t{v} * 3 + c);
  }
  void find_held();
  double prescribed(const Held& held, double time) const { return paths_[held.path].value(time); }
  void evaluate(double time);
  void explicit_step(double time, double dt);
  void advance_component(std::size_t c, double dt);
  void require_capacities(Steps steps) const;
  Contents contents() const;
  double capacity(Index v) const { return field_.capacity ? field_.capacity->rows()[v] : 0; }
  double relaxation(Index v) const { return field_.relaxation ? field_.relaxation->rows()[v] : 0; }
  // As evaluated:
  double rate(Index v, std::size_t c) const { return rate_rows_[std::size_t{v} * 4 + c]; }
  double flux(Index v, std::size_t c) const {
    return has_fluxes_ ? flux_rows_[std::size_t{v} * 4 + c] : 0;  // films included
  }
  // Newton's method (field_newton.cpp)
  void solve(double time, double per_dt);
  void find_diagonal(double time, double per_dt);
  double find_residual(double time, double per_dt);
  bool solve_linear(double time, double per_dt);
  bool solve_definite();
  /// Values that a steady state leaves open by a constant, in groups.
  struct OpenGroups {
    std::vector<Index> of;  ///< by place in the vectors of Newton's method; `none`: determined
    Index count = 0;
  };
  OpenGroups find_open_groups() const;
  void add_open_groups(OpenGroups& groups, const std::vector<Index>& islands, Index count,
                       std::size_t first, std::size_t last) const;
  bool is_balanced(const OpenGroups& groups) const;
  void keep_contents(const OpenGroups& groups);
  void set_matrix(double time, double per_dt);
  void build_multigrid();
  double taken_up(Index v, std::size_t c, double per_dt) const;
  double rounding(double per_dt) const;
  void book(double time, double per_dt);

  Attributes& attributes_;
  const CellComplex& complex_;
  const VertexField& field_;
  std::size_t components_;
  std::vector<std::unique_ptr<ForceTerm>> terms_;  ///< rates and exchange
  ForceLoop& rates_;
  Exchange& exchange_;
  bool has_dissipation_;
  DeadLoads fluxes_;
  std::vector<ValuePath> paths_;
  /// By vertex and component: 1 + the number of its path; 0: none.
  std::vector<std::uint32_t> paths_of_;
  std::vector<Held> held_;                       ///< the same, ascending
  AlignedVector<double> rate_rows_, flux_rows_;  ///< of 4 per vertex
  bool has_fluxes_ = false;
  Booked booked_;
  Contents start_{};          ///< the contents then
  Contents before_change_{};  ///< before an operation
  double stable_ = 0;         ///< s; 0: to be found
  std::uint64_t steps_since_ = 0;
  Iterations iterations_, kept_iterations_;
  // Newton's method works with these, of 3 numbers per vertex:
  std::vector<double> before_, diagonal_, sums_, residual_, change_, rest_, correction_;
  std::vector<char> is_free_;
  TangentMatrix matrix_;
  ConjugateGradients solver_;
  std::unique_ptr<Preconditioner> multigrid_;  ///< with a hierarchy for these free components:
  std::vector<std::uint8_t> multigrid_free_;
  bool is_built_ = false;     ///< for the present step
  std::vector<double> kept_;  ///< values at the start of the step
  Booked kept_booked_;
};

}  // namespace suture
