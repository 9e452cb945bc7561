// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/contact_term.hpp"

#include <algorithm>

#include "kernel/forces/quad.hpp"

namespace suture {

ContactTerm::ContactTerm(Contact& contact, Attributes& attributes, BoundedTerm& models,
                         double stiffening)
    : contact_(contact), attributes_(attributes), models_(models), stiffening_(stiffening) {
  contact_.use_forces();
}

void ContactTerm::find_stiffness(double time) {
  if (!stiffness_.empty()) return;
  stiffness_.assign(attributes_.vertex_count(), 0);
  models_.add_bounds(time, [&](Index v, const double* stiffness, const double*) {
    stiffness_[v] += stiffening_ * std::max({stiffness[0], stiffness[1], stiffness[2]});
  });
}

void ContactTerm::add_forces(double time, const LiveMask& live, double* rows) {
  for (const Contact::Force& on : forces_at(time)) add_row(rows, live, on.vertex, 1, on.force);
}

void ContactTerm::add_forces_at(const VertexSelection& selection, std::span<const Index>,
                                double time, std::vector<Vec3>& forces) {
  for (const Contact::Force& on : forces_at(time)) {
    if (!selection.contains(on.vertex)) continue;
    Vec3& force = forces[selection.slot(on.vertex)];
    force = plus(force, on.force);
  }
}

}  // namespace suture
