// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/event_schedule.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/base/vec3.hpp"

namespace suture {

EventSchedule::EventSchedule(const std::vector<Event>& events, BuiltScene& built)
    : events_(events), built_(built), states_(events.size()) {
  for (std::size_t i = 0; i < events.size(); ++i) {
    (events[i].is_timed() ? timed_ : others_).push_back(i);
    if (events[i].when) states_[i].vertices = built.selector().vertices(events[i].when->where);
  }
}

double EventSchedule::last_change() const {
  double last = 0;
  for (const Event& event : events_)
    if (std::isfinite(event.finish())) last = std::max(last, event.finish());
  return last;
}

void EventSchedule::state(Archive& archive) {
  archive("next timed", next_timed_);
  archive.member("done", states_, &State::done);
  archive.member("last step", states_, &State::last_step);
}

std::vector<std::size_t> EventSchedule::due(const Clock& clock) {
  std::vector<std::size_t> now;
  for (; next_timed_ < timed_.size(); ++next_timed_) {
    if (!clock.reached(events_[timed_[next_timed_]].at)) break;
    now.push_back(timed_[next_timed_]);
  }
  for (const std::size_t i : others_) {
    State& state = states_[i];
    if (state.done || state.last_step == clock.step() || !is_due(i, clock)) continue;
    state.last_step = clock.step();
    now.push_back(i);
  }
  std::ranges::sort(now);
  return now;
}

bool EventSchedule::is_due(std::size_t i, const Clock& clock) {
  const Event& event = events_[i];
  State& state = states_[i];
  if (event.when) {
    state.done = clock.step() % event.when->every == 0 && holds(i);
    return state.done;
  }
  if (!clock.reached(event.start())) return false;
  // The last time is due still, what comes after it is not.
  const double last = event.finish();
  if (event.every > 0) {
    state.done = clock.passed(last);
    return !state.done && clock.step() % event.every == 0;
  }
  state.done = clock.time() >= last;  // not half a step earlier: the blade goes all its way
  return true;
}

/// The mean over the nodes that are left; nothing is left: no.
bool EventSchedule::holds(std::size_t i) const {
  const Condition& condition = *events_[i].when;
  Attributes& a = built_.body().attributes();
  const Column& value = condition.of == Condition::Of::velocity ? a.velocity() : a.position();
  Vec3 mean{};
  double count = 0;
  for (const Index v : states_[i].vertices) {
    if (!built_.body().complex().exists(0, v)) continue;
    ++count;
    for (int c = 0; c < 3; ++c) {
      const double start = condition.of == Condition::Of::displacement ? a.rest().get(v, c) : 0;
      mean[static_cast<std::size_t>(c)] += value.get(v, c) - start;
    }
  }
  if (count == 0) return false;
  for (double& component : mean) component /= count;
  if (condition.of == Condition::Of::position && condition.component == 3)
    mean = minus(mean, condition.zero);
  const double observed = condition.component < 3
                              ? mean[static_cast<std::size_t>(condition.component)]
                              : std::hypot(mean[0], mean[1], mean[2]);
  return condition.above ? observed > condition.bound : observed < condition.bound;
}

}  // namespace suture
