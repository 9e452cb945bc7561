// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/surface_points.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "kernel/base/sort_unique.hpp"
#include "kernel/contact/row_lanes.hpp"
#include "kernel/solvers/clones.hpp"

namespace suture {
namespace {

/// Of rows of 4, for some points.
SUTURE_CLONES
void sum_rows(const Index* first, const Index* vertices, const double* weights, const double* rows,
              const Index* some, std::size_t count, double* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const Index p = some[i];
    RowLanes sum = weights[first[p]] * row_at(rows, vertices[first[p]]);
    for (Index j = first[p] + 1; j < first[p + 1]; ++j)
      sum += weights[j] * row_at(rows, vertices[j]);
    row_at(out, p) = sum;
  }
}

void sum_rows(const EmbeddedPoints& points, std::span<const Index> some, const double* rows,
              std::vector<double>& out) {
  out.resize(4 * std::size_t{points.size()});
  sum_rows(points.first.data(), points.vertices.data(), points.weights.data(), rows, some.data(),
           some.size(), out.data());
}

}  // namespace

double ContactPoint::in_series(const double* values, const double* held) const {
  if (vertices.size() == 1) return values[vertices[0]];
  double sum = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (static_cast<int>(held[vertices[i]]) != all_held)
      sum += weights[i] * weights[i] / values[vertices[i]];
  return sum > 0 ? 1 / sum : 0;
}

const EmbeddedPoints& SurfacePoints::points() const {
  if (std::exchange(is_current_, true)) return points_;
  const Embedding& embedding = source_();
  std::vector<std::uint8_t> is_used(embedding.points.size(), 0);
  for (const auto& triangle : embedding.triangles)
    for (const Index p : triangle) is_used[p] = 1;
  points_ = {};
  std::vector<Index> number(is_used.size(), none);
  for (const Index vertices : {1u, 2u, 4u, 8u})
    for (std::size_t p = 0; p < is_used.size(); ++p) {
      const Index first = embedding.points.first[p], end = embedding.points.first[p + 1];
      if (is_used[p] == 0 || end - first != vertices) continue;
      number[p] = static_cast<Index>(points_.size());
      for (Index i = first; i < end; ++i) {
        points_.vertices.push_back(embedding.points.vertices[i]);
        points_.weights.push_back(embedding.points.weights[i]);
      }
      points_.first.push_back(static_cast<Index>(points_.vertices.size()));
    }
  triangles_ = embedding.triangles;
  triangle_element_ = embedding.triangle_element;
  is_laid_open_ = embedding.is_laid_open;
  is_lip_.assign(points_.size(), 0);
  for (std::size_t t = 0; t < triangles_.size(); ++t)
    for (Index& p : triangles_[t]) {
      p = number[p];
      if (is_laid_open_[t] != 0) is_lip_[p] = 1;
    }
  numbers_.resize(points_.size());
  std::iota(numbers_.begin(), numbers_.end(), 0);
  return points_;
}

std::vector<Index> SurfacePoints::ascending_vertices() const {
  std::vector<Index> vertices = points().vertices;
  sort_unique(vertices);
  return vertices;
}

void SurfacePoints::gather(Attributes& attributes, std::span<const Index> some) {
  sum_rows(points(), some, attributes.position().rows(), positions_);
  sum_rows(points(), some, attributes.velocity().rows(), velocities_);
}

void SurfacePoints::gather_velocities(Attributes& attributes) {
  sum_rows(points(), numbers_, attributes.velocity().rows(), velocities_);
}

bool ContactPoint::is_held(const double* held) const {
  return std::ranges::all_of(vertices,
                             [&](Index v) { return static_cast<int>(held[v]) == all_held; });
}

PointMass::PointMass(const ContactPoint& point, Attributes& attributes, const LiveMask* moving)
    : point_(point), attributes_(&attributes), moving_(moving) {
  const double* mass = attributes.mass().rows();
  double all = 0;
  Vec3 free{};
  for (std::size_t i = 0; i < point.vertices.size(); ++i) {
    const Index v = point.vertices[i];
    const double inverse = point.weights[i] * point.weights[i] / mass[v];
    const unsigned held = held_components(v);
    is_held_somewhere_ = is_held_somewhere_ || held != 0;
    all += inverse;
    for (unsigned c = 0; c < 3; ++c)
      if ((held >> c & 1) == 0) free[c] += inverse;
  }
  for (unsigned c = 0; c < 3; ++c) {
    if (free[c] == 0) fixed_ |= 1u << c;
    mass_[c] = 1 / (free[c] == 0 ? all : free[c]);
  }
}

void PointMass::change(const Vec3& velocity, double dt) const {
  const double* mass = attributes_->mass().rows();
  for (std::size_t i = 0; i < point_.vertices.size(); ++i) {
    const Index v = point_.vertices[i];
    const double share = point_.weights[i] / mass[v];
    double* x = attributes_->position().rows() + 4 * std::size_t{v};
    double* u = attributes_->velocity().rows() + 4 * std::size_t{v};
    const unsigned held = is_held_somewhere_ ? held_components(v) : 0;
    for (unsigned c = 0; c < 3; ++c) {
      if ((held >> c & 1) != 0) continue;
      const double by = share * mass_[c] * velocity[c];
      u[c] += by;
      x[c] += dt * by;
    }
  }
}

}  // namespace suture
