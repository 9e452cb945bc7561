// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/part_writer.hpp"

#include <algorithm>

namespace suture {

void PartWriter::reserve(std::size_t points, std::size_t tetrahedra, std::size_t triangles) {
  parts_.points.reserve(parts_.points.size() + points);
  parts_.tetrahedra.reserve(parts_.tetrahedra.size() + tetrahedra);
  parts_.cells.reserve(parts_.cells.size() + tetrahedra);
  parts_.triangles.reserve(parts_.triangles.size() + triangles);
  parts_.is_cut.reserve(parts_.is_cut.size() + triangles);
}

Index PartWriter::add_points(Index element, std::span<const Vec3> places) {
  const auto first = static_cast<Index>(parts_.points.size());
  for (const Vec3& at : places) parts_.points.push_back({element, at});
  return first;
}

Index PartWriter::add_volume(Index copy, const Material& material) {
  const Index first = add_points(copy, material.points);
  for (const auto& [a, b, c, d] : material.tetrahedra)
    parts_.tetrahedra.push_back({first + a, first + b, first + c, first + d});
  const Index first_cell = next_cell_;
  for (const Index cell : material.cells) {
    parts_.cells.push_back(first_cell + cell);
    next_cell_ = std::max(next_cell_, first_cell + cell + 1);
  }
  return first;
}

void PartWriter::add_triangle(Index first, const std::array<Index, 3>& corners, bool is_cut) {
  const auto [a, b, c] = corners;
  parts_.triangles.push_back({first + a, first + b, first + c});
  parts_.is_cut.push_back(is_cut ? 1 : 0);
}

void PartWriter::add_open_triangle(Index element, const std::array<Vec3, 3>& places) {
  add_triangle(add_points(element, places), {0, 1, 2}, true);
}

void PartWriter::end_copy(Index copy, const PartMoments& moments) {
  parts_.elements.push_back(copy);
  parts_.moments.push_back(moments);
  parts_.first.push_back(static_cast<Index>(parts_.tetrahedra.size()));
  next_cell_ = 0;
}

}  // namespace suture
