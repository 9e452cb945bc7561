// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/pieces.hpp"

#include <algorithm>

#include "kernel/topology/disjoint_sets.hpp"

namespace suture {

std::vector<Index> pieces_of(const CellComplex& complex, const Attributes& attributes) {
  const Index vertices = attributes.vertex_count();
  DisjointSets sets(vertices);
  std::vector<bool> used(vertices);
  for (Index e = 0; e < complex.element_count(); ++e) {
    if (!complex.exists(3, e)) continue;
    const Hexahedron& nodes = complex.vertices_of(e);
    for (const Index v : nodes) {
      used[v] = true;
      sets.unite(nodes[0], v);
    }
  }
  for (const auto& instance : attributes.instances())
    for (const Seam& lips : instance->lips)
      if (complex.exists(3, element_of(lips.one)) && complex.exists(3, element_of(lips.other)))
        sets.unite(complex.origin(lips.one), complex.origin(lips.other));
  const auto root = [&](Index v) { return static_cast<Index>(sets.find(v)); };
  std::vector<Index> size(vertices), order, number(vertices, none);
  for (Index v = 0; v < vertices; ++v)
    if (used[v] && size[root(v)]++ == 0) order.push_back(root(v));
  std::ranges::stable_sort(order, [&](Index a, Index b) { return size[a] > size[b]; });
  for (Index i = 0; i < order.size(); ++i) number[order[i]] = i;
  std::vector<Index> pieces(vertices, none);
  for (Index v = 0; v < vertices; ++v)
    if (used[v]) pieces[v] = number[root(v)];
  return pieces;
}

}  // namespace suture
