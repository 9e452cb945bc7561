// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <random>
#include <string>

#include "kernel/plugin_host/plugin_host.hpp"
#include "kernel/scene/scene.hpp"

namespace suture {
class Simulation;
}

namespace suture::test {

constexpr double robust_edge = 0.1;  ///< of all elements, m

/// A scene with contact, whose start differs a little with each seed.
struct RobustScene {
  Scene scene;
  std::function<void(Simulation&)> start{};  ///< called before the first step
};
struct RobustCase {
  const char* name;
  RobustScene (*make)(PluginHost& host, std::mt19937& random);
  bool comes_to_rest = false;  ///< until nothing moves, if the run has no end
};
const std::vector<RobustCase>& robust_cases();

}  // namespace suture::test
