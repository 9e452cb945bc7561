// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/spectrum/coarse_space.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernel/base/box.hpp"
#include "kernel/base/saturate.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/dynamics/pieces.hpp"

namespace suture {
namespace {

Box box_of(Attributes& attributes, const std::vector<Index>& pieces) {
  const Column& rest = attributes.rest();
  Box box = no_box;
  for (Index v = 0; v < pieces.size(); ++v)
    if (pieces[v] != none) include(box, {rest.get(v, 0), rest.get(v, 1), rest.get(v, 2)});
  return box;
}

/// The side of each vertex along the three axes of the elements, as far as these agree from
/// element to element: bit a alternates along axis a.
std::vector<std::uint8_t> parities(const CellComplex& complex, Index vertices) {
  constexpr std::uint8_t unknown = 8;
  std::vector<std::uint8_t> parity(vertices, unknown);
  std::vector<Index> open(complex.element_count());
  std::iota(open.begin(), open.end(), Index{0});
  bool seed = true;
  while (!open.empty()) {
    std::vector<Index> left;
    for (const Index e : open) {
      if (!complex.exists(3, e)) continue;
      const Hexahedron& nodes = complex.vertices_of(e);
      unsigned n = 0;
      while (n < 8 && parity[nodes[n]] == unknown) ++n;
      if (n == 8 && !seed) {
        left.push_back(e);
        continue;
      }
      const unsigned base = n == 8 ? 0 : parity[nodes[n]] ^ n;
      seed = false;
      for (unsigned i = 0; i < 8; ++i)
        if (parity[nodes[i]] == unknown) parity[nodes[i]] = static_cast<std::uint8_t>(base ^ i);
    }
    seed = left.size() == open.size();  // another piece
    open = std::move(left);
  }
  return parity;
}

}  // namespace

CoarseSpace::CoarseSpace(const CellComplex& complex, Attributes& attributes,
                         const std::vector<double>& scale, Index nodes)
    : mass_root_(scale.size()) {
  for (std::size_t i = 0; i < scale.size(); ++i) mass_root_[i] = scale[i] > 0 ? 1 / scale[i] : 0;
  grids_.push_back(make_grid(complex, attributes, nodes));
  size_ = 3 * grids_.back().count;
}

void CoarseSpace::add_checkerboards(const CellComplex& complex, Attributes& attributes,
                                    Index nodes) {
  Grid grid = make_grid(complex, attributes, nodes);
  grid.first = size_;
  grid.signs = parities(complex, attributes.vertex_count());
  for (std::uint8_t& bits : grid.signs) {
    const int x = bits & 1, y = bits >> 1 & 1, z = bits >> 2 & 1;
    bits = static_cast<std::uint8_t>((y ^ z) | (x ^ z) << 1 | (x ^ y) << 2);
  }
  size_ += 3 * grid.count;
  grids_.push_back(std::move(grid));
}

/// Gives the corners of the box around a vertex to `grid`. False if that takes more than
/// `nodes` nodes; with `forced` the vertex, of a crumb, goes without.
bool CoarseSpace::add_vertex(Grid& grid, GridNumbers& numbers, Index vertex, Index piece,
                             const Vec3& place, const Vec3& cells, std::size_t nodes, bool forced) {
  std::array<std::int64_t, 3> cell;
  for (std::size_t c = 0; c < 3; ++c)
    cell[c] = saturate<std::int64_t>(std::clamp(std::floor(place[c]), 0.0, cells[c] - 1));
  for (std::size_t corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::array<std::int64_t, 4> key{0, 0, 0, static_cast<std::int64_t>(piece)};
    for (std::size_t c = 0; c < 3; ++c) {
      const double at = place[c] - static_cast<double>(cell[c]);
      const bool side = corner >> c & 1;
      key[c] = cell[c] + side;
      weight *= side ? at : 1 - at;
    }
    grid.nodes[vertex][corner] = -1;
    if (weight < 1e-9) continue;
    auto found = numbers.find(key);
    if (found == numbers.end()) {
      if (numbers.size() >= nodes && !forced) return false;
      if (numbers.size() >= nodes) continue;
      found = numbers.emplace(key, static_cast<std::int32_t>(numbers.size())).first;
    }
    grid.nodes[vertex][corner] = found->second;
    grid.weights[vertex][corner] = static_cast<float>(weight);
  }
  return true;
}

/// Boxes as near to cubes as the body's box allows, as small as `nodes` allows; the largest
/// pieces are served first.
CoarseSpace::Grid CoarseSpace::make_grid(const CellComplex& complex, Attributes& attributes,
                                         Index nodes) const {
  const Index vertices = attributes.vertex_count();
  const std::vector<Index> pieces = pieces_of(complex, attributes);
  std::vector<Index> order;
  for (Index v = 0; v < vertices; ++v)
    if (pieces[v] != none) order.push_back(v);
  std::ranges::stable_sort(order, [&](Index a, Index b) { return pieces[a] < pieces[b]; });
  const Box box = box_of(attributes, pieces);
  const Vec3 length = minus(box.high, box.low);
  const std::size_t most = std::max<std::size_t>(nodes, 8);
  double size = std::cbrt(length[0] * length[1] * length[2] / nodes);
  Grid grid;
  for (bool fits = false; !fits; size *= 1.05) {
    Vec3 cells;
    for (std::size_t c = 0; c < 3; ++c) cells[c] = std::max(1.0, std::round(length[c] / size));
    const bool coarsest = cells == Vec3{1, 1, 1};
    GridNumbers numbers;
    grid.nodes.assign(vertices, {});
    grid.weights.assign(vertices, {});
    fits = std::ranges::all_of(order, [&](Index v) {
      Vec3 place{};
      for (std::size_t c = 0; c < 3; ++c) {
        const double x = attributes.rest().get(v, static_cast<int>(c)) - box.low[c];
        if (length[c] > 0) place[c] = x / length[c] * cells[c];
      }
      return add_vertex(grid, numbers, v, pieces[v], place, cells, most, coarsest);
    });
    grid.count = static_cast<Eigen::Index>(numbers.size());
  }
  return grid;
}

/// visit(component of a vertex, motion, weight)
template <class Visit>
void CoarseSpace::for_each(Visit visit) const {
  for (const Grid& grid : grids_)
    for (std::size_t v = 0; v < grid.nodes.size(); ++v)
      for (std::size_t corner = 0; corner < 8; ++corner) {
        const std::int32_t node = grid.nodes[v][corner];
        const auto weight = static_cast<double>(grid.weights[v][corner]);
        if (node < 0 || weight == 0) continue;
        for (std::size_t c = 0; c < 3; ++c) {
          const bool minus = !grid.signs.empty() && (grid.signs[v] >> c & 1);
          const double factor = mass_root_[3 * v + c] * (minus ? -weight : weight);
          visit(3 * v + c, grid.first + 3 * node + static_cast<Eigen::Index>(c), factor);
        }
      }
}

void CoarseSpace::prolong(const Eigen::VectorXd& c, double* y) const {
  for_each([&](std::size_t i, Eigen::Index j, double weight) { y[i] += weight * c[j]; });
}

Eigen::VectorXd CoarseSpace::restrict(const double* y) const {
  Eigen::VectorXd c = Eigen::VectorXd::Zero(size_);
  for_each([&](std::size_t i, Eigen::Index j, double weight) { c[j] += weight * y[i]; });
  return c;
}

}  // namespace suture
