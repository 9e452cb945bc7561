// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/links.hpp"

#include <algorithm>

#include "kernel/base/sort_unique.hpp"

namespace suture {
namespace {

void end_cell(NodeGraph& graph) {
  std::vector<Index>& nodes = graph.cell_nodes;
  sort_unique(nodes, graph.cell_begin.back());
  graph.cell_begin.push_back(static_cast<Index>(nodes.size()));
}

}  // namespace

NodeGraph links_of(const TangentMatrix& a) {
  NodeGraph links;
  links.places.resize(a.size() / 3);
  a.for_some_cells(
      [&](const CellTangents& cell) {
        if (cell.functor != link_functor) return false;
        links.cell_nodes.insert(links.cell_nodes.end(), cell.vertices, cell.vertices + cell.nodes);
        end_cell(links);
        return false;
      },
      [](const CellTangents&) {});
  return links;
}

NodeGraph coarser_links(const NodeGraph& links, const Interpolation& p, Index coarse_nodes) {
  NodeGraph coarse;
  coarse.places.resize(coarse_nodes);
  for (std::size_t cell = 0; cell < links.cells(); ++cell) {
    for (const Index node : links.cell(cell))
      coarse.cell_nodes.insert(coarse.cell_nodes.end(),
                               p.node.begin() + std::ptrdiff_t{p.begin[node]},
                               p.node.begin() + std::ptrdiff_t{p.begin[node + 1]});
    end_cell(coarse);
  }
  return coarse;
}

}  // namespace suture
