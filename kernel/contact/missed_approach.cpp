// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/missed_approach.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "kernel/base/box.hpp"
#include "kernel/base/rows.hpp"

namespace suture {
namespace {

using Cube = std::array<double, 3>;  // whole numbers

/// Between places in the same cube or in two that touch each other.
double largest_difference(const std::map<Cube, Box>& ways) {
  double largest = 0;
  for (const auto& [cube, own] : ways)
    for (int i = 0; i < 27; ++i) {
      const Cube next{cube[0] + i % 3 - 1, cube[1] + i / 3 % 3 - 1, cube[2] + i / 9 - 1};
      const auto other = ways.find(next);
      if (other == ways.end()) continue;
      Box both = own;
      include_box(both, other->second);
      largest = std::max(largest, diagonal_of(both));
    }
  return largest;
}

}  // namespace

std::optional<MissedApproach> find_missed_approach(std::span<const Index> places,
                                                   const double* from, const double* to,
                                                   double edge, double depth) {
  const auto way_of = [&](Index v) { return minus(row(to, v), row(from, v)); };
  Box all = no_box;
  for (const Index v : places) include(all, way_of(v));
  double allowed = depth;
  for (double distance = edge; diagonal_of(all) > allowed; distance *= 4) {
    std::map<Cube, Box> ways;
    for (const Index v : places) {
      Cube cube = row(from, v);
      for (double& c : cube) c = std::floor(c / distance);
      include(ways.try_emplace(cube, no_box).first->second, way_of(v));
    }
    const double way = largest_difference(ways);
    if (way > allowed) return MissedApproach{distance, way, allowed};
    allowed = distance + depth;
  }
  return {};
}

}  // namespace suture
