// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/cut_area.hpp"

#include <cmath>
#include <sstream>

#include "kernel/base/vec3.hpp"

namespace suture {

std::string CutArea::text() const {
  std::ostringstream text;
  text.precision(3);
  text << opened << " of the " << blade << " m^2 of the blade in the body";
  return text.str();
}

double area_of(const Corners3& triangle) {
  return 0.5 * norm(cross(minus(triangle[1], triangle[0]), minus(triangle[2], triangle[0])));
}

double held_area(const Corners3& triangle, const std::function<bool(const Vec3&)>& holds) {
  constexpr int parts = 4;  // of a side
  const auto& [a, b, c] = triangle;
  const Vec3 u = scaled(1.0 / parts, minus(b, a)), v = scaled(1.0 / parts, minus(c, a));
  int held = 0;
  for (int i = 0; i < parts; ++i)
    for (int j = 0; i + j < parts; ++j)
      for (const double third : {1 / 3.0, 2 / 3.0}) {  // upright, and upside down
        if (third > 0.5 && i + j == parts - 1) continue;
        held += holds(plus(a, plus(scaled(i + third, u), scaled(j + third, v)))) ? 1 : 0;
      }
  return area_of(triangle) * held / (parts * parts);
}

Section section_of(const std::array<Vec3, 4>& corners, const std::array<double, 4>& heights,
                   double tolerance) {
  std::array<std::size_t, 4> above{}, below{};
  std::size_t above_count = 0, below_count = 0;
  for (std::size_t i = 0; i < 4; ++i)
    (heights[i] >= -tolerance ? above[above_count++] : below[below_count++]) = i;
  if (above_count == 0 || below_count == 0) return {};
  const auto crossing = [&](std::size_t a, std::size_t b) {
    const double top = std::abs(heights[a]) <= tolerance ? 0 : heights[a];
    return plus(corners[a], scaled(top / (top - heights[b]), minus(corners[b], corners[a])));
  };
  if (above_count == 2) {
    const Vec3 p = crossing(above[0], below[0]), q = crossing(above[0], below[1]),
               r = crossing(above[1], below[1]), s = crossing(above[1], below[0]);
    return {{{{p, q, r}, {p, r, s}}}, 2};
  }
  Section section;
  section.count = 1;
  for (std::size_t i = 0; i < 3; ++i)
    section.triangles[0][i] =
        above_count == 1 ? crossing(above[0], below[i]) : crossing(above[i], below[0]);
  return section;
}

}  // namespace suture
