// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/images/label_surface.hpp"

#include <algorithm>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/mesh/file_text.hpp"

namespace suture {
namespace {

using Quad = std::array<Index, 4>;
using VoxelPlace = std::array<std::uint64_t, 3>;

/// With what fill_surface() needs for the triangles of a side.
constexpr double bytes_per_side = 150;

bool is_inside(const LabelImage& image, const VoxelPlace& p) {
  return image.region_of[image.place(p[0], p[1], p[2])] != 0;
}

/// Calls visit(voxel, axis, is_high) for each side of a voxel inside that has none beyond it.
template <class Visit>
void for_each_side(const LabelImage& image, Visit&& visit) {
  VoxelPlace at{};
  for (at[2] = 0; at[2] < image.size[2]; ++at[2])
    for (at[1] = 0; at[1] < image.size[1]; ++at[1])
      for (at[0] = 0; at[0] < image.size[0]; ++at[0]) {
        if (!is_inside(image, at)) continue;
        for (std::size_t axis = 0; axis < 3; ++axis)
          for (const bool is_high : {false, true}) {
            VoxelPlace beyond = at;
            beyond[axis] += is_high ? 1 : std::uint64_t(-1);
            if (beyond[axis] >= image.size[axis] || !is_inside(image, beyond))
              visit(at, axis, is_high);
          }
      }
}

/// The sides, whose corners are numbered as they are met, layer by layer.
class Stairs {
 public:
  explicit Stairs(const LabelImage& image) : row_(image.size[0] + 1) {
    for (auto& layer : number_) layer.assign(row_ * (image.size[1] + 1), none);
    for_each_side(image, [&](const VoxelPlace& at, std::size_t axis, bool is_high) {
      add(at, axis, is_high);
    });
  }

  std::vector<Vec3> points;  ///< in voxels
  std::vector<Quad> sides;   ///< counterclockwise from outside, if the steps are right-handed

 private:
  void add(const VoxelPlace& at, std::size_t axis, bool is_high) {
    if (at[2] != layer_) move_to(at[2]);
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    Quad side;
    for (std::size_t c = 0; c < 4; ++c) {  // around the axis
      VoxelPlace corner = at;
      corner[axis] += is_high ? 1 : 0;
      corner[u] += c == 1 || c == 2 ? 1 : 0;
      corner[v] += c >= 2 ? 1 : 0;
      side[is_high ? c : 3 - c] = number(corner);
    }
    sides.push_back(side);
  }
  /// The corners of a layer of voxels lie in two layers, of which the next layer shares one.
  void move_to(std::uint64_t layer) {
    if (layer == layer_ + 1)
      std::swap(number_[0], number_[1]);
    else
      std::ranges::fill(number_[0], none);
    std::ranges::fill(number_[1], none);
    layer_ = layer;
  }
  Index number(const VoxelPlace& corner) {
    Index& number = number_[corner[2] - layer_][corner[0] + row_ * corner[1]];
    if (number == none) {
      number = static_cast<Index>(points.size());
      points.push_back({double(corner[0]), double(corner[1]), double(corner[2])});
    }
    return number;
  }

  std::size_t row_;
  std::uint64_t layer_ = 0;
  std::array<std::vector<Index>, 2> number_;
};

/// x' = x + w (mean of the neighbours - x).
void smoothing_step(const std::vector<Quad>& sides, double w, std::vector<Vec3>& points) {
  std::vector<Vec3> sum(points.size(), Vec3{});
  std::vector<Index> count(points.size(), 0);
  for (const Quad& side : sides)
    for (std::size_t c = 0; c < 4; ++c) {  // each edge belongs to two sides, one for each direction
      const Index from = side[c], to = side[(c + 1) % 4];
      sum[from] = plus(sum[from], points[to]);
      ++count[from];
    }
  for (std::size_t p = 0; p < points.size(); ++p)
    points[p] =
        plus(scaled(1 - w, points[p]), scaled(w / double(std::max<Index>(count[p], 1)), sum[p]));
}

void smooth(const std::vector<Quad>& sides, std::vector<Vec3>& points) {
  constexpr int rounds = 20;
  constexpr double shrink = 0.5, grow = -0.5, reach = 0.5;
  const std::vector<Vec3> corners = points;
  for (int round = 0; round < rounds; ++round) {
    smoothing_step(sides, shrink, points);
    smoothing_step(sides, grow, points);
    for (std::size_t p = 0; p < points.size(); ++p)
      for (std::size_t a = 0; a < 3; ++a)
        points[p][a] = std::clamp(points[p][a], corners[p][a] - reach, corners[p][a] + reach);
  }
}

}  // namespace

TriangleSurface surface_of(const LabelImage& image, double memory) {
  std::uint64_t count = 0;
  for_each_side(image, [&](auto&&...) { ++count; });
  if (count >= none / 4)
    throw InputError(image.source + ": " + grouped(count) +
                     " sides of voxels lie on the surface, too many for 32-bit numbers");
  require_memory(image.source, grouped(count) + " sides of voxels on the surface",
                 bytes_per_side * double(count), memory);
  Stairs stairs(image);
  smooth(stairs.sides, stairs.points);
  const bool is_mirrored = dot(image.steps[0], cross(image.steps[1], image.steps[2])) < 0;
  TriangleSurface surface{image.source, {}, {}};
  for (const Vec3& p : stairs.points) surface.points.push_back(image.corner(p[0], p[1], p[2]));
  for (Quad side : stairs.sides) {
    if (is_mirrored) std::swap(side[1], side[3]);
    surface.triangles.push_back({side[0], side[1], side[2]});
    surface.triangles.push_back({side[0], side[2], side[3]});
  }
  return surface;
}

}  // namespace suture
