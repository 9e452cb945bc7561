// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/step_limits.hpp"

namespace suture {

StepLimits::StepLimits(Body& body) : body_(body), search_(body) { body.add_follower(*this); }

double StepLimits::stable_step(double time, bool from_random) {
  if (from_random) search_.forget();
  if (body_.models().has_tangent()) {
    const double dt = search_.largest(time);
    if (dt > 0) return dt;  // false if the state is beyond numbers
  }
  return bounds(time).dt;
}

StepBounds StepLimits::bounds(double time) {
  Attributes& attributes = body_.attributes();
  std::vector<BoundSums> sums(attributes.vertex_count());
  for (const auto& term : body_.terms())
    term->add_bounds(time, [&](Index v, const double* k, const double* c) { sums[v].add(k, c); });
  StepBounds bounds;
  for (Index v = 0; v < attributes.vertex_count(); ++v) bounds.include(v, sums[v], attributes);
  return bounds;
}

StepBounds StepLimits::bounds_at(std::span<const Index> vertices, double time) {
  StepBounds bounds;
  if (vertices.empty()) return bounds;
  Attributes& attributes = body_.attributes();
  selection_.select(vertices, attributes.vertex_count());
  std::vector<BoundSums> sums(vertices.size());
  for (const auto& term : body_.terms())
    term->add_bounds_at(selection_, vertices, time, [&](Index v, const double* k, const double* c) {
      if (selection_.contains(v)) sums[selection_.slot(v)].add(k, c);
    });
  for (std::size_t i = 0; i < vertices.size(); ++i)
    bounds.include(vertices[i], sums[i], attributes);
  return bounds;
}

StepBounds StepLimits::bounds_of_changes(double time) {
  return bounds_at(changed_.take(body_.complex()), time);
}

void StepLimits::follow(const CellComplex& complex, const TopologyChange& change) {
  search_.follow(change);
  changed_.add(complex, change, body_.models().reads_summed_columns());
}

void StepLimits::state(Archive& archive) {
  archive("search", search_);
  archive("changed", changed_);
}

}  // namespace suture
