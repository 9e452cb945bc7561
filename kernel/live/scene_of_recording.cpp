// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/live/scene_of_recording.hpp"

#include <map>
#include <nlohmann/json.hpp>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

using Ordered = nlohmann::ordered_json;

/// Stations {"at", "translation", "angle"} of a path, which is at rest after the last.
class LedPath {
 public:
  explicit LedPath(Ordered& stations) : stations_(stations) {}

  /// Sends it on another way from `time` on, to `target`, or by `step` from where it is.
  void lead(double time, double during, const std::optional<Vec3>& target, const Vec3& step) {
    const auto [place, angle] = at(time);
    while (!stations_.empty() && stations_.back().at("at") >= time)
      stations_.erase(stations_.end() - 1);
    add(time, place, angle);
    add(time + during, target.value_or(plus(place, step)), angle);
  }

 private:
  struct Place {
    Vec3 translation{};
    double angle = 0;
  };
  static Place of(const Ordered& station) {
    return {station.value("translation", Vec3{}), station.value("angle", 0.0)};
  }
  Place at(double time) const {
    if (stations_.empty()) return {};
    std::size_t next = 0;
    while (next < stations_.size() && stations_[next].at("at") < time) ++next;
    if (next == stations_.size()) return of(stations_.back());
    const Place b = of(stations_[next]);
    if (next == 0) return b;
    const Place a = of(stations_[next - 1]);
    const double from = stations_[next - 1].at("at"), to = stations_[next].at("at");
    const double part = (time - from) / (to - from);
    return {plus(a.translation, scaled(part, minus(b.translation, a.translation))),
            a.angle + part * (b.angle - a.angle)};
  }
  void add(double time, const Vec3& translation, double angle) {
    Ordered station{{"at", time}, {"translation", translation}};
    if (angle != 0) station["angle"] = angle;
    stations_.push_back(station);
  }

  Ordered& stations_;
};

class SceneWriter {
 public:
  explicit SceneWriter(const std::string& text)
      : scene_(Ordered::parse(text, nullptr, true, true)) {
    if (!scene_.contains("events")) scene_["events"] = Ordered::array();
  }

  void add(const RecordedInput& input) {
    const Ordered value = Ordered::parse(input.value);
    const std::string what = value.begin().key();
    const Ordered& how = value.begin().value();
    if (what == "move") {
      move(how, input.time);
    } else if (what == "steer") {
      steer(how, input.time);
    } else if (what == "sweep") {
      sweep(how, input.time);
    } else if (what == "parameters" || what == "gravity") {
      left_out_.push_back(what + ": " + how.dump());
    } else {
      event(value, input.time);
    }
  }
  RecordedScene finish(double end) {
    scene_["solver"]["end"] = end;
    return {scene_.dump(1) + "\n", std::move(left_out_)};
  }

 private:
  void event(Ordered event, double time) {
    if (event.contains("grasp")) {
      Ordered& name = event["grasp"].at("name");
      Held& held = grasps_[name];
      held = {scene_["events"].size(), time, held.count + 1};
      name = held.name(name);
    } else if (event.contains("release")) {
      Ordered& name = event["release"];
      if (const auto held = grasps_.find(name); held != grasps_.end())
        name = held->second.name(name);
    }
    event["at"] = time;
    scene_["events"].push_back(std::move(event));
  }
  void move(const Ordered& move, double time) {
    const std::string name = move.at("grasp");
    const auto held = grasps_.find(name);
    if (held == grasps_.end()) return left_out_.push_back("move of '" + name + "'");
    Ordered& stations =
        scene_["events"][held->second.event]["grasp"]["move"]["path"];  // times from the grasp on
    LedPath(stations).lead(time - held->second.time, move.at("during"), {},
                           move.at("translation").get<Vec3>());
  }
  void steer(const Ordered& steer, double time) {
    const std::string name = steer.at("obstacle");
    if (steer.contains("rotation")) left_out_.push_back("rotation of '" + name + "'");
    if (!steer.contains("translation")) return;
    const double during =
        steer.contains("at") ? steer["at"].get<double>() - time : steer.at("during").get<double>();
    for (Ordered& obstacle : scene_.at("contact").at("obstacles"))
      if (obstacle.at("name") == name)
        LedPath(obstacle["path"]).lead(time, during, steer["translation"].get<Vec3>(), {});
  }
  void sweep(const Ordered& sweep, double time) {
    for (const Ordered& triangle : sweep.at("triangles")) {
      Ordered polygon = Ordered::array();
      for (const std::size_t corner : triangle) polygon.push_back(sweep.at("points").at(corner));
      scene_["events"].push_back(
          {{"at", time},
           {"cut", {{"plane", {{"polygon", polygon}}}, {"along", sweep.value("along", "faces")}}}});
    }
  }

  struct Held {
    std::size_t event = 0;  ///< that takes hold
    double time = 0;        ///< s, of it
    int count = 0;          ///< of those with its name so far

    /// Names are unique in a scene; a hand takes hold again and again.
    std::string name(const std::string& given) const {
      return count > 1 ? given + "-" + std::to_string(count) : given;
    }
  };
  Ordered scene_;
  std::map<std::string, Held> grasps_;  ///< by the names of the recording
  std::vector<std::string> left_out_;
};

}  // namespace

RecordedScene scene_of(const std::string& scene, std::span<const RecordedInput> inputs,
                       double end) {
  try {
    SceneWriter writer(scene);
    for (const RecordedInput& input : inputs) writer.add(input);
    return writer.finish(end);
  } catch (const Ordered::exception& error) {
    throw InputError(std::string("an input is not understood: ") + error.what());
  }
}

}  // namespace suture
