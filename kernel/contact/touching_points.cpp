// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/touching_points.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernel/base/sort_unique.hpp"

namespace suture {
namespace {

constexpr std::size_t largest_cluster = 32;

}  // namespace

TouchingPoints::TouchingPoints(const CellComplex& complex, Attributes& attributes,
                               SurfacePoints::Source embedding)
    : attributes_(attributes), surface_(complex) {
  if (embedding)
    embedded_.emplace(std::move(embedding));
  else
    number_vertices();
}

void TouchingPoints::number_vertices() {
  numbers_.resize(attributes_.vertex_count());
  std::iota(numbers_.begin(), numbers_.end(), 0);
}

std::span<const Index> TouchingPoints::ascending_vertices() {
  if (vertices_.empty())
    vertices_ = embedded_ ? embedded_->ascending_vertices() : surface_.ascending_vertices();
  return vertices_;
}

void TouchingPoints::add_cluster(std::span<const Index> numbers, std::span<const Index> vertices) {
  cluster_numbers_.insert(cluster_numbers_.end(), numbers.begin(), numbers.end());
  cluster_vertices_.insert(cluster_vertices_.end(), vertices.begin(), vertices.end());
  cluster_ends_.push_back({cluster_numbers_.size(), cluster_vertices_.size()});
}

TouchingPoints::Cluster TouchingPoints::cluster(std::size_t i) const {
  const auto [first, first_vertex] = cluster_ends_[i];
  const auto [end, end_of_vertices] = cluster_ends_[i + 1];
  return {std::span(cluster_numbers_).subspan(first, end - first),
          std::span(cluster_vertices_).subspan(first_vertex, end_of_vertices - first_vertex)};
}

/// Vertices are in the order of the mesh, in which neighbours follow each
/// other; points of an embedded surface by the cell in which they are at rest.
void TouchingPoints::find_clusters(double cell) {
  if (!cluster_ends_.empty()) return;
  cluster_numbers_.clear();
  cluster_vertices_.clear();
  cluster_ends_.assign(1, {0, 0});
  if (!embedded_) {
    const std::span<const Index> all = ascending_vertices();
    for (std::size_t first = 0; first < all.size(); first += largest_cluster) {
      const auto some = all.subspan(first, std::min(largest_cluster, all.size() - first));
      add_cluster(some, some);
    }
    return;
  }
  std::vector<std::pair<std::array<double, 3>, Index>> cells;
  for_each([&](const ContactPoint& point) {
    Vec3 place = point.sum(attributes_.rest().rows());
    for (double& x : place) x = std::floor(x / cell);
    cells.push_back({place, point.number});
  });
  std::ranges::sort(cells);
  for (std::size_t i = 0; i < cells.size();) {
    std::vector<Index> numbers, vertices;
    for (const std::array<double, 3> of = cells[i].first;
         i < cells.size() && cells[i].first == of && numbers.size() < largest_cluster; ++i) {
      numbers.push_back(cells[i].second);
      const std::span<const Index> around = (*this)[cells[i].second].vertices;
      vertices.insert(vertices.end(), around.begin(), around.end());
    }
    sort_unique(vertices);
    add_cluster(numbers, vertices);
  }
}

void TouchingPoints::follow(const CellComplex& complex, const TopologyChange& change) {
  surface_.follow(complex, change);
  vertices_.clear();
  cluster_ends_.clear();
  if (embedded_)
    embedded_->follow();
  else
    number_vertices();
}

void TouchingPoints::state(Archive& archive) {
  if (archive.has_cells()) archive("surface", surface_);
  if (!archive.loads()) return;
  vertices_.clear();
  cluster_ends_.clear();
  if (!embedded_)
    number_vertices();
  else if (archive.has_cells())
    embedded_->follow();
}

}  // namespace suture
