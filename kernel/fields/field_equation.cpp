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
      complex_(complex),
      field_(field),
      components_(static_cast<std::size_t>(field.values->spec().components)),
      rates_(static_cast<ForceLoop&>(
          *terms_.emplace_back(std::make_unique<ForceLoop>(attributes, complex, threads, &field)))),
      exchange_(static_cast<Exchange&>(
          *terms_.emplace_back(std::make_unique<Exchange>(attributes, *field.values)))),
      has_dissipation_(rates_.has_dissipation()),
      fluxes_(attributes),
      paths_of_(attributes.vertex_count() * components_, 0),
      matrix_(attributes, terms_, rates_.workers()) {}

// --------------------------------------------------------------- conditions --

void FieldEquation::set(std::span<const Index> vertices, double value, std::size_t component) {
  for (const Index v : vertices) this->value(v, component) = value;
}

Index FieldEquation::prescribe(std::span<const Index> vertices, const ValuePath& path,
                               std::size_t component) {
  for (const Index v : vertices)
    if (is_prescribed(v, component) && paths_[path_of(v, component) - 1].stations != path.stations)
      return v;
  paths_.push_back(path);
  for (const Index v : vertices) path_of(v, component) = static_cast<std::uint32_t>(paths_.size());
  return none;
}

void FieldEquation::find_held() {
  held_.clear();
  for_each_value([&](Index v, std::size_t c, std::size_t) {
    if (is_prescribed(v, c)) held_.push_back({v, static_cast<std::uint32_t>(c), path_of(v, c) - 1});
  });
}

double FieldEquation::last_change() const {
  double last = std::max(fluxes_.last_change(), exchange_.coefficients().last_change());
  for (const ValuePath& path : paths_) last = std::max(last, path.stations.back().at);
  return last;
}

// -------------------------------------------------------------------- rates --

void FieldEquation::evaluate(double time) {
  const std::size_t size = std::size_t{vertices()} * 4;
  rate_rows_.assign(size, 0);
  rates_.add_forces(time, 0, ForceLoop::Part::all, rate_rows_.data());
  if (!has_fluxes_) return;
  flux_rows_.assign(size, 0);
  fluxes_.add_forces(time, attributes_.kernel(0).cells.live(), flux_rows_.data());
  exchange_.add_forces(time, attributes_.kernel(0).cells.live(), flux_rows_.data());
}

double FieldEquation::stable_step(double time) {
  if (stable_ > 0 && steps_since_ < steps_between_bounds) return stable_;
  find_diagonal(time, 0);
  stable_ = std::numeric_limits<double>::infinity();
  steps_since_ = 0;
  for_each_value([&](Index v, std::size_t c, std::size_t i) {
    if (sums_[i] > 0 && !is_prescribed(v, c)) stable_ = std::min(stable_, capacity(v) / sums_[i]);
  });
  return stable_;
}

// -------------------------------------------------------------------- steps --

void FieldEquation::start(double time, Steps steps) {
  find_held();
  has_fluxes_ = !fluxes_.adds_no_rows() || !exchange_.adds_no_rows();
  for (const Held& held : held_) value(held.vertex, held.component) = prescribed(held, time);
  booked_ = {};
  iterations_ = {};
  stable_ = 0;
  start_ = contents();
  find_diagonal(time, 0);
  require_capacities(steps);
}

/// A field that follows the motion needs none in implicit steps.
void FieldEquation::require_capacities(Steps steps) const {
  if (steps == Steps::steady || (steps == Steps::implicit && feels_motion())) return;
  for_each_value([&](Index v, std::size_t c, std::size_t i) {
    if (sums_[i] == 0 || capacity(v) > 0 || is_prescribed(v, c)) return;
    throw InputError("field '" + field_.name +
                     "': a node where models give it a rate has no capacity; add a model with a "
                     "capacity to these elements, or replace /solver/integrator by /solver/static");
  });
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
}

/// What a prescribed vertex takes up beside its rate has come through it.
void FieldEquation::explicit_step(double time, double dt) {
  evaluate(time);
  if (has_dissipation_) booked_.dissipated += dt * rates_.dissipation(time);
  for (std::size_t c = 0; c < components_; ++c) advance_component(c, dt);
  for (const Held& held : held_) {
    const auto [v, c, path] = held;
    const double next = prescribed(held, time + dt);
    const double in = capacity(v) * (next - value(v, c)) - dt * (rate(v, c) + flux(v, c));
    booked_.of[c].inflow += in;
    booked_.supplied += next * in;
    value(v, c) = next;
  }
}

/// u += h (r + q) / C. What a field that does not fall (SUTURE_RISING) would lose is not produced.
void FieldEquation::advance_component(std::size_t c, double dt) {
  double produced = 0, inflow = 0, dissipated = 0, supplied = 0;
  bool is_finite = true;
  const Index count = vertices();
  for (Index v = 0; v < count; ++v) {
    const double capacity = this->capacity(v), rate = this->rate(v, c), flux = this->flux(v, c);
    const bool is_free = capacity > 0 && !is_prescribed(v, c);
    const bool cannot_fall = is_free && field_.is_rising && rate + flux < 0;
    double& u = value(v, c);
    produced += cannot_fall ? -flux : rate;
    inflow += flux;
    if (is_free && !cannot_fall) {
      const double change = dt * (rate + flux) / capacity;
      u += change;
      dissipated += rate * change;
    }
    supplied += u * flux;
    is_finite &= std::isfinite(u);
  }
  booked_.of[c].produced += dt * produced;
  booked_.of[c].inflow += dt * inflow;
  booked_.supplied += dt * supplied;
  if (!has_dissipation_) booked_.dissipated += dissipated;
  if (is_finite) return;
  throw NumericalError("field '" + field_.name +
                       "' is not finite: its rates grow faster than its steps follow; choose an "
                       "implicit integrator, or a shorter dt");
}

// ------------------------------------------------------------------ balance --

FieldEquation::Contents FieldEquation::contents() const {
  Contents sums{};
  for_each_value(
      [&](Index v, std::size_t c, std::size_t) { sums[c] += capacity(v) * value(v, c); });
  return sums;
}

FieldBalance FieldEquation::balance(std::size_t component) const {
  FieldBalance balance = booked_.of[component];
  balance.content = contents()[component];
  return balance;
}

FieldEnergy FieldEquation::energy(double time) {
  double stored = rates_.energy(time);
  if (has_dissipation_)
    for_each_value([&](Index v, std::size_t c, std::size_t) {
      stored += capacity(v) * value(v, c) * value(v, c) / 2;
    });
  return {stored, booked_.dissipated, booked_.supplied};
}

std::string FieldEquation::name(std::size_t component) const {
  return components_ == 1 ? field_.name : field_.name + ' ' + std::to_string(component);
}

std::string FieldEquation::balance_text(double time) {
  const std::string unit = ' ' + unit_of_content();
  bool has_capacity = false;
  for_each_value([&](Index v, std::size_t, std::size_t) { has_capacity |= capacity(v) > 0; });
  std::ostringstream text;
  for (std::size_t c = 0; c < components_; ++c) {
    const FieldBalance b = balance(c);
    text << (c == 0 ? "" : "; ") << name(c) << ": ";
    if (!has_capacity) {
      text << "no capacity, so it contains nothing";
      if (b.inflow != 0) text << "; since the start, " << b.inflow << unit << " came in";
      continue;
    }
    text << "content " << b.content << unit << "; since the start, " << b.inflow << unit
         << " came in, models produced " << b.produced << unit << ", and " << b.changed << unit
         << " are due to operations and jumps to equilibria";
  }
  if (iterations_.all != 0)
    text << "; its equations took " << iterations_.all << " iterations, "
         << iterations_.with_multigrid << " of them with the multigrid";
  if (!has_energy()) return text.str();
  const FieldEnergy e = energy(time);
  text << "; field and deformation store " << e.stored << " J, and " << e.dissipated
       << " J were dissipated";
  if (has_dissipation()) text << "; what came in brought " << e.supplied << " J";
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

void FieldEquation::before_operation() { before_change_ = contents(); }

void FieldEquation::follow(const CellComplex& complex, const TopologyChange& change) {
  rates_.follow(complex, change);
  fluxes_.follow(complex, change);
  exchange_.follow(complex, change);
  paths_of_.resize(vertices() * components_, 0);
  for (std::size_t c = 0; c < components_; ++c) {
    for (const Split& split : change.splits[0])
      path_of(split.new_cell, c) = path_of(split.old_cell, c);
    for (const auto& [kept, gone] : change.merges[0])
      if (const std::uint32_t path = std::exchange(path_of(gone, c), 0); !is_prescribed(kept, c))
        path_of(kept, c) = path;
    for (const Index v : change.removed[0]) path_of(v, c) = 0;
  }
  find_held();
  const Contents now = contents();
  for (std::size_t c = 0; c < components_; ++c) booked_.of[c].changed += now[c] - before_change_[c];
  stable_ = 0;
  multigrid_.reset();
}

void FieldEquation::keep() {
  kept_.assign(std::size_t{vertices()} * 3, 0);
  for_each_value([&](Index v, std::size_t c, std::size_t i) { kept_[i] = value(v, c); });
  kept_booked_ = booked_;
  kept_iterations_ = iterations_;
}

void FieldEquation::restore() {
  for_each_value([&](Index v, std::size_t c, std::size_t i) { value(v, c) = kept_[i]; });
  booked_ = kept_booked_;
  iterations_ = kept_iterations_;
}

/// The values are those of the attributes.
void FieldEquation::state(Archive& archive) {
  const auto add = [&](const std::string& what, std::size_t c, double& number) {
    archive((what + (c == 0 ? "" : std::to_string(c))).c_str(), number);
  };
  for (std::size_t c = 0; c < components_; ++c) {
    add("inflow", c, booked_.of[c].inflow);
    add("produced", c, booked_.of[c].produced);
    add("changed", c, booked_.of[c].changed);
  }
  archive("dissipated", booked_.dissipated);
  archive("supplied", booked_.supplied);
  archive("stable", stable_);
  archive("steps since", steps_since_);
  archive("iterations", iterations_.all);
  archive("with multigrid", iterations_.with_multigrid);
  if (!archive.has_cells()) return;
  for (std::size_t c = 0; c < components_; ++c) add("start", c, start_[c]);
  archive("rates", rates_);
  archive("fluxes", fluxes_);
  archive("exchange", exchange_);
  archive("paths", paths_of_);
  archive.require(paths_of_.size() == vertices() * components_,
                  "the prescribed vertices of a field differ");
  for (const std::uint32_t path : paths_of_)
    archive.require(path <= paths_.size(), "a field has other conditions");
  if (archive.loads()) {
    find_held();
    multigrid_.reset();
  }
}

}  // namespace suture
