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

namespace suture {
namespace {

/// s: in so long the hand gets to where the mouse is.
constexpr double hand_delay = 0.05;

}  // namespace

/// Applies an input of the page. A refused input changes nothing, and the page shows the reason.
void LiveRun::obey(const std::string& text, Observer& observer) {
  is_shown_ = false;
  try {
    const Json input = Json::parse(text);
    const std::string what = input.at("do");
    if (control(what, input, observer)) return;
    if (status_.has_failed)
      throw InputError("the run has failed; take the last action back, or reset it");
    act(what, input, observer);
  } catch (const Json::exception& error) {
    tell("error", std::string("this input is not understood: ") + error.what());
  } catch (const IoError&) {
    throw;  // of the recording
  } catch (const NumericalError& error) {
    fail(error.what());
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
    as_action(name == "sweep" ? "cut" : name, [&] { apply(json_text(event), observer); });
    if (name == "parameters" || name == "gravity") tell_lists();
  } else if (what == "grab") {
    grab(input.at("at").get<Vec3>(), observer);
  } else if (what == "take") {
    take_tool(input.at("tool"), input.at("at").get<Vec3>(), observer);
  } else if (what == "drag") {
    drag(input.at("to").get<Vec3>(), observer);
  } else if (what == "let_go") {
    let_go(observer);
  } else {
    throw InputError("there is no input '" + what + "'");
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
  apply_input(value, scene_, *simulation_, observer, diagnostics_);
  record(input);
}

/// Sends a scene that does what was done so far.
void LiveRun::send_scene() {
  if (!recording_->has_inputs()) throw InputError("nothing was done yet that a scene could repeat");
  const RecordedScene scene = scene_of(recording_->read(), simulation_->time());
  for (const std::string& input : scene.left_out)
    tell("warning", "a scene cannot say this input, which was left out: " + input);
  server_.say(json_text(Json{{"scene", scene.text}, {"name", scene_.file.stem().string()}}));
}

/// To a file beside the recording.
void LiveRun::save_checkpoint() {
  require_own("save a checkpoint");
  const std::filesystem::path file =
      free_name(recording_->path().parent_path(), scene_, "checkpoint", ".h5");
  try {
    suture::save_checkpoint(*simulation_, header_, file);
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
  KeptState kept =
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

void LiveRun::keep(const std::string& name, bool is_before_action) {
  if (!own_) return;
  KeptState kept{
      name, is_before_action, simulation_->time(), simulation_->step(), recording_->inputs(),
      hand_};
  if (device_hand_) kept.cursor = device_hand_->cursor();
  StateTree spare = kept_.take_spare();
  kept.state = simulation_->save(&spare);
  kept_.keep(std::move(kept));
  tell_lists();
}

/// Keeps the state before an action, which may be refused.
void LiveRun::as_action(const std::string& name, const std::function<void()>& action) {
  next_picture_ = Wall::now();  // who acts wants to see it
  if (!own_) return action();
  keep(name, true);
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
