// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/cell_sample.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace suture {
namespace {

/// Where a cell is: the coarse node with the largest share of its first and its last vertex, which
/// are opposite each other, and the octant around that node in which their middle is.
struct CellPlace {
  Index owner = none;  ///< `none` if no node has a share
  unsigned octant = 0;
};
constexpr unsigned octants = 8;

class FindPlace {
 public:
  FindPlace(const Interpolation& p, std::span<const Vec3> places) : p_(p), places_(places) {}

  CellPlace operator()(std::span<const Index> vertices) {
    shares_.clear();
    Vec3 middle{};
    for (const Index v : {vertices.front(), vertices.back()})
      for (Index i = p_.begin[v]; i < p_.begin[v + 1]; ++i) {
        add(p_.node[i], p_.weight[i]);
        for (std::size_t c = 0; c < 3; ++c)
          middle[c] += 0.5 * double{p_.weight[i]} * places_[p_.node[i]][c];
      }
    const auto largest = std::ranges::max_element(shares_, {}, &Share::weight);
    if (largest == shares_.end()) return {};
    CellPlace result{largest->node};
    for (std::size_t c = 0; c < 3; ++c)
      result.octant |= static_cast<unsigned>(middle[c] > places_[result.owner][c]) << c;
    return result;
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
  std::span<const Vec3> places_;
  std::vector<Share> shares_;
};

/// A coarse node is missed if its part in the sample is less than this part of that in all cells.
constexpr double least_part = 0.25;

/// How many cells with so many nodes are chosen of those in an octant.
Index chosen_of(Index cells, Index nodes) {
  const Index least = std::max(hexahedron::vertices / nodes, Index{1});
  return std::min(cells, std::max(least, std::min(cells / 8, Index{4})));
}

std::span<const Index> vertices_of(const CellTangents& cell) { return {cell.vertices, cell.nodes}; }

/// Visits the vertices of all cells.
template <class Visit>
void visit(const TangentMatrix& a, Visit visit_cell) {
  a.for_some_cells(
      [&](const CellTangents& cell) {
        visit_cell(cell);
        return false;
      },
      [](const CellTangents&) {});
}

/// A number that differs from one cell to the next.
std::uint32_t scattered(std::size_t cell) {
  std::uint32_t hash = static_cast<std::uint32_t>(cell) * 0x9E3779B9u;
  hash = (hash ^ hash >> 15) * 0x2C1B3C6Du;
  return hash ^ hash >> 13;
}

}  // namespace

/// The place of every cell, in the order of the cells, functor by functor.
struct CellSample::Places {
  struct Functor {
    Index number, nodes;  ///< of a cell
    std::size_t begin;    ///< its first cell
  };
  std::vector<CellPlace> of_cell;
  std::vector<Functor> functors;
  std::vector<Index> cells_of_vertex;  ///< how many
  std::size_t coarse_nodes;

  Places(const TangentMatrix& a, const Interpolation& p, std::span<const Vec3> places)
      : cells_of_vertex(p.fine_nodes()), coarse_nodes(places.size()) {
    FindPlace find(p, places);
    visit(a, [&](const CellTangents& cell) {
      if (functors.empty() || functors.back().number != cell.functor ||
          functors.back().nodes != cell.nodes)
        functors.push_back({cell.functor, cell.nodes, of_cell.size()});
      of_cell.push_back(find(vertices_of(cell)));
      for (const Index v : vertices_of(cell)) ++cells_of_vertex[v];
    });
  }
  std::size_t end(std::size_t functor) const {
    return functor + 1 < functors.size() ? functors[functor + 1].begin : of_cell.size();
  }
  std::size_t octant_of(std::size_t cell) const {
    return std::size_t{of_cell[cell].owner} * octants + of_cell[cell].octant;
  }

  /// The cells of an octant are dealt out to as many groups as there are cells to choose. Returns
  /// the first group of each octant, and their number.
  template <class Counts>
  std::vector<Index> first_groups(std::size_t functor, Counts counts) const {
    std::vector<Index> first(coarse_nodes * octants + 1);
    for (std::size_t i = functors[functor].begin; i < end(functor); ++i)
      if (counts(i)) ++first[octant_of(i) + 1];
    for (std::size_t octant = 1; octant < first.size(); ++octant)
      first[octant] = first[octant - 1] + chosen_of(first[octant], functors[functor].nodes);
    return first;
  }
};

CellSample::CellSample(const TangentMatrix& a, const Interpolation& p,
                       std::span<const Vec3> places) {
  const Places cells(a, p, places);
  choose(cells, {});
  const std::vector<bool> missed = missed_nodes(a, p, cells);
  if (std::ranges::find(missed, true) == missed.end()) return;
  std::vector<bool> own;
  visit(a, [&](const CellTangents& cell) {
    own.push_back(std::ranges::any_of(vertices_of(cell), [&](Index v) {
      return std::any_of(p.node.begin() + p.begin[v], p.node.begin() + p.begin[v + 1],
                         [&](Index node) { return missed[node]; });
    }));
  });
  choose(cells, own);
}

/// The coarse nodes of which a component has next to no part in the sample. Its part in a cell is
/// the sum of the squared weights of the free vertices.
std::vector<bool> CellSample::missed_nodes(const TangentMatrix& a, const Interpolation& p,
                                           const Places& cells) const {
  std::vector<double> part(cells.coarse_nodes * 3), sampled(part);
  const auto add = [&](std::vector<double>& sums, Index v, double count) {
    for (Index i = p.begin[v]; i < p.begin[v + 1]; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        if (a.free()[std::size_t{v} * 3 + c])
          sums[std::size_t{p.node[i]} * 3 + c] += count * double{p.weight[i]} * double{p.weight[i]};
  };
  for (Index v = 0; v < p.fine_nodes(); ++v) add(part, v, cells.cells_of_vertex[v]);
  std::size_t visited = 0, chosen = 0;
  visit(a, [&](const CellTangents& cell) {
    if (!is_chosen_[visited++]) return;
    const double weight = double{weights_[chosen++]};
    for (const Index v : vertices_of(cell)) add(sampled, v, weight);
  });
  std::vector<bool> missed(cells.coarse_nodes);
  for (std::size_t i = 0; i < part.size(); ++i)
    if (sampled[i] < least_part * part[i]) missed[i / 3] = true;
  return missed;
}

/// `own`: cells that stand for themselves; none if empty.
void CellSample::choose(const Places& cells, const std::vector<bool>& own) {
  is_chosen_.assign(cells.of_cell.size(), false);
  weights_.clear();
  for (std::size_t i = 0; i < cells.functors.size(); ++i) choose(cells, i, own);
}

/// One cell of each group.
void CellSample::choose(const Places& cells, std::size_t functor, const std::vector<bool>& own) {
  struct Group {
    std::size_t cell = 0;  ///< the chosen one
    std::uint32_t rank = std::numeric_limits<std::uint32_t>::max();
    float cells = 0;
  };
  const std::size_t begin = cells.functors[functor].begin, end = cells.end(functor);
  const auto is_own = [&](std::size_t i) { return !own.empty() && own[i]; };
  const auto is_in_group = [&](std::size_t i) {
    return cells.of_cell[i].owner != none && !is_own(i);
  };
  const std::vector<Index> first = cells.first_groups(functor, is_in_group);
  std::vector<Group> groups(first.back());
  const auto group_of = [&](std::size_t i) -> Group& {
    const std::size_t octant = cells.octant_of(i);
    return groups[first[octant] + i % (first[octant + 1] - first[octant])];
  };
  for (std::size_t i = begin; i < end; ++i) {
    if (!is_in_group(i)) continue;
    Group& group = group_of(i);
    ++group.cells;
    const std::uint32_t rank = scattered(i);
    if (rank >= group.rank) continue;
    group.rank = rank;
    group.cell = i;
  }
  for (std::size_t i = begin; i < end; ++i) {
    is_chosen_[i] = is_own(i) || (is_in_group(i) && group_of(i).cell == i);
    if (is_chosen_[i]) weights_.push_back(is_own(i) ? 1 : group_of(i).cells);
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
