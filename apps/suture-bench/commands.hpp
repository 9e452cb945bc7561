// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "apps/suture-bench/report.hpp"

namespace CLI {
class App;
}

namespace suture::bench {

struct Command {
  CLI::App* app;
  std::function<void(Report&)> run;
};

/// Rates of the models' forces through the SDK, by size, fresh and after cuts.
void add_force(CLI::App& app, std::vector<Command>& commands);
/// Where the time of a step goes.
void add_step(CLI::App& app, std::vector<Command>& commands);

}  // namespace suture::bench
