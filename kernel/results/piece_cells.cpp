// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/results/piece_cells.hpp"

namespace suture {
namespace {

std::vector<bool> marks_of_corners(const std::vector<Index>& elements, const CellComplex& complex) {
  std::vector<bool> is_corner(complex.count(0));
  for (const Index e : elements)
    for (const Index v : complex.vertices_of(e)) is_corner[v] = true;
  return is_corner;
}

std::vector<Index> places_of(const std::vector<bool>& marks) {
  std::vector<Index> places;
  for (Index i = 0; i < marks.size(); ++i)
    if (marks[i]) places.push_back(i);
  return places;
}

}  // namespace

PieceCells PieceCells::of(const CellComplex& complex, std::size_t number, std::size_t count) {
  const std::size_t all = complex.existing(3);
  const std::size_t begin = all * std::min(number, count) / count,
                    end = all * std::min(number + 1, count) / count;
  PieceCells piece;
  piece.elements.reserve(end - begin);
  std::size_t existing = 0;
  for (Index e = 0; existing < end; ++e)
    if (complex.exists(3, e) && existing++ >= begin) piece.elements.push_back(e);
  piece.vertices = places_of(marks_of_corners(piece.elements, complex));
  return piece;
}

std::vector<Index> PieceCells::elements_near(const CellComplex& complex) const {
  const std::vector<bool> is_own = marks_of_corners(elements, complex);
  std::vector<bool> is_near(complex.element_count());
  for (Index e = 0; e < complex.element_count(); ++e) {
    if (!complex.exists(3, e)) continue;
    if (std::ranges::none_of(complex.vertices_of(e), [&](Index v) { return is_own[v]; })) continue;
    is_near[e] = true;
    for (int face = 0; face < hexahedron::faces; ++face)
      if (const Index other = complex.neighbour(e, face); other != none) is_near[other] = true;
  }
  return places_of(is_near);
}

std::vector<std::int64_t> PieceCells::points(const CellComplex& complex) const {
  if (complex.existing(0) == complex.count(0)) return {vertices.begin(), vertices.end()};
  std::vector<std::int64_t> points;
  std::int64_t existing = 0;
  Index next = 0;
  for (const Index vertex : vertices) {
    for (; next < vertex; ++next) existing += complex.exists(0, next) ? 1 : 0;
    points.push_back(existing);
  }
  return points;
}

}  // namespace suture
