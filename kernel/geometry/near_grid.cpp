// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/near_grid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "kernel/base/saturate.hpp"

namespace suture {

namespace {
// Cubes along the longest axis: about as many as a surface of so many triangles has
// along its own, four times; few triangles are as quick to ask by the tree.
int longest_for(std::size_t triangles) {
  return std::clamp(static_cast<int>(4 * std::sqrt(double(triangles))), 8, 256);
}
// Rounding of the place of a cube, relative to its edge. Coordinates are taken relative to the
// corner of the lattice, so that a distant blade loses no more accuracy than its coordinates have
// lost.
constexpr double slack = 1e-6;
}  // namespace

/// Cubes first .. last-1 along each axis.
struct NearGrid::Cubes {
  std::array<int, 3> first, last;
};

NearGrid::NearGrid(const TriangleSurface& surface, const Box& box) {
  double extent = 0, magnitude = 0;
  for (int a = 0; a < 3; ++a) {
    extent = std::max(extent, box.high[a] - box.low[a]);
    magnitude = std::max({magnitude, std::abs(box.low[a]), std::abs(box.high[a])});
  }
  // No cube is thinner than what coordinates can resolve.
  edge_ = std::max(extent / (longest_for(surface.triangles.size()) - 2), 1e-8 * magnitude);
  if (edge_ == 0) edge_ = 1;
  std::size_t cubes = 1;
  for (int a = 0; a < 3; ++a) {
    low_[a] = box.low[a] - edge_ / 2;
    count_[a] = saturate<int>(std::ceil((box.high[a] - low_[a]) / edge_) + 1);
    cubes *= static_cast<std::size_t>(count_[a]);
  }
  bits_.assign((cubes + 63) / 64, 0);
  for (const Triangle& t : surface.triangles) {
    std::array<Vec3, 3> x;
    for (int n = 0; n < 3; ++n)
      for (int a = 0; a < 3; ++a) x[n][a] = (surface.points[t[n]][a] - low_[a]) / edge_;
    Vec3 u, v;
    Box own{x[0], x[0]};
    for (int a = 0; a < 3; ++a) {
      u[a] = x[1][a] - x[0][a];
      v[a] = x[2][a] - x[0][a];
      own.low[a] = std::min({x[0][a], x[1][a], x[2][a]}) - slack;
      own.high[a] = std::max({x[0][a], x[1][a], x[2][a]}) + slack;
    }
    const Vec3 normal{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                      u[0] * v[1] - u[1] * v[0]};
    mark({{0, 0, 0}, count_}, x, normal, own);
  }
}

// Lengths in edges of a cube, from the lattice's corner.
void NearGrid::mark(const Cubes& cubes, const std::array<Vec3, 3>& x, const Vec3& normal,
                    const Box& box) {
  // The plane passes within the reach of the cubes' half diagonal along the normal.
  double height = 0, reach = 0;
  int widest = 0;
  for (int a = 0; a < 3; ++a) {
    if (box.high[a] < cubes.first[a] || box.low[a] > cubes.last[a]) return;
    const double half = 0.5 * (cubes.last[a] - cubes.first[a]);
    height += normal[a] * (cubes.first[a] + half - x[0][a]);
    reach += std::abs(normal[a]) * (half + slack);
    if (cubes.last[a] - cubes.first[a] > cubes.last[widest] - cubes.first[widest]) widest = a;
  }
  if (std::abs(height) > reach) return;
  if (cubes.last[widest] - cubes.first[widest] > 1) {
    const int middle = (cubes.first[widest] + cubes.last[widest]) / 2;
    Cubes lower = cubes, upper = cubes;
    lower.last[widest] = upper.first[widest] = middle;
    mark(lower, x, normal, box);
    mark(upper, x, normal, box);
    return;
  }
  const std::size_t bit =
      cubes.first[0] + std::size_t(count_[0]) *
                           (cubes.first[1] + std::size_t(count_[1]) * std::size_t(cubes.first[2]));
  bits_[bit / 64] |= std::uint64_t{1} << bit % 64;
}

bool NearGrid::may_meet(const Vec3& a, const Vec3& b) const {
  int first[3], last[3];
  for (int i = 0; i < 3; ++i) {
    const double low = (std::min(a[i], b[i]) - low_[i]) / edge_ - slack;
    const double high = (std::max(a[i], b[i]) - low_[i]) / edge_ + slack;
    if (!(high >= 0) || !(low < count_[i])) return false;
    first[i] = low > 0 ? static_cast<int>(low) : 0;
    last[i] = high < count_[i] ? static_cast<int>(high) : count_[i] - 1;
  }
  for (int k = first[2]; k <= last[2]; ++k)
    for (int j = first[1]; j <= last[1]; ++j) {
      const std::size_t row =
          std::size_t(count_[0]) * (j + std::size_t(count_[1]) * std::size_t(k));
      for (std::size_t bit = row + first[0]; bit <= row + last[0]; ++bit)
        if (bits_[bit / 64] >> bit % 64 & 1) return true;
    }
  return false;
}

std::size_t NearGrid::marked() const {
  std::size_t count = 0;
  for (const std::uint64_t word : bits_) count += std::popcount(word);
  return count;
}

}  // namespace suture
