// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a LiveRun does on inputs.
#include <algorithm>

#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/live/inputs.hpp"
#include "kernel/live/json_text.hpp"
#include "kernel/live/live_run.hpp"
#include "kernel/live/scene_of_recording.hpp"
#include "kernel/run/checkpoints.hpp"
#include "kernel/run/steering.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture {
namespace {

/// s: in so long the hand gets to where the mouse is.
constexpr double hand_delay = 0.05;

using Json = nlohmann::json;

bool is_along_blade(const Json& event) {
  if (!event.is_object() || event.empty() || !event.begin().value().is_object()) return false;
  const auto along = event.begin().value().find("along");
  return along != event.begin().value().end() && *along == "blade";
}

/// The scene with models that are prepared for cuts along blades.
std::unique_ptr<Scene> divisible(const Scene& scene, PluginHost& host, Diagnostics& diagnostics) {
  SceneSource source = scene.source;
  auto text = nlohmann::ordered_json::parse(source.text, nullptr, true, true);
  text["divisible"] = true;
  source.text = text.dump();
  auto made = std::make_unique<Scene>(read_scene_source(source, {}, host, diagnostics));
  leave_out_results(*made);
  return made;
}

/// That scene, and a run of it.
std::pair<std::unique_ptr<Scene>, std::unique_ptr<Simulation>> divisible_run(
    const Scene& given, PluginHost& host, Diagnostics& diagnostics) try {
  auto scene = divisible(given, host, diagnostics);
  auto simulation = std::make_unique<Simulation>(*scene, host, diagnostics);
  return {std::move(scene), std::move(simulation)};
} catch (const InputError& error) {
  const std::string why = error.what();
  throw InputError("this body cannot be cut along a blade: " + why.substr(0, why.find('\n')));
}

}  // namespace

/// Applies an input of the page. A refused input changes nothing, and the page shows the reason.
void LiveRun::obey(const std::string& text, Observer& observer) {
  is_shown_ = false;
  std::string what;
  try {
    const Json input = Json::parse(text);
    what = input.at("do");
    if (control(what, input, observer)) return;
    if (status_.has_failed && (what == "drag" || what == "let_go" || what == "aim")) return;
    if (status_.has_failed)
      throw InputError("the run has failed; take the last action back, or reset it");
    act(what, input, observer);
  } catch (const Json::exception&) {
    tell("error", not_understood(text, what));
  } catch (const NumericalError& error) {
    fail(error);
  } catch (const Error& error) {
    tell("error", error.what());
  }
}

/// Inputs that do not act on the body, also after a failure; false for others.
bool LiveRun::control(const std::string& what, const Json& input, Observer& observer) {
  if (what == "play" || what == "pause") {
    play(what == "play");
  } else if (what == "reset") {
    reset(observer);
  } else if (what == "back") {
    go_back(input, observer);
  } else if (what == "remove_piece") {
    remove_failed_piece(observer);
  } else if (what == "field") {
    pictures_->choose(input.at("name"));
    field_ = input.at("name");
  } else if (what == "speed") {
    const double speed = input.at("value");
    if (!(speed >= 0 && speed <= 1e6)) throw InputError("a speed is a number from 0 to 1e6");
    status_.speed = speed;
    play(status_.is_playing);
  } else {
    return false;
  }
  return true;
}

void LiveRun::act(const std::string& what, const Json& input, Observer& observer) {
  if (what == "step") {
    play(false);
    make_steps(1, observer);
  } else if (what == "scene") {
    send_scene();
  } else if (what == "checkpoint") {
    save_checkpoint();
  } else if (what == "keep") {
    keep(input.value("name", "kept"), false);
  } else if (what == "apply") {
    const Json& event = input.at("event");
    const std::string name = event.is_object() && !event.empty() ? event.begin().key() : "action";
    if (is_along_blade(event)) make_divisible(observer);
    as_action(
        name == "sweep" ? "cut" : name, [&] { apply(json_text(event), observer); },
        input.value("aimed", false));
    if (name == "parameters" || name == "gravity") tell_lists();
  } else if (what == "aim") {
    aim();
  } else if (what == "grab") {
    grab(input.at("at").get<Vec3>(), observer);
  } else if (what == "take") {
    take_tool(input.at("tool"), input.at("at").get<Vec3>(), observer);
  } else if (what == "drag") {
    drag(input.at("to").get<Vec3>(), observer);
  } else if (what == "let_go") {
    let_go(observer);
  } else {
    throw InputError("there is no input '" + what + "'" + similar_input(what));
  }
}

void LiveRun::play(bool plays) {
  status_.is_playing = plays && !status_.has_ended && !status_.has_failed;
  playing_since_ = Wall::now();
  played_from_ = simulation_->time();
  measured_ = {playing_since_};
  status_.steps_per_second = status_.real_time = 0;
  engage_device();
}

void LiveRun::apply(const std::string& value, Observer& observer, const std::string& device) {
  const RecordedInput input{simulation_->step(), simulation_->time(), device, value};
  apply_input(value, *scene_, *simulation_, observer, diagnostics_);
  record(input);
}

/// What was done since the scene began, if that is known.
std::optional<std::vector<RecordedInput>> LiveRun::all_inputs() const {
  auto all = earlier_;
  if (!recording_->problem().empty()) return {};
  if (!all || !recording_->has_inputs()) return all;
  const std::vector<RecordedInput> since = recording_->read().inputs;
  all->insert(all->end(), since.begin(), since.end());
  return all;
}

/// Sends a scene that does what was done so far.
void LiveRun::send_scene() {
  if (!recording_->is_on())
    throw InputError(
        "a scene is made from the recording, which the script has ended or not asked for");
  const auto inputs = all_inputs();
  if (!inputs)
    throw InputError(
        "a scene begins at rest, and the checkpoint at which this run began does not say what was "
        "done before: only those of suture live do");
  if (inputs->empty()) throw InputError("nothing was done yet that a scene could repeat");
  const RecordedScene scene = scene_of(scene_->source.text, *inputs, simulation_->time());
  for (const std::string& input : scene.left_out)
    tell("warning", "a scene cannot say this input, which was left out: " + input);
  server_.say(json_text(Json{{"scene", scene.text}, {"name", scene_->file.stem().string()}}));
}

/// Cuts along blades need models that are prepared for them when a run begins: makes this run again
/// with such models. Throws the errors of Simulation and of repeat(); nothing has changed then.
void LiveRun::make_divisible(Observer& observer) {
  if (simulation_->attributes().parts().may_grow()) return;
  require_own("prepare it for cuts along blades; set \"divisible\": true in its scene");
  if (start_)
    throw InputError(
        "this run began at a checkpoint of a scene without cuts along blades, so it cannot make "
        "one; cut along faces");
  let_go(observer);
  report_warnings();
  auto [scene, simulation] = divisible_run(*scene_, host_, diagnostics_);
  observer.on_message("the run is made again, prepared for cuts along blades");
  reported_warnings_ = diagnostics_.warnings().size();  // those of before again
  const bool has_file = recording_->knows_inputs(), plays = status_.is_playing;
  Recording done;
  if (has_file) done = recording_->read();
  const std::filesystem::path old = recording_->path();
  RecordingWriter recording(
      has_file ? free_name(old.parent_path(), *scene_, "recording", ".jsonl") : old, *scene,
      *simulation);
  done.start = state_hash(*simulation);
  done.last_step = simulation_->step();  // to where this run is
  CheckpointHeader header = checkpoint_header(simulation->built(), host_);
  auto pictures = std::make_unique<Pictures>(*simulation, pictures_->last_number());
  if (!repeat(done, *scene, *simulation, observer, diagnostics_))
    throw InputError("the run made again ended earlier; cut along faces");
  for (const RecordedInput& input : done.inputs) recording.input(input);
  recording_->end(*simulation_);
  kept_.clear();
  take(std::move(simulation), std::move(pictures));
  header_ = std::move(header);
  divisible_ = std::move(scene);
  scene_ = divisible_.get();
  recording_ = std::move(recording);
  play(plays);
}

/// To a file beside the recording.
void LiveRun::save_checkpoint() {
  require_own("save a checkpoint");
  const std::filesystem::path file =
      free_name(recording_->path().parent_path(), *scene_, "checkpoint", ".h5");
  try {
    CheckpointHeader header = header_;
    if (const auto inputs = all_inputs()) header.inputs = lines_of(*inputs);
    suture::save_checkpoint(*simulation_, std::move(header), file);
  } catch (const IoError& error) {
    return tell("error", error.what());
  }
  tell("message", "saved " + file.string() + "; go on from it with suture live " + file.string() +
                      ", or suture run --resume " + file.string() + " --set /solver/end=SECONDS");
}

// -------------------------------------------------------------- kept states --

void LiveRun::reset(Observer& observer) {
  require_own("start it again");
  kept_.clear();
  build(pictures_->last_number(), start_ ? &*start_ : nullptr);
  recording_->reset();
  observer.on_message("the run is at its start again");
}

/// To a kept state, or takes the last action back.
void LiveRun::go_back(const Json& input, Observer& observer) {
  require_own("go back");
  const bool takes_back = !input.contains("to");
  LiveState kept =
      takes_back ? kept_.take_last_action() : kept_.take(whole_number(input["to"], "'to'"));
  build(pictures_->last_number(), &kept.state);
  hand_ = kept.hand;
  if (device_hand_ && kept.cursor) device_hand_->return_to(*kept.cursor);
  recording_->back(kept.step, kept.inputs);
  observer.on_message(timed(kept.time, takes_back ? kept.name + " was taken back"
                                                  : "the run is back at '" + kept.name + "'"));
  kept.is_before_action = false;
  if (!takes_back) kept_.keep(std::move(kept));
  tell_lists();
}

/// Repeats the steps from the last copy of the state to the last good one, and removes there the
/// piece at which the run has failed, with all that are no larger. What the mouse held is released.
void LiveRun::remove_failed_piece(Observer& observer) {
  require_own("remove a piece");
  if (!status_.has_failed || !simulation_->failed_piece())
    throw InputError("the run has not failed at a small piece; there is nothing to remove");
  const FailedPiece piece = *simulation_->failed_piece();
  const auto done =
      recording_->knows_inputs() ? recording_->read().inputs : std::vector<RecordedInput>();
  std::optional<LiveState> from = std::exchange(recent_, std::nullopt);
  if (from && from->step > piece.good_step) from.reset();
  kept_.drop_after(piece.good_step);
  build(pictures_->last_number(), from ? &from->state : start_ ? &*start_ : nullptr);
  const std::size_t first = from ? from->inputs : 0;
  from ? recording_->back(from->step, first) : recording_->reset();
  const auto run_to = [&](std::uint64_t step) {
    if (simulation_->step() < step)
      simulation_->advance({{}, step - simulation_->step()}, observer);
  };
  for (std::size_t i = first; i < done.size() && done[i].step <= piece.good_step; ++i) {
    run_to(done[i].step);
    apply(done[i].value, observer, done[i].device);
  }
  run_to(piece.good_step);
  if (!simulation_->built().body().constraints().held_by(hand_name).empty())
    apply(release_input(hand_name), observer);
  apply(json_text(Json{{"remove_islands", {{"volume", 1.001 * piece.volume}}}}), observer);
  observer.on_message(timed(simulation_->time(), "the run goes on without " + piece.text()));
  tell_lists();
  play(true);
}

LiveState LiveRun::state_now(StateTree spare) {
  LiveState kept;
  kept.time = simulation_->time();
  kept.step = simulation_->step();
  kept.inputs = recording_->inputs();
  kept.hand = hand_;
  if (device_hand_) kept.cursor = device_hand_->cursor();
  kept.state = simulation_->save(&spare);
  return kept;
}

void LiveRun::keep(const std::string& name, bool is_before_action) {
  if (own_) keep(state_now(kept_.take_spare()), name, is_before_action);
}

void LiveRun::keep(LiveState state, const std::string& name, bool is_before_action) {
  aimed_.reset();  // states are in the order of the run
  state.name = name;
  state.is_before_action = is_before_action;
  kept_.keep(std::move(state));
  tell_lists();
}

/// Copies the state, O(body), while a page draws the way of a tool: who lets go of the mouse then
/// need not wait for it.
void LiveRun::aim() {
  if (!own_) return;
  if (aimed_) kept_.set_spare(std::move(aimed_->state));
  aimed_ = state_now(kept_.take_spare());
}

/// Keeps the state before an action, which may be refused; that of aim() if the action was aimed.
void LiveRun::as_action(const std::string& name, const std::function<void()>& action,
                        bool is_aimed) {
  next_picture_ = acted_ = Wall::now();  // who acts wants to see it
  if (!own_) return action();
  keep(is_aimed && aimed_ ? *std::move(aimed_) : state_now(kept_.take_spare()), name, true);
  try {
    action();
  } catch (const NumericalError&) {
    throw;  // the way back from a failure
  } catch (...) {
    kept_.drop_last();
    tell_lists();
    throw;
  }
}

// --------------------------------------------------------------------- hand --

/// Holds the nodes around a place.
void LiveRun::grab(const Vec3& at, Observer& observer) {
  let_go(observer);
  as_action("grab", [&] { apply(hold_input(at, 1.2 * pictures_->edge_length()), observer); });
  hand_ = Hand{"", {}, at, at, simulation_->time()};
}

/// Takes an obstacle, which then moves as the hand does.
void LiveRun::take_tool(const std::string& tool, const Vec3& at, Observer& observer) {
  let_go(observer);
  const ContactLaw* contact = simulation_->contact();
  const Obstacle& obstacle = contact->obstacles()[obstacle_named(tool, contact)];
  const Pose pose = obstacle.motion.pose(simulation_->time());
  keep("push with " + tool, true);
  hand_ = Hand{tool, minus(pose.translation, at), at, at, simulation_->time()};
}

void LiveRun::drag(const Vec3& to, Observer& observer) {
  if (!hand_) return;
  const double now = simulation_->time();
  const double way = norm(minus(to, hand_->place(now)));
  const double shortest = way / (hand_reach * pictures_->edge_length()) * dt_;
  const double speed = status_.real_time > 0 ? status_.real_time : status_.speed;
  const Hand next =
      hand_->led(to, now, std::max(hand_delay * std::clamp(speed, 0.01, 1.0), shortest));
  apply(next.input(), observer);
  hand_ = next;
  if (status_.is_playing) make_steps(1, observer);  // a picture shows that it moves
  next_picture_ = Wall::now();
}

void LiveRun::let_go(Observer& observer) {
  if (!hand_) return;
  const bool holds_nodes = hand_->tool.empty();
  hand_.reset();
  if (holds_nodes) apply(release_input(hand_name), observer);
}

/// With what the body pulls at the hand.
void LiveRun::feel_hand() {
  status_.hand.reset();
  if (!hand_ || status_.has_failed) return;
  LiveStatus::Held held{hand_->place(simulation_->time()), {}};
  if (hand_->tool.empty()) {
    held.force = simulation_->force_on_grasp(hand_name);
  } else {
    const ContactLaw* contact = simulation_->contact();
    const std::size_t obstacle = obstacle_named(hand_->tool, contact);
    const auto compliant = contact->tool_state(obstacle);
    held.force = compliant ? compliant->hand_force : contact->loads()[obstacle].force;
  }
  status_.hand = held;
}

}  // namespace suture
