// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>

#include "kernel/scene/scene_parts.hpp"

namespace suture::scene_parts {
namespace {

// A time that must lie within the run.
double read_time(ObjectReader& object, const std::string& key, const Scene& scene) {
  const double time = object.number(key, Limits::not_negative("s")).value_or(0);
  if (scene.solver.end && time > *scene.solver.end) {
    const std::string text = describe(*object.find(key));  // "the number 2"
    object.complain(key, "is after the end of the run (/solver/end); is " + text);
  }
  return time;
}

Condition read_condition(ObjectReader object) {
  Condition condition;
  if (const JsonValue* where = object.require("where", "the nodes to observe"))
    condition.where = read_selection(*where, object.path_of("where"), object.mistakes());
  static const std::array<std::string, 3> quantities{"displacement", "velocity", "position"};
  object.require("of", "\"displacement\", \"velocity\" or \"position\"");
  condition.of = static_cast<Condition::Of>(object.choice("of", quantities).value_or(0));
  static const std::array<std::string, 4> components{"x", "y", "z", "magnitude"};
  condition.component = static_cast<int>(object.choice("component", components).value_or(3));
  static const std::array<std::string, 2> sides{"above", "below"};
  const std::string unit = condition.of == Condition::Of::velocity ? "m/s" : "m";
  if (const auto side = object.one_of(sides)) {
    condition.above = *side == 0;
    condition.bound = object.number(sides[*side], Limits::any(unit)).value_or(0);
  }
  condition.every = object.natural("every", 1).value_or(1);
  object.finish();
  return condition;
}

// 'from' and 'until' of an event that repeats.
void read_interval(ObjectReader& object, Event& event, const Scene& scene) {
  const bool repeats = object.find("every") != nullptr;
  for (const char* key : {"from", "until"}) {
    if (!repeats && object.find(key) != nullptr)
      object.complain(key, "is only allowed with 'every' (steps)");
  }
  event.from = read_time(object, "from", scene);
  if (object.find("until") != nullptr) {
    event.until = read_time(object, "until", scene);
    if (*event.until < event.from) object.complain("until", "is before 'from'");
  }
}

void read_schedule(ObjectReader& object, Event& event, const Scene& scene) {
  static const std::array<std::string, 3> kinds{"at", "every", "when"};
  if (std::holds_alternative<CutBlade>(event.what)) {
    for (const char* key : {"at", "every", "when", "from", "until"}) {
      if (object.find(key) != nullptr)
        object.complain(key,
                        "is not allowed here: the path of the blade contains its times; remove it");
    }
    return;
  }
  const auto kind = object.one_of(kinds);
  if (kind == 0u) event.at = read_time(object, "at", scene);
  if (kind == 1u) event.every = object.natural("every", 1).value_or(1);
  if (kind == 1u && event.is_hold())
    object.complain("every", "has no meaning for " + std::string(event.operation()) +
                                 ", which happens once; give 'at' or 'when'");
  if (kind == 2u) {
    event.when = read_condition({*object.find("when"), object.path_of("when"), object.mistakes()});
  }
  read_interval(object, event, scene);
}

std::optional<EventOperation> read_operation(ObjectReader& object, Reading& reading) {
  static const std::array<std::string, 7> kinds{
      "cut", "pierce", "tear", "suture", "remove_islands", "grasp", "release"};
  const auto kind = object.one_of(kinds);
  if (!kind) return {};
  if (*kind == 6) return Release{object.string("release").value_or("")};
  const ObjectReader inner(*object.find(kinds[*kind]), object.path_of(kinds[*kind]),
                           object.mistakes());
  if (*kind == 0) return read_cut(inner, reading);
  if (*kind == 1) return read_pierce(inner);
  if (*kind == 2) return read_tear(inner, reading);
  if (*kind == 3) return read_suture(inner);
  if (*kind == 4) return read_remove_islands(inner);
  return read_grasp(inner, reading);
}

// Which operations have geometry that may be looked up in either shape.
bool has_shape(const EventOperation& what) {
  return std::holds_alternative<CutPlane>(what) || std::holds_alternative<CutSurface>(what) ||
         std::holds_alternative<Pierce>(what);
}

// The operation of an event, and the shape that it acts on.
void read_what(ObjectReader& object, Event& event, Reading& reading) {
  const auto operation = read_operation(object, reading);
  if (operation) event.what = *operation;
  static const std::array<std::string, 2> body_shapes{"deformed", "rest"};
  event.rest_shape = object.choice("shape", body_shapes) == 1u;
  if (operation && object.find("shape") != nullptr && !has_shape(*operation) &&
      !std::holds_alternative<CutFaces>(*operation)) {
    object.complain("shape",
                    std::string("has no meaning for ") + event.operation() +
                        (std::holds_alternative<CutBlade>(*operation)
                             ? " by a moving blade, which always acts on the deformed shape"
                             : ""));
  }
}

void read_event(ObjectReader& object, Reading& reading) {
  Event event;
  event.path = object.path();
  read_what(object, event, reading);
  read_schedule(object, event, reading.scene);
  event.on_failure = read_on_failure(object);
  reading.scene.events.push_back(std::move(event));
}

}  // namespace

Event read_event_now(ObjectReader& object, Reading& reading) {
  Event event;
  event.path = "event";
  read_what(object, event, reading);
  object.finish();
  return event;
}

void read_debris(ObjectReader& top, Reading& reading) {
  DebrisOptions& debris = reading.scene.debris;
  debris.removes = reading.scene.divides_elements();
  const JsonValue* value = top.find("debris");
  if (value == nullptr) return;
  ObjectReader object(*value, "/debris", reading.mistakes);
  static const std::array<std::string, 2> fates{"remove", "keep"};
  debris.removes = object.choice("do", fates).value_or(0) == 0;
  if (object.find("below") != nullptr && object.find("volume") != nullptr)
    object.complain("volume",
                    "cannot be combined with 'below', which is a part of a typical element; "
                    "remove one of them");
  debris.fraction = object.number("below", Limits::positive("1")).value_or(debris.fraction);
  debris.volume = object.number("volume", Limits::positive("m^3"));
  object.finish();
}

void read_events(ObjectReader& top, Reading& reading) {
  for_each_object(top, "events", "events",
                  [&](ObjectReader& object) { read_event(object, reading); });
  check_grasps(top, reading.scene);
  std::vector<Event>& events = reading.scene.events;
  std::stable_sort(events.begin(), events.end(),
                   [](const Event& a, const Event& b) { return a.start() < b.start(); });
}

}  // namespace suture::scene_parts
