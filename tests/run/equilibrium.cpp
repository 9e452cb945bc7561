// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/run/equilibrium.hpp"

#include <cmath>

#include "kernel/results/fields.hpp"

namespace suture::test {
namespace {

using Eigen::Vector3d;

constexpr double slack = 1e-6, far = 1e9;

Scene solved_statically(Scene scene) {
  scene.solver.integrator = "static";
  scene.solver.threads = 1;
  return scene;
}

Vector3d row(const Column& column, Index v) {
  return {column.get(v, 0), column.get(v, 1), column.get(v, 2)};
}

Vector3d sum_of(const char* field, BuiltScene& built, const Selection& where) {
  const auto& fields = kernel_fields();
  const auto choice = std::ranges::find(fields, field, &FieldChoice::name);
  Vector3d sum = Vector3d::Zero();
  for (const Index v : built.selector().vertices(where))
    for (int c = 0; c < 3; ++c) sum[c] += choice->value(built, built.scene().gravity, v, c);
  return sum;
}

}  // namespace

Scene block(PluginHost& host, const std::string& model, const Vec3& size,
            const std::array<Index, 3>& cells, const std::map<std::string, double>& values) {
  Scene scene;
  scene.mesh.box = BoxOptions{{0, 0, 0}, size, cells, {1, 1, 1}};
  ModelUse use;
  use.name = model;
  use.model = &host.model(model);
  use.parameters = parameters(*use.model, values);
  scene.models.push_back(use);
  scene.output.enabled = false;
  return scene;
}

Selection within(const Vec3& min, const Vec3& max) {
  Selection::InBox box{min, max};
  for (std::size_t c = 0; c < 3; ++c) box.min[c] -= slack, box.max[c] += slack;
  Selection selection;
  selection.what = box;
  return selection;
}

Selection at(const Vec3& coordinates) {
  Vec3 min = coordinates, max = coordinates;
  for (std::size_t c = 0; c < 3; ++c)
    if (std::isnan(coordinates[c])) min[c] = -far, max[c] = far;
  return within(min, max);
}

Constraint& hold(Scene& scene, const Selection& where, std::uint8_t components,
                 const Vec3& translation) {
  Constraint constraint;
  constraint.where = where;
  constraint.components = components;
  constraint.translation = translation;
  constraint.moves = translation != Vec3{};
  constraint.ramp = {0, 1, false};
  return scene.constraints.emplace_back(constraint);
}

void load(Scene& scene, const Selection& where, const Vec3& traction) {
  Load load;
  load.kind = Load::Kind::traction;
  load.value = traction;
  load.where = where;
  load.ramp = {0, 1, false};
  scene.loads.push_back(load);
}

Equilibrium::Equilibrium(const Scene& scene, int steps)
    : built_(solved_statically(scene), diagnostics_) {
  built_.dynamics().start();
  for (int i = 1; i <= steps; ++i) proceed(static_cast<double>(i) / steps);
}

void Equilibrium::proceed(double time) {
  built_.dynamics().step(time - built_.dynamics().time(), time);
  built_.dynamics().synchronise();
}

Vector3d Equilibrium::displacement(const Selection& where) {
  const std::vector<Index> vertices = built_.selector().vertices(where);
  Attributes& attributes = built_.body().attributes();
  Vector3d sum = Vector3d::Zero();
  for (const Index v : vertices) sum += row(attributes.position(), v) - row(attributes.rest(), v);
  return sum / static_cast<double>(vertices.size());
}

Vector3d Equilibrium::reaction(const Selection& where) { return sum_of("reaction", built_, where); }

Vector3d Equilibrium::moment(const Selection& where) {
  return sum_of("reaction_moment", built_, where);
}

double Equilibrium::energy() { return energies(built_.dynamics()).elastic; }

double Equilibrium::distance(const std::function<Vector3d(const Vector3d&)>& place) {
  Attributes& attributes = built_.body().attributes();
  double largest = 0;
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    largest = std::max(largest,
                       (row(attributes.position(), v) - place(row(attributes.rest(), v))).norm());
  return largest;
}

}  // namespace suture::test
