// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/results/displayed_ids.hpp"

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

DisplayedIds DisplayedIds::of(const CellComplex& complex) {
  DisplayedIds ids{existing(complex, 0), existing(complex, 3), {}};
  ids.point_of.assign(complex.count(0), none);
  for (Index i = 0; i < ids.vertices.size(); ++i) ids.point_of[ids.vertices[i]] = i;
  return ids;
}

void leave_out_holes(Frame& frame, const DisplayedIds& ids) {
  keep(frame.points, ids.vertices);
  keep(frame.point_fields, ids.vertices);
  keep(frame.hexahedra, ids.elements);
  for (Hexahedron& nodes : frame.hexahedra)
    for (Index& v : nodes) v = ids.point_of[v];
  keep(frame.cell_fields, ids.elements);
}

}  // namespace suture
