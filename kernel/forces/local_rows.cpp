// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/local_rows.hpp"

#include <algorithm>

#include "kernel/attributes/lips.hpp"
#include "kernel/topology/marks.hpp"

namespace suture {

std::vector<Index> LocalRows::elements_around(const CellComplex& complex,
                                              std::span<const Index> vertices) {
  element_marks_.resize(complex.element_count() / 64 + 1, 0);
  std::vector<Index> elements;
  for (const Index v : vertices) {
    if (!complex.exists(0, v)) continue;
    complex.star(0, v, star_);
    for (const Dart d : star_)
      if (marks::mark(element_marks_, d / hexahedron::darts))
        elements.push_back(d / hexahedron::darts);
  }
  marks::unmark(element_marks_, elements);
  std::ranges::sort(elements);
  return elements;
}

/// Pairs of which one of the elements, which ascend, has a lip. O(lips log elements).
template <class Visit>
void for_each_lips_of(const Instance& instance, std::span<const Index> elements, Visit visit) {
  const auto has = [&](Dart lip) { return std::ranges::binary_search(elements, element_of(lip)); };
  for (const Seam& lips : instance.lips)
    if (has(lips.one) || has(lips.other)) visit(lips);
}

template <class Wanted>
std::span<const loops::BatchRows> LocalRows::find(const CellComplex& complex,
                                                  const CompiledFunctor& functor,
                                                  std::span<const Index> elements, Wanted wanted) {
  const CellSet& cells = functor.cells();
  row_marks_.resize(std::max<std::size_t>(row_marks_.size(), cells.size() / 64 + 1), 0);
  rows_.clear();
  const auto add = [&](Index cell) {
    const Index row = cells.row(cell);
    if (row != none && functor.visits(complex, row) && wanted(row) && marks::mark(row_marks_, row))
      rows_.push_back(row);
  };
  if (acts_on_lips(functor.functor()))
    for_each_lips_of(functor.instance(), elements, [&](const Seam& lips) {
      if (const Index face = face_of_lips(complex, lips); face != none) add(face);
    });
  else
    for (const Index e : elements)
      if (complex.exists(3, e))
        std::ranges::for_each(cells_of_element(complex, functor.dimension(), e), add);
  marks::unmark(row_marks_, rows_);
  std::ranges::sort(rows_);
  return in_batches(functor.dimension() == 3 ? functor.instance().skewed_begin : 0);
}

/// A batch has rows on one side of `border`. Its rows may lie in several blocks of 8: elements
/// around a few vertices are in short rows of the mesh, so those of one block do not fill a batch.
std::span<const loops::BatchRows> LocalRows::in_batches(Index border) {
  batches_.clear();
  for (std::size_t i = 0; i < rows_.size();) {
    loops::BatchRows& batch = batches_.emplace_back();
    batch.valid = 0;
    const bool before = rows_[i] < border;
    for (; i < rows_.size() && batch.valid < SUTURE_LANES && (rows_[i] < border) == before; ++i)
      batch.row[batch.valid++] = rows_[i];
    for (Index l = batch.valid; l < SUTURE_LANES; ++l) batch.row[l] = batch.row[batch.valid - 1];
  }
  return batches_;
}

std::span<const loops::BatchRows> LocalRows::rows_of(const CellComplex& complex,
                                                     const CompiledFunctor& functor,
                                                     std::span<const Index> elements) {
  return find(complex, functor, elements, [](Index) { return true; });
}

std::span<const loops::BatchRows> LocalRows::rows_at(const CellComplex& complex,
                                                     const CompiledFunctor& functor,
                                                     std::span<const Index> elements,
                                                     const VertexSelection& selection) {
  return find(complex, functor, elements, [&](Index row) {
    return std::ranges::any_of(functor.connectivity(complex).of(row),
                               [&](Index v) { return selection.contains(v); });
  });
}

}  // namespace suture
