// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/swept_crossing.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "kernel/base/box.hpp"
#include "kernel/base/rows.hpp"
#include "kernel/contact/place_grid.hpp"
#include "kernel/geometry/surface_tree.hpp"

namespace suture {
namespace {

// In typical edges: how far in front of a plane a point may begin behind it, how far
// beside_when_passing a triangle it may pass it, and a cell of the grid.
constexpr double level_at_start = 1e-4, beside_when_passing = 1e-3, cell_in_edges = 1;
constexpr int halvings = 50;
// A place that moves by more edges than these has gone wrong in other ways.
constexpr double most_stretches = 1000;

class Ways {
 public:
  Ways(const SweptPlaces& places, std::span<const Index> points)
      : places_(places), cell_(cell_in_edges * places.edge) {
    for (const Index p : points)
      mean_ = plus(mean_, scaled(1.0 / static_cast<double>(points.size()), way(p)));
  }

  /// At part t of the way, less that part of the mean way.
  Vec3 at(Index p, double t) const {
    return plus(row(places_.from, p), scaled(t, minus(way(p), mean_)));
  }
  Vec3 end(Index p) const { return row(places_.to, p); }
  /// Of the way of places into pieces that are no longer than a cell.
  template <std::size_t n>
  std::size_t stretches(const std::array<Index, n>& places) const {
    double longest = 0;
    for (const Index p : places) longest = std::max(longest, norm(minus(way(p), mean_)));
    const double count = std::ceil(longest / cell_);
    return static_cast<std::size_t>(std::clamp(count, 1.0, most_stretches));
  }
  /// Around some places on a stretch.
  template <std::size_t n>
  Box box(const std::array<Index, n>& places, std::size_t stretch, std::size_t of) const {
    Box box = no_box;
    for (const Index p : places)
      for (const std::size_t end : {stretch, stretch + 1})
        include(box, at(p, static_cast<double>(end) / static_cast<double>(of)));
    return box;
  }
  double cell_size() const { return cell_; }

 private:
  Vec3 way(Index p) const { return minus(row(places_.to, p), row(places_.from, p)); }

  SweptPlaces places_;
  double cell_;
  Vec3 mean_{};
};

double volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return dot(cross(minus(b, a), minus(c, a)), minus(d, a));
}

/// The part of the way at which four places are in a plane; their volume changes its sign on it, or
/// is next to nothing at its start.
double time_of_plane(const Ways& ways, const std::array<Index, 4>& p) {
  const auto f = [&](double t) {
    return volume(ways.at(p[0], t), ways.at(p[1], t), ways.at(p[2], t), ways.at(p[3], t));
  };
  const bool is_positive = f(1) < 0;  // before
  if ((f(0) > 0) != is_positive) return 0;
  double low = 0, high = 1;
  for (int i = 0; i < halvings; ++i) {
    const double middle = (low + high) / 2;
    ((f(middle) > 0) == is_positive ? low : high) = middle;
  }
  return high;
}

/// From the plane of a triangle, positive in front of it; not finite without an area.
double height(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  return volume(a, b, c, p) / norm(cross(minus(b, a), minus(c, a)));
}

bool passes(const Ways& ways, const std::array<Index, 3>& corners, Index p, double edge,
            double depth) {
  const auto [a, b, c] = corners;
  if (!(height(ways.end(a), ways.end(b), ways.end(c), ways.end(p)) < -depth)) return false;
  if (!(height(ways.at(a, 0), ways.at(b, 0), ways.at(c, 0), ways.at(p, 0)) >
        -level_at_start * edge))
    return false;
  const double t = time_of_plane(ways, {a, b, c, p});
  const Vec3 A = ways.at(a, t), B = ways.at(b, t), C = ways.at(c, t), P = ways.at(p, t);
  const Weights of = nearest_in(A, B, C, P);
  const Vec3 foot = plus(scaled(of.a, A), plus(scaled(of.b, B), scaled(of.c, C)));
  return norm(minus(P, foot)) < beside_when_passing * edge;
}

/// The distance of the lines of two edges; with its sign, which is that of the volume. 0 if they
/// are parallel.
double distance_of_lines(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 across = cross(minus(b, a), minus(d, c));
  const double size = norm(across);
  return size > 1e-6 * norm(minus(b, a)) * norm(minus(d, c)) ? dot(across, minus(c, a)) / size : 0;
}

bool passes(const Ways& ways, const std::array<Index, 2>& first, const std::array<Index, 2>& second,
            double edge, double depth) {
  const auto distance = [&](double t) {
    return distance_of_lines(ways.at(first[0], t), ways.at(first[1], t), ways.at(second[0], t),
                             ways.at(second[1], t));
  };
  const double before = distance(0), after = distance(1);
  if (std::abs(after) <= depth || before * after >= 0) return false;
  const double t = time_of_plane(ways, {first[0], first[1], second[0], second[1]});
  const Vec3 a = ways.at(first[0], t), u = minus(ways.at(first[1], t), a),
             c = ways.at(second[0], t), v = minus(ways.at(second[1], t), c), w = minus(c, a);
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), area = uu * vv - uv * uv;
  if (!(area > 1e-12 * uu * vv)) return false;
  const double r = (dot(w, u) * vv - dot(w, v) * uv) / area,
               s = (dot(w, u) * uv - dot(w, v) * uu) / area;
  const double slack = beside_when_passing * edge / std::sqrt(std::min(uu, vv));
  return std::min({r, s, 1 - r, 1 - s}) > -slack;
}

/// Stretches of ways in a grid, each at its middle.
template <std::size_t n>
PlaceGrid ways_grid(const Ways& ways, std::size_t count, auto places_of) {
  std::vector<PlaceGrid::Entry> entries;
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<Index, n> places = places_of(i);
    const std::size_t stretches = ways.stretches(places);
    for (std::size_t k = 0; k < stretches; ++k) {
      const Box box = ways.box(places, k, stretches);
      entries.push_back({scaled(0.5, plus(box.low, box.high)), static_cast<Index>(i), 0});
    }
  }
  return PlaceGrid(entries, 2 * ways.cell_size(), 4 * ways.cell_size());
}

}  // namespace

std::optional<SweptCrossing> find_passed_triangle(
    const SweptPlaces& places, std::span<const Index> points,
    std::span<const std::array<Index, 3>> triangles, double depth,
    const std::function<bool(Index point, Index triangle)>& counts) {
  const Ways ways(places, points);
  PlaceGrid grid =
      ways_grid<1>(ways, points.size(), [&](std::size_t i) { return std::array{points[i]}; });
  for (Index t = 0; t < triangles.size(); ++t) {
    const std::array<Index, 3>& corners = triangles[t];
    const std::size_t stretches = ways.stretches(corners);
    for (std::size_t k = 0; k < stretches; ++k) {
      const Box box = enlarged(ways.box(corners, k, stretches), ways.cell_size() / 2);
      for (const Index i : grid.find(box, none)) {
        const Index p = points[i];
        if (std::ranges::find(corners, p) != corners.end()) continue;
        if (passes(ways, corners, p, places.edge, depth) && counts(p, t))
          return SweptCrossing{{p, corners[0], corners[1], corners[2]},
                               -height(ways.end(corners[0]), ways.end(corners[1]),
                                       ways.end(corners[2]), ways.end(p))};
      }
    }
  }
  return {};
}

std::optional<SweptCrossing> find_passed_edges(
    const SweptPlaces& places, std::span<const std::array<Index, 2>> edges, double depth,
    const std::function<bool(Index first, Index second)>& counts) {
  std::vector<Index> ends;
  for (const auto& edge : edges) ends.insert(ends.end(), edge.begin(), edge.end());
  const Ways ways(places, ends);
  PlaceGrid grid = ways_grid<2>(ways, edges.size(), [&](std::size_t i) { return edges[i]; });
  double reach = ways.cell_size();  // of an entry around its middle
  for (const auto& [a, b] : edges)
    reach = std::max(reach, ways.cell_size() + norm(minus(ways.at(b, 0), ways.at(a, 0))));
  for (Index first = 0; first < edges.size(); ++first) {
    const std::size_t stretches = ways.stretches(edges[first]);
    for (std::size_t k = 0; k < stretches; ++k)
      for (const Index second :
           grid.find(enlarged(ways.box(edges[first], k, stretches), reach), none))
        if (second > first && passes(ways, edges[first], edges[second], places.edge, depth) &&
            counts(first, second)) {
          const auto [a, b] = edges[first];
          const auto [c, d] = edges[second];
          return SweptCrossing{
              {a, b, c, d},
              std::abs(distance_of_lines(ways.end(a), ways.end(b), ways.end(c), ways.end(d)))};
        }
  }
  return {};
}

}  // namespace suture
