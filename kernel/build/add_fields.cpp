// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/build/add_fields.hpp"

#include <algorithm>
#include <span>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

using Kind = FieldCondition::Kind;

void prescribe(const FieldCondition& condition, const std::vector<Index>& vertices,
               FieldEquation& equation, const std::function<std::string(Index)>& name) {
  const Index contradicted = equation.prescribe(vertices, condition.path, condition.component);
  if (contradicted == none) return;
  throw InputError(condition.place + ": prescribes another '" + condition.field +
                   "' than an earlier condition at " + name(contradicted) +
                   "; select other nodes, or remove one of the two");
}

/// Into nodes or faces: `amount` of a component.
void add_flow(const FieldCondition& condition, double amount, const Selector& selector, Body& body,
              DeadLoads& flows) {
  Vec3 value{};
  value[condition.component] = amount;
  if (condition.kind == Kind::source)
    flows.add_force(body.complex(), selector.vertices(condition.where), value, condition.ramp);
  else if (selector.has_parts() || body.attributes().parts().may_grow())
    flows.add_surface_traction(body.complex(), selector.surface_triangles(condition.where), value,
                               condition.ramp);
  else
    flows.add_traction(body.complex(), selector.boundary_faces(condition.where), value,
                       condition.ramp);
}

bool changes(const Instance& instance, const std::string& field) {
  const suture_model& model = instance.model();
  return std::ranges::any_of(std::span(model.functors, model.functor_count),
                             [&](const suture_functor& f) {
                               return f.field != 0 && model.attributes[f.field - 1].name == field;
                             });
}

/// Refuses what flows into nodes around which no model takes the field further.
void require_changes(const FieldCondition& condition, const Selector& selector, Body& body,
                     const std::function<std::string(Index)>& name) {
  Attributes& attributes = body.attributes();
  std::vector<bool> is_changed(attributes.vertex_count());
  std::string models;
  for (const auto& instance : attributes.instances()) {
    if (!changes(*instance, condition.field)) continue;
    models += (models.empty() ? "" : ", ") + instance->title();
    for (Index e = 0; e < body.complex().element_count(); ++e)
      if (instance->table(3).cells.contains(e))
        for (const Index v : body.complex().vertices_of(e)) is_changed[v] = true;
  }
  DeadLoads alone(attributes);
  add_flow(condition, condition.value, selector, body, alone);
  std::vector<double> rows(is_changed.size() * 4);
  alone.add_forces(condition.ramp.to, attributes.kernel(0).cells.live(), rows.data());
  for (Index v = 0; v < is_changed.size(); ++v)
    if (rows[std::size_t{v} * 4 + condition.component] != 0 && !is_changed[v])
      throw InputError(condition.place + ": '" + condition.field + "' flows into " + name(v) +
                       ", which lies outside the region of " + models +
                       ": no other model changes this field; extend the region, or select other "
                       "nodes");
}

void add(const FieldCondition& condition, const Selector& selector, Body& body,
         const std::function<std::string(Index)>& name) {
  FieldEquation& equation = body.field(condition.field);
  if (condition.kind >= Kind::flux) {
    require_changes(condition, selector, body, name);
    const double outside = condition.kind == Kind::film ? condition.outside : 1;
    add_flow(condition, condition.value * outside, selector, body, equation.fluxes());
    if (condition.kind == Kind::film)
      add_flow(condition, condition.value, selector, body, equation.film_coefficients());
    return;
  }
  const std::vector<Index> vertices = selector.vertices(condition.where);
  if (condition.kind == Kind::start)
    equation.set(vertices, condition.value, condition.component);
  else
    prescribe(condition, vertices, equation, name);
}

}  // namespace

void add_fields(const Scene& scene, const Selector& selector, Body& body,
                const std::function<std::string(Index)>& name) {
  for (const FieldCondition& condition : scene.fields) add(condition, selector, body, name);
}

}  // namespace suture
