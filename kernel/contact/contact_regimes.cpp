// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/contact_regimes.hpp"

#include <algorithm>
#include <sstream>

#include "kernel/contact/contact.hpp"

namespace suture {
namespace {

// A contact alternates that has changed so often, and within the last so many iterations.
constexpr unsigned least_changes = 4, recent = 5;

}  // namespace

void ContactRegimes::begin(unsigned iteration) {
  iteration_ = iteration;
  if (iteration == 0) regimes_.clear();
  for (auto& [where, regime] : regimes_) regime.next = Kind::apart;
}

void ContactRegimes::note(std::size_t obstacle, Index vertex, bool slides) {
  regimes_[{obstacle, vertex}].next = slides ? Kind::slides : Kind::holds;
}

void ContactRegimes::end() {
  for (auto& [where, regime] : regimes_) {
    const Kind before = std::exchange(regime.now, regime.next);
    if (before == regime.now || iteration_ == 0) continue;
    ++regime.changes;
    regime.last_change = iteration_;
    regime.lets_go |= before == Kind::apart || regime.now == Kind::apart;
  }
}

bool ContactRegimes::alternates(const Entry& entry) const {
  const Regime& regime = entry.second;
  return regime.changes >= least_changes && regime.last_change + recent > iteration_;
}

std::optional<NonsmoothTerm::Alternation> ContactRegimes::alternation(
    std::span<const Obstacle> obstacles) const {
  const auto often = std::ranges::max_element(regimes_, {}, [&](const Entry& entry) {
    return alternates(entry) ? entry.second.changes : 0;
  });
  if (often == regimes_.end() || !alternates(*often)) return {};
  const auto& [obstacle, vertex] = often->first;
  const auto nodes =
      std::ranges::count_if(regimes_, [&](const Entry& entry) { return alternates(entry); });
  std::ostringstream text;
  text << "contact "
       << (obstacle == Contact::between_pieces
               ? "between pieces"
               : "with the obstacle '" + obstacles[obstacle].name + "'")
       << " alternates between "
       << (often->second.lets_go ? "touching and letting go" : "friction that holds and sliding")
       << " at " << nodes << (nodes == 1 ? " node" : " nodes");
  return NonsmoothTerm::Alternation{text.str(), vertex};
}

}  // namespace suture
