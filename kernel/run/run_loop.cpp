// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/run_loop.hpp"

#include <cmath>
#include <exception>
#include <new>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/base/heap.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/base/safe_range.hpp"
#include "kernel/build/check_obstacles.hpp"
#include "kernel/build/check_parts.hpp"
#include "kernel/forces/contact_law.hpp"
#include "kernel/output/output_folder.hpp"
#include "kernel/plugin_host/plugin_call.hpp"
#include "kernel/processes/process_share.hpp"
#include "kernel/results/frame_parts.hpp"
#include "kernel/run/notes_on_steps.hpp"
#include "kernel/run/shared_run.hpp"
#include "kernel/run/steering.hpp"
#include "kernel/run/stops.hpp"
#include "kernel/run/within_steps.hpp"
#include "kernel/steps/free_bodies.hpp"
#include "kernel/steps/hourglass_watch.hpp"

namespace suture {
namespace {

using Wall = std::chrono::steady_clock;

double seconds_since(Wall::time_point start) {
  return std::chrono::duration<double>(Wall::now() - start).count();
}

Clock clock_of(const Scene& scene) {
  return {scene.solver.dt, stops_of(scene), scene.output.enabled ? scene.output.every : 0,
          scene.solver.end};
}

void report_events(const std::vector<std::string>& lines, Observer& observer) {
  for (const std::string& line : lines) observer.on_message(line);
}

StepControl::Notify notify_to(Observer& observer) {
  return [&](const std::string& text) { observer.on_message(text); };
}

}  // namespace

RunLoop::RunLoop(const Scene& scene, PluginHost& host, Diagnostics& diagnostics, bool skip,
                 std::shared_ptr<OutputFolder> folder, bool check_plugins, Communicator* processes)
    : host_(host),
      diagnostics_(diagnostics),
      built_(scene, diagnostics, skip),
      events_(scene_, built_, diagnostics),
      recorder_(scene_, built_, events_, provenance_of(host, built_), std::move(folder)),
      schedule_(scene_.events, built_),
      control_(scene_, built_, recorder_, schedule_, events_, clock_of(scene), diagnostics),
      records_(built_, recorder_, clock_),
      sleeper_(scene.solver, built_),
      ending_(built_, schedule_, control_, recorder_, diagnostics),
      checkpoints_(built_, host, recorder_.folder()),
      was_skipped_(scene_.events.size()),
      processes_(processes) {
  Decision fixed_cells = decide_fixed_cells(scene_, built_, recorder_);
  decisions_ = decide(scene_, host, built_, recorder_);
  decisions_.push_back(std::move(fixed_cells));
  if (check_plugins) built_.body().check_plugins();  // before the first force
  if (processes) share(*processes);
  built_.dynamics().start();
  built_.dynamics().motion().release_rows_of_others();
  if (ending_.rest()) check_free_bodies(scene_, built_, diagnostics);
  if (built_.dynamics().is_static()) require_held_bodies();
  control_.start();
  if (scene_.solver.budget) built_.dynamics().prepare(control_.next_dt());
  if (built_.dynamics().newton()) decisions_.push_back({"linear solver", false, describe_solver()});
  if (check_plugins) check_bounds();
  deliver_plugin_warnings(diagnostics);
  trim_heap();  // of the search
}

void RunLoop::share(Communicator& processes) {
  require_shareable(scene_);
  require_same_run(processes, scene_, checkpoint_header(built_, host_));
  Body& body = built_.body();
  body.share(
      std::make_unique<ProcessShare>(processes, body.models().workers().threads(), body.complex()));
  body.attributes().partial_rows().keeps_all = scene_.checkpoint.enabled && processes.rank() == 0;
}

/// A fixed dt does not need the bounds of the stable step.
void RunLoop::check_bounds() {
  try {
    built_.limits().bounds(clock_.time());
  } catch (const NoStepBound&) {
  }
}

std::string RunLoop::describe_solver() {
  const std::string text = built_.dynamics().describe_solver(control_.next_dt());
  return control_.accuracy() ? text + "; for the first step, and chosen again for each" : text;
}

void RunLoop::require_held_bodies() {
  if (scene_.solver.hold_free_pieces) return;
  const std::string body = describe_unheld_body(built_);
  if (!body.empty())
    throw InputError("/constraints: " + body +
                     ", so it has no equilibrium of its own; constrain it, set "
                     "/solver/static/free_pieces to \"hold\", or replace /solver/static by an "
                     "integrator");
}

// ------------------------------------------------------------------- events --

/// At an equilibrium that an event has led to, more events may be due. False if the run went back
/// to an earlier step instead.
bool RunLoop::fire_events(Observer& observer, const StepControl::Notify& notify) {
  do {
    if (!fire_due_events(observer, notify)) return false;
  } while (balance(notify));
  return true;
}

/// In a static run, what is recorded after the start is an equilibrium, and so is the end. True if
/// it was found again.
bool RunLoop::balance(const StepControl::Notify& notify) {
  if (!is_unbalanced_ || !built_.dynamics().is_static() || clock_.step() == 0) return false;
  if (records_.are_done() && !clock_.finished()) return false;  // the next step follows
  find_equilibrium(notify);
  return true;
}

void RunLoop::find_equilibrium(const StepControl::Notify& notify) {
  ending_.check_pieces(notify);
  control_.balance();
  is_unbalanced_ = false;
}

/// False if the run went back to an earlier step, whose events are due again.
bool RunLoop::fire_due_events(Observer& observer, const StepControl::Notify& notify) {
  for (const std::size_t i : schedule_.due(clock_)) {
    bool went_no_further = false;
    try {
      const EventOutcome outcome = events_.fire(i, clock_.time());
      take_over(outcome);
      report(i, outcome, observer);
      went_no_further = outcome.refusal != nullptr;
      if (went_no_further) std::rethrow_exception(outcome.refusal);
    } catch (const Error& error) {
      const bool is_refusal = went_no_further || events_.is_refusal(error);
      if (is_refusal && !stops_at_failure(scene_.events[i])) {
        skip(i, error);
        continue;
      }
      const auto* numerical = dynamic_cast<const NumericalError*>(&error);
      if (!numerical) throw;
      if (is_refusal) throw NumericalError(timed(clock_.time(), error.what()));
      if (events_.has_changed()) control_.commit();
      control_.take_back(*numerical, notify);
      return false;
    }
  }
  return true;
}

void RunLoop::report(std::size_t event, const EventOutcome& outcome, Observer& observer) {
  if (!outcome.changed()) return;
  const Index islands = built_.body().islands().existing();
  report_events(event_report_.add(event, outcome, clock_.time(), islands), observer);
}

bool RunLoop::stops_at_failure(const Event& event) const {
  const OnFailure by_solver = scene_.solver.on_failure;
  return (event.on_failure == OnFailure::by_solver ? by_solver : event.on_failure) ==
         OnFailure::stop;
}

/// Each event is reported once. A blade that was refused cuts no more.
void RunLoop::skip(std::size_t event, const Error& error) {
  const Event& skipped = scene_.events[event];
  ++summary_.events_skipped;
  const bool is_blade = std::holds_alternative<CutBlade>(skipped.what);
  if (is_blade) schedule_.end(event);
  if (std::exchange(was_skipped_[event], 1) != 0) return;
  diagnostics_.warn(timed(clock_.time(), error.what()) +
                    (is_blade ? "; the blade cuts no further" : "; the event is skipped"));
}

/// The cells are others: so are the islands and the stable step.
void RunLoop::take_over(const EventOutcome& outcome) {
  if (!outcome.changed()) return;
  is_unbalanced_ = true;
  if (outcome.nodes_held + outcome.nodes_released > 0) sleeper_.wake_all();
  summary_.faces_cut += outcome.faces_cut;
  summary_.faces_torn += outcome.faces_torn;
  summary_.elements_cut += outcome.elements_cut;
  summary_.faces_sewn += outcome.faces_sewn;
  summary_.elements_removed += outcome.elements_removed;
  control_.after_event();
}

void RunLoop::report_sleep(Observer& observer) {
  if (!sleeper_.check(clock_.step())) return;
  control_.commit();
  observer.on_message(timed(clock_.time(), std::to_string(sleeper_.sleeping()) + " of " +
                                               std::to_string(built_.body().islands().existing()) +
                                               " islands asleep"));
}

EventOutcome RunLoop::apply(const Event& event, Observer& observer) {
  check_parts(event, built_.body().attributes().parts().may_grow());
  const EventOutcome outcome = events_.apply(in_frame(event, built_.frame()), clock_.time());
  take_over(outcome);
  if (outcome.changed())
    observer.on_message(event_line(outcome, clock_.time(), built_.body().islands().existing()));
  return outcome;
}

namespace {

void require_finite(const Column& column, const char* what, const BuiltScene& built) {
  for (Index v = 0; v < column.size(); ++v)
    for (int c = 0; c < 3; ++c) {
      if (std::isfinite(column.get(v, c))) continue;
      throw InputError(std::string(what) + " of node " +
                       std::to_string(built.names().point_id(built.body().user_vertex()[v])) +
                       " is not finite; nothing was changed");
    }
}

}  // namespace

void RunLoop::change_motion(const std::function<void(Attributes&)>& change) {
  Attributes& attributes = built_.body().attributes();
  const Column position = attributes.position(), velocity = attributes.velocity();
  const auto restore = [](Column& column, const Column& earlier) {
    std::copy_n(earlier.rows(), std::size_t{earlier.size()} * 4, column.rows());
  };
  std::exception_ptr failure;
  sleeper_.wake_all();
  control_.commit();  // no rollback crosses it
  built_.dynamics().jump([&] {
    try {
      change(attributes);
      require_finite(attributes.position(), "the position", built_);
      require_finite(attributes.velocity(), "the velocity", built_);
      built_.body().constraints().apply(attributes, clock_.time());
      if (ContactLaw* contact = built_.body().contact()) contact->forget_sides();
    } catch (...) {
      failure = std::current_exception();
      restore(attributes.position(), position);
      restore(attributes.velocity(), velocity);
    }
  });
  if (failure) std::rethrow_exception(failure);
  control_.after_jump();
  is_unbalanced_ = true;
}

/// No rollback crosses it: the program that steers would not steer again.
void RunLoop::steer(const std::string& obstacle, const PoseTarget& target) {
  ContactLaw* contact = built_.body().contact();
  Steering steering = steering_to(target, obstacle, contact, clock_.time(), scene_.solver);
  contact->set_path(steering.obstacle, std::move(steering.path));
  built_.redirect(steering.obstacle);
  sleeper_.wake_disturbed();
  control_.commit();
}

void RunLoop::move_grasp(const std::string& grasp, const Vec3& translation, double duration) {
  if (!is_safe_point(translation) || !(duration > 0) || !std::isfinite(duration))
    throw InputError("the motion of grasp '" + grasp +
                     "' needs a finite translation and a duration > 0");
  built_.move_grasp(grasp, translation, clock_.time(), duration);
  sleeper_.wake_all();
  control_.commit();
  is_unbalanced_ = true;
}

ForceTerm& RunLoop::add_term(std::unique_ptr<ForceTerm> term) {
  if (recorder_.writes_energies())
    throw InputError("energies.csv has no column for the work of '" + std::string(term->name()) +
                     "'; remove /output/energies, or run without output");
  const auto* tangent = dynamic_cast<const TangentTerm*>(term.get());
  if (built_.dynamics().is_implicit() && tangent && !tangent->has_tangent())
    throw InputError("the integrator needs the derivatives of all forces, and '" +
                     std::string(term->name()) + "' has none; use an explicit integrator");
  Attributes& attributes = built_.body().attributes();
  AlignedVector<double> rows(std::size_t{attributes.vertex_count()} * 4);
  term->add_forces(clock_.time(), attributes.kernel(0).cells.live(), rows.data());  // may throw
  if (auto* stored = dynamic_cast<EnergyTerm*>(term.get())) stored->energy(clock_.time());
  ForceTerm* added = nullptr;
  sleeper_.wake_all();
  built_.dynamics().jump([&] { added = &built_.body().add(std::move(term)); });
  control_.after_jump();
  is_unbalanced_ = true;
  return *added;
}

// ----------------------------------------------------------------- the loop --

std::optional<RunSummary::Outcome> RunLoop::advance(const Pause& pause, Observer& observer) {
  try {
    return loop(pause, observer);
  } catch (const IoError&) {
    throw;  // what is held back would be written behind a gap
  } catch (const Error&) {
    close_failed(observer);
    throw;
  } catch (const std::bad_alloc&) {
    close_failed(observer);
    throw;
  }
}

void RunLoop::make_ready() {
  if (!std::exchange(is_ready_, true)) events_.make_ready();
}

/// None if the run pauses.
std::optional<RunSummary::Outcome> RunLoop::loop(const Pause& pause, Observer& observer) {
  make_ready();
  const WithinSteps within_steps(
      control_, built_.dynamics(), observer,
      [&](const Newton::Iteration& iteration) { report_progress(observer, &iteration); });
  const StepControl::Notify notify = notify_to(observer);
  began_ = reported_ = Wall::now();
  began_at_ = clock_.step();
  const auto pauses = [&] {
    return (pause.time && clock_.reached(*pause.time)) ||
           (pause.steps && clock_.step() >= began_at_ + *pause.steps);
  };
  std::optional<RunSummary::Outcome> outcome = RunSummary::Outcome::interrupted;
  while (!stops(observer)) {
    try {
      if (!fire_events(observer, notify)) continue;
      if (!record(notify)) continue;
      outcome = ending_.check(notify);
      records_.roll_back();
      if (outcome || pauses()) break;
      outcome = RunSummary::Outcome::interrupted;
      control_.step(notify);
    } catch (const StepAbandoned&) {
      continue;
    }
    is_unbalanced_ = false;
    records_.roll_back();
    report_sleep(observer);
    deliver_plugin_warnings(diagnostics_);
    if (clock_.step() % 16 == 0 || built_.dynamics().is_implicit()) report_progress(observer);
  }
  summary_.seconds += seconds_since(began_);
  if (outcome) summary_.outcome = *outcome;
  return outcome;
}

/// Between two steps: writes a checkpoint that is due, or because the run is to stop.
bool RunLoop::stops(Observer& observer) {
  const bool stops = observer.stop_requested();
  if (checkpoints_.is_due(clock_) || (stops && checkpoints_.is_enabled()))
    checkpoints_.write(clock_, *this);
  return stops;
}

/// False if the run went back to an earlier step instead.
bool RunLoop::record(const StepControl::Notify& notify) {
  if (records_.are_done()) return true;
  const bool good = control_.try_check([&] { records_.record(control_.last_dt()); }, notify);
  records_.roll_back();
  return good;
}

void RunLoop::rehearse(std::size_t event, double time) {
  try {
    take_over(events_.fire(event, time));
  } catch (const Error&) {
    return;  // a state that the run itself may never reach
  }
}

bool RunLoop::try_step() {
  try {
    control_.make_step();
    control_.watch().after_step(clock_.step());
    return true;
  } catch (const NumericalError&) {
    return false;
  }
}

/// At most ten times a second.
void RunLoop::report_progress(Observer& observer, const Newton::Iteration* iteration) {
  if (!(seconds_since(reported_) > 0.1)) return;
  reported_ = Wall::now();
  Progress progress;
  progress.step = clock_.step();
  progress.time = clock_.time();
  progress.end = scene_.solver.end.value_or(0);
  if (const RestSearch* rest = ending_.rest()) {
    progress.residual = rest->residual();
    progress.tolerance = rest->tolerance();
  }
  if (iteration != nullptr) {
    progress.iteration = iteration->number;
    progress.residual = iteration->residual / iteration->scale;
    progress.tolerance = scene_.solver.step_tolerance;
  }
  const double spent = seconds_since(began_);
  const auto steps = static_cast<double>(clock_.step() - began_at_);
  progress.elements_per_second =
      spent > 0 ? steps * built_.body().complex().element_count() / spent : 0;
  if (progress.end > 0 && clock_.time() > 0 && !ending_.rest())
    progress.seconds_left = spent * (progress.end - clock_.time()) / clock_.time();
  observer.on_progress(progress);
}

// ---------------------------------------------------------------- beginning and end --

void RunLoop::resume(const Checkpoint& checkpoint, const std::filesystem::path& file) {
  checkpoints_.resume(checkpoint, file, clock_, *this);
  if (recorder_.begins()) records_.begin_here();
  if (const std::size_t missing = recorder_.missing_frames(); missing > 0)
    diagnostics_.warn(recorder_.folder()->path().string() + ": " + std::to_string(missing) +
                      " of the earlier frames are missing, and the .pvd files do not list them; to "
                      "keep them, resume in the folder where they are");
  first_step_ = clock_.step();
}

/// Writes the pending records; those of the failed step were dropped. Pieces need all processes.
void RunLoop::close_failed(Observer& observer) {
  if (processes_) processes_->meet_error();
  if (processes_ && scene_.output.pieces && !processes_->all_meet_error()) return;
  report_events(event_report_.finish(), observer);
  recorder_.release(clock_.step());
  recorder_.finish();
  checkpoints_.finish();
  recorder_.folder()->close();
}

RunSummary RunLoop::run(Observer& observer) {
  do advance({}, observer);
  while (!record_end(observer));
  finish(observer);
  recorder_.folder()->close();
  summarise();
  return summary_;
}

/// Makes the last records. False if that failed and the run is back at an earlier step, from which
/// it must go on.
bool RunLoop::record_end(Observer& observer) {
  // What a static run records is an equilibrium: not the state between an event and the next one.
  const bool records_state = !(built_.dynamics().is_static() && is_unbalanced_);
  const auto record = [&] { records_.finish(control_.last_dt(), records_state); };
  try {
    if (control_.try_check(record, notify_to(observer))) return true;
    records_.roll_back();
    if (summary_.outcome != RunSummary::Outcome::interrupted) return false;
    record();  // it stood at a state that the next step would have taken back
    return true;
  } catch (const IoError&) {
    throw;
  } catch (const Error&) {
    close_failed(observer);
    throw;
  }
}

void RunLoop::finish(Observer& observer) {
  // If the run was interrupted, the run that continues it reports what is gathered.
  if (summary_.outcome != RunSummary::Outcome::interrupted)
    report_events(event_report_.finish(), observer);
  events_.finish();
  const bool rests = summary_.outcome != RunSummary::Outcome::finished &&
                     summary_.outcome != RunSummary::Outcome::interrupted;
  for (const std::string& text :
       {hourglass_warning(scene_, built_, rests), control_.balance_warning(),
        rounding_warning(built_.dynamics(), scene_.solver.step_tolerance), deep_overlaps(built_)})
    if (!text.empty()) diagnostics_.warn(text);
  for (const std::string& text : notes_on_steps(built_.dynamics())) observer.on_message(text);
  for (auto& field : built_.body().fields()) observer.on_message(field.balance_text(clock_.time()));
  checkpoints_.finish();
  if (summary_.outcome == RunSummary::Outcome::interrupted && checkpoints_.is_enabled())
    observer.on_message("resume with: suture run --resume " + checkpoints_.newest());
}

void RunLoop::summarise() {
  if (built_.dynamics().has_balance()) {
    summary_.exchanged = control_.guard().exchanged();
    summary_.balance = control_.guard().open_balance() * summary_.exchanged;
  }
  summary_.lowest_eigenvalue = ending_.lowest_eigenvalue();
  summary_.rollbacks = control_.rollbacks();
  summary_.steps = clock_.step();
  summary_.time = clock_.time();
  summary_.dt = control_.last_dt();
  if (const StepAccuracy* accuracy = control_.accuracy()) {
    summary_.rejected_steps = accuracy->rejected_steps();
    summary_.shortest_dt = accuracy->shortest();
    summary_.longest_dt = accuracy->longest();
  }
  summary_.debris = events_.removed_debris();
  summary_.volume_at_start = events_.debris().volume_at_start();
  summary_.frames = recorder_.frames_written();
  summary_.inverted_elements = control_.guard().inverted_elements();
  summary_.threads = built_.body().models().threads();
  if (summary_.seconds > 0) {
    const auto made = static_cast<double>(summary_.steps - first_step_);
    summary_.elements_per_second =
        made * built_.body().complex().element_count() / summary_.seconds;
  }
  summary_.pvd = recorder_.collection();
}

void RunLoop::state(Archive& archive) {
  if (built_.is_embedded())
    archive("parts", built_.embedded_parts());  // before contact, which needs them
  archive("control", control_);
  archive("events", events_);
  archive("event report", event_report_);
  archive("sleeper", sleeper_);
  archive("ending", ending_);
  archive("records", records_);
  archive("recorder", recorder_);
  archive("unbalanced", is_unbalanced_);
  archive("skipped", was_skipped_);
  archive("events skipped", summary_.events_skipped);
  archive("faces cut", summary_.faces_cut);
  archive("faces torn", summary_.faces_torn);
  archive("faces sewn", summary_.faces_sewn);
  archive("elements removed", summary_.elements_removed);
  if (built_.body().attributes().parts().may_grow()) archive("elements cut", summary_.elements_cut);
}

}  // namespace suture
