// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/run/differing_values.hpp"

#include <limits>

#include "kernel/base/error.hpp"
#include "kernel/mesh/box.hpp"
#include "tests/run/host.hpp"

namespace suture::test {

Selection right_half() {
  Selection half;
  half.what = Selection::HalfSpace{{0.5, 0, 0}, {1, 0, 0}};
  half.path = "/right";
  return half;
}

std::uint32_t index_of(const suture_model& model, const std::string& parameter) {
  for (std::uint32_t p = 0; p < model.parameter_count; ++p)
    if (model.parameters[p].name == parameter) return p;
  throw std::logic_error("no parameter " + parameter);
}

CellValues& vary(ModelUse& use, const std::string& parameter) {
  const std::uint32_t p = index_of(*use.model, parameter);
  use.parameters[p] = std::numeric_limits<double>::quiet_NaN();
  CellValues values;
  values.parameter = &use.model->parameters[p];
  values.path = "/models/0/parameters/" + parameter;
  while (use.model->attributes[values.attribute].name != parameter) ++values.attribute;
  return use.values.emplace_back(values);
}

Scene fibres(Index nx, Index n, double k, double element) {
  Scene scene = beam(host(), "tm-faure", nx, n, 0);
  ModelUse& use = scene.models[0];
  use.model = &host().model("fibres-of-test");
  use.parameters =
      parameters(*use.model, {{"mu", 1e5}, {"k", k}, {"rho", 1000}, {"element", element}});
  return scene;
}

Scene statics(Scene scene) {
  scene.solver.integrator = "static";
  scene.solver.end = scene.solver.dt = 1;
  return scene;
}

ColumnsOfMeshes::ColumnsOfMeshes() : mesh_(make_box({.size = {4, 1, 1}, .cells = {4, 1, 1}})) {
  scene_ = fibres(1, 1, 0);
  scene_.mesh.box.reset();
  scene_.mesh.file = folder_ / "m.vtu";
  scene_.constraints[0].where.what = Selection::Plane{{0, 0, 0}, {1, 0, 0}, 1e-6};
  CellValues& fibre = vary(scene_.models[0], "fibre");
  fibre.elsewhere = {0, 3, 4};
}

void ColumnsOfMeshes::add(const std::string& name, bool of_elements, std::size_t components,
                          const std::function<double(const Vec3&, std::size_t)>& value) {
  MeshArray array{name, of_elements, components, {}, {}};
  for (std::size_t i = 0; i < (of_elements ? mesh_.hexahedra.size() : mesh_.points.size()); ++i)
    for (std::size_t c = 0; c < components; ++c)
      array.values.push_back(value(mesh_.points[of_elements ? mesh_.hexahedra[i][0] : i], c));
  mesh_.arrays.push_back(array);
}

CellValues& ColumnsOfMeshes::use_array(const std::string& parameter, const std::string& array) {
  auto& uses = scene_.models[0].values;
  if (parameter == "fibre") uses.clear();
  CellValues& values = vary(scene_.models[0], parameter);
  values.array = array;
  return values;
}

std::vector<double> ColumnsOfMeshes::column(const std::string& name, int dimension) {
  write_mesh(scene_.mesh.file, mesh_, diagnostics_);
  BuiltScene built(scene_, diagnostics_);
  return values_of(*built.body().attributes().instances()[0], name, dimension);
}

std::vector<double> ColumnsOfMeshes::values_of(Instance& instance, const std::string& name,
                                               int dimension) {
  const Column& found = *instance.table(dimension).find(name);
  const CellSet& cells = instance.table(dimension).cells;
  std::vector<double> values;
  for (Index cell = 0; cell < cells.size(); ++cell)
    for (int c = 0; c < found.spec().components; ++c)
      values.push_back(found.get(cells.row(cell), c));
  return values;
}

std::string ColumnsOfMeshes::error() {
  try {
    column("mu");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace suture::test
