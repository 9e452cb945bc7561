// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/shown.hpp"

namespace suture {
namespace {

template <class T>
void keep(std::vector<T>& values, const std::vector<Index>& kept, std::size_t width = 1) {
  if (values.empty()) return;
  for (std::size_t i = 0; i < kept.size(); ++i)
    for (std::size_t c = 0; c < width; ++c) values[i * width + c] = values[kept[i] * width + c];
  values.resize(kept.size() * width);
}

std::vector<Index> existing(const CellComplex& complex, int dimension) {
  std::vector<Index> cells;
  cells.reserve(complex.existing(dimension));
  for (Index i = 0; i < complex.count(dimension); ++i)
    if (complex.exists(dimension, i)) cells.push_back(i);
  return cells;
}

}  // namespace

void keep(std::vector<FrameField>& fields, const std::vector<Index>& cells) {
  for (FrameField& field : fields) {
    const auto width = static_cast<std::size_t>(field.components);
    keep(field.values, cells, width);
    keep(field.ids, cells, width);
  }
}

Shown Shown::of(const CellComplex& complex) {
  Shown shown{existing(complex, 0), existing(complex, 3), {}};
  shown.point_of.assign(complex.count(0), none);
  for (Index i = 0; i < shown.vertices.size(); ++i) shown.point_of[shown.vertices[i]] = i;
  return shown;
}

void leave_out_holes(Frame& frame, const Shown& shown) {
  keep(frame.points, shown.vertices);
  keep(frame.point_fields, shown.vertices);
  keep(frame.hexahedra, shown.elements);
  for (Hexahedron& nodes : frame.hexahedra)
    for (Index& v : nodes) v = shown.point_of[v];
  keep(frame.cell_fields, shown.elements);
}

}  // namespace suture
