// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/steps/guard.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <sstream>
#include <string_view>

#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/dynamics/inversion.hpp"
#include "kernel/dynamics/rounding.hpp"

namespace suture {
namespace {

void require_finite(const EnergyBalance& energies, const Motion& motion) {
  const bool is_finite = std::isfinite(energies.kinetic) && std::isfinite(energies.elastic);
  if (is_finite && std::isfinite(energies.balance)) return;
  motion.require_finite_forces();  // names the node
  if (is_finite) throw NotFinite("the work of the forces is not finite");
  std::ostringstream text;
  text << "the energy is not finite: " << energies.kinetic << " J kinetic, " << energies.elastic
       << " J elastic";
  throw NotFinite(text.str());
}

/// Why a few inverted elements do not end a run, and what prevents them.
std::string few_text(const BuiltScene& built, Index element) {
  std::ostringstream text;
  text << "up to " << percent_inverted << " % of the elements do not stop it";
  const std::string stiffer = stiffer_element(built, element);
  return text.str() + (stiffer.empty() ? "" : "; " + stiffer + " resists it more");
}

}  // namespace

std::string stiffer_element(const BuiltScene& built, Index element) {
  const std::string_view now = "mean-gradient", other = "trilinear";
  for (const auto& instance : built.body().attributes().instances()) {
    if (!instance->table(3).cells.contains(element)) continue;
    const std::span parameters(instance->model().parameters, instance->model().parameter_count);
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const std::span choices(parameters[i].choices, parameters[i].choice_count);
      const double value = instance->parameters()[i];
      if (parameters[i].name != std::string_view("element") || choices.empty() ||
          choices[static_cast<std::size_t>(value)] != now ||
          std::ranges::find(choices, other) == choices.end())
        continue;
      return "\"element\": \"trilinear\" of model '" + instance->name() + "'";
    }
  }
  return "";
}

Guard::Guard(BuiltScene& built, Diagnostics& diagnostics)
    : built_(built),
      diagnostics_(diagnostics),
      stops_(built.stops_on_inversion()),
      inverted_at_rest_(find_inverted(built.body(), {})) {}

void Guard::check(std::uint64_t step, double time) {
  last_ = built_.dynamics().check_balance();
  const Motion& motion = built_.dynamics().motion();
  require_finite(last_, motion);
  if (stored_rounding_ == 0) stored_rounding_ = rounding_of_stored_energy(motion);
  noise_ = 10 * static_cast<double>(step) * rounding_of(motion).energy + stored_rounding_;
  forgiven_ = std::min(forgiven_, unexplained());  // energy that was lost may not come back
  check_inversion(step, time);
}

// Viscous functors only dissipate: energy that they add is as unexplained as a growing balance.
// Energy that the step returns later is not growth.
double Guard::unexplained() const {
  return last_.balance - last_.recoverable - std::min(last_.dissipated, 0.0);
}

/// A part of what was exchanged; 0 if it is as small as noise.
double Guard::share(double energy) const {
  return exchanged() > 0 && std::abs(energy) > noise_ ? energy / exchanged() : 0;
}

double Guard::growth() const { return share(std::max(unexplained() - forgiven_, 0.0)); }

double Guard::open_balance() const { return share(last_.balance - last_.recoverable); }

void Guard::check_inversion(std::uint64_t step, double time) {
  const std::vector<Index> inverted = find_inverted(built_.body(), inverted_at_rest_);
  if (inverted.empty()) return;
  const Inversion judged = judge_inversion(built_.body(), inverted, stops_);
  const bool first_time = worst_inverted_ == 0;
  worst_inverted_ = std::max(worst_inverted_, static_cast<Index>(inverted.size()));
  if (!first_time && judged.fatal == none) return;
  Index shown = judged.first != none ? judged.first : inverted.front();
  if (judged.fatal != none) shown = judged.fatal;
  std::ostringstream text;
  text << inverted.size() << (inverted.size() == 1 ? " element is" : " elements are")
       << " inverted (a corner Jacobian <= 0): element " << built_.element_name(shown) << " at "
       << built_.place_of(shown) << (inverted.size() > 1 ? " and others" : "");
  if (judged.fatal != none) {
    fatal_ = judged.fatal;
    throw NumericalError(text.str());
  }
  diagnostics_.warn(
      "step " + std::to_string(step) + ", " + timed(time, text.str()) + "; the run continues (" +
      (judged.first != none ? few_text(built_, shown) : "on_inversion is \"warn\"") + ")");
}

void Guard::state(Archive& archive) {
  archive("worst inverted", worst_inverted_);
  archive("fatal", fatal_);
  archive("noise", noise_);
  archive("stored rounding", stored_rounding_);
  archive("last", last_);
  archive("forgiven", forgiven_);
}

}  // namespace suture
