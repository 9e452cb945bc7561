// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/element_blocks.hpp"

#include <algorithm>
#include <cmath>

namespace suture {
namespace {

/// A part of the magnitudes that a centroid or a height adds up; both are rounded by less than
/// 32 eps.
constexpr double rounding = 1e-14;

}  // namespace

ElementBlocks::ElementBlocks(const CellComplex& complex, const Places& places)
    : boxes_(blocks_of(complex.count(0), size)) {
  read(0, complex.count(0), places);
  lists_.find(complex);
}

void ElementBlocks::read(Index first, Index last, const Places& places) {
  for (Index begin = first; begin < last; begin += size) {
    Box box = no_box;
    for (Index v = begin; v < std::min(begin + size, last); ++v) include(box, places.at(v));
    boxes_[begin / size] = box;
  }
}

/// Vertices that were split or have met.
void ElementBlocks::follow(const CellComplex& complex, const TopologyChange& change,
                           const Places& places) {
  boxes_.resize(blocks_of(complex.count(0), size), no_box);
  for (const Index v : change.stars[0].cells) include(boxes_[v / size], places.at(v));
  lists_.follow(complex, change);
}

std::vector<Box> ElementBlocks::boxes() const {
  std::vector<Box> result(lists_.lists().size(), no_box);
  for (std::size_t b = 0; b < result.size(); ++b) {
    for (const Index v : lists_.lists()[b]) {
      include(result[b], boxes_[v].low);
      include(result[b], boxes_[v].high);
    }
    for (std::size_t a = 0; a < 3; ++a) {
      result[b].low[a] -= rounding * std::abs(result[b].low[a]);
      result[b].high[a] += rounding * std::abs(result[b].high[a]);
    }
  }
  return result;
}

SearchedElements::SearchedElements(const ElementBlocks* blocks, Index count,
                                   const std::function<bool(const Box&)>& may_hold)
    : count_(count) {
  if (!blocks) return;
  for (const Box& box : blocks->boxes())
    is_near_.push_back(box.low[0] <= box.high[0] && may_hold(box));
}

std::vector<ElementRange> SearchedElements::ranges() const {
  std::vector<ElementRange> result;
  for (Index begin = 0; begin < count_; begin += ElementBlocks::size)
    if (contains(begin)) result.push_back({begin, std::min(begin + ElementBlocks::size, count_)});
  return result;
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
