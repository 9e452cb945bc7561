// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernel/forces/compiled_functor.hpp"
#include "kernel/forces/vertex_selection.hpp"

namespace suture {

/// Finds the rows that a functor visits around some elements or vertices, without a pass over the
/// mesh. Memory: one bit per element and per row of the largest table, cleared through a list.
/// Returned spans are valid until the next call.
class LocalRows {
 public:
  /// Elements with one of these vertices, ascending; removed vertices have none.
  std::vector<Index> elements_around(const CellComplex& complex, std::span<const Index> vertices);

  /// Rows of the elements, or of their vertices, edges or faces, each once, ascending; removed
  /// elements have none. In batches of 8; the last one may have fewer.
  std::span<const loops::BatchRows> rows_of(const CellComplex& complex,
                                            const CompiledFunctor& functor,
                                            std::span<const Index> elements);
  /// Only rows with a selected vertex.
  std::span<const loops::BatchRows> rows_at(const CellComplex& complex,
                                            const CompiledFunctor& functor,
                                            std::span<const Index> elements,
                                            const VertexSelection& selection);

 private:
  template <class Wanted>
  std::span<const loops::BatchRows> find(const CellComplex& complex, const CompiledFunctor& functor,
                                         std::span<const Index> elements, Wanted wanted);
  std::span<const loops::BatchRows> in_batches(Index border);

  std::vector<std::uint64_t> row_marks_, element_marks_;
  std::vector<Index> rows_;
  std::vector<Dart> star_;
  std::vector<loops::BatchRows> batches_;
};

}  // namespace suture
