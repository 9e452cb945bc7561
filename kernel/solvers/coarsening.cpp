// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/coarsening.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_set>
#include <utility>

#include "kernel/base/sort_unique.hpp"
#include "kernel/topology/disjoint_sets.hpp"

namespace suture {
namespace {

using Point = std::array<std::int32_t, 3>;

/// An axis is coarsened if its spacing is below this multiple of the shortest: anisotropic boxes
/// become cubes first.
constexpr double short_axis = 1.5;

std::array<bool, 3> axes_to_coarsen(const NodeGraph& fine) {
  double shortest = 0;
  for (std::size_t c = 0; c < 3; ++c)
    if (fine.extent[c] > 1 && (shortest == 0 || fine.spacing[c] < shortest))
      shortest = fine.spacing[c];
  std::array<bool, 3> axes{};
  for (std::size_t c = 0; c < 3; ++c)
    axes[c] = !fine.is_grid || fine.spacing[c] < short_axis * shortest;
  return axes;
}

/// The points of the coarse grid around all fine nodes: the shares of a node in them.
class Shares {
 public:
  Shares(const NodeGraph& fine, const std::array<bool, 3>& axes) {
    begin_.reserve(fine.nodes() + 1);
    std::vector<bool> used(fine.nodes());
    for (const Index node : fine.cell_nodes) used[node] = true;
    for (Index node = 0; node < fine.nodes(); ++node) {
      begin_.push_back(static_cast<Index>(points_.size()));
      if (used[node]) add(fine.places[node], axes);
    }
    begin_.push_back(static_cast<Index>(points_.size()));
  }

  Index begin(Index node) const { return begin_[node]; }
  Index end(Index node) const { return begin_[node + 1]; }
  std::size_t size() const { return points_.size(); }
  const Point& point(std::size_t share) const { return points_[share]; }

  float weight(std::size_t share) const { return weights_[share]; }

 private:
  struct Side {
    std::int32_t point;
    double weight;
  };
  /// The points along one axis; one if the place is a point of the grid.
  static std::pair<std::array<Side, 2>, std::size_t> sides(double place) {
    constexpr double rounding = 1e-6;
    const double low = std::floor(place + rounding), part = std::max(0.0, place - low);
    const auto first = static_cast<std::int32_t>(low);
    if (part < rounding) return {{{{first, 1.0}, {}}}, 1};
    return {{{{first, 1 - part}, {first + 1, part}}}, 2};
  }
  void add(const Vec3& place, const std::array<bool, 3>& axes) {
    const auto [x, nx] = sides(axes[0] ? place[0] / 2 : place[0]);
    const auto [y, ny] = sides(axes[1] ? place[1] / 2 : place[1]);
    const auto [z, nz] = sides(axes[2] ? place[2] / 2 : place[2]);
    for (std::size_t k = 0; k < nz; ++k)
      for (std::size_t j = 0; j < ny; ++j)
        for (std::size_t i = 0; i < nx; ++i) {
          points_.push_back({x[i].point, y[j].point, z[k].point});
          weights_.push_back(static_cast<float>(x[i].weight * y[j].weight * z[k].weight));
        }
  }

  std::vector<Index> begin_;
  std::vector<Point> points_;
  std::vector<float> weights_;
};

/// Unites the shares of the nodes of a cell that refer to the same point.
class CellUnion {
 public:
  CellUnion(const Shares& shares, DisjointSets& sets) : shares_(shares), sets_(sets) {}

  void unite(std::span<const Index> nodes) {
    measure(nodes);
    first_.assign(static_cast<std::size_t>(size_[0]) * size_[1] * size_[2], none);
    for (const Index node : nodes)
      for (Index share = shares_.begin(node); share < shares_.end(node); ++share) {
        Index& first = first_[place(shares_.point(share))];
        if (first == none)
          first = share;
        else
          sets_.unite(first, share);
      }
  }

 private:
  void measure(std::span<const Index> nodes) {
    Point high = low_ = shares_.point(shares_.begin(nodes[0]));
    for (const Index node : nodes)
      for (Index share = shares_.begin(node); share < shares_.end(node); ++share)
        for (std::size_t c = 0; c < 3; ++c) {
          low_[c] = std::min(low_[c], shares_.point(share)[c]);
          high[c] = std::max(high[c], shares_.point(share)[c]);
        }
    for (std::size_t c = 0; c < 3; ++c) size_[c] = static_cast<std::size_t>(high[c] - low_[c]) + 1;
  }
  std::size_t place(const Point& p) const {
    const auto at = [&](std::size_t c) { return static_cast<std::size_t>(p[c] - low_[c]); };
    return (at(2) * size_[1] + at(1)) * size_[0] + at(0);
  }

  const Shares& shares_;
  DisjointSets& sets_;
  Point low_{};
  std::array<std::size_t, 3> size_{};
  std::vector<Index> first_;  ///< per point, the first share
};

/// For every node of a cell, the last one before it at the same place, or `none`: the other side of
/// a slit. Nodes without a cell have no place of their own.
std::vector<Index> earlier_copies(const NodeGraph& graph, const Shares& shares) {
  std::size_t size = 16;
  while (size < 2 * graph.places.size()) size *= 2;
  std::vector<Index> table(size, none), earlier(graph.nodes(), none);
  for (Index node = 0; node < graph.nodes(); ++node) {
    if (shares.begin(node) == shares.end(node)) continue;
    const Vec3& place = graph.places[node];
    std::uint64_t hash = 0;
    for (const double x : place)
      hash =
          (hash ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(x))) * 0x9E3779B97F4A7C15u;
    std::size_t slot = (hash ^ hash >> 32) % size;
    while (table[slot] != none && graph.places[table[slot]] != place) slot = (slot + 1) % size;
    earlier[node] = std::exchange(table[slot], node);
  }
  return earlier;
}

/// Divides the sets of shares in whose support a slit ends, on grids. One function for both sides
/// would close the slit up to the next coarse node: what holds the sides together would be too
/// thick on every level.
///
///    5 . 5'     Fine nodes; the sides of a slit that ends in 3 are 4, 5 and 4', 5'. The set of the
///    4 . 4'     coarse node at 4 has the shares of 3, 4, 4', 5, 5' and of those beside them. Each
///     . 3 .     cell has the near share among them: that of 4, or 4', and that of 3 in the cells
///     . 2 .     below it. Cells with the same one belong together. A share goes to the cells whose
///               near share is the largest: the cells at 4 and those at 4' for 3. It is divided
///               between them, so the old function is the sum of the new ones.
class SlitEnds {
 public:
  SlitEnds(const NodeGraph& fine, const Shares& shares, DisjointSets& sets)
      : shares_(shares), sets_(sets), near_sets_(0) {
    if (!fine.is_grid || !find_sets(fine)) return;
    near_sets_ = DisjointSets(shares.size());
    largest_.assign(shares.size(), 0);
    for (std::size_t cell = 0; cell < fine.cells(); ++cell) add(fine.cell(cell));
    std::erase_if(owners_, [&](const Owner& o) { return o.weight < largest_[o.share]; });
    for (Owner& owner : owners_) owner.set = near_sets_.find(owner.set);
    sort_unique(owners_);
    if (adds_too_many()) is_divided_.clear();
  }

  /// The sets of a share: one, or those between which it is divided.
  void list(std::size_t share, std::vector<std::size_t>& result) {
    result.clear();
    if (is_divided_.empty() || !is_divided_[share]) return result.push_back(sets_.find(share));
    const auto first = std::ranges::lower_bound(owners_, share, {}, &Owner::share);
    for (auto owner = first; owner != owners_.end() && owner->share == share; ++owner)
      result.push_back(owner->set);
  }

 private:
  struct Owner {
    std::size_t share, set;
    float weight;  ///< of the near share

    auto operator<=>(const Owner&) const = default;
  };

  // Bodies that are cut everywhere get so many coarse nodes that cycles take longer than what their
  // iterations save.
  static constexpr double max_added = 0.3;

  bool adds_too_many() const {
    double sets = 0, divided = 0;
    for (std::size_t share = 0; share < shares_.size(); ++share)
      if (sets_.find(share) == share) {
        ++sets;
        divided += is_divided_[share];
      }
    std::vector<std::size_t> parts;
    for (const Owner& owner : owners_) parts.push_back(owner.set);
    sort_unique(parts);
    return static_cast<double>(parts.size()) - divided > max_added * sets;
  }
  /// Those with shares of two nodes at the same place.
  bool find_sets(const NodeGraph& fine) {
    const std::vector<Index> earlier = earlier_copies(fine, shares_);
    std::vector<bool> is_found(shares_.size());
    bool found = false;
    for (Index node = 0; node < fine.nodes(); ++node)
      for (Index other = earlier[node]; other != none; other = earlier[other]) {
        const Index first = shares_.begin(node);
        for (Index i = 0; first + i < shares_.end(node); ++i) {
          const std::size_t set = sets_.find(first + i);
          if (set != sets_.find(shares_.begin(other) + i)) continue;
          is_found[set] = found = true;
        }
      }
    if (!found) return false;
    is_divided_.resize(shares_.size());
    for (std::size_t share = 0; share < shares_.size(); ++share)
      is_divided_[share] = is_found[sets_.find(share)];
    return true;
  }

  void add(std::span<const Index> nodes) {
    here_.clear();
    for (const Index node : nodes)
      for (Index share = shares_.begin(node); share < shares_.end(node); ++share)
        if (is_divided_[share]) here_.push_back({share, sets_.find(share), shares_.weight(share)});
    for (const Owner& share : here_) {
      const Owner* near = &share;
      for (const Owner& other : here_)
        if (other.set == share.set && other.weight > near->weight) near = &other;
      if (near->weight == share.weight) near_sets_.unite(first_near(share), share.share);
      float& largest = largest_[share.share];
      largest = std::max(largest, near->weight);
      owners_.push_back({share.share, near->share, near->weight});
    }
  }
  /// The first share of a cell in the same set and as large.
  std::size_t first_near(const Owner& share) const {
    return std::ranges::find_if(here_,
                                [&](const Owner& other) {
                                  return other.set == share.set && other.weight == share.weight;
                                })
        ->share;
  }

  const Shares& shares_;
  DisjointSets& sets_;
  DisjointSets near_sets_;
  std::vector<bool> is_divided_;  ///< whether the set of a share is; empty: none is
  std::vector<float> largest_;    ///< per share, the weight of the near one
  std::vector<Owner> owners_;     ///< of the shares in divided sets
  std::vector<Owner> here_;       ///< those shares of the cell at hand, with their old sets
};

/// Numbers the sets of shares in the order of their shares, as coarse nodes at their points.
Interpolation number(const NodeGraph& fine, const Shares& shares, SlitEnds& ends,
                     NodeGraph& coarse) {
  std::vector<Index> number_of(shares.size(), none);
  std::vector<std::size_t> sets;
  Interpolation p;
  for (Index node = 0; node < fine.nodes(); ++node) {
    p.begin.push_back(static_cast<Index>(p.node.size()));
    for (Index share = shares.begin(node); share < shares.end(node); ++share) {
      ends.list(share, sets);
      for (const std::size_t set : sets) {
        if (number_of[set] == none) {
          number_of[set] = coarse.nodes();
          const Point& at = shares.point(share);
          coarse.places.push_back({double(at[0]), double(at[1]), double(at[2])});
        }
        p.node.push_back(number_of[set]);
        p.weight.push_back(shares.weight(share) / static_cast<float>(sets.size()));
      }
    }
  }
  p.begin.push_back(static_cast<Index>(p.node.size()));
  return p;
}

/// Adds the coarse nodes of every fine cell as a cell, each list once.
class CoarseCells {
 public:
  explicit CoarseCells(NodeGraph& coarse)
      : graph_(coarse), last_(coarse.nodes(), none), known_(16, Hash{this}, Equal{this}) {}

  void add(std::span<const Index> fine, const Interpolation& p) {
    std::vector<Index>& nodes = graph_.cell_nodes;
    const std::size_t start = nodes.size();
    for (const Index node : fine)
      for (Index i = p.begin[node]; i < p.begin[node + 1]; ++i)
        if (std::exchange(last_[p.node[i]], added_) != added_) nodes.push_back(p.node[i]);
    ++added_;
    std::sort(nodes.begin() + static_cast<std::ptrdiff_t>(start), nodes.end());
    graph_.cell_begin.push_back(static_cast<Index>(nodes.size()));
    if (known_.insert(graph_.cells() - 1).second) return;
    graph_.cell_begin.pop_back();
    nodes.resize(static_cast<std::size_t>(start));
  }

 private:
  struct Hash {
    const CoarseCells* self;
    std::size_t operator()(std::size_t cell) const {
      std::uint64_t hash = 0;
      for (const Index node : self->graph_.cell(cell))
        hash = (hash ^ node) * 0x9E3779B97F4A7C15u + (hash >> 29);
      return hash;
    }
  };
  struct Equal {
    const CoarseCells* self;
    bool operator()(std::size_t a, std::size_t b) const {
      return std::ranges::equal(self->graph_.cell(a), self->graph_.cell(b));
    }
  };

  NodeGraph& graph_;
  std::vector<Index> last_;  ///< the last cell of each node, by the number of those added before
  Index added_ = 0;
  std::unordered_set<std::size_t, Hash, Equal> known_;
};

}  // namespace

Coarsening coarsen(const NodeGraph& fine) {
  const std::array<bool, 3> axes = axes_to_coarsen(fine);
  Coarsening result;
  NodeGraph& coarse = result.coarse;
  coarse.is_grid = fine.is_grid;
  for (std::size_t c = 0; c < 3; ++c) {
    coarse.spacing[c] = fine.spacing[c] * (axes[c] ? 2 : 1);
    coarse.extent[c] = fine.extent[c] / (axes[c] ? 2 : 1);
  }

  const Shares shares(fine, axes);
  DisjointSets sets(shares.size());
  CellUnion cell_union(shares, sets);
  for (std::size_t cell = 0; cell < fine.cells(); ++cell) cell_union.unite(fine.cell(cell));

  SlitEnds ends(fine, shares, sets);
  const Interpolation& p = result.interpolation = number(fine, shares, ends, coarse);
  CoarseCells cells(coarse);
  for (std::size_t cell = 0; cell < fine.cells(); ++cell) cells.add(fine.cell(cell), p);
  return result;
}

Interpolation transposed(const Interpolation& p, Index coarse_nodes) {
  Interpolation result;
  result.begin.resize(coarse_nodes + 1);
  result.node.resize(p.node.size());
  result.weight.resize(p.node.size());
  for (const Index node : p.node) ++result.begin[node + 1];
  std::partial_sum(result.begin.begin(), result.begin.end(), result.begin.begin());
  std::vector<Index> next(result.begin.begin(), result.begin.end() - 1);
  for (Index v = 0; v < p.fine_nodes(); ++v)
    for (Index i = p.begin[v]; i < p.begin[v + 1]; ++i) {
      const Index place = next[p.node[i]]++;
      result.node[place] = v;
      result.weight[place] = p.weight[i];
    }
  return result;
}

Held held_nodes(const Interpolation& p, Index coarse_nodes, const Held& fine) {
  std::vector<float> heaviest(coarse_nodes);
  for (std::size_t i = 0; i < p.node.size(); ++i)
    heaviest[p.node[i]] = std::max(heaviest[p.node[i]], p.weight[i]);
  Held held(std::size_t{coarse_nodes} * 3, 1);
  for (std::size_t v = 0; v < p.fine_nodes(); ++v)
    for (Index i = p.begin[v]; i < p.begin[v + 1]; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        if (!fine[v * 3 + c] && p.weight[i] == heaviest[p.node[i]])
          held[std::size_t{p.node[i]} * 3 + c] = 0;
  return held;
}

std::vector<bool> loose_nodes(const NodeGraph& graph, const Held& held) {
  DisjointSets pieces(graph.nodes());
  for (std::size_t cell = 0; cell < graph.cells(); ++cell)
    for (const Index node : graph.cell(cell)) pieces.unite(graph.cell(cell)[0], node);
  std::vector<Index> components(graph.nodes());
  for (std::size_t i = 0; i < held.size(); ++i) components[pieces.find(i / 3)] += held[i];
  std::vector<bool> loose(graph.nodes());
  for (std::size_t node = 0; node < loose.size(); ++node)
    loose[node] = components[pieces.find(node)] < 6;
  return loose;
}

std::vector<bool> loose_nodes(const Interpolation& p, Index coarse_nodes,
                              const std::vector<bool>& fine) {
  std::vector<bool> coarse(coarse_nodes);
  for (std::size_t v = 0; v < p.fine_nodes(); ++v)
    for (Index i = p.begin[v]; i < p.begin[v + 1]; ++i)
      if (fine[v]) coarse[p.node[i]] = true;
  return coarse;
}

}  // namespace suture
