// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/fields/field_equation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

/// Steps after which the stable step is found again: rates may depend on the state.
constexpr std::uint64_t steps_between_bounds = 256;

}  // namespace

FieldEquation::FieldEquation(Attributes& attributes, const CellComplex& complex,
                             const VertexField& field, unsigned threads)
    : attributes_(attributes),
      field_(field),
      rates_(attributes, complex, threads, &field),
      fluxes_(attributes),
      paths_of_(attributes.vertex_count(), 0) {}

// --------------------------------------------------------------- conditions --

void FieldEquation::set(std::span<const Index> vertices, double value) {
  for (const Index v : vertices) field_.values->rows()[v] = value;
}

Index FieldEquation::prescribe(std::span<const Index> vertices, const ValuePath& path) {
  for (const Index v : vertices)
    if (is_prescribed(v) && paths_[paths_of_[v] - 1].stations != path.stations) return v;
  paths_.push_back(path);
  for (const Index v : vertices) paths_of_[v] = static_cast<std::uint32_t>(paths_.size());
  return none;
}

void FieldEquation::find_held() {
  held_.clear();
  for (Index v = 0; v < paths_of_.size(); ++v)
    if (is_prescribed(v)) held_.push_back({v, paths_of_[v] - 1});
}

double FieldEquation::last_change() const {
  double last = fluxes_.last_change();
  for (const ValuePath& path : paths_) last = std::max(last, path.stations.back().at);
  return last;
}

// -------------------------------------------------------------------- rates --

void FieldEquation::evaluate(double time) {
  const std::size_t size = std::size_t{attributes_.vertex_count()} * 4;
  rate_rows_.assign(size, 0);
  rates_.add_forces(time, 0, ForceLoop::Part::all, rate_rows_.data());
  if (!has_fluxes_) return;
  flux_rows_.assign(size, 0);
  fluxes_.add_forces(time, attributes_.kernel(0).cells.live(), flux_rows_.data());
}

double FieldEquation::stable_step(double time) {
  if (stable_ > 0 && steps_since_ < steps_between_bounds) return stable_;
  find_diagonal(time, 0);
  stable_ = std::numeric_limits<double>::infinity();
  steps_since_ = 0;
  for (Index v = 0; v < attributes_.vertex_count(); ++v)
    if (sums_[v] > 0 && !is_prescribed(v)) stable_ = std::min(stable_, capacity(v) / sums_[v]);
  return stable_;
}

// -------------------------------------------------------------------- steps --

void FieldEquation::start(double time, Steps steps) {
  find_held();
  has_fluxes_ = !fluxes_.adds_no_rows();
  for (const Held& held : held_) field_.values->rows()[held.vertex] = prescribed(held, time);
  balance_ = {};
  stable_ = 0;
  start_ = sum_content();
  find_diagonal(time, 0);
  require_capacities(steps);
}

/// A field that follows the motion needs none in implicit steps.
void FieldEquation::require_capacities(Steps steps) const {
  if (steps == Steps::steady || (steps == Steps::implicit && feels_motion())) return;
  for (Index v = 0; v < attributes_.vertex_count(); ++v) {
    if (sums_[v] == 0 || capacity(v) > 0 || is_prescribed(v)) continue;
    throw InputError("field '" + field_.name +
                     "': a node where models give it a rate has no capacity; add a model with a "
                     "capacity to these elements, or replace /solver/integrator by /solver/static");
  }
}

void FieldEquation::advance_explicitly(double time, double dt) {
  if (dt == 0) return;
  const double stable = stable_step(time);
  const double steps = std::max(1.0, std::ceil(dt / stable));
  if (!(steps <= 1e6))
    throw NumericalError("field '" + field_.name + "' needs " + std::to_string(steps) +
                         " explicit steps in a step of " + std::to_string(dt) +
                         " s: choose an implicit integrator");
  for (double i = 0; i < steps; ++i) explicit_step(time + i * (dt / steps), dt / steps);
  ++steps_since_;
  require_finite();
}

/// u += h (r + q) / C. What a prescribed vertex takes up beside its rate has come through it; what
/// a field that does not fall (SUTURE_RISING) would lose is not produced.
void FieldEquation::explicit_step(double time, double dt) {
  evaluate(time);
  double* const u = field_.values->rows();
  double produced = 0, in = 0, lost = 0;
  for (Index v = 0; v < attributes_.vertex_count(); ++v) {
    produced += rate(v);
    in += flux(v);
    const double c = capacity(v), more = rate(v) + flux(v);
    if (!(c > 0) || is_prescribed(v)) continue;
    if (field_.is_rising && more < 0) {
      produced -= more;
    } else {
      u[v] += dt * more / c;
      lost += rate(v) * (dt * more / c);
    }
  }
  balance_.dissipated += lost;
  double through = 0;
  for (const Held& held : held_) {
    const Index v = held.vertex;
    const double next = prescribed(held, time + dt);
    through += capacity(v) * (next - u[v]) - dt * (rate(v) + flux(v));
    u[v] = next;
  }
  balance_.produced += dt * produced;
  balance_.inflow += dt * in + through;
}

void FieldEquation::require_finite() const {
  const double* const u = field_.values->rows();
  for (Index v = 0; v < attributes_.vertex_count(); ++v)
    if (!std::isfinite(u[v]))
      throw NumericalError("field '" + field_.name +
                           "' is not finite: its rates grow faster than "
                           "its steps follow; choose an implicit integrator, or a shorter dt");
}

// ------------------------------------------------------------------ balance --

double FieldEquation::sum_content() const {
  const double* const u = field_.values->rows();
  double sum = 0;
  for (Index v = 0; v < attributes_.vertex_count(); ++v) sum += capacity(v) * u[v];
  return sum;
}

FieldBalance FieldEquation::balance(double time) {
  FieldBalance balance = balance_;
  balance.content = sum_content();
  if (has_energy()) balance.energy = rates_.energy(time);
  return balance;
}

std::string FieldEquation::balance_text(double time) {
  const FieldBalance b = balance(time);
  const std::string unit = ' ' + unit_of_content();
  std::ostringstream text;
  text << field_.name << ": content " << b.content << unit << "; since the start, " << b.inflow
       << unit << " came in, models produced " << b.produced << unit << ", and " << b.changed
       << unit << " are due to operations and jumps to equilibria";
  if (has_energy())
    text << "; field and deformation store " << b.energy << " J, and " << b.dissipated
         << " J were dissipated";
  return text.str();
}

/// "J/K" times "K" is "J", "m^3" times "mol/m^3" is "mol".
std::string FieldEquation::unit_of_content() const {
  const std::string capacity = field_.capacity ? field_.capacity->spec().unit : "";
  const std::string per = "/" + field_.unit;
  if (capacity.ends_with(per)) return capacity.substr(0, capacity.size() - per.size());
  if (const std::string whole = "/" + capacity; field_.unit.ends_with(whole))
    return field_.unit.substr(0, field_.unit.size() - whole.size());
  if (capacity.empty()) return field_.unit;
  return field_.unit == "1" ? capacity : capacity + ' ' + field_.unit;
}

// --------------------------------------------------------- operations, state --

void FieldEquation::follow(const CellComplex& complex, const TopologyChange& change) {
  rates_.follow(complex, change);
  fluxes_.follow(complex, change);
  paths_of_.resize(attributes_.vertex_count(), 0);
  for (const Split& split : change.splits[0]) paths_of_[split.new_cell] = paths_of_[split.old_cell];
  for (const auto& [kept, gone] : change.merges[0])
    if (const std::uint32_t path = std::exchange(paths_of_[gone], 0); !is_prescribed(kept))
      paths_of_[kept] = path;
  for (const Index v : change.removed[0]) paths_of_[v] = 0;
  find_held();
  balance_.changed += sum_content() - content_;
  stable_ = 0;
}

void FieldEquation::keep() {
  kept_.assign(field_.values->rows(), field_.values->rows() + attributes_.vertex_count());
  kept_balance_ = balance_;
}

void FieldEquation::restore() {
  std::ranges::copy(kept_, field_.values->rows());
  balance_ = kept_balance_;
}

/// The values are those of the attributes.
void FieldEquation::state(Archive& archive) {
  archive("inflow", balance_.inflow);
  archive("produced", balance_.produced);
  archive("changed", balance_.changed);
  archive("dissipated", balance_.dissipated);
  archive("stable", stable_);
  archive("steps since", steps_since_);
  if (!archive.has_cells()) return;
  archive("start", start_);
  archive("rates", rates_);
  archive("fluxes", fluxes_);
  archive("paths", paths_of_);
  archive.require(paths_of_.size() == attributes_.vertex_count(),
                  "the prescribed vertices of a field differ");
  for (const std::uint32_t path : paths_of_)
    archive.require(path <= paths_.size(), "a field has other conditions");
  if (archive.loads()) find_held();
}

}  // namespace suture
