// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/work_scene.hpp"

namespace suture::bench {

using Json = nlohmann::json;

WorkMethod static_method(const std::string& model, const std::string& element) {
  const std::string parameters = element.empty() ? "{}" : R"({"element": ")" + element + R"("})";
  return {model + (element.empty() ? "" : " " + element) + ", static", model, parameters,
          static_solver};
}

Json box_scene(const std::array<Index, 3>& cells, const Vec3& size, const WorkMethod& method,
               const Json& material) {
  Json parameters = Json::parse(method.parameters);
  parameters.update(material);
  Json box = {{"size", size}, {"cells", cells}};
  return {{"suture", 1},
          {"mesh", {{"box", box}}},
          {"models", {{{"model", method.model}, {"parameters", parameters}}}},
          {"solver", Json::parse(method.solver)}};
}

Json tables(const Json& probe) {
  return {{"frames", false}, {"probes", {{"every_steps", 1000000000}, {"at", {probe}}}}};
}

Json held(const std::string& set) { return {{"fix", "xyz"}, {"where", {{"set", set}}}}; }

namespace {

/// The centre of the end face: one node, or the mean of four.
Json tip_probe(const std::array<Index, 3>& cells) {
  const double reach = 0.6 * 0.25 / cells[1];
  return {{"name", "tip"},
          {"fields", {"displacement"}},
          {"where",
           {{"box",
             {{"min", {1 - 1e-6, 0.125 - reach, 0.125 - reach}},
              {"max", {1 + 1e-6, 0.125 + reach, 0.125 + reach}}}}}}};
}

}  // namespace

Json cantilever_scene(const Cantilever& what, const std::array<Index, 3>& cells,
                      const WorkMethod& method) {
  Json scene =
      box_scene(cells, {1, 0.25, 0.25}, method, {{"E", 4e5}, {"nu", what.nu}, {"rho", 1000}});
  scene["gravity"] = {0, -what.gravity, 0};
  scene["constraints"] = {held("x0")};
  scene["output"] = tables(tip_probe(cells));
  return scene;
}

}  // namespace suture::bench
