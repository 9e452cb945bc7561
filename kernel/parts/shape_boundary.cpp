// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/shape_boundary.hpp"

#include <algorithm>
#include <numeric>

#include "kernel/topology/hexahedron_tables.hpp"

namespace suture {
namespace {

/// For each point, the first one at the same place.
std::vector<Index> first_at_place(const std::vector<Vec3>& points) {
  std::vector<Index> order(points.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    return points[a] != points[b] ? points[a] < points[b] : a < b;
  });
  std::vector<Index> first(points.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] =
        i > 0 && points[order[i]] == points[order[i - 1]] ? first[order[i - 1]] : order[i];
  return first;
}

struct CellFace {
  std::array<Index, 4> key{};  ///< the points, ascending; of triangles, the last twice
  ShapeFace face;
};

/// A face of a cell, seen from outside, without what coincides.
ShapeFace face_of(const Hexahedron& nodes, int face, const std::vector<Index>& first) {
  ShapeFace result;
  for (int k = hexahedron::darts_per_face - 1; k >= 0; --k) {
    const Index point =
        first[nodes[hexahedron::dart_vertex[hexahedron::darts_per_face * face + k]]];
    if (result.size == 0 || result.corners[result.size - 1] != point)
      result.corners[result.size++] = point;
  }
  if (result.size > 1 && result.corners[result.size - 1] == result.corners[0]) --result.size;
  return result;
}

}  // namespace

std::vector<ShapeFace> boundary_of(const Mesh& shape) {
  const std::vector<Index> first = first_at_place(shape.points);
  std::vector<CellFace> faces;
  for (const Hexahedron& nodes : shape.hexahedra)
    for (int f = 0; f < hexahedron::faces; ++f) {
      const ShapeFace face = face_of(nodes, f, first);
      if (face.size < 3) continue;
      CellFace& added = faces.emplace_back(CellFace{face.corners, face});
      if (face.size == 3) added.key[3] = *std::max_element(added.key.begin(), added.key.end() - 1);
      std::sort(added.key.begin(), added.key.end());
    }
  std::sort(faces.begin(), faces.end(),
            [](const CellFace& a, const CellFace& b) { return a.key < b.key; });
  std::vector<ShapeFace> boundary;
  for (std::size_t i = 0, end = 0; i < faces.size(); i = end) {
    while (end < faces.size() && faces[end].key == faces[i].key) ++end;
    if (end == i + 1) boundary.push_back(faces[i].face);
  }
  return boundary;
}

PolygonSoup soup_of(const Mesh& shape, const std::vector<ShapeFace>& faces) {
  PolygonSoup soup;
  soup.source = shape.source;
  std::vector<Index> number(shape.points.size(), none);
  for (const ShapeFace& face : faces) {
    for (std::size_t c = 0; c < face.size; ++c) {
      const Index point = face.corners[c];
      if (number[point] == none) {
        number[point] = static_cast<Index>(soup.points.size());
        soup.points.push_back(shape.points[point]);
      }
      soup.corners.push_back(number[point]);
    }
    soup.offsets.push_back(static_cast<Index>(soup.corners.size()));
  }
  return soup;
}

}  // namespace suture
