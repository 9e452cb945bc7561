// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/spectrum/step_limits.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

namespace suture {

namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Index bound_portions = 64;
}  // namespace

StepLimits::StepLimits(Body& body) : body_(body), search_(body) { body.add_follower(*this); }

double StepLimits::stable_step(double time, bool from_random) {
  is_searching_ = is_bounding_ = false;
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
  for_each_with<BoundedTerm>(body_.terms(), [&](BoundedTerm& term) {
    term.add_bounds(time, [&](Index v, const double* k, const double* c) { sums[v].add(k, c); });
  });
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
  for_each_with<BoundedTerm>(body_.terms(), [&](BoundedTerm& term) {
    term.add_bounds_at(selection_, vertices, time, [&](Index v, const double* k, const double* c) {
      if (selection_.contains(v)) sums[selection_.slot(v)].add(k, c);
    });
  });
  for (std::size_t i = 0; i < vertices.size(); ++i)
    bounds.include(vertices[i], sums[i], attributes);
  return bounds;
}

StepBounds StepLimits::bounds_of_changes(double time) {
  return bounds_at(changed_.take(body_.complex()), time);
}

void StepLimits::begin(Aim aim) {
  is_searching_ = aim != Aim::bound && body_.models().has_tangent();
  is_bounding_ = aim != Aim::stable_step || !is_searching_;
  found_ = {is_searching_ ? infinity : 0, infinity};
  next_vertex_ = 0;
  if (is_searching_) search_.begin();
}

std::optional<StepLimits::Found> StepLimits::advance(double time) {
  if (is_searching_) {
    if (!search_.advance(time)) return std::nullopt;
    is_searching_ = false;
    found_.stable = search_.result();
    if (!(found_.stable > 0)) is_bounding_ = true;  // the state is beyond numbers
  } else if (bound_next_vertices(time)) {
    is_bounding_ = false;
    if (!(found_.stable > 0)) found_.stable = found_.bound;
  }
  return is_bounding_ ? std::nullopt : std::optional(found_);
}

/// True if nothing is left to do.
bool StepLimits::bound_next_vertices(double time) {
  const Index count = body_.attributes().vertex_count();
  const Index last = std::min(count, next_vertex_ + count / bound_portions + 1);
  std::vector<Index> vertices(last - next_vertex_);
  std::iota(vertices.begin(), vertices.end(), next_vertex_);
  std::erase_if(vertices, [&](Index v) { return !body_.complex().exists(0, v); });
  next_vertex_ = last;
  try {
    found_.bound = std::min(found_.bound, bounds_at(vertices, time).dt);
  } catch (const NoStepBound&) {
    is_bounding_ = false;
    if (!(found_.stable > 0)) throw;
    return true;
  }
  return last == count;
}

void StepLimits::follow(const CellComplex& complex, const TopologyChange& change) {
  search_.follow(change);
  changed_.add(complex, change, body_.models().reads_summed_columns());
}

void StepLimits::state(Archive& archive) {
  archive("search", search_);
  archive("changed", changed_);
  archive("is searching", is_searching_);
  archive("is bounding", is_bounding_);
  archive("found stable", found_.stable);
  archive("found bound", found_.bound);
  archive("next vertex", next_vertex_);
}

}  // namespace suture
