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

/// Time per cut face, beside CGAL's unsew<3>.
void add_cut(CLI::App& app, std::vector<Command>& commands);
/// Time and memory per hexahedron of building the map from a mesh.
void add_build(CLI::App& app, std::vector<Command>& commands);
/// Rates of the models' forces through the SDK, by size, fresh and after cuts.
void add_force(CLI::App& app, std::vector<Command>& commands);
/// Where the time of a step goes.
void add_step(CLI::App& app, std::vector<Command>& commands);
/// Time until the paper's cantilever is at rest.
void add_rest(CLI::App& app, std::vector<Command>& commands);

}  // namespace suture::bench
