// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/build/add_fields.hpp"

#include <algorithm>

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

void add(const FieldCondition& condition, const Selector& selector, Body& body,
         const std::function<std::string(Index)>& name) {
  FieldEquation& equation = body.field(condition.field);
  Vec3 value{};
  value[condition.component] = condition.value;
  if (condition.kind == Kind::flux) {
    if (selector.has_parts() || body.attributes().parts().may_grow())
      equation.fluxes().add_surface_traction(
          body.complex(), selector.surface_triangles(condition.where), value, condition.ramp);
    else
      equation.fluxes().add_traction(body.complex(), selector.boundary_faces(condition.where),
                                     value, condition.ramp);
    return;
  }
  const std::vector<Index> vertices = selector.vertices(condition.where);
  if (condition.kind == Kind::source)
    equation.fluxes().add_force(body.complex(), vertices, value, condition.ramp);
  else if (condition.kind == Kind::start)
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
