// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/penalty_forces.hpp"

#include <algorithm>
#include <utility>

#include "kernel/forces/quad.hpp"

namespace suture {

// ------------------------------------------------------------------- forces --

/// visit(obstacle, vertex, nearest) for all vertices in an obstacle, by obstacle and in the order
/// of the boundary.
template <class Visit>
void PenaltyForces::for_each_push(double time, Visit visit) {
  find_stiffness(time);
  const double* x = attributes_.position().rows();
  for (std::size_t i = 0; i < contact_.obstacles().size(); ++i) {
    const PlacedObstacle placed(contact_.obstacles()[i], contact_.thickness(),
                                last_.empty() ? time : last_time_, time);
    for (const Index v : contact_.surface().vertices()) {
      const Vec3 place = row(x, v), start = last_.empty() ? place : row(last_.data(), v);
      const Vec3* side = contact_.sides().outside(i, v);
      if (!side && !placed.may_meet(start, place, 0)) continue;
      const Nearest nearest = side ? placed.gap_from(*side, place) : placed.gap(start, place);
      if (nearest.distance < 0) visit(i, v, nearest);
    }
  }
}

PenaltyForces::Forces PenaltyForces::forces_at(double time) {
  Forces forces;
  const double e = onset * contact_.mean_edge();
  for_each_push(time, [&](std::size_t obstacle, Index v, const Nearest& nearest) {
    const double depth = -nearest.distance, within = std::min(depth, e);
    const double force = stiffness_[v] * (within * within / (2 * e) + depth - within);
    forces.push_back({v, scaled(force, nearest.normal), obstacle, nearest});
  });
  return forces;
}

void PenaltyForces::add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) {
  Forces forces = forces_at(step.time);
  for (const Contact::Force& on : forces) add_row(rows, live, on.vertex, 1, on.force);
  if (!last_.empty()) work_ += work_since_last(forces);
  const double* x = attributes_.position().rows();
  last_.assign(x, x + std::size_t{attributes_.vertex_count()} * 4);
  last_time_ = step.time;
  forces_ = std::move(forces);
  contact_.record(forces_, step.time, 0);
}

/// By the trapezoidal rule: (f + f') / 2 . (x' - x).
double PenaltyForces::work_since_last(const Forces& forces) const {
  const double* x = attributes_.position().rows();
  double work = 0;
  for (const Forces* list : {&forces_, &forces})
    for (const Contact::Force& on : *list)
      work += dot(on.force, minus(row(x, on.vertex), row(last_.data(), on.vertex))) / 2;
  return work;
}

// ------------------------------------------------------------------ tangents --

/// -k min(1, d / e) n n^T, without the derivatives of n, which are smaller by the depth over the
/// radius.
void PenaltyForces::add_tangent(const double* d, double dx, double, const TangentTime& at,
                                double* out) {
  const double e = onset * contact_.mean_edge();
  for_each_push(at.time, [&](std::size_t, Index v, const Nearest& nearest) {
    const std::size_t i = std::size_t{v} * 3;
    const double along = dot(nearest.normal, {d[i], d[i + 1], d[i + 2]});
    const double k = stiffness_[v] * std::min(1., -nearest.distance / e);
    const double factor = -dx * k * along;
    for (std::size_t c = 0; c < 3; ++c) out[i + c] += factor * nearest.normal[c];
  });
}

/// Of all vertices of the boundary: any may touch in the next step.
void PenaltyForces::add_bounds(double time, const AddBounds& sums) {
  find_stiffness(time);
  const double no_coupling[6]{};
  for (const Index v : contact_.surface().vertices()) {
    const double k = stiffness_[v], bound[6]{k, k, k, 0, 0, 0};
    sums(v, bound, no_coupling);
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
  archive("last time", last_time_);
  archive.member("pushed by", forces_, &Contact::Force::obstacle);
  archive.member("pushed", forces_, &Contact::Force::vertex);
  archive.member("forces", forces_, &Contact::Force::force);
}

}  // namespace suture
