// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/cut_patterns.hpp"

#include <algorithm>
#include <bit>
#include <map>

#include "kernel/base/sort_unique.hpp"
#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

using CornerNumber = unsigned;
using Four = std::array<PatternPoint, 4>;
using Three = std::array<PatternPoint, 3>;

PatternPoint at_corner(CornerNumber a) { return static_cast<PatternPoint>(8 * a); }
PatternPoint crossing(CornerNumber a, CornerNumber b) {
  return static_cast<PatternPoint>(8 * std::min(a, b) + (a ^ b));
}

/// The faces of a positively oriented tetrahedron, seen from outside.
std::array<Three, 4> faces_of(const Four& t) {
  return {{{t[1], t[2], t[3]}, {t[0], t[3], t[2]}, {t[0], t[1], t[3]}, {t[0], t[2], t[1]}}};
}

/// Two triangles, corner i of the first joined to corner i of the second, as three tetrahedra. The
/// diagonal of each side begins at the lowest of its points (Dompierre et al. 1999).
void add_wedge(Three low, Three high, std::vector<Four>& out) {
  const auto lowest = [](const Three& t) { return std::ranges::min_element(t); };
  if (*lowest(high) < *lowest(low)) low.swap(high);
  const auto i = static_cast<std::size_t>(lowest(low) - low.begin());
  const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
  const auto a = low[i], b = low[j], c = low[k], d = high[i], e = high[j], f = high[k];
  if (std::min(b, f) < std::min(c, e))
    out.insert(out.end(), {{a, b, c, f}, {a, b, f, e}, {a, e, f, d}});
  else
    out.insert(out.end(), {{a, b, c, e}, {a, e, c, f}, {a, e, f, d}});
}

/// The inner part of a tetrahedron of the cube.
std::vector<Four> clipped(const std::array<CornerNumber, 4>& corners, CornerSet inside) {
  std::vector<CornerNumber> in, out;
  for (const CornerNumber c : corners) (inside >> c & 1 ? in : out).push_back(c);
  std::vector<Four> result;
  switch (in.size()) {
    case 1:
      result.push_back({at_corner(in[0]), crossing(in[0], out[0]), crossing(in[0], out[1]),
                        crossing(in[0], out[2])});
      break;
    case 2:
      add_wedge({at_corner(in[0]), crossing(in[0], out[0]), crossing(in[0], out[1])},
                {at_corner(in[1]), crossing(in[1], out[0]), crossing(in[1], out[1])}, result);
      break;
    case 3:
      add_wedge({at_corner(in[0]), at_corner(in[1]), at_corner(in[2])},
                {crossing(in[0], out[0]), crossing(in[1], out[0]), crossing(in[2], out[0])},
                result);
      break;
    case 4:
      result.push_back({at_corner(in[0]), at_corner(in[1]), at_corner(in[2]), at_corner(in[3])});
      break;
    default:
      break;
  }
  return result;
}

/// The orientation does not depend on where edges are crossed.
void orient(Four& t) {
  std::array<Vec3, 4> x;
  for (std::size_t i = 0; i < 4; ++i) x[i] = place_of(t[i], 0.5);
  const Vec3 normal = cross(minus(x[1], x[0]), minus(x[2], x[0]));
  if (dot(normal, minus(x[3], x[0])) < 0) std::swap(t[2], t[3]);
}

/// Adds the faces that lie on the surface: those of crossings only, except where two of the
/// tetrahedra meet.
void add_surface(const std::vector<Four>& tetrahedra, std::vector<Three>& out) {
  std::map<Three, std::pair<Three, int>> found;
  for (const Four& t : tetrahedra)
    for (const Three& face : faces_of(t)) {
      if (std::ranges::any_of(face, [](PatternPoint p) { return direction(p) == 0; })) continue;
      Three key = face;
      std::ranges::sort(key);
      auto& [oriented, times] = found[key];
      oriented = face;
      ++times;
    }
  for (const auto& [key, face] : found)
    if (face.second == 1) out.push_back(face.first);
}

template <std::size_t N>
void number(const std::vector<std::array<PatternPoint, N>>& cells,
            const std::vector<PatternPoint>& points,
            std::vector<std::array<std::uint8_t, N>>& out) {
  for (const auto& cell : cells) {
    auto& numbered = out.emplace_back();
    for (std::size_t i = 0; i < N; ++i)
      numbered[i] =
          static_cast<std::uint8_t>(std::ranges::lower_bound(points, cell[i]) - points.begin());
  }
}

CutPattern make_pattern(CornerSet inside) {
  std::vector<Four> tetrahedra;
  std::vector<Three> triangles;
  std::array<CornerNumber, 3> axes{1, 2, 4};
  do {
    std::vector<Four> part =
        clipped({0, axes[0], axes[0] | axes[1], axes[0] | axes[1] | axes[2]}, inside);
    for (Four& t : part) orient(t);
    add_surface(part, triangles);
    tetrahedra.insert(tetrahedra.end(), part.begin(), part.end());
  } while (std::ranges::next_permutation(axes).found);
  CutPattern pattern;
  for (const Four& t : tetrahedra) pattern.points.insert(pattern.points.end(), t.begin(), t.end());
  sort_unique(pattern.points);
  number(tetrahedra, pattern.points, pattern.tetrahedra);
  number(triangles, pattern.points, pattern.triangles);
  return pattern;
}

/// The corners that edges of the tetrahedra join to one of these.
CornerSet neighbours_of(CornerSet corners) {
  CornerSet result = corners;
  for (CornerNumber a = 0; a < 8; ++a)
    for (CornerNumber b = 0; b < 8; ++b)
      if ((corners >> a & 1) != 0 && ((a & b) == a || (a & b) == b)) result |= CornerSet(1u << b);
  return result;
}

}  // namespace

const CutPattern& cut_pattern(CornerSet inside) {
  static const std::vector<CutPattern> table = [] {
    std::vector<CutPattern> patterns;
    for (unsigned set = 0; set <= all_corners; ++set)
      patterns.push_back(make_pattern(static_cast<CornerSet>(set)));
    return patterns;
  }();
  return table[inside];
}

std::vector<CornerSet> connected_parts(CornerSet inside) {
  std::vector<CornerSet> parts;
  while (inside != 0) {
    CornerSet part = 0, next = CornerSet(1u << std::countr_zero(inside));
    while (next != part) {
      part = next;
      next = neighbours_of(part) & inside;
    }
    parts.push_back(part);
    inside &= CornerSet(~part);
  }
  return parts;
}

Vec3 place_of(PatternPoint point, double share) {
  Vec3 place;
  for (unsigned a = 0; a < 3; ++a) {
    place[a] = (low_corner(point) >> a & 1) != 0 ? 1 : -1;
    if ((direction(point) >> a & 1) != 0) place[a] = 2 * share - 1;
  }
  return place;
}

}  // namespace suture
