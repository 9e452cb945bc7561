// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points are sorted into cubes of four tolerances. A point within one tolerance of a side of its
// cube is compared with the points beyond this side, too: with 3.4 cubes on average.
#include "kernel/mesh/coincident_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>

#include "kernel/base/sort_unique.hpp"
#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

using Cube = std::array<std::int64_t, 3>;

struct HashCube {
  std::size_t operator()(const Cube& cube) const {
    std::uint64_t hash = 0;
    for (const std::int64_t c : cube) {
      hash = (hash ^ static_cast<std::uint64_t>(c)) * 0x9E3779B97F4A7C15u;
      hash ^= hash >> 29;
    }
    return hash;
  }
};

class Places {
 public:
  explicit Places(double tolerance) : tolerance_(tolerance), edge_(4 * tolerance) {}

  /// The nearest of the added points within the tolerance, the first of equally near ones; or none.
  Index nearest(const Vec3& point, std::span<const Vec3> points) const {
    std::array<std::array<std::int64_t, 2>, 3> range;
    for (std::size_t a = 0; a < 3; ++a)
      range[a] = {number(point[a] - tolerance_), number(point[a] + tolerance_)};
    Index best = none;
    double least = tolerance_;
    for (std::int64_t i = range[0][0]; i <= range[0][1]; ++i)
      for (std::int64_t j = range[1][0]; j <= range[1][1]; ++j)
        for (std::int64_t k = range[2][0]; k <= range[2][1]; ++k) {
          const auto found = cubes_.find({i, j, k});
          if (found == cubes_.end()) continue;
          for (const Index other : found->second) {
            const double distance = norm(minus(points[other], point));
            if (distance > least || (distance == least && best < other)) continue;
            least = distance;
            best = other;
          }
        }
    return best;
  }
  void add(Index index, const Vec3& point) {
    cubes_[{number(point[0]), number(point[1]), number(point[2])}].push_back(index);
  }

 private:
  std::int64_t number(double x) const {
    constexpr double most = 4e18;  // a cast of more would be undefined
    return static_cast<std::int64_t>(std::clamp(std::floor(x / edge_), -most, most));
  }

  double tolerance_, edge_;
  std::unordered_map<Cube, std::vector<Index>, HashCube> cubes_;
};

}  // namespace

std::vector<Index> first_in_place(std::span<const Vec3> points, double tolerance) {
  Places places(tolerance);
  std::vector<Index> first(points.size());
  for (Index p = 0; p < points.size(); ++p) {
    first[p] = p;
    if (!std::ranges::all_of(points[p], [](double x) { return std::isfinite(x); }))
      continue;  // the import refuses it
    const Index earlier = places.nearest(points[p], points);
    if (earlier == none)
      places.add(p, points[p]);
    else
      first[p] = earlier;
  }
  return first;
}

std::size_t merge_points(Mesh& mesh, double tolerance) {
  const std::vector<Index> first = first_in_place(mesh.points, tolerance);
  const auto count = static_cast<Index>(mesh.points.size());
  std::vector<Index> number(count);
  Index kept = 0;
  for (Index p = 0; p < count; ++p) number[p] = first[p] == p ? kept++ : number[first[p]];
  if (kept == count) return 0;
  if (mesh.point_ids.empty()) {
    mesh.point_ids.resize(count);
    std::iota(mesh.point_ids.begin(), mesh.point_ids.end(), std::uint64_t{0});
  }
  for (Index p = 0; p < count; ++p) {
    if (first[p] != p) continue;
    mesh.points[number[p]] = mesh.points[p];
    mesh.point_ids[number[p]] = mesh.point_ids[p];
    for (MeshArray& array : mesh.arrays)
      if (!array.of_elements && !array.values.empty())
        std::copy_n(
            array.values.begin() + static_cast<std::ptrdiff_t>(p * array.components),
            array.components,
            array.values.begin() + static_cast<std::ptrdiff_t>(number[p] * array.components));
  }
  mesh.points.resize(kept);
  mesh.point_ids.resize(kept);
  for (MeshArray& array : mesh.arrays)
    if (!array.of_elements && !array.values.empty()) array.values.resize(kept * array.components);
  for (Hexahedron& nodes : mesh.hexahedra)
    for (Index& node : nodes)
      if (node < count) node = number[node];  // the import refuses others
  for (auto& [name, set] : mesh.point_sets) {
    for (Index& point : set) point = number[point];
    sort_unique(set);
  }
  return count - kept;
}

}  // namespace suture
