// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/work_scene.hpp"

#include "kernel/mesh/box.hpp"

namespace suture::bench {

using Json = nlohmann::json;

double WorkMesh::dofs() const { return 3.0 * (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1); }

std::string WorkMesh::name() const {
  std::string text =
      std::to_string(cells[0]) + "x" + std::to_string(cells[1]) + "x" + std::to_string(cells[2]);
  if (grading != 1) text += " graded " + std::to_string(static_cast<int>(grading));
  return text;
}

WorkMethod static_method(const std::string& model, const std::string& element,
                         std::vector<WorkMesh> meshes) {
  const std::string parameters = element.empty() ? "{}" : R"({"element": ")" + element + R"("})";
  return {model + (element.empty() ? "" : " " + element) + ", static", model, parameters,
          static_solver, std::move(meshes)};
}

Json box_scene(const WorkMesh& mesh, const Vec3& size, const WorkMethod& method,
               const Json& material) {
  Json parameters = Json::parse(method.parameters);
  parameters.update(material);
  Json box = {{"size", size}, {"cells", mesh.cells}};
  if (mesh.grading != 1) box["grading"] = {mesh.grading, 1, 1};
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
Json tip_probe(const WorkMesh& mesh) {
  const double reach = 0.6 * 0.25 / mesh.cells[1];
  return {{"name", "tip"},
          {"fields", {"displacement"}},
          {"where",
           {{"box",
             {{"min", {1 - 1e-6, 0.125 - reach, 0.125 - reach}},
              {"max", {1 + 1e-6, 0.125 + reach, 0.125 + reach}}}}}}};
}

}  // namespace

Json cantilever_scene(const Cantilever& what, const WorkMesh& mesh, const WorkMethod& method) {
  Json scene =
      box_scene(mesh, {1, 0.25, 0.25}, method, {{"E", 4e5}, {"nu", what.nu}, {"rho", 1000}});
  scene["gravity"] = {0, -what.gravity, 0};
  scene["constraints"] = {held("x0")};
  scene["output"] = tables(tip_probe(mesh));
  return scene;
}

Mesh box_of(const Json& scene) {
  const Json& box = scene["mesh"]["box"];
  return make_box({box.value("origin", Vec3{}), box["size"], box["cells"],
                   box.value("grading", Vec3{1, 1, 1})});
}

}  // namespace suture::bench
