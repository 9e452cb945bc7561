// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/base/archive.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/operations/event_runner.hpp"

namespace suture {

EventOutcome& EventOutcome::operator+=(const EventOutcome& other) {
  faces_cut += other.faces_cut;
  faces_torn += other.faces_torn;
  faces_sewn += other.faces_sewn;
  elements_removed += other.elements_removed;
  elements_cut += other.elements_cut;
  nodes_held += other.nodes_held;
  nodes_released += other.nodes_released;
  return *this;
}

std::string EventOutcome::text() const {
  std::string text;
  const auto add = [&](const char* verb, Index n, const char* what) {
    if (n > 0) text += (text.empty() ? "" : ", ") + std::string(verb) + count_text(n, what);
  };
  add("cut ", elements_cut, "element");
  add("cut ", faces_cut, "face");
  add("tore ", faces_torn, "face");
  add("sewed ", faces_sewn, "face");
  add("removed ", elements_removed, "element");
  add("grasped ", nodes_held, "node");
  add("released ", nodes_released, "node");
  return text;
}

void OpenedFace::state(Archive& archive) {
  archive("side", side);
  archive("event", event);
  archive("time", time);
}

}  // namespace suture
