// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/penalty_forces.hpp"

#include <algorithm>
#include <utility>

#include "kernel/forces/quad.hpp"

namespace suture {

PenaltyForces::PenaltyForces(Contact& contact, Attributes& attributes, ForceTerm& models)
    : contact_(contact), attributes_(attributes), models_(models) {
  contact_.use_forces();
}

void PenaltyForces::find_stiffness(double time) {
  if (!stiffness_.empty()) return;
  stiffness_.assign(attributes_.vertex_count(), 0);
  models_.add_bounds(time, [&](Index v, const double* stiffness, const double*) {
    stiffness_[v] += stiffening * std::max({stiffness[0], stiffness[1], stiffness[2]});
  });
}

// ------------------------------------------------------------------- forces --

/// visit(push) for all vertices in an obstacle, by obstacle and in the order of the boundary.
template <class Visit>
void PenaltyForces::for_each_push(double time, Visit visit) {
  find_stiffness(time);
  const double* x = attributes_.position().rows();
  for (std::size_t i = 0; i < contact_.obstacles().size(); ++i) {
    const PlacedObstacle placed(contact_.obstacles()[i], contact_.thickness(), time, time);
    for (const Index v : contact_.surface().vertices()) {
      const Vec3 place = row(x, v);
      if (!placed.may_touch(place, 0)) continue;
      const Nearest nearest = placed.gap(place);
      if (nearest.distance >= 0) continue;
      visit(Push{i, v, nearest.normal, scaled(-stiffness_[v] * nearest.distance, nearest.normal)});
    }
  }
}

void PenaltyForces::add_forces(double time, const LiveMask& live, double* rows) {
  for_each_push(time, [&](const Push& push) { add_row(rows, live, push.vertex, 1, push.force); });
}

void PenaltyForces::add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) {
  std::vector<Push> pushes;
  for_each_push(step.time, [&](const Push& push) {
    add_row(rows, live, push.vertex, 1, push.force);
    pushes.push_back(push);
  });
  if (!last_.empty()) work_ += work_since_last(pushes);
  const double* x = attributes_.position().rows();
  last_.assign(x, x + std::size_t{attributes_.vertex_count()} * 4);
  pushes_ = std::move(pushes);
  record(pushes_, step.time);
}

/// By the trapezoidal rule: (f + f') / 2 . (x' - x).
double PenaltyForces::work_since_last(const std::vector<Push>& pushes) const {
  const double* x = attributes_.position().rows();
  double work = 0;
  for (const std::vector<Push>* list : {&pushes_, &pushes})
    for (const Push& push : *list)
      work += dot(push.force, minus(row(x, push.vertex), row(last_.data(), push.vertex))) / 2;
  return work;
}

void PenaltyForces::add_forces_at(const VertexSelection& selection, std::span<const Index>,
                                  double time, std::vector<Vec3>& forces) {
  for_each_push(time, [&](const Push& push) {
    if (!selection.contains(push.vertex)) return;
    Vec3& force = forces[selection.slot(push.vertex)];
    force = plus(force, push.force);
  });
}

/// For the tables and fields of contact.
void PenaltyForces::record(const std::vector<Push>& pushes, double time) {
  std::vector<Contact::Touch> touches;
  std::vector<Contact::Load> loads(contact_.obstacles().size());
  for (const Push& push : pushes) {
    touches.push_back({push.vertex, push.force});
    const PlacedObstacle placed(contact_.obstacles()[push.obstacle], 0, time, time);
    const Vec3 arm = minus(row(attributes_.position().rows(), push.vertex), placed.centre());
    Contact::Load& load = loads[push.obstacle];
    load.force = minus(load.force, push.force);
    load.torque = minus(load.torque, cross(arm, push.force));
  }
  contact_.record(std::move(touches), std::move(loads), 0);
}

// ------------------------------------------------------------------ tangents --

/// -k n n^T, without the derivatives of n, which are smaller by the depth over the radius.
void PenaltyForces::add_tangent(const double* d, double dx, double, const TangentTime& at,
                                double* out) {
  for_each_push(at.time, [&](const Push& push) {
    const std::size_t i = std::size_t{push.vertex} * 3;
    const double along = dot(push.normal, {d[i], d[i + 1], d[i + 2]});
    const double factor = -dx * stiffness_[push.vertex] * along;
    for (std::size_t c = 0; c < 3; ++c) out[i + c] += factor * push.normal[c];
  });
}

/// Of all vertices of the boundary: any may touch in the next step.
void PenaltyForces::add_bounds(double time, const AddBounds& sums) {
  find_stiffness(time);
  const double none[6]{};
  for (const Index v : contact_.surface().vertices()) {
    const double k = stiffness_[v], bound[6]{k, k, k, 0, 0, 0};
    sums(v, bound, none);
  }
}

// -------------------------------------------------------- operations and state --

void PenaltyForces::restart() {
  work_ = 0;
  forget_last();
}

void PenaltyForces::follow(const CellComplex&, const TopologyChange&) {
  stiffness_.clear();
  forget_last();
}

void PenaltyForces::state(Archive& archive) {
  if (archive.has_cells()) archive("stiffness", stiffness_);
  archive("work", work_);
  archive("last position", last_);
  archive.member("pushed by", pushes_, &Push::obstacle);
  archive.member("pushed", pushes_, &Push::vertex);
  archive.member("normals", pushes_, &Push::normal);
  archive.member("forces", pushes_, &Push::force);
}

}  // namespace suture
