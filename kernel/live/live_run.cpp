// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/live/live_run.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/live/adjustable.hpp"
#include "kernel/live/json_text.hpp"
#include "kernel/run/checkpoints.hpp"

namespace suture {
namespace {

using Json = nlohmann::json;
using Seconds = std::chrono::duration<double>;

/// Between pictures, s: the time of a run that they take is at most a twentieth, unless there would
/// be less than 15 of them in a second.
constexpr double shortest_interval = 1.0 / 60, longest_interval = 1.0 / 15, share = 0.05;
/// After a picture for pages that may still come, in times of its own: a script that nobody watches
/// loses at most a twentieth of its time.
constexpr int unwatched_rest = 20;
/// Steps are made for so long before inputs are looked at again.
constexpr double slice = 0.004, slice_with_device = 0.001;
/// A run that cannot keep up does not try to catch up on more than this, s.
constexpr double most_behind = 0.1;
/// Between copies of the state, and in times of their own.
constexpr auto copy_interval = std::chrono::seconds(2);
constexpr int copy_rest = 100;
constexpr auto idle = std::chrono::milliseconds(20), rest_after_action = 25 * idle;

}  // namespace

void leave_out_results(Scene& scene) {
  OutputOptions& output = scene.output;
  output.frames = output.springs = output.faces = output.obstacles = output.cuts = output.surface =
      false;
  output.energies_every = output.probes_every = output.tools_every = 0;
  scene.checkpoint.enabled = false;
}

/// Tells the pages what the run reports.
class LiveRun::Reporter final : public Observer {
 public:
  Reporter(LiveRun& run, Observer& next) : run_(run), next_(next) {}
  void on_message(const std::string& message) override {
    next_.on_message(message);
    run_.tell("message", message);
  }
  void on_detail(const std::string& message) override { next_.on_detail(message); }
  bool stop_requested() override { return next_.stop_requested(); }
  bool gives_up_step() override { return next_.gives_up_step(); }

 private:
  LiveRun& run_;
  Observer& next_;
};

LiveRun::LiveRun(const Scene& scene, PluginHost& host, Diagnostics& diagnostics, LiveServer& server,
                 std::filesystem::path recording)
    : scene_(&scene), host_(host), diagnostics_(diagnostics), server_(server) {
  build(0, nullptr);
  header_ = checkpoint_header(simulation_->built(), host);
  recording_.emplace(std::move(recording), *scene_, *simulation_);
}

LiveRun::LiveRun(Simulation& simulation, const Scene& scene, PluginHost& host,
                 Diagnostics& diagnostics, LiveServer& server,
                 std::optional<std::filesystem::path> recording,
                 std::span<const RecordedInput> done)
    : scene_(&scene),
      host_(host),
      diagnostics_(diagnostics),
      server_(server),
      simulation_(&simulation),
      pictures_(std::make_unique<Pictures>(simulation, 0)),
      reported_warnings_(diagnostics.warnings().size()) {
  pictures_->choose(field_);
  tell_lists();
  std::optional<Simulation> start;  // a recording begins there
  Diagnostics again;
  if (simulation.step() > 0 || !done.empty()) start.emplace(scene, host, again);
  recording_.emplace(std::move(recording), scene, start ? *start : simulation);
  for (const RecordedInput& input : done) record(input);
}

LiveRun::~LiveRun() = default;

/// What is shown as laid open is so since the start: pictures know the body before it has a state.
void LiveRun::build(std::uint64_t first_surface, const StateTree* state) {
  if (own_) report_warnings();
  auto simulation = std::make_unique<Simulation>(*scene_, host_, diagnostics_);
  if (own_) reported_warnings_ = diagnostics_.warnings().size();  // those of before again
  auto pictures = std::make_unique<Pictures>(*simulation, first_surface);
  if (state != nullptr) {
    simulation->load(*state);
    pictures->find_surface_again();
  }
  take(std::move(simulation), std::move(pictures));
}

/// Goes on with another simulation, at first paused.
void LiveRun::take(std::unique_ptr<Simulation> simulation, std::unique_ptr<Pictures> pictures) {
  pictures->choose(field_);
  pictures_ = std::move(pictures);
  own_ = std::move(simulation);
  simulation_ = own_.get();
  status_.is_playing = status_.has_ended = status_.has_failed = is_shown_ = false;
  status_.remedy.clear();
  recent_.reset();
  hand_.reset();
  aimed_.reset();
  tell_lists();
  if (device_) follow(*device_, device_obstacle_);
}

void LiveRun::run(Observer& observer) {
  Reporter reporter(*this, observer);
  play(false);
  while (!observer.stop_requested()) {
    for (const std::string& text : server_.take_inputs()) obey(text, reporter);
    report_warnings();
    show();  // before steps, which may take long
    catch_up();
    if (status_.is_playing)
      make_due_steps(reporter);
    else
      server_.wait(idle);
  }
}

/// While the picture of an action is drawn, nothing shall take its time.
bool LiveRun::has_just_acted() const { return Wall::now() < acted_ + rest_after_action; }

/// Takes memory for the next state, which who acts would have to wait for, and shows the curves.
void LiveRun::catch_up() {
  if (!is_shown_ || has_just_acted()) return;
  if (own_ && !kept_.has_spare()) kept_.set_spare(simulation_->save());
  if (lacks_curves_) is_shown_ = false;
}

void LiveRun::end() {
  if (!status_.has_failed) recording_->end(*simulation_);
  report_warnings();
}

void LiveRun::watch() {
  for ([[maybe_unused]] const std::string& input : server_.take_inputs())
    tell("error", "the script makes the steps now; this page watches until it gives the control");
  report_warnings();
  status_.is_playing = true;
  is_shown_ = false;
  show();
}

void LiveRun::show_last() {
  report_warnings();
  status_.is_playing = false;
  const Wall::time_point start = Wall::now();
  if (!server_.is_watched() && start < next_unwatched_) return;
  pictures_->plot();
  server_.show(pictures_->picture(status_));
  next_unwatched_ = Wall::now() + unwatched_rest * (Wall::now() - start);
}

void LiveRun::resume(Checkpoint checkpoint, const std::filesystem::path& file, Observer& observer) {
  require_fit(checkpoint.header, header_, file);
  start_.emplace(std::move(checkpoint.state));
  earlier_.reset();
  load_checkpoint(file, [&] {
    simulation_->load(*start_);
    if (checkpoint.header.inputs) earlier_ = inputs_of(*checkpoint.header.inputs);
  });
  pictures_->find_surface_again();
  recording_ = RecordingWriter(recording_->path(), *scene_, *simulation_, file);
  for (const char* grasp : {hand_name, device_grasp_name})
    if (!simulation_->built().body().constraints().held_by(grasp).empty())
      apply(release_input(grasp), observer);
  tell_lists();  // values may have changed
}

/// A recording that ends with a failure is repeated up to its last input.
bool LiveRun::continue_from(const Recording& given, Observer& observer) {
  Recording recording = given;
  if (!recording.failure.empty()) {
    recording.failure.clear();
    recording.last_step =
        recording.inputs.empty() ? recording.first_step : recording.inputs.back().step;
  }
  const bool is_there = repeat(recording, *scene_, *simulation_, observer, diagnostics_);
  compare_end(recording, *simulation_, diagnostics_);
  for (const RecordedInput& input : recording.inputs) record(input);
  tell_lists();  // values may have changed
  return is_there;
}

void LiveRun::record(const RecordedInput& input) {
  recording_->input(input);
  status_.has_ended = false;
}

void LiveRun::stop_recording(const std::string& why) {
  if (!recording_->is_on()) return;
  recording_->stop();
  tell("warning", "the recording ends here: " + why);
}

void LiveRun::require_own(const std::string& what) const {
  if (!own_) throw InputError("a script runs this simulation; only it can " + what);
}

// -------------------------------------------------------------------- steps --

/// As many as the wanted speed allows and a slice of time has room for.
void LiveRun::make_due_steps(Observer& observer) {
  double due = INFINITY;
  if (status_.speed > 0) {
    const double behind = Seconds(Wall::now() - playing_since_).count() * status_.speed -
                          (simulation_->time() - played_from_);
    if (behind <= 0) return server_.wait(std::chrono::milliseconds(device_ ? 1 : 2));
    if (behind > most_behind * status_.speed) {
      playing_since_ = Wall::now();
      played_from_ = simulation_->time() - most_behind * status_.speed;
    }
    due = dt_ > 0 ? behind / dt_ : 1;
  }
  const double time = device_ ? slice_with_device : slice;
  const double fits = seconds_per_step_ > 0 ? time / seconds_per_step_ : 1;
  const double count = std::clamp(std::ceil(std::min(due, fits)), 1.0, 1e4);
  move_device_hand(count, observer);
  make_steps(static_cast<std::uint64_t>(count), observer);
  feel();
}

void LiveRun::make_steps(std::uint64_t count, Observer& observer) {
  if (status_.has_ended) return;
  const auto start = Wall::now();
  const std::uint64_t first = simulation_->step();
  const double time = simulation_->time();
  is_shown_ = false;
  try {
    const auto outcome = simulation_->advance({{}, count}, observer);
    status_.has_ended = outcome && *outcome != RunSummary::Outcome::interrupted;
  } catch (const Error& error) {
    return fail(error);
  }
  copy_if_due();
  if (simulation_->step() > first) {
    const auto made = static_cast<double>(simulation_->step() - first);
    seconds_per_step_ = Seconds(Wall::now() - start).count() / made;
    dt_ = (simulation_->time() - time) / made;
    measure(simulation_->step() - first, simulation_->time() - time);
  }
  if (!status_.has_ended) return;
  play(false);
  observer.on_message("the run has ended; go on by acting on the body, or reset it");
}

/// Says it once: pages in plain words, the terminal and the recording in all detail.
void LiveRun::fail(const Error& error) {
  if (status_.has_failed) return;
  status_.has_failed = true;
  failure_code_ = error.exit_code();
  play(false);
  status_.has_ended = true;
  is_shown_ = false;
  recording_->failed(simulation_->step(), error.what());
  diagnostics_.note(std::string("the run has failed: ") + error.what());
  const auto& piece = simulation_->failed_piece();
  if (!piece || !own_)
    return tell("error",
                std::string(error.what()) + "\nThe run has failed; this is its last state.");
  status_.remedy = "remove " + piece->text() + " and go on";
  tell("error", "The run has failed: " + piece->text() +
                    " collapsed. Remove it, take the last action back, or reset the run.");
}

/// From time to time, so that what led to a failure can be repeated.
void LiveRun::copy_if_due() {
  if (!own_ || Wall::now() < next_recent_) return;
  const Wall::time_point start = Wall::now();
  recent_ = state_now(recent_ ? std::move(recent_->state) : StateTree());
  const Wall::time_point end = Wall::now();
  next_recent_ = end + std::max<Wall::duration>(copy_interval, copy_rest * (end - start));
}

void LiveRun::measure(std::uint64_t steps, double simulated) {
  measured_.steps += steps;
  measured_.simulated += simulated;
  const double spent = Seconds(Wall::now() - measured_.since).count();
  if (spent < 0.5) return;
  status_.steps_per_second = static_cast<double>(measured_.steps) / spent;
  status_.real_time = measured_.simulated / spent;
  status_.device.exchanges_per_second = static_cast<double>(measured_.exchanges) / spent;
  measured_ = {Wall::now()};
}

// -------------------------------------------------------------------- pages --

void LiveRun::show() {
  show_device();
  if (is_shown_ || !server_.wants_picture() || Wall::now() < next_picture_) return;
  lacks_curves_ = has_just_acted();
  Wall::time_point start;
  try {
    if (!lacks_curves_ && !status_.has_failed) pictures_->plot();
    start = Wall::now();  // curves have a pace of their own
    feel_hand();
    server_.show(pictures_->picture(status_));
  } catch (const NumericalError& error) {
    return fail(error);
  }
  is_shown_ = true;
  const double spent = Seconds(Wall::now() - start).count();
  const auto interval = std::chrono::duration_cast<Wall::duration>(
      Seconds(std::clamp(spent / share, shortest_interval, longest_interval)));
  // From when it was due, or else a late one would delay all others.
  next_picture_ = std::max(next_picture_ + interval, start);
}

void LiveRun::report_warnings() {
  if (recording_ && recording_->problem() != reported_problem_) {
    reported_problem_ = recording_->problem();
    diagnostics_.warn("the recording ends here, and the run goes on without it: " +
                      reported_problem_);
  }
  const auto& warnings = diagnostics_.warnings();
  while (reported_warnings_ < warnings.size()) tell("warning", warnings[reported_warnings_++]);
}

/// What pages choose from, to these and to those that come later.
void LiveRun::tell_lists() {
  Json greeting = pictures_->greeting();
  const Json lists{{"kept", kept_.list()}, {"values", adjustable_values(*simulation_)}};
  greeting.update(lists);
  server_.greet(json_text(greeting));
  server_.say(json_text(lists));
}

void LiveRun::tell(const char* key, const std::string& text) {
  server_.say(json_text(Json{{key, text}, {"time", simulation_->time()}}));
}

}  // namespace suture
