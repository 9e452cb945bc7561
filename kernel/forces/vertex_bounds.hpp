// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "kernel/forces/force_loop.hpp"
#include "kernel/forces/stable_step.hpp"
#include "kernel/forces/symmetric3.hpp"
#include "kernel/forces/vertex_selection.hpp"

namespace suture {

/// Sums of the bounds of all functors at one vertex: XX YY ZZ XY YZ XZ of K and of C.
struct BoundSums {
  std::array<double, 6> stiffness{}, damping{};

  /// K and C are blocks of 8 lanes.
  void add(const double* k, const double* c) {
    for (std::size_t i = 0; i < 6; ++i) {
      stiffness[i] += k[i * SUTURE_LANES];
      damping[i] += c[i * SUTURE_LANES];
    }
  }
};

/// Of all vertices. 96 B each.
class VertexBounds {
 public:
  explicit VertexBounds(Index vertices) : sums_(vertices) {}
  void add(Index vertex, const double* k, const double* c) { sums_[vertex].add(k, c); }
  const BoundSums& operator[](Index vertex) const { return sums_[vertex]; }

 private:
  std::vector<BoundSums> sums_;
};

/// Of some vertices; those of others are dropped.
class LocalBounds {
 public:
  explicit LocalBounds(const VertexSelection& selection, std::size_t count)
      : selection_(selection), sums_(count) {}
  void add(Index vertex, const double* k, const double* c) {
    if (selection_.contains(vertex)) sums_[selection_.slot(vertex)].add(k, c);
  }
  const BoundSums& operator[](Index vertex) const { return sums_[selection_.slot(vertex)]; }

 private:
  const VertexSelection& selection_;
  std::vector<BoundSums> sums_;
};

/// The part of a bound that acts on free components.
inline std::array<double, 6> free_part(std::array<double, 6> a, int fixed) {
  for (int c = 0; c < 3; ++c) {
    if (!(fixed >> c & 1)) continue;
    a[static_cast<std::size_t>(c)] = 0;
    a[3 + static_cast<std::size_t>(c)] = 0;  // XY, YZ, XZ
    a[3 + (static_cast<std::size_t>(c) + 2) % 3] = 0;
  }
  return a;
}

/// Adds a vertex to the extremes, unless it is held or gone.
inline void include_vertex(Index vertex, const BoundSums& sums, Attributes& attributes,
                           ForceLoop::Bounds& bounds) {
  const double mass = attributes.mass().rows()[vertex];
  const int bits = static_cast<int>(attributes.fixed().rows()[vertex]);
  if (bits == 7 || mass == 0) return;
  const double k = largest_eigenvalue(free_part(sums.stiffness, bits)) / mass;
  const double c = largest_eigenvalue(free_part(sums.damping, bits)) / mass;
  bounds.stiffness = std::max(bounds.stiffness, k);
  bounds.damping = std::max(bounds.damping, c);
  const double dt = stable_step(k, c);
  if (dt < bounds.dt) {
    bounds.dt = dt;
    bounds.vertex = vertex;
  }
}

}  // namespace suture
