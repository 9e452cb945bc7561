// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/build/check_constraints.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/dynamics/prescribed_position.hpp"

namespace suture {
namespace {

constexpr double rounding = 1e-12;

/// Times between which two motions do not separate if they agree at them all: motions follow ramps
/// or the segments of a path, and not every turn between these times can be a whole one.
std::vector<double> times_of(const PrescribedMotion& motion) {
  std::vector<double> ends{motion.begin()}, times;
  for (std::size_t i = 1; i < motion.path.stations.size(); ++i)
    ends.push_back(motion.path.stations[i].at);
  if (ends.size() == 1) ends.push_back(motion.end());
  for (std::size_t i = 1; i < ends.size(); ++i)
    for (const double part : {0.3, 0.7, 1.0})
      times.push_back(ends[i - 1] + part * (ends[i] - ends[i - 1]));
  return times;
}

double farthest(const PrescribedMotion& motion) {
  double length = norm(motion.translation);
  for (const MotionPath::Station& station : motion.path.stations)
    length = std::max(length, norm({station.place[0], station.place[1], station.place[2]}));
  return length;
}

bool agree(const PrescribedMotion& a, const PrescribedMotion& b, const Vec3& rest,
           std::size_t component) {
  if (!a.moves() && !b.moves()) return true;
  const double scale = norm(rest) + norm(a.centre) + norm(b.centre) + farthest(a) + farthest(b);
  const auto agrees = [&](double t) {
    const Vec3 gap = minus(prescribed_position(a, rest, t), prescribed_position(b, rest, t));
    return std::abs(gap[component]) <= rounding * scale;
  };
  return std::ranges::all_of(times_of(a), agrees) && std::ranges::all_of(times_of(b), agrees);
}

struct Conflict {
  Index first = none;
  std::size_t count = 0;  ///< of vertices
};

/// By the places of the two constraints.
using Conflicts = std::map<std::pair<std::size_t, std::size_t>, Conflict>;

Conflicts conflicts_of(const std::vector<PlacedConstraint>& constraints, const Column& rest) {
  constexpr std::size_t nobody = ~std::size_t{0};
  std::vector<std::array<std::size_t, 3>> holders(rest.size(), {nobody, nobody, nobody});
  Conflicts conflicts;
  for (std::size_t i = 0; i < constraints.size(); ++i)
    for (const Index v : constraints[i].vertices) {
      const Vec3 place{rest.get(v, 0), rest.get(v, 1), rest.get(v, 2)};
      std::size_t counted = nobody;  // a vertex counts once for each pair
      for (std::size_t c = 0; c < 3; ++c) {
        if (!(constraints[i].components >> c & 1)) continue;
        const std::size_t other = std::exchange(holders[v][c], i);
        if (other == nobody || other == counted ||
            agree(constraints[other].motion, constraints[i].motion, place, c))
          continue;
        Conflict& conflict = conflicts[{other, i}];
        conflict.first = std::min(conflict.first, v);
        ++conflict.count;
        counted = other;
      }
    }
  return conflicts;
}

}  // namespace

void check_constraints(const std::vector<PlacedConstraint>& constraints, const Column& rest,
                       const std::function<std::string(Index)>& name) {
  if (constraints.size() < 2 ||
      std::ranges::none_of(constraints, [](const auto& c) { return c.motion.moves(); }))
    return;
  std::string text;
  for (const auto& [pair, conflict] : conflicts_of(constraints, rest)) {
    const std::string &earlier = constraints[pair.first].path,
                      &later = constraints[pair.second].path;
    text += (text.empty() ? "" : "\n") + later + ": prescribes another motion than " + earlier +
            " for " + std::to_string(conflict.count) +
            (conflict.count == 1 ? " node, " : " nodes, the first is ") + name(conflict.first) +
            "; select other nodes, or remove one of the two constraints";
  }
  if (!text.empty()) throw InputError(text);
}

}  // namespace suture
