// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/element_finder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "kernel/base/rows.hpp"
#include "kernel/parts/embedding.hpp"

namespace suture {
namespace {

// On the surface of an element, in its reference coordinates.
constexpr double on_surface = 1e-9;
constexpr int max_iterations = 12;
// Reference coordinates beyond which an element is left alone.
constexpr double far_outside = 8;
// How much faster than at the end of a step its vertices may have moved in it.
constexpr double faster = 2;

bool contains(const Box& outer, const Box& inner, double margin) {
  for (std::size_t c = 0; c < 3; ++c)
    if (!(inner.low[c] - margin >= outer.low[c] && inner.high[c] + margin <= outer.high[c]))
      return false;
  return true;
}

/// With the surface, and `margin` beyond it.
bool is_in(const Box& box, const Vec3& place, double margin) {
  for (std::size_t c = 0; c < 3; ++c) {
    const double slack = margin + on_surface * (box.high[c] - box.low[c]);
    if (place[c] < box.low[c] - slack || place[c] > box.high[c] + slack) return false;
  }
  return true;
}

/// The sides of a box beyond which a place lies, a bit each.
std::uint8_t sides_beyond(const Box& box, const Vec3& place) {
  unsigned sides = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const unsigned below = place[c] < box.low[c] ? 1 : 0, above = place[c] > box.high[c] ? 2 : 0;
    sides |= (below | above) << 2 * c;
  }
  return static_cast<std::uint8_t>(sides);
}

double top_speed(const double* velocity, Index vertices) {
  std::array<double, 4> squared{};  // one would wait for itself
  for (Index v = 0; v < vertices; ++v) {
    const Vec3 u = row(velocity, v);
    squared[v % 4] = std::max(squared[v % 4], dot(u, u));
  }
  return std::sqrt(std::ranges::max(squared));
}

/// The columns of dx/d(at), for the nodes X0..X7.
std::array<Vec3, 3> gradient(const Hexahedron& nodes, const Vec3& at, const double* rows) {
  std::array<Vec3, 3> columns{};
  for (unsigned n = 0; n < 8; ++n) {
    Vec3 sign, factor;
    for (unsigned c = 0; c < 3; ++c) {
      sign[c] = (n >> c & 1) != 0 ? 1 : -1;
      factor[c] = (1 + sign[c] * at[c]) / 2;
    }
    const Vec3 x = row(rows, nodes[n]);
    for (unsigned c = 0; c < 3; ++c) {
      const double slope = sign[c] / 2 * factor[(c + 1) % 3] * factor[(c + 2) % 3];
      columns[c] = plus(columns[c], scaled(slope, x));
    }
  }
  return columns;
}

/// By Cramer's rule; none of a singular matrix.
std::optional<Vec3> solve(const std::array<Vec3, 3>& columns, const Vec3& right) {
  const Vec3 bc = cross(columns[1], columns[2]);
  const double determinant = dot(columns[0], bc);
  if (determinant == 0) return {};
  return Vec3{dot(right, bc) / determinant, dot(columns[0], cross(right, columns[2])) / determinant,
              dot(columns[0], cross(columns[1], right)) / determinant};
}

}  // namespace

Box ElementFinder::box_of(Index element) const {
  Box box = no_box;
  for (const Index v : complex_.vertices_of(element))
    include(box, row(attributes_.position().rows(), v));
  return box;
}

void ElementFinder::update(const Box& box, double dt, double margin) {
  moved_ += faster * dt * top_speed(attributes_.velocity().rows(), attributes_.vertex_count());
  if (is_current_ && contains(searched_, box, moved_)) return;
  is_current_ = true;
  moved_ = 0;
  searched_ = box;
  for (std::size_t c = 0; c < 3; ++c) {
    searched_.low[c] -= margin;
    searched_.high[c] += margin;
  }
  // An element is left out if all of its vertices lie beyond the same side of the box.
  std::vector<std::uint8_t> beyond(attributes_.vertex_count());
  for (Index v = 0; v < beyond.size(); ++v)
    beyond[v] = sides_beyond(searched_, row(attributes_.position().rows(), v));
  near_.clear();
  for (Index e = 0; e < complex_.element_count(); ++e) {
    if (!complex_.exists(3, e)) continue;
    unsigned all = ~0u;
    for (const Index v : complex_.vertices_of(e)) all &= beyond[v];
    if (all == 0) near_.push_back({e, box_of(e)});
  }
  make_groups();
}

/// Neighbours have numbers near each other, so that groups are small.
void ElementFinder::make_groups() {
  groups_.assign((near_.size() + in_group - 1) / in_group, no_box);
  for (std::size_t g = 0; g < groups_.size(); ++g)
    for (const Near& near : group(g))
      for (const Vec3& corner : {near.box.low, near.box.high}) include(groups_[g], corner);
}

/// Vertices that are sewn together jump; copies are new.
void ElementFinder::follow(const TopologyChange& change) {
  if (change.elements.size() > near_.size()) return forget();
  for (const Index e : change.elements) {
    const Box around = box_of(e);
    const auto place = std::ranges::lower_bound(near_, e, {}, &Near::element);
    if (place != near_.end() && place->element == e)
      place->box = around;
    else if (overlap(searched_, around))
      near_.insert(place, {e, around});
  }
  make_groups();
}

bool ElementFinder::may_contain(const Box& box, const Vec3& place) const {
  return is_in(box, place, moved_);
}

std::optional<Vec3> ElementFinder::locate(Index element, const Vec3& place) const {
  const Hexahedron& nodes = complex_.vertices_of(element);
  const double* x = attributes_.position().rows();
  Vec3 at{};
  for (int i = 0; i < max_iterations; ++i) {
    const auto step = solve(gradient(nodes, at, x), minus(place, place_in(nodes, at, x, 4)));
    if (!step) return {};
    at = plus(at, *step);
    const double size = std::max({std::abs(at[0]), std::abs(at[1]), std::abs(at[2])});
    if (!(size < far_outside)) return {};
    if (norm(*step) < 1e-3 * on_surface) return at;
  }
  return {};
}

std::optional<Vec3> ElementFinder::inside(Index element, const Vec3& place) const {
  if (!complex_.exists(3, element)) return {};
  if (!is_in(box_of(element), place, 0)) return {};
  auto at = locate(element, place);
  if (!at) return {};
  for (double& c : *at) {
    if (std::abs(c) > 1 + on_surface) return {};
    c = std::clamp(c, -1.0, 1.0);
  }
  return at;
}

}  // namespace suture
