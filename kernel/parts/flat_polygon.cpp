// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/flat_polygon.hpp"

#include <algorithm>

#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

constexpr double least_shape_of_triangle = 1e-9;  // twice its area over its longest side squared

}  // namespace

std::vector<Triangle> triangulated(const std::vector<Index>& polygon, const std::vector<Vec3>& at) {
  const std::size_t n = polygon.size();
  if (n < 3) return {};
  Vec3 normal{};
  for (std::size_t i = 0; i < n; ++i)
    normal = plus(normal, cross(minus(at[i], at[0]), minus(at[(i + 1) % n], at[0])));
  const double size = norm(normal);
  if (!(size > 0)) return {};
  normal = scaled(1 / size, normal);
  const auto shape = [&](std::size_t i, std::size_t j, std::size_t k) {
    const Vec3 a = minus(at[j], at[i]), b = minus(at[k], at[i]), c = minus(at[k], at[j]);
    return dot(cross(a, b), normal) / std::max({dot(a, a), dot(b, b), dot(c, c)});
  };
  std::vector<std::size_t> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = i;
  std::ranges::sort(order, {}, [&](std::size_t i) { return at[i]; });
  for (const std::size_t root : order) {
    bool fits = true;
    for (std::size_t i = 1; i + 1 < n && fits; ++i)
      fits = shape(root, (root + i) % n, (root + i + 1) % n) > least_shape_of_triangle;
    if (!fits) continue;
    std::vector<Triangle> fan;
    for (std::size_t i = 1; i + 1 < n; ++i)
      fan.push_back({polygon[root], polygon[(root + i) % n], polygon[(root + i + 1) % n]});
    return fan;
  }
  // Ears, the best first.
  std::vector<std::size_t> left(n);
  for (std::size_t i = 0; i < n; ++i) left[i] = i;
  std::vector<Triangle> triangles;
  while (left.size() > 3) {
    std::size_t best = left.size();
    double best_shape = least_shape_of_triangle;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const std::size_t m = left.size(), a = left[(i + m - 1) % m], b = left[i],
                        c = left[(i + 1) % m];
      const double s = shape(a, b, c);
      if (!(s > best_shape)) continue;
      const bool holds_another = std::ranges::any_of(left, [&](std::size_t p) {
        return p != a && p != b && p != c && shape(a, b, p) >= 0 && shape(b, c, p) >= 0 &&
               shape(c, a, p) > -least_shape_of_triangle;
      });
      if (holds_another) continue;
      best = i;
      best_shape = s;
    }
    if (best == left.size()) return {};
    const std::size_t m = left.size();
    triangles.push_back(
        {polygon[left[(best + m - 1) % m]], polygon[left[best]], polygon[left[(best + 1) % m]]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
  if (!(shape(left[0], left[1], left[2]) > least_shape_of_triangle)) return {};
  triangles.push_back({polygon[left[0]], polygon[left[1]], polygon[left[2]]});
  return triangles;
}

}  // namespace suture
