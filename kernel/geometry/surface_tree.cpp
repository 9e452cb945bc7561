// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/surface_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

constexpr std::size_t least_in_leaf = 3;
// Levels of nodes with planes, from the leaves up. The planes of larger patches, which are curved,
// rule out little more than their boxes.
constexpr int levels_with_planes = 8;

float rounded_down(double x) {
  const auto f = static_cast<float>(x);
  return f > x ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}
float rounded_up(double x) { return -rounded_down(-x); }

double positive(double x) { return x > 0 ? x : 0; }

}  // namespace

Weights nearest_in(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const Vec3 ab = minus(b, a), ac = minus(c, a);
  const double ab_a = dot(ab, minus(p, a)), ac_a = dot(ac, minus(p, a));
  if (ab_a <= 0 && ac_a <= 0) return {1, 0, 0};
  const double ab_b = dot(ab, minus(p, b)), ac_b = dot(ac, minus(p, b));
  if (ab_b >= 0 && ac_b <= ab_b) return {0, 1, 0};
  const double of_c = ab_a * ac_b - ab_b * ac_a;
  if (of_c <= 0 && ab_a >= 0 && ab_b <= 0) {
    const double part = ab_a / (ab_a - ab_b);
    return {1 - part, part, 0};
  }
  const double ab_c = dot(ab, minus(p, c)), ac_c = dot(ac, minus(p, c));
  if (ac_c >= 0 && ab_c <= ac_c) return {0, 0, 1};
  const double of_b = ab_c * ac_a - ab_a * ac_c;
  if (of_b <= 0 && ac_a >= 0 && ac_c <= 0) {
    const double part = ac_a / (ac_a - ac_c);
    return {1 - part, 0, part};
  }
  const double of_a = ab_b * ac_c - ab_c * ac_b;
  if (of_a <= 0 && ac_b >= ab_b && ab_c >= ac_c) {
    const double part = (ac_b - ab_b) / ((ac_b - ab_b) + (ab_c - ac_c));
    return {0, 1 - part, part};
  }
  const double sum = of_a + of_b + of_c;
  return {of_a / sum, of_b / sum, of_c / sum};
}

// ---------------------------------------------------------------- building --

SurfaceTree::SurfaceTree(const TriangleSurface& surface) : surface_(surface) {
  const std::size_t count = surface.triangles.size();
  leaves_ = static_cast<Index>(std::bit_floor(std::max(count / least_in_leaf, std::size_t{1})));
  sort_triangles();
  nodes_.resize(std::size_t{2} * leaves_);
  for (Index leaf = 0; leaf < leaves_; ++leaf) make_leaf(leaf);
  for (Index node = leaves_ - 1; node > 0; --node) {
    const Node &one = nodes_[2 * node], &other = nodes_[2 * node + 1];
    for (std::size_t c = 0; c < 3; ++c) {
      nodes_[node].low[c] = std::min(one.low[c], other.low[c]);
      nodes_[node].high[c] = std::max(one.high[c], other.high[c]);
    }
  }
  Index first = leaves_;
  for (Index leaves = 1; leaves < 1 << levels_with_planes && first > 0; leaves *= 2, first /= 2)
    for (Index i = 0; i < first; ++i)
      add_planes(triangles_in(i * leaves, (i + 1) * leaves), nodes_[first + i]);
}

struct SurfaceTree::Middle {
  std::array<float, 3> at;
  Index triangle;
};

void SurfaceTree::sort_triangles() {
  std::vector<Middle> middles;
  middles.reserve(surface_.triangles.size());
  for (Index i = 0; i < surface_.triangles.size(); ++i) {
    const Triangle& t = surface_.triangles[i];
    Middle& middle = middles.emplace_back(Middle{{}, i});
    for (std::size_t c = 0; c < 3; ++c)
      middle.at[c] = static_cast<float>(
          (surface_.points[t[0]][c] + surface_.points[t[1]][c] + surface_.points[t[2]][c]) / 3);
  }
  order_.resize(middles.size());
  halve(middles, 0, leaves_);
  for (std::size_t i = 0; i < middles.size(); ++i) order_[i] = middles[i].triangle;
}

/// Sorts the triangles of some leaves into the two halves of these, along the longest axis.
void SurfaceTree::halve(std::span<Middle> middles, Index first_leaf, Index last_leaf) const {
  if (last_leaf - first_leaf == 1) return;
  std::array<float, 3> low = middles[0].at, high = low;
  for (const Middle& middle : middles)
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], middle.at[c]);
      high[c] = std::max(high[c], middle.at[c]);
    }
  std::size_t axis = 0;
  for (std::size_t c = 1; c < 3; ++c)
    if (high[c] - low[c] > high[axis] - low[axis]) axis = c;
  const Index middle_leaf = (first_leaf + last_leaf) / 2;
  const std::size_t half = triangles_in(first_leaf, middle_leaf).size();
  std::ranges::nth_element(middles, middles.begin() + static_cast<std::ptrdiff_t>(half), {},
                           [axis](const Middle& m) { return std::pair(m.at[axis], m.triangle); });
  halve(middles.first(half), first_leaf, middle_leaf);
  halve(middles.subspan(half), middle_leaf, last_leaf);
}

std::span<const Index> SurfaceTree::triangles_in(Index first_leaf, Index last_leaf) const {
  const auto begin_of = [this](std::size_t leaf) { return leaf * order_.size() / leaves_; };
  const std::size_t begin = begin_of(first_leaf);
  return {order_.data() + begin, begin_of(last_leaf) - begin};
}

void SurfaceTree::make_leaf(Index leaf) {
  Box box = no_box;
  for (const Index i : triangles_of(leaf))
    for (const Index corner : surface_.triangles[i]) include(box, surface_.points[corner]);
  Node& node = nodes_[leaves_ + leaf];
  for (std::size_t c = 0; c < 3; ++c) {
    node.low[c] = rounded_down(box.low[c]);
    node.high[c] = rounded_up(box.high[c]);
  }
}

void SurfaceTree::add_planes(std::span<const Index> triangles, Node& node) const {
  Vec3 sum{};
  for (const Index i : triangles) {
    const Triangle& t = surface_.triangles[i];
    const Vec3& a = surface_.points[t[0]];
    sum = plus(sum, cross(minus(surface_.points[t[1]], a), minus(surface_.points[t[2]], a)));
  }
  const double length = norm(sum);
  if (!(length > 0)) return;
  const Vec3 unit = scaled((1 - 1e-6) / length, sum);
  for (std::size_t c = 0; c < 3; ++c) node.normal[c] = static_cast<float>(unit[c]);
  const Vec3 normal{node.normal[0], node.normal[1], node.normal[2]};
  double below = std::numeric_limits<double>::infinity(), above = -below;
  for (const Index i : triangles)
    for (const Index corner : surface_.triangles[i]) {
      const double height = dot(normal, surface_.points[corner]);
      below = std::min(below, height);
      above = std::max(above, height);
    }
  node.below = rounded_down(below);
  node.above = rounded_up(above);
}

// --------------------------------------------------------------- searching --

struct SurfaceTree::Search {
  const Vec3& place;
  double squared_distance;
  double squared_part = 1;  ///< nodes farther away than this part of the distance are left out
  bool is_any_enough = false;
  bool is_first_wanted = false;  ///< of those that are as near
  Index found = none;            ///< nearer than at the start

  bool may_hold(double squared_gap) const {
    return squared_gap < squared_part * squared_distance ||
           (is_first_wanted && found != none && squared_gap == squared_distance);
  }
  bool is_better(double squared, Index triangle) const {
    return squared < squared_distance ||
           (is_first_wanted && found != none && triangle < found && squared == squared_distance);
  }
  bool is_over() const { return is_any_enough && found != none; }
};

/// A lower bound of the squared distance.
double SurfaceTree::squared_gap(Index i, const Vec3& place) const {
  const Node& node = nodes_[i];
  double squared = 0, height = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double gap = positive(std::max(node.low[c] - place[c], place[c] - node.high[c]));
    squared += gap * gap;
    height += node.normal[c] * place[c];
  }
  const double gap = positive(std::max(node.below - height, height - node.above));
  return std::max(squared, gap * gap);
}

void SurfaceTree::examine(std::span<const Index> triangles, Search& search) const {
  for (const Index i : triangles) {
    const Triangle& t = surface_.triangles[i];
    const Vec3 &a = surface_.points[t[0]], &b = surface_.points[t[1]], &c = surface_.points[t[2]];
    const Weights w = nearest_in(a, b, c, search.place);
    const Vec3 foot = plus(a, plus(scaled(w.b, minus(b, a)), scaled(w.c, minus(c, a))));
    const Vec3 away = minus(search.place, foot);
    const double squared = dot(away, away);
    if (!search.is_better(squared, i)) continue;
    search.squared_distance = squared;
    search.found = i;
  }
}

/// The node has been found to be near enough.
void SurfaceTree::descend(Index node, Search& search) const {
  if (node >= leaves_) return examine(triangles_of(node - leaves_), search);
  Index first = 2 * node, second = first + 1;
  double near = squared_gap(first, search.place), far = squared_gap(second, search.place);
  if (far < near) {
    std::swap(first, second);
    std::swap(near, far);
  }
  if (search.may_hold(near)) descend(first, search);
  if (search.may_hold(far) && !search.is_over()) descend(second, search);
}

Index SurfaceTree::nearest(const Vec3& place, Index start, double within) const {
  Search search{.place = place, .squared_distance = within * within, .is_first_wanted = true};
  examine({&start, 1}, search);
  descend(1, search);
  return search.found;
}

Index SurfaceTree::nearly_nearest(const Vec3& place, Index start, double least_part) const {
  Search search{place, std::numeric_limits<double>::infinity(), least_part * least_part};
  examine({&start, 1}, search);
  descend(1, search);
  return search.found;
}

bool SurfaceTree::is_within(const Vec3& place, double distance) const {
  Search search{place, distance * distance, 1, true};
  descend(1, search);
  return search.found != none;
}

bool SurfaceTree::overlap(const Node& a, const Node& b) {
  for (std::size_t c = 0; c < 3; ++c)
    if (a.high[c] < b.low[c] || b.high[c] < a.low[c]) return false;
  return true;
}

}  // namespace suture
