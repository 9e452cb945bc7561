// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/sleeper.hpp"

#include <algorithm>

#include "kernel/dynamics/sleep.hpp"

namespace suture {
namespace {

constexpr std::uint64_t steps_between_checks = 64;
constexpr unsigned checks_needed = 4;

/// Elements by island, ascending.
std::vector<std::vector<Index>> elements_by_island(const Islands& islands, Index elements) {
  std::vector<std::vector<Index>> lists(islands.count());
  for (Index e = 0; e < elements; ++e)
    if (islands.of(e) != none) lists[islands.of(e)].push_back(e);
  return lists;
}

}  // namespace

Sleeper::Sleeper(const SolverOptions& options, BuiltScene& built)
    : built_(built), acceleration_(options.sleep_acceleration), velocity_(options.sleep_velocity) {
  built.body().add_follower(*this);
}

bool Sleeper::is_still(std::span<const Index> elements) const {
  const Stillness found = stillness(built_.dynamics(), elements);
  return found.acceleration <= acceleration_ && found.velocity <= velocity_;
}

Index Sleeper::check(std::uint64_t step) {
  if (!is_enabled() || step % steps_between_checks != 0) return 0;
  if (built_.dynamics().time() < built_.body().last_change()) return 0;
  const Islands& islands = built_.body().islands();
  still_checks_.resize(islands.count());
  Index fallen_asleep = 0;
  const auto lists = elements_by_island(islands, built_.body().complex().element_count());
  for (Index island = 0; island < islands.count(); ++island) {
    unsigned& checks = still_checks_[island];
    if (lists[island].empty() || checks >= checks_needed) continue;
    checks = is_still(lists[island]) ? checks + 1 : 0;
    if (checks < checks_needed) continue;
    put_to_sleep(built_.dynamics(), lists[island]);
    ++fallen_asleep;
  }
  return fallen_asleep;
}

void Sleeper::follow(const CellComplex&, const TopologyChange&) {
  std::ranges::fill(still_checks_, 0u);
}

void Sleeper::state(Archive& archive) { archive("still looks", still_checks_); }

Index Sleeper::sleeping() const {
  return static_cast<Index>(std::ranges::count_if(
      still_checks_, [](unsigned checks) { return checks >= checks_needed; }));
}

}  // namespace suture
