// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/run/beam.hpp"

#include <stdexcept>

namespace suture::test {

PluginHost& tree_plugins() {
  static PluginHost plugins;
  return plugins;
}

std::vector<double> parameters(const suture_model& model,
                               const std::map<std::string, double>& values) {
  std::vector<double> result;
  std::size_t used = 0;
  for (std::uint32_t p = 0; p < model.parameter_count; ++p) {
    const auto found = values.find(model.parameters[p].name);
    used += found != values.end();
    result.push_back(found != values.end() ? found->second : model.parameters[p].default_value);
  }
  if (used != values.size()) throw std::logic_error("a value names no parameter of the model");
  return result;
}

Scene beam(PluginHost& host, const std::string& model, Index nx, Index n, double gravity,
           const std::map<std::string, double>& values) {
  Scene scene;
  scene.title = "the paper's beam";
  scene.mesh.box = BoxOptions{{0, 0, 0}, {1, 0.25, 0.25}, {nx, n, n}, {1, 1, 1}};
  std::map<std::string, double> all{{"E", 400e3}, {"nu", 0.3}, {"rho", 1000}};
  for (const auto& [name, value] : values) all[name] = value;
  ModelUse use;
  use.name = model;
  use.model = &host.model(model);
  use.parameters = parameters(*use.model, all);
  scene.models.push_back(use);
  scene.gravity = {0, -gravity, 0};
  Constraint clamp;
  clamp.where.what = Selection::Named{"x0"};
  scene.constraints.push_back(clamp);
  scene.output.enabled = false;
  return scene;
}

Selection beam_tip(Index n) {
  const double reach = (n % 2 == 1 ? 0.125 / n : 0) + 1e-6;
  Selection tip;
  tip.what = Selection::InBox{{1 - 1e-6, 0.125 - reach, 0.125 - reach},
                              {1 + 1e-6, 0.125 + reach, 0.125 + reach}};
  tip.path = "/tip";
  return tip;
}

}  // namespace suture::test
