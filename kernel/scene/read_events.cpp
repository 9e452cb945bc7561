// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>

#include "kernel/scene/scene_parts.hpp"

namespace suture::scene_parts {
namespace {

CutPlane read_plane(ObjectReader plane) {
  CutPlane cut;
  cut.point = require_vector(plane, "point", "m", "a point of the plane [x, y, z] in m");
  plane.require("normal", "the direction across the cut [x, y, z]");
  cut.normal = read_direction(plane, "normal").value_or(Vec3{1, 0, 0});
  plane.finish();
  return cut;
}

std::optional<std::array<std::uint64_t, 2>> read_pair(const JsonValue& value,
                                                      const std::string& path, Mistakes& mistakes) {
  if (value.kind != JsonValue::Kind::array || value.items.size() != 2) {
    mistakes.add(value.at, path,
                 "must be the numbers of the two elements of a face [a, b], is " + describe(value));
    return {};
  }
  const auto a = read_natural(value.items[0], child_path(path, 0), 0, UINT64_MAX, mistakes);
  const auto b = read_natural(value.items[1], child_path(path, 1), 0, UINT64_MAX, mistakes);
  if (!a || !b) return {};
  if (*a == *b) {
    mistakes.add(value.at, path, "names element " + std::to_string(*a) + " twice; a face has two");
    return {};
  }
  return std::array{*a, *b};
}

CutFaces read_faces(const JsonValue& value, const std::string& path, Mistakes& mistakes) {
  CutFaces cut;
  const auto* items = read_array(value, path, "pairs of element numbers", mistakes);
  if (items == nullptr) return cut;
  if (items->empty()) mistakes.add(value.at, path, "is empty: cuts nothing");
  for (std::size_t i = 0; i < items->size(); ++i) {
    if (const auto pair = read_pair((*items)[i], child_path(path, i), mistakes)) {
      cut.element_pairs.push_back(*pair);
    }
  }
  return cut;
}

void read_cut(ObjectReader cut, Event& event) {
  static const std::array<std::string, 2> kinds{"plane", "faces"};
  if (const auto kind = cut.one_of(kinds)) {
    const JsonValue& inner = *cut.find(kinds[*kind]);
    const std::string path = cut.path_of(kinds[*kind]);
    if (*kind == 0) event.what = read_plane({inner, path, cut.mistakes()});
    if (*kind == 1) event.what = read_faces(inner, path, cut.mistakes());
  }
  cut.finish();
}

void read_event(ObjectReader& object, Reading& reading) {
  Event event;
  event.path = object.path();
  object.require("at", "when it happens, in s");
  event.at = object.number("at", Range::not_negative("s")).value_or(0);
  const auto& end = reading.scene.solver.end;
  if (end && event.at > *end) {
    const std::string text = describe(*object.find("at"));  // "the number 2"
    object.complain("at", "is after the end of the run (/solver/end); is " + text);
  }
  if (const JsonValue* cut = object.require("cut", "what happens")) {
    read_cut({*cut, object.path_of("cut"), reading.mistakes}, event);
  }
  static const std::array<std::string, 2> shapes{"deformed", "rest"};
  event.rest_shape = object.choice("shape", shapes) == 1u;
  reading.scene.events.push_back(std::move(event));
}

}  // namespace

void read_events(ObjectReader& top, Reading& reading) {
  for_each_object(top, "events", "events",
                  [&](ObjectReader& object) { read_event(object, reading); });
  std::vector<Event>& events = reading.scene.events;
  std::stable_sort(events.begin(), events.end(),
                   [](const Event& a, const Event& b) { return a.at < b.at; });
}

}  // namespace suture::scene_parts
