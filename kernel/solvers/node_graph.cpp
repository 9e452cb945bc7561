// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/node_graph.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/topology/rest_shape.hpp"

namespace suture {
namespace {

/// How far a vertex may be from a point of the grid that it is on, in multiples of the spacing:
/// coordinates in files often have 5 digits.
constexpr double on_grid = 1e-3;

/// The spacing where vertices are no grid, in multiples of the edge of a mean element. The wider a
/// grid is, the fewer coarse nodes an element belongs to, and the more iterations are needed.
constexpr double widening = 1.25;

struct Bounds {
  static constexpr double infinite = std::numeric_limits<double>::infinity();
  Vec3 low{infinite, infinite, infinite}, high{-infinite, -infinite, -infinite};

  void add(const Vec3& p) {
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], p[c]);
      high[c] = std::max(high[c], p[c]);
    }
  }
  Vec3 extent() const { return {high[0] - low[0], high[1] - low[1], high[2] - low[2]}; }
};

void add_elements(const CellComplex& complex, NodeGraph& graph) {
  graph.cell_begin.reserve(complex.existing(3) + 1);
  graph.cell_nodes.reserve(std::size_t{complex.existing(3)} * hexahedron::vertices);
  for (Index e = 0; e < complex.element_count(); ++e) {
    if (!complex.exists(3, e)) continue;
    const Hexahedron& x = complex.vertices_of(e);
    graph.cell_nodes.insert(graph.cell_nodes.end(), x.begin(), x.end());
    graph.cell_begin.push_back(static_cast<Index>(graph.cell_nodes.size()));
  }
}

Corners corners_of(const NodeGraph& graph, std::size_t element) {
  Corners x;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = graph.places[graph.cell(element)[i]];
  return x;
}

/// The edge of the cube with the mean volume of an element.
double mean_edge(const NodeGraph& graph) {
  double volume = 0;
  for (std::size_t e = 0; e < graph.cells(); ++e)
    for (const double jacobian : gauss_jacobians(corners_of(graph, e)))
      volume += std::abs(jacobian) / hexahedron::vertices;
  return std::cbrt(volume / static_cast<double>(graph.cells()));
}

Vec3 box_of(const Corners& corners) {
  Bounds bounds;
  for (const Vec3& x : corners) bounds.add(x);
  return bounds.extent();
}

/// The spacing nearest to `edge` with which the body is a whole number of cells wide on the coarse
/// levels, too. A layer of coarse nodes outside the body would have next to no part in it.
double fitted(double extent, double edge) {
  const double cells = extent / edge;
  if (!(cells > 0 && std::isfinite(cells))) return edge;
  double unit = 1;
  while (cells >= 8 * unit) unit *= 2;
  return extent / (std::max(1.0, std::round(cells / unit)) * unit);
}

/// The nodes of cells, once each.
std::vector<Index> used_nodes(const NodeGraph& graph) {
  std::vector<bool> is_used(graph.nodes());
  for (const Index node : graph.cell_nodes) is_used[node] = true;
  std::vector<Index> used;
  used.reserve(graph.nodes());
  for (Index node = 0; node < graph.nodes(); ++node)
    if (is_used[node]) used.push_back(node);
  return used;
}

bool are_on_grid(const NodeGraph& graph, const std::vector<Index>& nodes, const Vec3& spacing) {
  return std::ranges::all_of(nodes, [&](Index node) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double place = graph.places[node][c] / spacing[c];
      if (!(std::abs(place - std::round(place)) < on_grid)) return false;
    }
    return true;
  });
}

}  // namespace

NodeGraph vertex_graph(const CellComplex& complex, Attributes& attributes) {
  NodeGraph graph;
  add_elements(complex, graph);
  graph.places.resize(attributes.vertex_count());
  const double* rest = attributes.rest().rows();
  Bounds bounds;
  const std::vector<Index> used = used_nodes(graph);
  for (const Index v : used) {
    const double* p = rest + std::size_t{v} * 4;
    graph.places[v] = {p[0], p[1], p[2]};
    bounds.add(graph.places[v]);
  }
  for (Vec3& place : graph.places)
    for (std::size_t c = 0; c < 3; ++c) place[c] -= bounds.low[c];

  const Vec3 box = box_of(corners_of(graph, 0));
  graph.is_grid = are_on_grid(graph, used, box);
  const double edge = graph.is_grid ? 0 : widening * mean_edge(graph);
  const Vec3 extent = bounds.extent();
  for (std::size_t c = 0; c < 3; ++c)
    graph.spacing[c] = graph.is_grid ? box[c] : fitted(extent[c], edge);
  for (Vec3& place : graph.places)
    for (std::size_t c = 0; c < 3; ++c) {
      place[c] /= graph.spacing[c];
      if (graph.is_grid) place[c] = std::round(place[c]);
    }
  for (std::size_t c = 0; c < 3; ++c) graph.extent[c] = extent[c] / graph.spacing[c];
  return graph;
}

}  // namespace suture
