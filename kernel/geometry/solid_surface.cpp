// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/solid_surface.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstdint>

#include "kernel/base/error.hpp"
#include "kernel/base/radix_sort.hpp"
#include "kernel/base/rows.hpp"
#include "kernel/geometry/surface_tree.hpp"

namespace suture {
namespace {

// Of the radius: nearer to the surface, the direction of the offset is rounding.
constexpr double on_surface = 1e-10;
// Of the radius: distances of cells are stored in single precision.
constexpr double rounding_of_cells = 1e-6;
// A ball that is larger than the one that fits by less than this part of it fits, too.
constexpr double rounding_of_balls = 1e-6;
// Of the grid: the number that is sought for each triangle, the least and the largest, and the
// largest along an axis.
constexpr double cells_per_triangle = 8, least_cells = 8192, most_cells = 65536, most_along = 256;

Vec3 area_vector(const TriangleSurface& s, const Triangle& t) {
  const Vec3& a = s.points[t[0]];
  return cross(minus(s.points[t[1]], a), minus(s.points[t[2]], a));
}

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

}  // namespace

SolidSurface::SolidSurface(TriangleSurface surface) : surface_(std::move(surface)) {
  std::erase_if(surface_.triangles,
                [&](const Triangle& t) { return !(norm(area_vector(surface_, t)) > 0); });
  if (surface_.triangles.empty())
    throw InputError(surface_.source + ": the surface has no triangle with an area");
  const Box given = box_of(surface_.points);
  const Vec3 middle = scaled(0.5, plus(given.low, given.high));
  for (Vec3& p : surface_.points) {
    p = minus(p, middle);
    radius_ = std::max(radius_, norm(p));
  }
  box_ = box_of(surface_.points);
  make_normals();
  tree_ = std::make_unique<SurfaceTree>(surface_);
  make_grid();
  find_thickness();
}
SolidSurface::~SolidSurface() = default;

void SolidSurface::make_normals() {
  vertex_normals_.resize(surface_.points.size());
  for (const Triangle& t : surface_.triangles) {
    const Vec3 area = area_vector(surface_, t), normal = scaled(1 / norm(area), area);
    face_normals_.push_back(normal);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& corner = surface_.points[t[i]];
      const double angle = angle_between(minus(surface_.points[t[(i + 1) % 3]], corner),
                                         minus(surface_.points[t[(i + 2) % 3]], corner));
      vertex_normals_[t[i]] = plus(vertex_normals_[t[i]], scaled(angle, normal));
    }
  }
  make_edge_normals();
}

void SolidSurface::make_edge_normals() {
  struct Side {
    std::uint64_t edge;
    Index triangle, number;
  };
  std::vector<Side> sides, spare;
  sides.reserve(3 * surface_.triangles.size());
  for (Index i = 0; i < surface_.triangles.size(); ++i)
    for (Index side = 0; side < 3; ++side) {
      const Triangle& t = surface_.triangles[i];
      const Index from = t[side], to = t[(side + 1) % 3];
      sides.push_back({std::uint64_t{std::min(from, to)} << 32 | std::max(from, to), i, side});
    }
  radix_sort(sides, spare, [](const Side& side) { return side.edge; });
  edge_normals_.resize(surface_.triangles.size());
  for (auto first = sides.begin(); first != sides.end();) {
    Vec3 sum{};
    auto last = first;
    for (; last != sides.end() && last->edge == first->edge; ++last)
      sum = plus(sum, face_normals_[last->triangle]);
    for (; first != last; ++first) edge_normals_[first->triangle][first->number] = sum;
  }
}

// -------------------------------------------------------------------- the grid --

void SolidSurface::make_grid() {
  const double longest = std::max({box_.length(0), box_.length(1), box_.length(2)});
  const double volume = box_.length(0) * box_.length(1) * box_.length(2);
  const double wanted = std::clamp(
      cells_per_triangle * static_cast<double>(surface_.triangles.size()), least_cells, most_cells);
  edge_ = std::max(std::cbrt(volume / wanted), longest / most_along);
  std::size_t cells = 1;
  for (std::size_t c = 0; c < 3; ++c) {
    count_[c] = static_cast<std::size_t>(std::ceil(box_.length(c) / edge_)) + 2;  // a cell around
    low_[c] = (box_.low[c] + box_.high[c] - edge_ * static_cast<double>(count_[c])) / 2;
    cells *= count_[c];
  }
  cells_.resize(cells);
  Index last = 0;
  for (std::size_t i = 0; i < cells; ++i) {
    cells_[i].distance = static_cast<float>(nearest(centre(i), last, cells_[i].nearest).distance);
    last = cells_[i].nearest;
  }
}

/// Halves the diameter of a ball until it fits inside at the centroid of every triangle.
void SolidSurface::find_thickness() {
  thickness_ = 2 * radius_;
  for (const Index i : tree_->order()) {
    const Triangle& t = surface_.triangles[i];
    const Vec3 corners =
        plus(surface_.points[t[0]], plus(surface_.points[t[1]], surface_.points[t[2]]));
    const auto fits = [&](double radius) {
      const Vec3 middle = minus(scaled(1. / 3, corners), scaled(radius, face_normals_[i]));
      return !tree_->is_within(middle, radius * (1 - rounding_of_balls));
    };
    while (thickness_ > rounding_of_cells * radius_ && !fits(thickness_ / 2)) thickness_ /= 2;
  }
}

std::array<double, 3> SolidSurface::extents() const {
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Vec3& p : surface_.points) {
    const Eigen::Vector3d v(p[0], p[1], p[2]);
    moments += v * v.transpose();
  }
  const Eigen::Matrix3d axes =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments).eigenvectors();
  Box box = no_box;
  for (const Vec3& p : surface_.points) {
    const Eigen::Vector3d along = axes.transpose() * Eigen::Vector3d(p[0], p[1], p[2]);
    include(box, {along[0], along[1], along[2]});
  }
  return {box.length(0), box.length(1), box.length(2)};
}

/// The cell of a place, or the nearest.
std::size_t SolidSurface::cell_at(const Vec3& place) const {
  std::size_t cell = 0;
  for (std::size_t c = 3; c-- > 0;) {
    const double along = (place[c] - low_[c]) / edge_;
    const double last = static_cast<double>(count_[c] - 1);
    cell = cell * count_[c] + static_cast<std::size_t>(std::min(std::max(along, 0.0), last));
  }
  return cell;
}

Vec3 SolidSurface::centre(std::size_t cell) const {
  const std::array<std::size_t, 3> at{cell % count_[0], cell / count_[0] % count_[1],
                                      cell / count_[0] / count_[1]};
  Vec3 centre;
  for (std::size_t c = 0; c < 3; ++c)
    centre[c] = low_[c] + edge_ * (static_cast<double>(at[c]) + 0.5);
  return centre;
}

/// A lower bound of the distance of a place.
double SolidSurface::least_distance(const Vec3& place) const {
  const std::size_t cell = cell_at(place);
  const double by_cell = cells_[cell].distance - norm(minus(place, centre(cell)));
  Vec3 outside;
  for (std::size_t c = 0; c < 3; ++c)
    outside[c] = std::max({box_.low[c] - place[c], place[c] - box_.high[c], 0.0});
  const double by_box = norm(outside);
  return (by_box > 0 ? std::max(by_box, by_cell) : by_cell) - rounding_of_cells * radius_;
}

std::vector<Vec3> SolidSurface::points_inside() const {
  std::vector<Vec3> points;
  const auto deepest = std::ranges::min_element(cells_, {}, &Cell::distance);
  if (deepest->distance < 0)
    points.push_back(centre(static_cast<std::size_t>(deepest - cells_.begin())));
  for (int axis = 14; axis < 27; ++axis) {  // half of the directions to the neighbours of a cube
    const Vec3 along{double(axis % 3 - 1), double(axis / 3 % 3 - 1), double(axis / 9 - 1)};
    const auto [low, high] = std::ranges::minmax_element(
        surface_.points, {}, [&](const Vec3& p) { return dot(p, along); });
    points.insert(points.end(), {*low, *high});
  }
  return points;
}

// ----------------------------------------------------------------- the distance --

SolidSurface::Foot SolidSurface::foot(Index triangle, const Vec3& place) const {
  const Triangle& t = surface_.triangles[triangle];
  const Vec3 &a = surface_.points[t[0]], &b = surface_.points[t[1]], &c = surface_.points[t[2]];
  const Weights w = nearest_in(a, b, c, place);
  const Vec3 point = plus(a, plus(scaled(w.b, minus(b, a)), scaled(w.c, minus(c, a))));
  const int zeros = (w.a == 0) + (w.b == 0) + (w.c == 0);
  if (zeros == 2) {
    const Index corner = w.a != 0 ? t[0] : w.b != 0 ? t[1] : t[2];
    return {surface_.points[corner], vertex_normals_[corner]};
  }
  if (zeros == 0) return {point, face_normals_[triangle]};
  const std::size_t edge = w.c == 0 ? 0 : w.a == 0 ? 1 : 2;
  return {point, edge_normals_[triangle][edge]};
}

Nearest SolidSurface::nearest(const Vec3& place, Index start, Index& triangle) const {
  triangle = tree_->nearest(place, start);
  const Foot found = foot(triangle, place);
  const Vec3 away = minus(place, found.point);
  const double distance = norm(away), height = dot(away, found.normal);
  if (distance <= on_surface * radius_) {
    const double length = norm(found.normal);
    return {height / length, scaled(1 / length, found.normal)};
  }
  const double side = height < 0 ? -1 : 1;
  return {side * distance, scaled(side / distance, away)};
}

Nearest SolidSurface::nearest(const Vec3& place) const {
  Index unused;
  return nearest(place, cells_[cell_at(place)].nearest, unused);
}

}  // namespace suture
