// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/block_lists.hpp"

#include <algorithm>
#include <utility>

namespace suture {

void BlockLists::find(const CellComplex& complex) {
  lists_.assign(blocks_of(complex.element_count(), elements_), {});
  std::vector<Index> listed(vertices_.count(complex.count(0)), none);
  const auto add_corners = [&](Index block, Index element) {
    for (const Index v : complex.vertices_of(element))
      if (const Index seen = vertices_.of(v); std::exchange(listed[seen], block) != block)
        lists_[block].push_back(seen);
  };
  for (Index e = 0; e < complex.element_count(); ++e) {
    if (!complex.exists(3, e)) continue;
    add_corners(e / elements_, e);
    for (int f = 0; f < hexahedron::faces; ++f)
      if (const Index n = complex.neighbour(e, f); n != none && n / elements_ != e / elements_)
        add_corners(e / elements_, n);
  }
}

void BlockLists::gather(const BlockLists& finer) {
  const std::size_t per_block = elements_ / finer.elements_;
  lists_.assign(blocks_of(finer.lists_.size(), elements_ / finer.elements_), {});
  std::vector<Index> listed;
  for (std::size_t i = 0; i < finer.lists_.size(); ++i)
    for (const Index small : finer.lists_[i]) {
      const auto block = static_cast<Index>(i / per_block);
      const Index seen = vertices_.of(finer.vertices_.first(small));
      if (seen >= listed.size()) listed.resize(seen + std::size_t{1}, none);
      if (std::exchange(listed[seen], block) != block) lists_[block].push_back(seen);
    }
}

void BlockLists::add_block(Index seer, Index block) {
  std::vector<Index>& list = lists_[seer / elements_];
  if (std::ranges::find(list, block) == list.end()) list.push_back(block);
}

void BlockLists::add(const CellComplex& complex, Index seer, Index seen) {
  for (const Index v : complex.vertices_of(seen)) add_block(seer, vertices_.of(v));
}

/// New elements, and those that see them; new corners of elements. Where faces were sewn,
/// neighbours may have had other corners when they were last seen.
void BlockLists::follow(const CellComplex& complex, const TopologyChange& change) {
  lists_.resize(blocks_of(complex.element_count(), elements_));
  const auto for_each_neighbour = [&](Index element, auto visit) {
    for (int f = 0; f < hexahedron::faces; ++f)
      if (const Index n = complex.neighbour(element, f); n != none) visit(n);
  };
  for (const Split& copy : change.copies) {
    add(complex, copy.new_cell, copy.new_cell);
    for_each_neighbour(copy.new_cell, [&](Index n) {
      add(complex, copy.new_cell, n);
      add(complex, n, copy.new_cell);
    });
  }
  const Stars& stars = change.stars[0];
  for (std::size_t i = 0; i < stars.size(); ++i)
    for (const Dart dart : stars[i]) {
      const Index e = dart / hexahedron::darts, block = vertices_.of(stars.cells[i]);
      add_block(e, block);
      for_each_neighbour(e, [&](Index n) {
        if (n / elements_ == e / elements_) return;
        add_block(n, block);
        if (change.faces_sewn != 0) add(complex, e, n);
      });
    }
}

}  // namespace suture
