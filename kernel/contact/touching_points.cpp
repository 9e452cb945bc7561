// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/touching_points.hpp"

#include <numeric>

namespace suture {

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

void TouchingPoints::follow(const CellComplex& complex, const TopologyChange& change) {
  surface_.follow(complex, change);
  vertices_.clear();
  if (embedded_)
    embedded_->follow();
  else
    number_vertices();
}

void TouchingPoints::state(Archive& archive) {
  if (archive.has_cells()) archive("surface", surface_);
  if (!archive.loads()) return;
  vertices_.clear();
  if (!embedded_)
    number_vertices();
  else if (archive.has_cells())
    embedded_->follow();
}

}  // namespace suture
