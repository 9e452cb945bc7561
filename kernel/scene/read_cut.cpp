// SPDX-License-Identifier: GPL-3.0-or-later
//
// Blades of a scene: planes and lists of faces.
#include <algorithm>
#include <array>
#include <cmath>

#include "kernel/scene/scene_parts.hpp"

namespace suture::scene_parts {
namespace {

double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Twice the vector area of a polygon (Newell): its normal, by the size of a right hand.
Vec3 newell(const std::vector<Vec3>& polygon) {
  Vec3 sum{};
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t d = (c + 1) % 3, e = (c + 2) % 3;
      sum[c] += (a[d] - b[d]) * (a[e] + b[e]);
    }
  }
  return sum;
}

// The plane of a polygon; its points must lie within a millionth of its size of it.
void read_polygon(ObjectReader& plane, CutPlane& cut) {
  const std::string path = plane.path_of("polygon");
  cut.polygon = read_points(*plane.find("polygon"), path, 3, plane.mistakes());
  if (cut.polygon.size() < 3) return;
  cut.point = cut.polygon[0];
  cut.normal = newell(cut.polygon);
  const double area = std::sqrt(dot(cut.normal, cut.normal));
  double size = 0, off = 0;
  for (const Vec3& p : cut.polygon) {
    const Vec3 r{p[0] - cut.point[0], p[1] - cut.point[1], p[2] - cut.point[2]};
    size = std::max(size, std::sqrt(dot(r, r)));
    off = std::max(off, std::abs(dot(r, cut.normal)) / area);
  }
  if (!(area > 1e-12 * size * size)) {
    plane.complain("polygon", "has no area: its points lie on a line");
    cut.normal = {1, 0, 0};
  } else if (off > 1e-6 * size) {
    plane.complain("polygon",
                   "is not flat: a point lies " + std::to_string(off) +
                       " m off the plane of the others; give a {\"surface\"} of triangles instead");
  }
}

CutPlane read_plane(ObjectReader plane) {
  CutPlane cut;
  if (plane.find("polygon") != nullptr) {
    for (const char* key : {"point", "normal", "radius"}) {
      if (plane.find(key) != nullptr)
        plane.complain(key, "is told by 'polygon' already; give one or the other");
    }
    read_polygon(plane, cut);
  } else {
    cut.point = require_vector(plane, "point", "m", "a point of the plane [x, y, z] in m");
    plane.require("normal", "the direction across the cut [x, y, z]");
    cut.normal = read_direction(plane, "normal").value_or(Vec3{1, 0, 0});
    cut.radius = plane.number("radius", Range::positive("m")).value_or(cut.radius);
  }
  plane.finish();
  return cut;
}

}  // namespace

std::vector<std::array<std::uint64_t, 2>> read_pairs(const JsonValue& value,
                                                     const std::string& path, Mistakes& mistakes) {
  std::vector<std::array<std::uint64_t, 2>> pairs;
  const auto* items = read_array(value, path, "pairs of element numbers", mistakes);
  if (items == nullptr) return pairs;
  if (items->empty()) mistakes.add(value.at, path, "is empty: names no face");
  for (std::size_t i = 0; i < items->size(); ++i) {
    const JsonValue& item = (*items)[i];
    const std::string here = child_path(path, i);
    if (item.kind != JsonValue::Kind::array || item.items.size() != 2) {
      mistakes.add(
          item.at, here,
          "must be the numbers of the two elements of a face [a, b], is " + describe(item));
      continue;
    }
    const auto a = read_natural(item.items[0], child_path(here, 0), 0, UINT64_MAX, mistakes);
    const auto b = read_natural(item.items[1], child_path(here, 1), 0, UINT64_MAX, mistakes);
    if (!a || !b) continue;
    if (*a == *b)
      mistakes.add(item.at, here, "names element " + std::to_string(*a) + " twice; a face has two");
    else
      pairs.push_back({*a, *b});
  }
  return pairs;
}

Operation read_cut(ObjectReader cut) {
  static const std::array<std::string, 2> kinds{"plane", "faces"};
  const auto kind = cut.one_of(kinds);
  Operation result;
  if (kind) {
    const JsonValue& inner = *cut.find(kinds[*kind]);
    const std::string path = cut.path_of(kinds[*kind]);
    if (*kind == 0) result = read_plane({inner, path, cut.mistakes()});
    if (*kind == 1) result = CutFaces{read_pairs(inner, path, cut.mistakes())};
  }
  cut.finish();
  return result;
}

}  // namespace suture::scene_parts
