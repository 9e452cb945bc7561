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
                            Index vertex_count)
    : vertices(vertex_blocks), lists(elements_per_block, vertex_blocks) {
  // Room for as many new vertices; only touched pages take memory.
  of_vertices.reserve(vertex_blocks.count(vertex_count) + vertex_count / VertexBlocks::new_size);
  of_vertices.assign(vertex_blocks.count(vertex_count), no_box);
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

ElementBlocks::ElementBlocks(const CellComplex& complex, const Places& places) {
  constexpr std::array<Index, levels> vertices{vertices_read, 128, 32};
  for (std::size_t level = 0; level < levels; ++level)
    levels_.emplace_back(sizes[level], VertexBlocks{vertices[level], large_blocks_end(complex)},
                         complex.count(0));
  levels_.back().lists.find(complex);
  for (std::size_t level = levels - 1; level-- > 0;)
    levels_[level].lists.gather(levels_[level + 1].lists);
  read(0, complex.count(0), places);
}

void ElementBlocks::read(Index first, Index last, const Places& places) {
  const VertexBlocks& vertices = levels_[0].vertices;
  for (Index begin = first; begin < last; begin += vertices.size_at(begin))
    read(0, begin, std::min(begin + vertices.size_at(begin), last), places);
}

/// One block of vertices of this level, and the smaller ones that it has.
Box ElementBlocks::read(std::size_t level, Index first, Index last, const Places& places) {
  Box box = no_box;
  if (level + 1 == levels) {
    box = box_of_vertices(first, last, places);
  } else {
    const Index size = levels_[level + 1].vertices.size_at(first);
    for (Index begin = first; begin < last; begin += size)
      include_box(box, read(level + 1, begin, std::min(begin + size, last), places));
  }
  levels_[level].of_vertices[levels_[level].vertices.of(first)] = box;
  return box;
}

void ElementBlocks::follow(const CellComplex& complex, const TopologyChange& change,
                           const Places& places) {
  for (Boxes& boxes : levels_) boxes.follow(complex, change, places);
}

// ---------------------------------------------------------------- searches --

SearchedElements::SearchedElements(const ElementBlocks* blocks, Index count,
                                   const std::function<bool(const Box&)>& may_hold)
    : count_(count) {
  constexpr Index most = ElementBlocks::sizes[0];
  if (blocks) {
    sections_.assign(blocks->count(1), 0);
    search(*blocks, 0, 0, count, may_hold);
  } else {
    for (Index begin = 0; begin < count; begin += most) add(begin, std::min(begin + most, count));
  }
}

/// Looks at the blocks of one level from `begin` on, and at smaller ones in those that are near.
void SearchedElements::search(const ElementBlocks& blocks, std::size_t level, Index begin,
                              Index end, const std::function<bool(const Box&)>& may_hold) {
  const Index size = ElementBlocks::sizes[level];
  for (Index e = begin; e < end; e += size) {
    const Box box = blocks.box(level, e / size);
    if (!(box.low[0] <= box.high[0] && may_hold(box))) continue;
    const Index last = std::min(e + size, end);
    if (level + 1 < ElementBlocks::levels)
      search(blocks, level + 1, e, last, may_hold);
    else
      add(e, last);
  }
}

/// Elements of one block of level 0.
void SearchedElements::add(Index begin, Index end) {
  if (!ranges_.empty() && ranges_.back().end == begin && begin % ElementBlocks::sizes[0] != 0)
    ranges_.back().end = end;
  else
    ranges_.push_back({begin, end});
  if (sections_.empty()) return;
  std::uint32_t& near = sections_[begin / section];
  if (near == 0) near = near_bits * near_sections_++;
  near |= std::uint32_t{1} << begin % section / block;
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
