// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/live/live_states.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

constexpr std::size_t max_bytes = std::size_t{1} << 29, max_count = 100;

}  // namespace

void LiveStates::keep(LiveState state) {
  state.id = ++last_id_;
  states_.push_back(std::move(state));
  std::size_t bytes = 0;
  for (const LiveState& kept : states_) bytes += kept.state.bytes();
  while (states_.size() > 1 && (bytes > max_bytes || states_.size() > max_count)) {
    bytes -= states_.front().state.bytes();
    spare_ = std::move(states_.front().state);
    states_.pop_front();
  }
}

LiveState LiveStates::take(std::uint64_t id) {
  const auto found = std::ranges::find(states_, id, &LiveState::id);
  if (found == states_.end())
    throw InputError("there is no kept state " + std::to_string(id) + "; the oldest are dropped");
  LiveState taken = std::move(*found);
  states_.erase(found, states_.end());
  return taken;
}

LiveState LiveStates::take_last_action() {
  for (auto kept = states_.rbegin(); kept != states_.rend(); ++kept)
    if (kept->is_before_action) return take(kept->id);
  throw InputError("there is no action to take back");
}

nlohmann::json LiveStates::list() const {
  auto list = nlohmann::json::array();
  for (const LiveState& kept : states_)
    list.push_back({{"id", kept.id},
                    {"name", kept.name},
                    {"action", kept.is_before_action},
                    {"time", kept.time},
                    {"step", kept.step}});
  return list;
}

}  // namespace suture
