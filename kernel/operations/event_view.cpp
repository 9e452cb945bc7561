// SPDX-License-Identifier: GPL-3.0-or-later
//
// What others see of events: outcomes, opened faces, blades, and what had no effect.
#include "kernel/base/archive.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/forces/contact_law.hpp"
#include "kernel/geometry/moving_blade.hpp"
#include "kernel/geometry/surface_blade.hpp"
#include "kernel/operations/cut_faces.hpp"
#include "kernel/operations/event_runner.hpp"
#include "kernel/operations/swept_sheet.hpp"

namespace suture {

EventOutcome& EventOutcome::operator+=(const EventOutcome& other) {
  faces_cut += other.faces_cut;
  faces_torn += other.faces_torn;
  faces_sewn += other.faces_sewn;
  elements_removed += other.elements_removed;
  elements_cut += other.elements_cut;
  elements_sewn += other.elements_sewn;
  nodes_held += other.nodes_held;
  nodes_released += other.nodes_released;
  debris += other.debris;
  area += other.area;
  return *this;
}

void EventOutcome::state(Archive& archive) {
  archive("faces cut", faces_cut);
  archive("faces torn", faces_torn);
  archive("faces sewn", faces_sewn);
  archive("elements removed", elements_removed);
  archive("elements cut", elements_cut);
  archive("elements sewn", elements_sewn);
  archive("nodes held", nodes_held);
  archive("nodes released", nodes_released);
  archive("debris", debris);
  archive("area opened", area.opened);
  archive("area of blade", area.blade);
}

std::string EventOutcome::text() const {
  std::string text;
  const auto add = [&](const char* verb, Index n, const char* what) {
    if (n > 0) text += (text.empty() ? "" : ", ") + std::string(verb) + count_text(n, what);
  };
  add("cut ", elements_cut, "element");
  add("cut ", faces_cut, "face");
  if (area.blade > 0) text += " (" + area.text() + ")";
  add("sewed ", elements_sewn, "element");
  add("tore ", faces_torn, "face");
  add("sewed ", faces_sewn, "face");
  add("removed ", elements_removed, "element");
  if (debris.pieces > 0)
    text +=
        " (debris: " + count_text(debris.pieces, "piece") + ", " + volume_text(debris.volume) + ")";
  add("grasped ", nodes_held, "node");
  add("released ", nodes_released, "node");
  return text;
}

MovingBlade EventRunner::blade_of(const CutBlade& cut) const {
  if (cut.carried) return MovingBlade::carried(points_of(*cut.carried, 0));
  std::vector<BladeKey> keys;
  for (const CutBlade::Station& station : cut.stations)
    keys.push_back({station.at, station.points});
  return MovingBlade(std::move(keys));
}

std::vector<Vec3> EventRunner::points_of(const CutBlade::Carried& carried, double time) const {
  const Pose pose = built_.body().contact()->pose(carried.obstacle, time);
  std::vector<Vec3> points = carried.points;
  for (Vec3& point : points) point = pose.place(point);
  return points;
}

std::vector<BladeShape> EventRunner::blades(double time) const {
  std::vector<BladeShape> shapes;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const State& state = states_[i];
    const auto number = static_cast<std::uint32_t>(i);
    if (state.blade && state.blade->begin() <= time && time <= state.blade->end())
      shapes.push_back({number, state.blade->at(time), {}});
    const TriangleSurface* surface = state.surface ? &state.surface->surface()
                                     : state.patch ? &state.patch->surface()
                                                   : nullptr;
    if (surface && (!state.has_fired || state.last >= time || scene_.events[i].every > 0))
      shapes.push_back({number, surface->points, surface->triangles});
  }
  return shapes;
}

void EventRunner::finish() {
  for (std::size_t i = 0; i < scene_.events.size(); ++i) {
    const Event& event = scene_.events[i];
    const bool reported = event.is_timed() || (event.when && states_[i].has_fired);  // at its time
    if (states_[i].had_effect || reported) continue;
    std::string text = event.path + ": " + event.operation() + " had no effect in the whole run";
    if (event.when) text += ": its condition was never met";
    if (states_[i].blade) {
      text += ": " + why_nothing_was_cut(states_[i].blade->box(), built_.body().complex(),
                                         Places{built_.body().attributes().position().rows()},
                                         built_.frame().origin, states_[i].sheet != nullptr);
    }
    diagnostics_.warn(text);
  }
}

void OpenedFace::state(Archive& archive) {
  archive("side", side);
  archive("event", event);
  archive("time", time);
}

}  // namespace suture
