// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/sound_soup.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "kernel/base/radix_sort.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/geometry/surface_tree.hpp"

namespace suture {
namespace {

// --------------------------------------------------------------- the soup --

bool are_triangles(const PolygonSoup& soup) {
  for (std::size_t i = 0; i <= soup.size(); ++i)
    if (soup.offsets[i] != 3 * i) return false;
  return soup.size() != 0;
}

/// True only if no two points are equal.
bool are_distinct(const std::vector<Vec3>& points) {
  std::vector<std::uint64_t> hashes, spare;
  hashes.reserve(points.size());
  for (const Vec3& p : points) {
    std::uint64_t hash = 0;
    for (const double x : p) {  // + 0.0: -0 equals 0
      hash = (std::rotl(hash, 23) ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9E3779B97F4A7C15u;
      hash ^= hash >> 29;
    }
    hashes.push_back(hash);
  }
  radix_sort(hashes, spare, [](std::uint64_t hash) { return hash; });
  return std::ranges::adjacent_find(hashes) == hashes.end();
}

/// Side 3 t + i of a triangle leads from its corner i to the next.
Index next_side(Index side) { return side % 3 == 2 ? side - 2 : side + 1; }
Index previous_side(Index side) { return side % 3 == 0 ? side + 2 : side - 1; }

/// The sides of triangles by the points where they begin.
struct Fans {
  explicit Fans(const PolygonSoup& soup) : corners(soup.corners) {
    begin.assign(soup.points.size() + 1, 0);
    for (const Index p : corners) ++begin[p + 1];
    for (std::size_t p = 0; p + 1 < begin.size(); ++p) begin[p + 1] += begin[p];
    std::vector<Index> next_place(begin.begin(), begin.end() - 1);
    sides.resize(corners.size());
    for (Index side = 0; side < corners.size(); ++side) sides[next_place[corners[side]]++] = side;
  }
  std::span<const Index> at(Index point) const {
    return {sides.data() + begin[point], sides.data() + begin[point + 1]};
  }
  /// The only side from one point to another; none if there is none or more than one.
  Index between(Index from, Index to) const {
    Index found = none;
    for (const Index side : at(from)) {
      if (corners[next_side(side)] != to) continue;
      if (found != none) return none;
      found = side;
    }
    return found;
  }

  const std::vector<Index>& corners;
  std::vector<Index> begin, sides;
};

/// The side of the neighbour along each side; empty if one has none or several, or the neighbour
/// has the same three corners.
std::vector<Index> opposite_sides(const Fans& fans) {
  const std::vector<Index>& corners = fans.corners;
  std::vector<Index> opposite(corners.size());
  for (Index side = 0; side < corners.size(); ++side) {
    const Index from = corners[side], to = corners[next_side(side)];
    opposite[side] = from == to ? none : fans.between(to, from);
    if (opposite[side] == none || fans.between(from, to) != side ||
        corners[previous_side(opposite[side])] == corners[previous_side(side)])
      return {};
  }
  return opposite;
}

/// True if the triangles around each point form one fan.
bool are_whole(const Fans& fans, const std::vector<Index>& opposite) {
  for (Index point = 0; point + 1 < fans.begin.size(); ++point) {
    const std::span<const Index> around = fans.at(point);
    if (around.empty()) return false;
    std::size_t met = 1;
    for (Index side = opposite[previous_side(around[0])]; side != around[0];
         side = opposite[previous_side(side)])
      ++met;
    if (met != around.size()) return false;
  }
  return true;
}

// ---------------------------------------------------------- intersections --

// Relative: a hundred times the rounding error of a product of three differences.
constexpr double margin = 1e-13;

double size_of(const Vec3& a) { return std::abs(a[0]) + std::abs(a[1]) + std::abs(a[2]); }

/// The sign of a . b, or 0 if rounding may have changed it. `a`: with a relative error of rounding,
/// with respect to `a_size`.
int certain_sign(const Vec3& a, double a_size, const Vec3& b) {
  const double product = dot(a, b);
  if (!(std::abs(product) > margin * a_size * size_of(b))) return 0;
  return product > 0 ? 1 : -1;
}

/// Two triangles. The corners that they share come first in both.
class TrianglePair {
 public:
  TrianglePair(const TriangleSurface& surface, Index one, Index other) : points_(surface.points) {
    const Triangle &a = surface.triangles[one], &b = surface.triangles[other];
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        if (a[i] == b[j]) {
          if (shared_ == 0) at_ = {i, j};
          last_at_ = {i, j};
          ++shared_;
        }
    corners_ = {a, b};
  }
  /// True only if they share nothing but the edge or point of their common corners.
  bool is_apart() const {
    if (shared_ == 3) return false;
    return (shared_ == 2 && is_unfolded()) || is_beside(0) || is_beside(1) ||
           (shared_ < 2 && is_separated());
  }

 private:
  const Vec3& point(std::size_t which, std::size_t i) const {
    return points_[corners_[which][i % 3]];
  }
  bool is_shared(std::size_t which, std::size_t i) const {
    return shared_ != 0 && (i == at_[which] || (shared_ == 2 && i == last_at_[which]));
  }
  Vec3 edge(std::size_t which, std::size_t i) const {
    return minus(point(which, i), point(which, 0));
  }
  Vec3 area(std::size_t which) const { return cross(edge(which, 1), edge(which, 2)); }
  double area_size(std::size_t which) const {
    return size_of(edge(which, 1)) * size_of(edge(which, 2));
  }

  /// Neighbours of the same orientation overlap only if they are folded onto each other.
  bool is_unfolded() const {
    const auto step = [&](std::size_t which) { return (last_at_[which] + 3 - at_[which]) % 3; };
    if (step(0) == step(1)) return false;  // the common edge leads the same way in both
    const Vec3 one = area(0), other = area(1);
    return dot(one, other) > margin * area_size(0) * area_size(1);
  }
  /// All other corners of the second triangle lie on one side of the plane of the first.
  bool is_beside(std::size_t first) const {
    const std::size_t second = 1 - first;
    const Vec3 normal = area(first);
    const double size = area_size(first);
    int side = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      if (is_shared(second, i)) continue;
      const int sign = certain_sign(normal, size, minus(point(second, i), point(first, 0)));
      if (sign == 0 || sign == -side) return false;
      side = sign;
    }
    return true;
  }
  Vec3 origin() const {
    if (shared_ == 1) return point(0, at_[0]);
    Vec3 sum{};
    for (std::size_t i = 0; i < 6; ++i) sum = plus(sum, point(i / 3, i));
    return scaled(1. / 6, sum);
  }
  /// A plane has all corners of one triangle on its one side and those of the other on the other
  /// side, except for a common corner, through which it leads. Across it is the direction between
  /// their middles as seen from between them; or, of triangles in about one plane, the normal of an
  /// edge in that plane.
  bool is_separated() const {
    Corners away{};
    const Vec3 from = origin();
    Vec3 across{};
    double reach = 0;
    for (std::size_t which = 0; which < 2; ++which)
      for (std::size_t i = 0; i < 3; ++i) {
        if (is_shared(which, i)) continue;
        away[which][i] = minus(point(which, i), from);
        const double length = norm(away[which][i]);
        if (!(length > 0)) return false;
        across = plus(across, scaled((which == 0 ? 1 : -1) / length, away[which][i]));
        reach = std::max(reach, size_of(away[which][i]));
      }
    if (is_between(away, across, reach)) return true;
    for (std::size_t which = 0; which < 2 && shared_ == 0; ++which) {
      const Vec3 normal = area(which);
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 inward = cross(normal, minus(point(which, i + 1), point(which, i)));
        if (is_between(away, which == 0 ? inward : scaled(-1, inward), reach)) return true;
      }
    }
    return false;
  }
  /// By triangle and corner, from the origin; what is shared does not count.
  using Corners = std::array<std::array<Vec3, 3>, 2>;
  bool is_between(const Corners& away, const Vec3& across, double reach) const {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (std::size_t i = 0; i < 3; ++i) {
      if (!is_shared(0, i)) least = std::min(least, dot(across, away[0][i]));
      if (!is_shared(1, i)) most = std::max(most, dot(across, away[1][i]));
    }
    const double error = margin * size_of(across) * reach;
    return shared_ == 1 ? least > error && most < -error : least - most > 2 * error;
  }

  const std::vector<Vec3>& points_;
  std::array<Triangle, 2> corners_;
  std::size_t shared_ = 0;
  std::array<std::size_t, 2> at_{}, last_at_{};  ///< of the first and last common corner
};

bool has_area(const TriangleSurface& surface, const Triangle& t) {
  const Vec3 one = minus(surface.points[t[1]], surface.points[t[0]]);
  const Vec3 other = minus(surface.points[t[2]], surface.points[t[0]]);
  return size_of(cross(one, other)) > margin * size_of(one) * size_of(other);
}

/// The side of the neighbour along each side; empty if the soup is not sound.
std::vector<Index> opposite_if_sound(const PolygonSoup& soup) {
  if (!are_triangles(soup) || !are_distinct(soup.points)) return {};
  const Fans fans(soup);
  std::vector<Index> opposite = opposite_sides(fans);
  if (!opposite.empty() && !are_whole(fans, opposite)) return {};
  return opposite;
}

bool is_in_one_piece(const std::vector<Index>& opposite) {
  std::vector<bool> is_reached(opposite.size() / 3);
  std::vector<Index> reached{0};
  is_reached[0] = true;
  for (std::size_t next = 0; next < reached.size(); ++next)
    for (Index side = 3 * reached[next]; side < 3 * reached[next] + 3; ++side) {
      const Index other = opposite[side] / 3;
      if (is_reached[other]) continue;
      is_reached[other] = true;
      reached.push_back(other);
    }
  return reached.size() == is_reached.size();
}

/// Six times the enclosed volume, negative inside out; 0 if rounding might have made it.
double certain_volume(const TriangleSurface& surface) {
  const Vec3& from = surface.points[0];
  double volume = 0, all = 0, size = 0;
  for (const Triangle& t : surface.triangles) {
    const Vec3 a = minus(surface.points[t[0]], from), b = minus(surface.points[t[1]], from),
               c = minus(surface.points[t[2]], from);
    const double part = dot(a, cross(b, c));
    volume += part;
    all += std::abs(part);
    size += size_of(a) * size_of(b) * size_of(c);
  }
  const double most_rounding = 1e-15 * (size + static_cast<double>(surface.triangles.size()) * all);
  return std::abs(volume) > most_rounding ? volume : 0;
}

}  // namespace

bool is_sound(const PolygonSoup& soup) { return !opposite_if_sound(soup).empty(); }

std::optional<TriangleSurface> sound_solid(const PolygonSoup& soup) {
  const std::vector<Index> opposite = opposite_if_sound(soup);
  if (opposite.empty() || !is_in_one_piece(opposite)) return std::nullopt;
  TriangleSurface surface{soup.source, soup.points, {}};
  surface.triangles.reserve(soup.size());
  for (std::size_t i = 0; i < soup.corners.size(); i += 3)
    surface.triangles.push_back({soup.corners[i], soup.corners[i + 1], soup.corners[i + 2]});
  const double volume = certain_volume(surface);
  if (volume == 0) return std::nullopt;
  for (Triangle& t : surface.triangles)
    if (volume < 0) std::swap(t[0], t[2]);
  return surface;
}

std::vector<Index> find_doubtful(const TriangleSurface& surface, const SurfaceTree& tree) {
  std::vector<Box> boxes(surface.triangles.size(), no_box);
  std::vector<std::uint8_t> with_area(surface.triangles.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    with_area[i] = has_area(surface, surface.triangles[i]);
    for (const Index corner : surface.triangles[i]) include(boxes[i], surface.points[corner]);
  }
  std::vector<Index> doubtful;
  const auto compare = [&](Index i, Index j) {
    if (!overlap(boxes[i], boxes[j])) return;
    if (with_area[i] && with_area[j] && TrianglePair(surface, i, j).is_apart()) return;
    doubtful.insert(doubtful.end(), {i, j});
  };
  tree.for_overlaps([&](std::span<const Index> some, std::span<const Index> others) {
    for (std::size_t i = 0; i < some.size(); ++i)
      for (std::size_t j = some.data() == others.data() ? i + 1 : 0; j < others.size(); ++j)
        compare(some[i], others[j]);
  });
  sort_unique(doubtful);
  return doubtful;
}

}  // namespace suture
