// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/penalty_forces.hpp"

#include <algorithm>
#include <utility>

#include "kernel/forces/quad.hpp"

namespace suture {

// ------------------------------------------------------------------- forces --

/// visit(obstacle, point, stiffness, nearest) for all points in an obstacle, by obstacle and in the
/// order of the surface.
template <class Visit>
void PenaltyForces::for_each_push(double time, Visit visit) {
  find_stiffness(time);
  const double* x = attributes_.position().rows();
  for (std::size_t i = 0; i < contact_.obstacles().size(); ++i) {
    if (!contact_.obstacles()[i].pushes) continue;
    const PlacedObstacle placed(contact_.obstacles()[i], contact_.thickness(),
                                last_.empty() ? time : last_time_, time);
    contact_.points().for_each([&](const ContactPoint& point) {
      const Vec3 place = point.sum(x), start = last_.empty() ? place : point.sum(last_.data());
      const Vec3* side = contact_.sides().outside(i, point.number);
      if (!side && !placed.may_meet(start, place, 0)) return;
      const Nearest nearest = side ? placed.gap_from(*side, place) : placed.gap(start, place);
      if (nearest.distance < 0) visit(i, point, stiffness_of(point), nearest);
    });
  }
}

PenaltyForces::Forces PenaltyForces::forces_at(double time) {
  Forces forces;
  const double e = onset * contact_.mean_edge();
  for_each_push(time, [&](std::size_t obstacle, const ContactPoint& point, double stiffness,
                          const Nearest& nearest) {
    const double depth = -nearest.distance, within = std::min(depth, e);
    const double force = stiffness * (within * within / (2 * e) + depth - within);
    for (std::size_t i = 0; i < point.vertices.size(); ++i)
      forces.push_back({point.vertices[i], scaled(point.weights[i] * force, nearest.normal),
                        obstacle, point.number, nearest});
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
  for_each_push(at.time, [&](std::size_t, const ContactPoint& point, double stiffness,
                             const Nearest& nearest) {
    double along = 0;
    for (std::size_t j = 0; j < point.vertices.size(); ++j) {
      const double* of = d + std::size_t{point.vertices[j]} * 3;
      along += point.weights[j] * dot(nearest.normal, {of[0], of[1], of[2]});
    }
    const double k = stiffness * std::min(1., -nearest.distance / e);
    const double factor = -dx * k * along;
    for (std::size_t j = 0; j < point.vertices.size(); ++j)
      for (std::size_t c = 0; c < 3; ++c)
        out[std::size_t{point.vertices[j]} * 3 + c] +=
            point.weights[j] * factor * nearest.normal[c];
  });
}

/// All points of the surface count: any may touch in the next step. Weights add up to 1, so that
/// the row of vertex v in k w w^T is bounded by k w_v.
void PenaltyForces::add_bounds(double time, const AddBounds& sums) {
  find_stiffness(time);
  const double no_coupling[6]{};
  contact_.points().for_each([&](const ContactPoint& point) {
    for (std::size_t i = 0; i < point.vertices.size(); ++i) {
      const double k = point.weights[i] * stiffness_of(point), bound[6]{k, k, k, 0, 0, 0};
      sums(point.vertices[i], bound, no_coupling);
    }
  });
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
