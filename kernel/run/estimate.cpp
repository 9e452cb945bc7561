// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "kernel/base/saturate.hpp"
#include "kernel/run/run_loop.hpp"
#include "kernel/run/simulation.hpp"

namespace suture {
namespace {

using Wall = std::chrono::steady_clock;

double elapsed_since(Wall::time_point start) {
  return std::chrono::duration<double>(Wall::now() - start).count();
}

/// Frames that are in memory at once: one being filled, one being written, two waiting.
constexpr double frames_alive = 4;
/// Memory of the writer while it works (VTK's objects, its thread), measured.
constexpr double writer_bytes = 3e6;

std::uint64_t frames_until(const Scene& scene, double end, std::uint64_t steps) {
  const OutputOptions& output = scene.output;
  if (output.every_steps > 0) return 1 + steps / output.every_steps;
  return output.every > 0 ? saturate<std::uint64_t>(1 + std::ceil(end / output.every - 1e-9)) : 2;
}

/// Estimates the steps until rest from those made: the residual falls by a factor per step.
std::uint64_t steps_to_rest(RunLoop& run, double budget) {
  const Clock& clock = run.control().clock();
  RestSearch* rest = run.ending().rest();
  const Wall::time_point start = Wall::now();
  std::uint64_t middle_step = 0;
  double middle_residual = 0;
  while (elapsed_since(start) < budget && run.try_step()) {
    if (rest->at_rest(run.built().dynamics())) return clock.step();
    if (middle_step == 0 && elapsed_since(start) > budget / 2) {
      middle_step = clock.step();
      middle_residual = rest->residual();
    }
  }
  const auto steps = static_cast<double>(clock.step() - middle_step);
  const double rate = std::log(middle_residual / rest->residual()) / steps;
  if (middle_step == 0 || !(rate > 0)) return 0;
  const double left = std::log(rest->residual() / rest->tolerance()) / rate;
  return clock.step() + static_cast<std::uint64_t>(std::max(left, 0.0));
}

/// Steps that follow their error begin short: makes some, and takes the others to be like the last.
std::uint64_t steps_by_error(RunLoop& run, double end, double budget) {
  const Clock& clock = run.control().clock();
  const Wall::time_point start = Wall::now();
  while (elapsed_since(start) < budget && !clock.finished() && run.try_step()) continue;
  const double left = std::max(end - clock.time(), 0.0) / run.control().last_dt();
  return clock.step() + saturate<std::uint64_t>(std::ceil(left - 1e-9));
}

/// The steps of a run during which an event repeats (a moving blade, a tear).
struct ActiveSteps {
  double duration;          ///< s of the simulation
  double dt;                ///< s, after the event
  double seconds_of_event;  ///< per step
};

/// Performs the event in the middle of its time span, in several consecutive steps. This may change
/// the body, which is used for the estimate only.
ActiveSteps measure_event(RunLoop& run, std::size_t i, double end, double seconds_per_step) {
  constexpr int max_steps = 64;
  constexpr double budget = 0.3;  // s
  const Event& event = run.built().scene().events[i];
  const double from = event.start(), to = std::min(event.finish(), end);
  double time = (from + to) / 2;
  run.rehearse(i, time);  // a blade cuts from its last position on
  const Wall::time_point start = Wall::now();
  int steps = 0;
  while (steps < max_steps && elapsed_since(start) < budget && run.try_step()) {
    time += run.control().last_dt();
    run.rehearse(i, time);
    ++steps;
  }
  const double seconds = elapsed_since(start) / std::max(steps, 1) - seconds_per_step;
  return {std::max(to - from, 0.0), run.control().next_dt(),
          std::max(seconds, 0.0) / static_cast<double>(std::max<std::uint64_t>(event.every, 1))};
}

/// Adds repeated events to the estimate of a run without them.
void add_events(RunLoop& run, double end, Estimate& estimate) {
  const std::vector<Event>& events = run.built().scene().events;
  for (std::size_t i = 0; i < events.size(); ++i) {
    if (!events[i].repeats()) continue;
    const ActiveSteps active = measure_event(run, i, end, estimate.seconds_per_step);
    const double steps = active.duration / active.dt;
    estimate.steps += saturate<std::uint64_t>(steps - active.duration / estimate.dt);
    estimate.seconds += steps * active.seconds_of_event;
  }
}

}  // namespace

Estimate Simulation::estimate() {
  RunLoop& run = *run_;
  const Clock& clock = run.control().clock();
  const Scene& scene = run.built().scene();
  Estimate estimate;
  run.make_ready();
  run.control().watch().search(0);
  estimate.stable_dt = run.control().watch().stable();
  estimate.dt = run.control().next_dt();
  const auto bytes = static_cast<double>(run.recorder().rehearse(0, run.records().gravity()));
  Wall::time_point start = Wall::now();
  run.recorder().rehearse(0, run.records().gravity());  // the first call loaded the writer
  const double frame_seconds = elapsed_since(start);
  start = Wall::now();
  const double end = scene.solver.end.value_or(0);
  if (run.ending().rest()) {
    estimate.steps = steps_to_rest(run, 1.0);
  } else if (run.control().accuracy()) {
    estimate.steps = steps_by_error(run, end, 1.0);
    estimate.dt = end / static_cast<double>(estimate.steps);
    estimate.dt_follows_error = true;
  } else {
    while (elapsed_since(start) < 0.2 && !clock.finished() && run.try_step()) continue;
    estimate.steps = saturate<std::uint64_t>(std::ceil(end / estimate.dt - 1e-9));
  }
  estimate.seconds_per_step = elapsed_since(start) / static_cast<double>(clock.step());
  if (!run.ending().rest()) add_events(run, end, estimate);
  if (run.recorder().writes_frames() && estimate.steps > 0) {
    const double last =
        run.ending().rest() ? static_cast<double>(estimate.steps) * estimate.dt : end;
    estimate.frames = frames_until(scene, last, estimate.steps);
  }
  estimate.seconds += static_cast<double>(estimate.steps) * estimate.seconds_per_step +
                      static_cast<double>(estimate.frames) * frame_seconds;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  estimate.bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
  if (bytes > 0) estimate.bytes += writer_bytes + (frames_alive - 1) * bytes;
  return estimate;
}

}  // namespace suture
