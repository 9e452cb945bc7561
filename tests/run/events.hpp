// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "kernel/run/simulation.hpp"

namespace suture::test {

/// The first event of a scene.
inline Event event_of(EventOperation what, double at = 0) {
  Event event;
  event.at = at;
  event.what = std::move(what);
  event.path = "/events/0";
  return event;
}

/// Keeps the messages of a run.
struct Listener : Observer {
  std::vector<std::string> lines;
  void on_message(const std::string& line) override { lines.push_back(line); }
};

}  // namespace suture::test
