// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/sleeper.hpp"

#include <algorithm>

#include "kernel/dynamics/sleep.hpp"
#include "kernel/forces/contact_law.hpp"
#include "kernel/topology/disjoint_sets.hpp"

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

Index Sleeper::island_of(Index vertex) const {
  Body& body = built_.body();
  return body.islands().of(element_of(body.complex().dart_of(0, vertex)));
}

/// When loads and constraints change last; what moves as an obstacle matters only to what it comes
/// near.
double Sleeper::last_change() const {
  double last = built_.body().constraints().last_change();
  for (const auto& term : built_.body().terms()) last = std::max(last, term->last_change());
  return last;
}

bool Sleeper::check(std::uint64_t step) {
  if (!is_enabled()) return false;
  still_checks_.resize(built_.body().islands().count());
  asleep_.resize(still_checks_.size());
  if (wake_disturbed()) return true;
  if (step % steps_between_checks != 0 || built_.dynamics().time() < last_change()) return false;
  return put_still_to_sleep();
}

// ------------------------------------------------------------------------ wake --

bool Sleeper::wake_disturbed() {
  if (!built_.body().contact() || sleeping() == 0) return false;
  const std::vector<bool> islands = disturbed();
  if (std::ranges::find(islands, true) == islands.end()) return false;
  wake(islands);
  return true;
}

void Sleeper::wake_all() {
  if (sleeping() == 0) return;
  wake(std::vector<bool>(asleep_.size(), true));
}

/// Islands that something wakes, with all that they touch.
std::vector<bool> Sleeper::disturbed() {
  const ContactLaw& contact = *built_.body().contact();
  std::vector<bool> found(asleep_.size());
  const auto disturb = [&](Index vertex) {
    const Index island = island_of(vertex);
    if (asleep_[island]) found[island] = true;
  };
  const Motion& motion = built_.dynamics().motion();
  for (const Index v : contact.near_moving_obstacles(motion.time(), motion.last_step())) disturb(v);
  contact.for_each_pushed_sleeper([&](Index vertex, double acceleration) {
    if (acceleration > acceleration_) disturb(vertex);
  });
  if (std::ranges::find(found, true) == found.end()) return found;
  const std::vector<Index> group = groups();
  std::vector<bool> wakes(found.size());
  for (Index i = 0; i < found.size(); ++i)
    if (found[i]) wakes[group[i]] = true;
  for (Index i = 0; i < found.size(); ++i) found[i] = asleep_[i] && wakes[group[i]];
  return found;
}

void Sleeper::wake(const std::vector<bool>& islands) {
  const auto elements =
      elements_by_island(built_.body().islands(), built_.body().complex().element_count());
  std::vector<Index> asleep;
  for (Index i = 0; i < islands.size(); ++i) {
    if (islands[i]) asleep_[i] = still_checks_[i] = 0;
    if (asleep_[i]) asleep.insert(asleep.end(), elements[i].begin(), elements[i].end());
  }
  wake_except(built_.dynamics(), asleep);
}

// ----------------------------------------------------------------------- sleep --

/// By island: the smallest one of those that press on each other, directly or through others.
std::vector<Index> Sleeper::groups() const {
  DisjointSets sets(asleep_.size());
  if (const ContactLaw* contact = built_.body().contact())
    for (const auto& [one, other] : contact->presses())
      sets.unite(island_of(one), island_of(other));
  std::vector<Index> group(asleep_.size());
  for (Index i = 0; i < group.size(); ++i) group[i] = static_cast<Index>(sets.find(i));
  return group;
}

void Sleeper::count_still_checks(const std::vector<std::vector<Index>>& elements) {
  for (Index i = 0; i < asleep_.size(); ++i)
    if (!elements[i].empty() && !asleep_[i])
      still_checks_[i] = is_still(elements[i]) ? std::min(still_checks_[i] + 1, checks_needed) : 0;
  const ContactLaw* contact = built_.body().contact();
  if (!contact) return;
  const Motion& motion = built_.dynamics().motion();
  for (const Index v : contact->near_moving_obstacles(motion.time(), motion.last_step()))
    still_checks_[island_of(v)] = 0;
}

bool Sleeper::put_still_to_sleep() {
  const auto elements =
      elements_by_island(built_.body().islands(), built_.body().complex().element_count());
  count_still_checks(elements);
  const std::vector<Index> group = groups();
  std::vector<bool> waits(group.size());
  for (Index i = 0; i < group.size(); ++i)
    if (still_checks_[i] < checks_needed && !elements[i].empty()) waits[group[i]] = true;
  std::vector<Index> still;
  for (Index i = 0; i < group.size(); ++i) {
    if (asleep_[i] || elements[i].empty() || waits[group[i]]) continue;
    asleep_[i] = 1;
    still.insert(still.end(), elements[i].begin(), elements[i].end());
  }
  put_to_sleep(built_.dynamics(), still);
  return !still.empty();
}

void Sleeper::follow(const CellComplex&, const TopologyChange&) {
  std::ranges::fill(still_checks_, 0u);
  std::ranges::fill(asleep_, std::uint8_t{0});
}

void Sleeper::state(Archive& archive) {
  archive("checks at rest", still_checks_);
  archive("asleep", asleep_);
}

Index Sleeper::sleeping() const { return static_cast<Index>(std::ranges::count(asleep_, 1)); }

}  // namespace suture
