// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/guard.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/dynamics/inversion.hpp"
#include "kernel/dynamics/rounding.hpp"

namespace suture {
namespace {

bool stops_on_inversion(const Scene& scene, const ModelUse& use) {
  for (const OnInversion choice : {use.on_inversion, scene.solver.on_inversion})
    if (choice != OnInversion::by_model) return choice == OnInversion::stop;
  return (use.model->flags & SUTURE_CONTINUUM) != 0;
}

}  // namespace

Guard::Guard(const Scene& scene, BuiltScene& built, Diagnostics& diagnostics)
    : built_(built),
      diagnostics_(diagnostics),
      inverted_at_rest_(find_inverted(built.body().complex(), built.body().attributes())) {
  for (const ModelUse& use : scene.models) stops_.push_back(stops_on_inversion(scene, use));
}

void Guard::check(std::uint64_t step, double time) {
  last_ = built_.dynamics().balance();
  noise_ = 10 * static_cast<double>(step) * rounding_of(built_.dynamics().motion()).energy;
  forgiven_ = std::min(forgiven_, unexplained());  // energy that was lost may not come back
  if (!std::isfinite(last_.kinetic) || !std::isfinite(last_.elastic)) {
    std::ostringstream text;
    text << "the energy is not finite: " << last_.kinetic << " J kinetic, " << last_.elastic
         << " J elastic";
    throw NotFinite(text.str());
  }
  check_inversion(step, time);
}

// Viscous functors only dissipate: energy that they add is as unexplained as a growing balance.
// Energy that the step returns later is not growth.
double Guard::unexplained() const {
  return last_.balance - last_.recoverable - std::min(last_.dissipated, 0.0);
}

double Guard::growth() const {
  const double grown = unexplained() - forgiven_;
  return last_.exchanged > 0 && grown > noise_ ? grown / last_.exchanged : 0;
}

void Guard::check_inversion(std::uint64_t step, double time) {
  std::vector<Index> inverted;
  std::ranges::set_difference(find_inverted(built_.body().complex(), built_.body().attributes()),
                              inverted_at_rest_, std::back_inserter(inverted));
  if (inverted.empty()) return;
  const auto& instances = built_.body().attributes().instances();
  const auto stops = [&](Index e) {
    for (std::size_t i = 0; i < instances.size(); ++i)
      if (stops_[i] && instances[i]->table(3).cells.contains(e)) return true;
    return false;
  };
  const auto worst = std::ranges::find_if(inverted, stops);
  const bool first_time = worst_inverted_ == 0;
  worst_inverted_ = std::max(worst_inverted_, static_cast<Index>(inverted.size()));
  if (!first_time && worst == inverted.end()) return;
  const Index shown = worst != inverted.end() ? *worst : inverted.front();
  std::ostringstream text;
  text << inverted.size() << (inverted.size() == 1 ? " element is" : " elements are")
       << " inverted (a corner Jacobian <= 0): element " << built_.element_name(shown) << " at "
       << built_.place_of(shown) << (inverted.size() > 1 ? " and others" : "");
  if (worst != inverted.end()) throw NumericalError(text.str());
  std::ostringstream when;
  when << "step " << step << ", t = " << time << " s: ";
  diagnostics_.warn(when.str() + text.str() + "; the run continues (on_inversion is \"warn\")");
}

void Guard::state(Archive& archive) {
  archive("worst inverted", worst_inverted_);
  archive("noise", noise_);
  archive("last", last_);
  archive("forgiven", forgiven_);
}

}  // namespace suture
