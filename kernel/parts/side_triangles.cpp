// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/side_triangles.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace suture {
namespace {

using Place = std::array<double, 2>;

// Boxes of triangles are larger than these, or rounding decides.
constexpr double box_rounding = 1e-12;

double cross_product(const Place& o, const Place& a, const Place& b) {
  return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
}

SideTriangle side_triangle(const std::array<Vec3, 3>& corners, unsigned axis) {
  SideTriangle triangle{};
  for (std::size_t i = 0; i < 3; ++i) {
    triangle.x[i] = {corners[i][(axis + 1) % 3], corners[i][(axis + 2) % 3]};
    for (std::size_t c = 0; c < 2; ++c) triangle.centroid[c] += triangle.x[i][c] / 3;
  }
  return triangle;
}

}  // namespace

std::array<Vec3, 3> SideTriangle::places(CubeSide side) const {
  std::array<Vec3, 3> places;
  for (std::size_t i = 0; i < 3; ++i) {
    places[i][side.axis] = side.place();
    for (unsigned c = 0; c < 2; ++c) places[i][(side.axis + 1 + c) % 3] = x[i][c];
  }
  return places;
}

double SideTriangle::area() const { return std::abs(cross_product(x[0], x[1], x[2])); }

bool SideTriangle::contains(const Place& p) const {
  const auto is_in_box = [&](std::size_t c) {
    const double low = std::min(std::min(x[0][c], x[1][c]), x[2][c]),
                 high = std::max(std::max(x[0][c], x[1][c]), x[2][c]);
    return p[c] >= low - box_rounding && p[c] <= high + box_rounding;
  };
  if (!is_in_box(0) || !is_in_box(1)) return false;  // most of them
  const double a = cross_product(x[0], x[1], p), b = cross_product(x[1], x[2], p),
               c = cross_product(x[2], x[0], p);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

SideTriangles::SideTriangles(const Material& material) {
  std::vector<std::uint8_t> at;  // the sides of points
  at.reserve(material.points.size());
  for (const Vec3& point : material.points) at.push_back(sides_at(point));
  struct Face {
    std::array<Index, 3> points;
    unsigned side;
  };
  std::vector<Face> faces;
  faces.reserve(material.tetrahedra.size());
  for (const auto& t : material.tetrahedra)
    for (const auto& [a, b, c] : tetrahedron_faces)
      if (const unsigned on = at[t[a]] & at[t[b]] & at[t[c]]; on != 0) {
        faces.push_back({{t[a], t[b], t[c]}, static_cast<unsigned>(std::countr_zero(on))});
        ++end_[faces.back().side];
      }
  std::partial_sum(end_.begin(), end_.end(), end_.begin());
  triangles_.resize(end_.back());
  std::array<std::size_t, 6> next{};
  std::copy(end_.begin(), end_.end() - 1, next.begin() + 1);
  for (const auto& [points, side] : faces) {
    const auto& [a, b, c] = points;
    triangles_[next[side]++] = side_triangle(
        {material.points[a], material.points[b], material.points[c]}, cube_sides[side].axis);
  }
}

const SideTriangles& SideTriangles::of_full_element() {
  static const SideTriangles full(Material::full_element());
  return full;
}

bool is_covered(const SideTriangle& triangle, std::span<const SideTriangle> others) {
  return std::ranges::any_of(others, [&](const auto& o) { return o.contains(triangle.centroid); });
}

Covered covered(std::span<const SideTriangle> some, std::span<const SideTriangle> others) {
  Covered covered;
  for (const SideTriangle& triangle : some) {
    if (is_covered(triangle, others))
      covered.area += triangle.area();
    else
      covered.is_all = false;
  }
  return covered;
}

}  // namespace suture
