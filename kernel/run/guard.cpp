// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/guard.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/dynamics/inversion.hpp"
#include "kernel/dynamics/rounding.hpp"

namespace suture {
Guard::Guard(BuiltScene& built, Diagnostics& diagnostics)
    : built_(built),
      diagnostics_(diagnostics),
      stops_(built.stops_on_inversion()),
      inverted_at_rest_(find_inverted(built.body(), {})) {}

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
  const std::vector<Index> inverted = find_inverted(built_.body(), inverted_at_rest_);
  if (inverted.empty()) return;
  const Index worst = first_forbidden(built_.body(), inverted, stops_);
  const bool first_time = worst_inverted_ == 0;
  worst_inverted_ = std::max(worst_inverted_, static_cast<Index>(inverted.size()));
  if (!first_time && worst == none) return;
  const Index shown = worst != none ? worst : inverted.front();
  std::ostringstream text;
  text << inverted.size() << (inverted.size() == 1 ? " element is" : " elements are")
       << " inverted (a corner Jacobian <= 0): element " << built_.element_name(shown) << " at "
       << built_.place_of(shown) << (inverted.size() > 1 ? " and others" : "");
  if (worst != none) throw NumericalError(text.str());
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
