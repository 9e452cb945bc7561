// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/cell_sample.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace suture {
namespace {

/// Where a cell is: the coarse node with the largest share of its first and its last vertex, which
/// are opposite each other, and the place of their middle beside that node.
struct CellPlace {
  Index owner = none;   ///< `none` if no node has a share
  unsigned octant = 0;  ///< around the owner
  float misfit = 0;     ///< with the point of the quadrature in that octant
};

class FindPlace {
 public:
  FindPlace(const Interpolation& p, std::span<const Vec3> places) : p_(p), places_(places) {}

  CellPlace operator()(std::span<const Index> vertices) {
    // The points of Gauss' rule with two points along each axis of a coarse cell, from its ends.
    constexpr double gauss = 0.2113248654;
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
    // Both squared: the distance from the point, and the difference of the owner's shares. Where
    // few cells are to choose from, the latter decides which of them integrates best.
    const double share = 0.5 * double{largest->weight} - std::pow(1 - gauss, 3);
    double misfit = share * share;
    for (std::size_t c = 0; c < 3; ++c) {
      const double from_owner = middle[c] - places_[result.owner][c];
      const double to_point = std::abs(from_owner) - gauss;
      result.octant |= static_cast<unsigned>(from_owner > 0) << c;
      misfit += to_point * to_point;
    }
    result.misfit = static_cast<float>(misfit);
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

/// A number that differs from one cell to the next.
float scattered(std::size_t cell) {
  std::uint32_t hash = static_cast<std::uint32_t>(cell) * 0x9E3779B9u;
  hash = (hash ^ hash >> 15) * 0x2C1B3C6Du;
  return static_cast<float>(hash ^ hash >> 13);
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
  std::size_t coarse_nodes;

  Places(const TangentMatrix& a, const Interpolation& p, std::span<const Vec3> places)
      : coarse_nodes(places.size()) {
    FindPlace find(p, places);
    a.for_some_cells(
        [&](const CellTangents& cell) {
          if (functors.empty() || functors.back().number != cell.functor ||
              functors.back().nodes != cell.nodes)
            functors.push_back({cell.functor, cell.nodes, of_cell.size()});
          of_cell.push_back(find({cell.vertices, cell.nodes}));
          return false;
        },
        [](const CellTangents&) {});
  }
  std::size_t end(std::size_t functor) const {
    return functor + 1 < functors.size() ? functors[functor + 1].begin : of_cell.size();
  }
};

CellSample::CellSample(const TangentMatrix& a, const Interpolation& p,
                       std::span<const Vec3> places) {
  const Places cells(a, p, places);
  is_chosen_.resize(cells.of_cell.size());
  for (std::size_t i = 0; i < cells.functors.size(); ++i) choose(cells, i);
}

/// Springs and other small cells point in different directions: several are chosen in each octant.
void CellSample::choose(const Places& cells, std::size_t functor) {
  struct Choice {
    std::size_t cell = 0;
    float misfit = std::numeric_limits<float>::infinity(), cells = 0;
  };
  constexpr unsigned octants = 8;
  const std::size_t begin = cells.functors[functor].begin, end = cells.end(functor);
  const std::size_t parts =
      std::max(hexahedron::vertices / cells.functors[functor].nodes, Index{1});
  std::vector<Choice> choices(cells.coarse_nodes * octants * parts);
  const auto choice_of = [&](std::size_t i) -> Choice& {
    const CellPlace& place = cells.of_cell[i];
    return choices[(std::size_t{place.owner} * octants + place.octant) * parts + i % parts];
  };
  for (std::size_t i = begin; i < end; ++i) {
    if (cells.of_cell[i].owner == none) continue;
    Choice& choice = choice_of(i);
    ++choice.cells;
    const float misfit = parts == 1 ? cells.of_cell[i].misfit : scattered(i);
    if (misfit >= choice.misfit) continue;
    choice.misfit = misfit;
    choice.cell = i;
  }
  for (std::size_t i = begin; i < end; ++i) {
    if (cells.of_cell[i].owner == none || choice_of(i).cell != i) continue;
    is_chosen_[i] = true;
    weights_.push_back(choice_of(i).cells);
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
