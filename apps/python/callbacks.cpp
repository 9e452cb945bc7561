// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/python/callbacks.hpp"

#include <algorithm>
#include <cmath>

#include "apps/python/session.hpp"

namespace suture::python {
namespace {

// A person who waits after Ctrl-C does not notice it; the GIL in every step would let other threads
// slow the run down.
constexpr auto between_signals = std::chrono::milliseconds(20);

}  // namespace

void Callbacks::add_every(std::uint64_t steps, py::function call) {
  entries_.push_back({.every = steps, .call = std::move(call)});
}

void Callbacks::add_at(double time, py::function call) {
  entries_.push_back({.at = time, .call = std::move(call)});
}

bool Callbacks::Entry::is_due(std::uint64_t step, double time) const {
  if (every > 0) return step != last && step % every == 0;
  // Steps of dt end at sums that are rounded.
  return !done && time >= at - 1e-12 * std::max(1.0, std::abs(at));
}

bool Callbacks::is_due(std::uint64_t step, double time) const {
  return std::ranges::any_of(entries_, [&](const Entry& e) { return e.is_due(step, time); });
}

void Callbacks::call_due(std::uint64_t step, double time, const py::object& simulation) {
  for (std::size_t i = 0; i < entries_.size(); ++i) {  // a callback may add others
    if (!entries_[i].is_due(step, time)) continue;
    entries_[i].last = step;
    entries_[i].done = true;
    const py::function call = entries_[i].call;
    call(simulation);
  }
}

void Callbacks::rewind(std::uint64_t step, double time) {
  for (Entry& entry : entries_) {
    entry.last = step;
    entry.done = false;
    entry.done = step > 0 && entry.is_due(step, time);
  }
}

int Callbacks::traverse(visitproc visit, void* argument) const {
  for (const Entry& entry : entries_)
    if (const int stop = visit(entry.call.ptr(), argument)) return stop;
  return 0;
}

template <class F>
void Observing::call(F&& f) {
  const py::gil_scoped_acquire lock;
  in_callback = true;
  try {
    f();
  } catch (...) {
    failure = std::current_exception();
  }
  in_callback = false;
}

void Observing::on_message(const std::string& text) {
  messages.push_back(text);
  if (live) live->report(text);
}

void Observing::on_progress(const Progress& now) {
  if (!progress || failure || now.iteration > 0)
    return;  // the state within a step is not one to see
  call([&] { progress(now.step, now.time, now.end); });
}

bool Observing::stop_requested() {
  if (live) live->watch();
  if (session_.kept_steps() != nullptr) session_.kept_steps()->keep();
  if (session_.followed() != nullptr && !failure) call([&] { session_.followed()->follow(); });
  const std::uint64_t step = session_.steps();
  const double time = session_.time();
  if (!failure && callbacks.is_due(step, time))
    call([&] { callbacks.call_due(step, time, py::cast(&session_)); });
  look_for_signals();
  return failure != nullptr;
}

bool Observing::gives_up_step() {
  look_for_signals();
  return failure != nullptr;
}

void Observing::look_for_signals() {
  const auto now = Clock::now();
  if (failure || now <= signals_due_) return;
  call([] {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  });
  signals_due_ = now + between_signals;
}

}  // namespace suture::python
