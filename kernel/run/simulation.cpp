// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/simulation.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/base/heap.hpp"
#include "kernel/dynamics/rest_search.hpp"
#include "kernel/run/decisions.hpp"
#include "kernel/run/event_schedule.hpp"
#include "kernel/run/free_bodies.hpp"
#include "kernel/run/hourglass_watch.hpp"
#include "kernel/run/sleeper.hpp"
#include "kernel/run/stability.hpp"
#include "kernel/run/step_control.hpp"

namespace suture {
namespace {

using Wall = std::chrono::steady_clock;

double seconds_since(Wall::time_point start) {
  return std::chrono::duration<double>(Wall::now() - start).count();
}

constexpr std::uint64_t rest_step_limit = 10'000'000;
// Times that an automatic dt must hit.
std::vector<double> stops_of(const Scene& scene) {
  std::vector<double> stops{scene.gravity_ramp.from, scene.gravity_ramp.to};
  for (const Event& event : scene.events) {
    for (const double time : {event.start(), event.finish()})
      if (std::isfinite(time)) stops.push_back(time);
  }
  const auto add = [&](const TimeRamp& ramp) { stops.insert(stops.end(), {ramp.from, ramp.to}); };
  for (const Constraint& constraint : scene.constraints) add(constraint.ramp);
  for (const Load& load : scene.loads) add(load.ramp);
  return stops;
}

std::string provenance_of(const Scene& scene, PluginHost& host, const World& world) {
  std::ostringstream text;
  text << "suture " SUTURE_VERSION "; scene " << scene.file.filename().string() << ' ' << scene.hash
       << "; mesh " << world.mesh_source << ';';
  for (const ModelUse& use : scene.models) {
    const suture_plugin& plugin = host.plugin_of(*use.model);
    text << ' ' << use.model->id << " (" << plugin.id << ' ' << plugin.version << ", "
         << host.file_of(*use.model).filename().string() << ");";
  }
  text << " threads " << world.dynamics->forces().threads() << "; "
       << world.dynamics->forces().isa();
  return text.str();
}

}  // namespace

struct Simulation::Impl {
  Impl(const Scene& s, PluginHost& host, Diagnostics& d, bool skip)
      : diagnostics(d),
        world(s, d, skip),
        recorder(scene, world, provenance_of(s, host, world)),
        schedule(scene.events, world),
        events(scene, world, d),
        control(
            scene, world, recorder, schedule, events,
            Clock(s.solver.dt, stops_of(s), s.output.enabled ? s.output.every : 0, s.solver.end),
            d),
        sleeper(s.solver, world),
        stability(scene, world, recorder, d) {
    Decision still = decide_still_cells(scene, world, recorder);
    decisions = decide(scene, host, world, recorder);
    decisions.push_back(std::move(still));
    decisions.push_back(decide_neighbours(scene, world, recorder));
    if (scene.solver.until_rest) {
      rest.emplace(scene.solver.tolerance, scene.solver.automatic_damping);
      rest->wait_until(schedule.settled_after());
    }
    world.dynamics->start();
    if (rest) look_for_free_bodies(scene, world, diagnostics);
    control.start();
    trim_heap();  // of the search
  }

  Vec3 gravity_now() const {
    Vec3 g = scene.gravity;
    for (double& component : g) component *= scene.gravity_ramp.value(clock.time());
    return g;
  }

  // ---- events ----

  void fire_events(Observer& observer) {
    for (const std::size_t i : schedule.due(clock)) {
      try {
        tell(events.fire(i, clock.time()), observer);
      } catch (const NumericalError& error) {
        std::ostringstream when;
        when << "t = " << clock.time() << " s: ";
        const std::string text = error.what();
        throw NumericalError(text.starts_with("t = ") ? text : when.str() + text);
      }
    }
  }

  // The cells are others: so are the islands and the stable step.
  void tell(const EventOutcome& outcome, Observer& observer) {
    if (!outcome.changed()) return;
    summary.faces_cut += outcome.faces_cut;
    summary.faces_torn += outcome.faces_torn;
    summary.faces_sewn += outcome.faces_sewn;
    summary.elements_removed += outcome.elements_removed;
    sleeper.woken();
    cells_changed = true;
    control.after_event();
    const Index islands = world.islands().existing();
    std::ostringstream text;
    text << "t = " << clock.time() << " s: " << outcome.text() << ", " << islands
         << (islands == 1 ? " island" : " islands");
    observer.on_message(text.str());
  }

  void tell_of_sleep(Observer& observer) {
    if (sleeper.look(clock.step()) == 0) return;
    control.commit();
    std::ostringstream text;
    text << "t = " << clock.time() << " s: " << sleeper.sleeping() << " of "
         << world.islands().existing() << " islands sleep";
    observer.on_message(text.str());
  }

  // ---- records ----

  bool frame_is_due() const {
    const OutputOptions& output = scene.output;
    if (!recorder.writes_frames()) return false;
    if (clock.step() == 0) return true;
    if (output.every_steps > 0) return clock.step() % output.every_steps == 0;
    return output.every > 0 &&
           clock.reached(static_cast<double>(recorder.frames_written()) * output.every);
  }

  void write_frame() {
    world.dynamics->synchronise();
    recorder.frame(clock.step(), clock.time(), gravity_now());
    last_frame_step = clock.step();
  }

  void record() {
    if (frame_is_due()) write_frame();
    record_tables(false);
  }

  /// The rows that are due; `last`: of every table that has none of this step.
  void record_tables(bool last) {
    const OutputOptions& output = scene.output;
    const auto due = [&](std::uint64_t every, std::uint64_t& row) {
      if (row == clock.step() || (!last && clock.step() % every != 0)) return false;
      row = clock.step();
      return true;
    };
    if (recorder.writes_energies() && due(output.energies_every, last_energies_step))
      recorder.energies(clock.step(), clock.time(), control.last_dt(), world.dynamics->balance());
    if (recorder.writes_probes() && due(output.probes_every, last_probes_step)) {
      if (recorder.probes_need(&FieldChoice::needs_force))
        world.dynamics->synchronise();
      else
        world.dynamics->synchronise_velocities();
      recorder.probes(clock.step(), clock.time(), gravity_now());
    }
  }

  void finish() {
    if (recorder.writes_frames() && last_frame_step != clock.step()) write_frame();
    record_tables(true);
    recorder.release(clock.step());
    recorder.finish();
  }

  // ---- the loop ----

  void step(Observer& observer) {
    control.step([&](const std::string& text) { observer.on_message(text); });
    follow_step_back();
  }

  /// As StepControl::tries().
  bool tries(const std::function<void()>& look, Observer& observer) {
    const bool good =
        control.tries(look, [&](const std::string& text) { observer.on_message(text); });
    follow_step_back();
    return good;
  }

  /// After a step back what comes again is recorded again. The present state was recorded
  /// before it was kept.
  void follow_step_back() {
    for (std::uint64_t* mark : {&last_frame_step, &last_energies_step, &last_probes_step})
      if (*mark > clock.step()) *mark = never;
    if (recorded_step != never) recorded_step = std::min(recorded_step, clock.step());
  }

  /// False where the body does not bear what an event would have taken from it: steps
  /// that are only timed know no events.
  bool tries_step() {
    try {
      control.make_step();
      control.watch().after_step(clock.step());
      return true;
    } catch (const NumericalError&) {
      return false;
    }
  }

  bool is_at_end(Observer& observer) {
    if (clock.finished()) {
      if (!ends_well(observer)) return false;
      summary.outcome = RunSummary::Outcome::finished;
      if (rest) {
        std::ostringstream text;
        text << "not at rest at /solver/end, t = " << clock.time() << " s: the residual is "
             << rest->residual() << ", asked for " << rest->tolerance();
        diagnostics.warn(text.str());
      }
      return true;
    }
    if (rest && clock.step() > 0 && is_at_rest(observer)) return true;
    const std::uint64_t limit = scene.solver.max_steps ? scene.solver.max_steps
                                : rest                 ? rest_step_limit
                                                       : 0;
    if (limit == 0 || clock.step() < limit) return false;
    refuse_more_steps(limit);
  }

  /// An event may have cut a piece off that now falls for ever.
  void require_no_falling_body() {
    cells_changed = false;
    const std::string body = falling_body(scene, world);
    if (!body.empty())
      throw NumericalError("no rest: " + body +
                           "; remove it (remove_islands), hold it, or give /solver/end");
  }

  bool is_at_rest(Observer& observer) {
    if (cells_changed && !scene.solver.end) require_no_falling_body();
    bool rests = false;
    if (!tries([&] { rests = rest->at_rest(*world.dynamics); }, observer)) return false;
    if (rests) {
      if (!ends_well(observer)) return false;
      if (rest->limited_by_rounding()) diagnostics.warn(rest->explanation(*world.dynamics));
      return ends_at_rest(observer);
    }
    if (rest->stagnates() && !scene.solver.end)
      throw NumericalError(rest->explanation(*world.dynamics));
    return false;
  }

  /// False after a kick.
  bool ends_at_rest(Observer& observer) {
    const auto verdict = stability.examine(*rest, clock.step(), clock.time(), gravity_now());
    summary.lowest_eigenvalue = stability.lowest_eigenvalue();
    if (verdict == Stability::Verdict::kicked) {
      control.commit();
      rest->restart();
      return false;
    }
    if (verdict == Stability::Verdict::stable) observer.on_message(stability.text());
    summary.outcome = verdict == Stability::Verdict::unstable
                          ? RunSummary::Outcome::unstable_equilibrium
                          : RunSummary::Outcome::at_rest;
    return true;
  }

  bool ends_well(Observer& observer) {
    const bool good =
        control.ends_well([&](const std::string& text) { observer.on_message(text); });
    follow_step_back();
    return good;
  }

  [[noreturn]] void refuse_more_steps(std::uint64_t limit) const {
    std::ostringstream text;
    if (rest)
      text << "not at rest after " << limit << " steps: the residual is " << rest->residual()
           << ", asked for " << rest->tolerance()
           << "; raise /solver/max_steps or /solver/tolerance, or damp more";
    else
      text << "t = " << clock.time() << " s after " << limit << " steps, and /solver/end is "
           << *scene.solver.end << " s; raise /solver/max_steps or dt";
    throw NumericalError(text.str());
  }

  void report(Observer& observer, Wall::time_point start, std::uint64_t first_step) {
    Progress progress;
    progress.step = clock.step();
    progress.time = clock.time();
    progress.end = scene.solver.end.value_or(0);
    if (rest) {
      progress.residual = rest->residual();
      progress.tolerance = rest->tolerance();
    }
    const double spent = seconds_since(start);
    const auto steps = static_cast<double>(clock.step() - first_step);
    progress.elements_per_second = spent > 0 ? steps * world.complex().element_count() / spent : 0;
    if (progress.end > 0 && clock.time() > 0 && !rest) {
      progress.seconds_left = spent * (progress.end - clock.time()) / clock.time();
    }
    observer.on_progress(progress);
  }

  /// Until `until`, or the end of the scene. Things due at a time come in the
  /// order events, records, step: a frame shows what an event at its time did.
  void loop(std::optional<double> until, Observer& observer) {
    const Wall::time_point start = Wall::now();
    Wall::time_point reported = start;
    const std::uint64_t first_step = clock.step();
    while (true) {
      fire_events(observer);
      if (recorded_step != clock.step() && !tries([&] { record(); }, observer)) continue;
      recorded_step = clock.step();
      if (is_at_end(observer) || (until && clock.reached(*until))) break;
      if (observer.stop_requested()) {
        summary.outcome = RunSummary::Outcome::interrupted;
        break;
      }
      step(observer);
      tell_of_sleep(observer);
      if (clock.step() % 16 == 0 && seconds_since(reported) > 0.1) {
        report(observer, start, first_step);
        reported = Wall::now();
      }
    }
    summary.seconds += seconds_since(start);
  }

  RunSummary run(Observer& observer) {
    try {
      loop(std::nullopt, observer);
    } catch (...) {
      recorder.release(clock.step());  // what stands: a step that failed has taken its own back
      recorder.finish();
      throw;
    }
    events.finish();
    const bool rests = summary.outcome != RunSummary::Outcome::finished &&
                       summary.outcome != RunSummary::Outcome::interrupted;
    if (const std::string text = hourglass_warning(scene, world, rests); !text.empty())
      diagnostics.warn(text);
    finish();
    if (const std::string text = control.balance_warning(); !text.empty()) diagnostics.warn(text);
    const EnergyBalance& energies = control.guard().last();
    if (energies.exchanged > control.guard().noise()) {
      summary.balance = energies.balance;
      summary.exchanged = energies.exchanged;
    }
    summary.steps_back = control.steps_back();
    summary.steps = clock.step();
    summary.time = clock.time();
    summary.dt = control.last_dt();
    summary.frames = recorder.frames_written();
    summary.inverted_elements = control.guard().inverted_elements();
    summary.threads = world.dynamics->forces().threads();
    if (summary.seconds > 0) {
      summary.elements_per_second =
          static_cast<double>(summary.steps) * world.complex().element_count() / summary.seconds;
    }
    summary.pvd = recorder.collection();
    return summary;
  }

  std::uint64_t steps_to_rest(double budget);

  Diagnostics& diagnostics;
  World world;
  const Scene& scene = world.scene;  ///< in the body's frame
  Recorder recorder;
  EventSchedule schedule;
  EventRunner events;
  StepControl control;
  const Clock& clock = control.clock();
  Sleeper sleeper;
  Stability stability;
  std::optional<RestSearch> rest;
  std::vector<Decision> decisions;
  RunSummary summary;
  bool cells_changed = false;  // since the last look for falling pieces
  static constexpr std::uint64_t never = ~std::uint64_t{0};
  std::uint64_t recorded_step = never, last_frame_step = never, last_energies_step = never,
                last_probes_step = never;
};

Simulation::Simulation(const Scene& scene, PluginHost& host, Diagnostics& diagnostics, bool skip)
    : impl_(std::make_unique<Impl>(scene, host, diagnostics, skip)) {}

Simulation::~Simulation() = default;

RunSummary Simulation::run(Observer& observer) { return impl_->run(observer); }

void Simulation::run_to(double time, Observer& observer) { impl_->loop(time, observer); }

void Simulation::apply(const Event& event, Observer& observer) {
  impl_->world.complex().require_beta3();
  const Event local = in_frame(event, impl_->world.frame);
  impl_->tell(impl_->events.apply(local, impl_->clock.time()), observer);
}

Dynamics::Energies Simulation::energies() { return impl_->world.dynamics->energies(); }

const std::vector<Decision>& Simulation::decisions() const { return impl_->decisions; }

const CellComplex& Simulation::complex() const {
  impl_->world.complex().require_beta3();
  return impl_->world.complex();
}

Attributes& Simulation::attributes() { return impl_->world.attributes; }

Vec3 Simulation::origin() const { return impl_->world.frame.origin; }

Vec3 Simulation::mean_displacement(const Selection& selection) const {
  const Selection local = in_frame(selection, impl_->world.frame);
  const std::vector<Index> vertices = impl_->world.selector.vertices(local);
  const Column &x = impl_->world.attributes.position(), &rest = impl_->world.attributes.rest();
  Vec3 mean{};
  for (const Index v : vertices) {
    for (int a = 0; a < 3; ++a) {
      mean[static_cast<std::size_t>(a)] +=
          (x.get(v, a) - rest.get(v, a)) / static_cast<double>(vertices.size());
    }
  }
  return mean;
}

namespace {

/// Frames that are in memory at once: one is filled, one written, two wait.
constexpr double frames_alive = 4;
/// What the writer takes when it is at work (VTK's objects, its thread), measured.
constexpr double writer_bytes = 3e6;

std::uint64_t frames_until(const Scene& scene, double end, std::uint64_t steps) {
  const OutputOptions& output = scene.output;
  if (output.every_steps > 0) return 1 + steps / output.every_steps;
  return output.every > 0 ? 1 + static_cast<std::uint64_t>(std::ceil(end / output.every - 1e-9))
                          : 2;
}

}  // namespace

/// Steps until rest from those made: the residual falls by a factor per step.
std::uint64_t Simulation::Impl::steps_to_rest(double budget) {
  const Wall::time_point start = Wall::now();
  std::uint64_t middle_step = 0;
  double middle_residual = 0;
  while (seconds_since(start) < budget && tries_step()) {
    if (rest->at_rest(*world.dynamics)) return clock.step();
    if (middle_step == 0 && seconds_since(start) > budget / 2) {
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

Estimate Simulation::estimate() {
  Impl& impl = *impl_;
  Estimate estimate;
  impl.control.watch().search(0);
  estimate.stable_dt = impl.control.watch().stable();
  estimate.dt = impl.control.next_dt();
  const auto bytes = static_cast<double>(impl.recorder.rehearse(0, impl.gravity_now()));
  Wall::time_point start = Wall::now();
  impl.recorder.rehearse(0, impl.gravity_now());  // the first one loaded the writer
  const double frame_seconds = seconds_since(start);
  start = Wall::now();
  const double end = impl.scene.solver.end.value_or(0);
  if (impl.rest) {
    estimate.steps = impl.steps_to_rest(1.0);
  } else {
    while (seconds_since(start) < 0.2 && !impl.clock.finished() && impl.tries_step()) continue;
    estimate.steps = static_cast<std::uint64_t>(std::ceil(end / estimate.dt - 1e-9));
  }
  estimate.seconds_per_step = seconds_since(start) / static_cast<double>(impl.clock.step());
  if (impl.recorder.writes_frames() && estimate.steps > 0) {
    const double last = impl.rest ? static_cast<double>(estimate.steps) * estimate.dt : end;
    estimate.frames = frames_until(impl.scene, last, estimate.steps);
  }
  estimate.seconds = static_cast<double>(estimate.steps) * estimate.seconds_per_step +
                     static_cast<double>(estimate.frames) * frame_seconds;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  estimate.bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
  if (bytes > 0) estimate.bytes += writer_bytes + (frames_alive - 1) * bytes;
  return estimate;
}

}  // namespace suture
