// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/boundary_surface.hpp"

#include <algorithm>
#include <utility>

namespace suture {
namespace {

/// Darts run counterclockwise as seen from inside.
BoundarySurface::Corners corners_of(const CellComplex& complex, Index face) {
  const Dart first = 4 * face;
  return {complex.origin(first), complex.origin(first + 3), complex.origin(first + 2),
          complex.origin(first + 1)};
}

}  // namespace

void DenseSet::insert(Index item) {
  if (item >= place_.size()) place_.resize(item + 1, none);
  place_[item] = static_cast<Index>(items_.size());
  items_.push_back(item);
}

void DenseSet::erase(Index item) {
  const Index place = place_[item];
  items_[place] = items_.back();
  place_[items_[place]] = place;
  items_.pop_back();
  place_[item] = none;
}

void DenseSet::clear() {
  for (const Index item : items_) place_[item] = none;
  items_.clear();
}

void DenseSet::state(Archive& archive) {
  archive("items", items_);
  if (!archive.loads()) return;
  std::ranges::fill(place_, none);
  const std::vector<Index> items = std::exchange(items_, {});
  for (const Index item : items) insert(item);
}

BoundarySurface::BoundarySurface(const CellComplex& complex) {
  for (Index e = 0; e < complex.element_count(); ++e) update(complex, e);
}

std::vector<Index> BoundarySurface::ascending_vertices() const {
  std::vector<Index> ascending;
  for (Index v = 0; v < uses_.size(); ++v)
    if (has_vertex(v)) ascending.push_back(v);
  return ascending;
}

void BoundarySurface::follow(const CellComplex& complex, const TopologyChange& change) {
  for (const Index element : change.removed[3]) update(complex, element);
  for (const Index element : change.elements) update(complex, element);
}

/// Faces that stay may have other vertices.
void BoundarySurface::update(const CellComplex& complex, Index element) {
  for (Index face = 6 * element; face < 6 * element + 6; ++face) {
    if (faces_.contains(face)) remove(face);
    if (complex.exists(3, element) && complex.beta3(4 * face) == none) add(complex, face);
  }
}

void BoundarySurface::add(const CellComplex& complex, Index face) {
  faces_.insert(face);
  corners_.push_back(corners_of(complex, face));
  for (const Index v : corners_.back()) {
    if (v >= uses_.size()) uses_.resize(std::max<std::size_t>(v + 1, complex.count(0)), 0);
    if (uses_[v]++ == 0) vertices_.insert(v);
  }
}

void BoundarySurface::remove(Index face) {
  Corners& corners = corners_[faces_.place(face)];
  for (const Index v : corners)
    if (--uses_[v] == 0) vertices_.erase(v);
  corners = corners_.back();
  corners_.pop_back();
  faces_.erase(face);
}

void BoundarySurface::count_corners() {
  std::ranges::fill(uses_, 0);
  for (const Corners& corners : corners_)
    for (const Index v : corners) {
      if (v >= uses_.size()) uses_.resize(v + 1, 0);
      ++uses_[v];
    }
}

void BoundarySurface::state(Archive& archive) {
  archive("faces", faces_);
  archive("corners", corners_);
  archive("vertices", vertices_);
  if (archive.loads()) count_corners();
}

}  // namespace suture
