// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/cell_sample.hpp"

#include <algorithm>
#include <cstdint>

namespace suture {
namespace {

/// The coarse node with the largest share of the first and the last vertex of a cell, which are
/// opposite each other; `none` if there is none.
class Owner {
 public:
  explicit Owner(const Interpolation& p) : p_(p) {}

  Index operator()(std::span<const Index> vertices) {
    shares_.clear();
    for (const Index v : {vertices.front(), vertices.back()})
      for (Index i = p_.begin[v]; i < p_.begin[v + 1]; ++i) add(p_.node[i], p_.weight[i]);
    const auto largest = std::ranges::max_element(shares_, {}, &Share::weight);
    return largest == shares_.end() ? none : largest->node;
  }

 private:
  struct Share {
    Index node;
    float weight;
  };
  void add(Index node, float weight) {
    const auto found = std::ranges::find(shares_, node, &Share::node);
    if (found == shares_.end())
      shares_.push_back({node, weight});
    else
      found->weight += weight;
  }

  const Interpolation& p_;
  std::vector<Share> shares_;
};

/// A number below `period` that differs from one coarse node and window to the next.
Index place_in_window(Index node, Index window, Index period) {
  std::uint32_t hash = node * 0x9E3779B9u + window * 0x85EBCA6Bu;
  hash = (hash ^ hash >> 15) * 0x2C1B3C6Du;
  return (hash ^ hash >> 13) % period;
}

}  // namespace

/// The coarse node of every cell, in the order of the cells, functor by functor.
struct CellSample::Owners {
  struct Functor {
    Index number, nodes;  ///< of a cell
    std::size_t begin;    ///< its first cell
  };
  std::vector<Index> owner;
  std::vector<Functor> functors;
  Index coarse_nodes = 0;

  Owners(const TangentMatrix& a, const Interpolation& p) {
    for (const Index node : p.node) coarse_nodes = std::max(coarse_nodes, node + 1);
    Owner find(p);
    a.for_some_cells(
        [&](const CellTangents& cell) {
          if (functors.empty() || functors.back().number != cell.functor ||
              functors.back().nodes != cell.nodes)
            functors.push_back({cell.functor, cell.nodes, owner.size()});
          owner.push_back(find({cell.vertices, cell.nodes}));
          return false;
        },
        [](const CellTangents&) {});
  }
  std::size_t end(std::size_t functor) const {
    return functor + 1 < functors.size() ? functors[functor + 1].begin : owner.size();
  }
};

CellSample::CellSample(const TangentMatrix& a, const Interpolation& p, Index nodes_of_cells) {
  const Owners owners(a, p);
  is_chosen_.resize(owners.owner.size());
  for (std::size_t i = 0; i < owners.functors.size(); ++i) choose(owners, i, nodes_of_cells);
}

/// One of every few cells of a node, at a place that changes: regular places would all be on the
/// same side of the node.
void CellSample::choose(const Owners& owners, std::size_t functor, Index nodes_of_cells) {
  const Index wanted = std::max(nodes_of_cells / owners.functors[functor].nodes, Index{1});
  const std::size_t begin = owners.functors[functor].begin, end = owners.end(functor);
  std::vector<Index> cells(owners.coarse_nodes), seen(cells.size()), chosen(cells.size());
  for (std::size_t i = begin; i < end; ++i)
    if (owners.owner[i] != none) ++cells[owners.owner[i]];
  for (std::size_t i = begin; i < end; ++i) {
    const Index node = owners.owner[i];
    if (node == none) continue;
    const Index period = std::max(cells[node] / wanted, Index{1}), place = seen[node]++;
    is_chosen_[i] = place % period == place_in_window(node, place / period, period);
    chosen[node] += is_chosen_[i];
  }
  for (std::size_t i = begin; i < end; ++i)
    if (is_chosen_[i]) {
      const Index node = owners.owner[i];
      weights_.push_back(static_cast<float>(cells[node]) / static_cast<float>(chosen[node]));
    }
}

void CellSample::for_each_cell(const TangentMatrix& a, const Visit& visit) const {
  std::size_t asked = 0, visited = 0;
  a.for_some_cells([&](const CellTangents&) { return is_chosen_[asked++]; },
                   [&](const CellTangents& cells) {
                     visit(cells, std::span(weights_).subspan(visited, cells.cells));
                     visited += cells.cells;
                   });
}

}  // namespace suture
