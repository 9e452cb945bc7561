// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/solid_surface.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>

#include "kernel/base/rows.hpp"
#include "kernel/geometry/oriented_surface.hpp"
#include "kernel/geometry/surface_tree.hpp"

namespace suture {
namespace {

// A part of the radius: nearer to the surface, the direction of the offset is rounding.
constexpr double on_surface = 1e-10;
// A part of the radius: distances of cells are stored in single precision.
constexpr double rounding_of_cells = 1e-6;
// What a stored distance has at least of itself. Seen from the middle of a tube, many triangles are
// about as near as the nearest one: to find that takes three times as long.
constexpr double least_part = 0.98;
// A ball fits if nothing but the surface that it touches is nearer to its middle than this part of
// its radius. The rest is room for the grid, which answers for most balls.
constexpr double free_of_ball = 0.9;
// Cells of the grid: the number that is sought for each triangle, the least and the largest, and
// the largest along an axis.
constexpr double cells_per_triangle = 8, least_cells = 8192, most_cells = 65536, most_along = 256;

}  // namespace

SolidSurface::SolidSurface(TriangleSurface surface) {
  const Box given = box_of(surface.points);
  middle_ = scaled(0.5, plus(given.low, given.high));
  for (Vec3& p : surface.points) {
    p = minus(p, middle_);
    radius_ = std::max(radius_, norm(p));
  }
  box_ = box_of(surface.points);
  oriented_ = std::make_unique<OrientedSurface>(std::move(surface));
  make_grid();
  find_thickness();
}
SolidSurface::~SolidSurface() = default;

const TriangleSurface& SolidSurface::surface() const { return oriented_->surface(); }
const SurfaceTree& SolidSurface::tree() const { return oriented_->tree(); }

// -------------------------------------------------------------------- the grid --

void SolidSurface::make_grid() {
  const double longest = std::max({box_.length(0), box_.length(1), box_.length(2)});
  const double volume = box_.length(0) * box_.length(1) * box_.length(2);
  const double wanted =
      std::clamp(cells_per_triangle * static_cast<double>(surface().triangles.size()), least_cells,
                 most_cells);
  edge_ = std::max(std::cbrt(volume / wanted), longest / most_along);
  std::size_t cells = 1;
  for (std::size_t c = 0; c < 3; ++c) {
    count_[c] = static_cast<std::size_t>(std::ceil(box_.length(c) / edge_)) + 2;  // a cell around
    low_[c] = (box_.low[c] + box_.high[c] - edge_ * static_cast<double>(count_[c])) / 2;
    cells *= count_[c];
  }
  cells_.resize(cells);
  for (std::size_t first = 0; first < cells; first += count_[0]) fill_row(first);
}

/// The first cell of a row is outside. The next one is on the same side as the last if the surface
/// is too far from either to come between them; otherwise, the nearest triangle says where it is.
void SolidSurface::fill_row(std::size_t first) {
  Index last = first == 0 ? 0 : cells_[first - count_[0]].nearest;
  double before = std::numeric_limits<double>::infinity();
  for (std::size_t i = first; i < first + count_[0]; ++i) {
    const Vec3 place = centre(i);
    const OrientedSurface::Foot foot = oriented_->rough_foot(place, last, least_part);
    double distance = norm(minus(place, foot.point));
    if (least_part * std::max(distance, std::abs(before)) > edge_) {
      distance = std::copysign(distance, before);
      cells_[i].nearest = foot.triangle;
    } else {
      distance = nearest(place, foot.triangle, cells_[i].nearest).distance;
    }
    cells_[i].distance = static_cast<float>(distance);
    last = cells_[i].nearest;
    before = distance;
  }
}

double SolidSurface::Cell::least() const { return distance > 0 ? least_part * distance : distance; }
double SolidSurface::Cell::greatest() const {
  return distance < 0 ? least_part * distance : distance;
}

/// Halves the diameter of a ball until it fits inside at the centroid of every triangle. Between
/// two parallel sides, a ball that just fits has a diameter of 2 / (1 + free_of_ball) times their
/// distance.
void SolidSurface::find_thickness() {
  double radius = radius_;
  for (const Index i : oriented_->tree().order()) {
    const Triangle& t = surface().triangles[i];
    const Vec3 centroid = scaled(
        1. / 3, plus(surface().points[t[0]], plus(surface().points[t[1]], surface().points[t[2]])));
    const auto fits = [&] {
      const Vec3 middle = minus(centroid, scaled(radius, oriented_->face_normal(i)));
      const double free = free_of_ball * radius;
      if (greatest_distance(middle) <= -free) return true;
      return may_be_within(middle, -free) && !oriented_->tree().is_within(middle, free) &&
             is_inside(middle, free);
    };
    while (radius > rounding_of_cells * radius_ && !fits()) radius /= 2;
  }
  thickness_ = (1 + free_of_ball) * radius;
}

std::array<double, 3> SolidSurface::extents() const {
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Vec3& p : surface().points) {
    const Eigen::Vector3d v(p[0], p[1], p[2]);
    moments += v * v.transpose();
  }
  const Eigen::Matrix3d axes =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments).eigenvectors();
  Box box = no_box;
  for (const Vec3& p : surface().points) {
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
  const double by_cell = cells_[cell].least() - norm(minus(place, centre(cell)));
  Vec3 outside;
  for (std::size_t c = 0; c < 3; ++c)
    outside[c] = std::max({box_.low[c] - place[c], place[c] - box_.high[c], 0.0});
  const double by_box = norm(outside);
  return (by_box > 0 ? std::max(by_box, by_cell) : by_cell) - rounding_of_cells * radius_;
}

/// An upper bound of the distance of a place; inside, its opposite is a lower bound of the depth.
double SolidSurface::greatest_distance(const Vec3& place) const {
  const std::size_t cell = cell_at(place);
  return cells_[cell].greatest() + norm(minus(place, centre(cell))) + rounding_of_cells * radius_;
}

/// Whether a place that is as far from the surface as `distance` is inside: as the centre of its
/// cell is, if that is nearer.
bool SolidSurface::is_inside(const Vec3& place, double distance) const {
  const std::size_t cell = cell_at(place);
  const bool is_known = norm(minus(place, centre(cell))) < distance;
  return is_known ? cells_[cell].distance < 0 : nearest(place).distance < 0;
}

std::vector<Vec3> SolidSurface::points_inside() const {
  std::vector<Vec3> points;
  const auto deepest = std::ranges::min_element(cells_, {}, &Cell::distance);
  if (deepest->distance < 0)
    points.push_back(centre(static_cast<std::size_t>(deepest - cells_.begin())));
  for (int axis = 14; axis < 27; ++axis) {  // half of the directions to the neighbours of a cube
    const Vec3 along{double(axis % 3 - 1), double(axis / 3 % 3 - 1), double(axis / 9 - 1)};
    const auto [low, high] = std::ranges::minmax_element(
        surface().points, {}, [&](const Vec3& p) { return dot(p, along); });
    points.insert(points.end(), {*low, *high});
  }
  return points;
}

// ----------------------------------------------------------------- the distance --

Nearest SolidSurface::nearest(const Vec3& place, Index start, Index& triangle) const {
  const OrientedSurface::Foot foot = oriented_->foot(place, start);
  triangle = foot.triangle;
  return OrientedSurface::distance(foot, place, on_surface * radius_);
}

Nearest SolidSurface::nearest(const Vec3& place) const {
  Index unused;
  return nearest(place, cells_[cell_at(place)].nearest, unused);
}

}  // namespace suture
