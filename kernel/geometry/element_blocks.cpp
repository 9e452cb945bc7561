// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/element_blocks.hpp"

#include <algorithm>
#include <cmath>

namespace suture {
namespace {

/// A part of the magnitudes that a centroid or a height adds up; both are rounded by less than
/// 32 eps.
constexpr double rounding = 1e-14;

Box box_of_vertices(Index first, Index last, const Places& places) {
  Box box = no_box;
  for (Index v = first; v < last; ++v) include(box, places.at(v));
  return box;
}

/// The number of vertices in large blocks: all that there are, in whole units of read().
Index large_blocks_end(const CellComplex& complex) {
  constexpr Index unit = ElementBlocks::vertices_read;
  return blocks_of(complex.count(0), unit) * unit;
}

}  // namespace

// ------------------------------------------------------------------ blocks --

ElementBlocks::Boxes::Boxes(Index elements_per_block, VertexBlocks vertex_blocks,
                            const CellComplex& complex)
    : vertices(vertex_blocks),
      lists(elements_per_block, vertex_blocks),
      of_vertices(vertex_blocks.count(complex.count(0)), no_box) {
  lists.find(complex);
}

Box ElementBlocks::Boxes::box(Index block) const {
  Box box = no_box;
  for (const Index v : lists.lists()[block]) include_box(box, of_vertices[v]);
  if (box.low[0] > box.high[0]) return box;  // infinity - infinity is none
  for (std::size_t a = 0; a < 3; ++a) {
    box.low[a] -= rounding * std::abs(box.low[a]);
    box.high[a] += rounding * std::abs(box.high[a]);
  }
  return box;
}

/// Vertices were split or have met.
void ElementBlocks::Boxes::follow(const CellComplex& complex, const TopologyChange& change,
                                  const Places& places) {
  of_vertices.resize(vertices.count(complex.count(0)), no_box);
  for (const Index v : change.stars[0].cells) include(of_vertices[vertices.of(v)], places.at(v));
  lists.follow(complex, change);
}

ElementBlocks::ElementBlocks(const CellComplex& complex, const Places& places)
    : groups_(group_size, {vertices_read, large_blocks_end(complex)}, complex),
      blocks_(size, {vertices_per_block, large_blocks_end(complex)}, complex) {
  read(0, complex.count(0), places);
}

void ElementBlocks::read(Index first, Index last, const Places& places) {
  for (Index begin = first; begin < last; begin += groups_.vertices.size_at(begin)) {
    const Index end = std::min(begin + groups_.vertices.size_at(begin), last);
    Box all = no_box;
    for (Index v = begin; v < end; v += blocks_.vertices.size_at(v)) {
      const Box box = box_of_vertices(v, std::min(v + blocks_.vertices.size_at(v), end), places);
      blocks_.of_vertices[blocks_.vertices.of(v)] = box;
      include_box(all, box);
    }
    groups_.of_vertices[groups_.vertices.of(begin)] = all;
  }
}

void ElementBlocks::follow(const CellComplex& complex, const TopologyChange& change,
                           const Places& places) {
  groups_.follow(complex, change, places);
  blocks_.follow(complex, change, places);
}

// ---------------------------------------------------------------- searches --

SearchedElements::SearchedElements(const ElementBlocks* blocks, Index count,
                                   const std::function<bool(const Box&)>& may_hold)
    : count_(count) {
  constexpr Index size = ElementBlocks::size, group_size = ElementBlocks::group_size;
  if (!blocks) {
    for (Index begin = 0; begin < count; begin += group_size) add(begin, group_size);
    return;
  }
  const auto is_near = [&](const Box& box) { return box.low[0] <= box.high[0] && may_hold(box); };
  slots_.assign(blocks->blocks(), none);
  for (Index begin = 0; begin < count; begin += group_size) {
    if (!is_near(blocks->group_box(begin / group_size))) continue;
    for (Index e = begin; e < std::min(begin + group_size, count); e += size) {
      if (!is_near(blocks->box(e / size))) continue;
      slots_[e / size] = static_cast<Index>(ranges_.size()) * size;
      add(e, size);
    }
  }
}

void SearchedElements::add(Index begin, Index size) {
  ranges_.push_back({begin, std::min(begin + size, count_)});
}

std::array<double, 2> heights_of(const Box& box, const Vec3& point, const Vec3& n) {
  double middle = 0, half = 0, magnitude = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double furthest = std::max(std::abs(box.low[a]), std::abs(box.high[a]));
    middle += n[a] * ((box.low[a] + box.high[a]) / 2 - point[a]);
    half += std::abs(n[a]) * box.length(a) / 2;
    magnitude += std::abs(n[a]) * (furthest + std::abs(point[a]));
  }
  half += rounding * magnitude;
  return {middle - half, middle + half};
}

}  // namespace suture
