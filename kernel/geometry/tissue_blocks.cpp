// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/tissue_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "kernel/base/archive_lists.hpp"

namespace suture {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

constexpr Index per_box = TissueBlocks::vertices_size;

/// One bit for each side of `box` beyond which all of both others lie.
std::uint8_t sides_beyond(const Box& box, const Box& one, const Box& other) {
  unsigned code = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    code |= unsigned(std::max(one.high[a], other.high[a]) < box.low[a]) << 2 * a;
    code |= unsigned(std::min(one.low[a], other.low[a]) > box.high[a]) << (2 * a + 1);
  }
  return static_cast<std::uint8_t>(code);
}

typedef double Pair __attribute__((vector_size(16), aligned(8), may_alias));

/// A box in pairs of coordinates, xy and z: one by one takes twice as long.
struct PairBox {
  Pair low_xy = Pair{} + infinity, high_xy = -low_xy, low_z = low_xy, high_z = high_xy;

  /// Includes x, and copies it.
  void take(const double* x, double* copy) {
    const Pair xy = *reinterpret_cast<const Pair*>(x), z{x[2], x[2]};
    *reinterpret_cast<Pair*>(copy) = xy;
    copy[2] = z[0];
    low_xy = xy < low_xy ? xy : low_xy;
    high_xy = xy > high_xy ? xy : high_xy;
    low_z = z < low_z ? z : low_z;
    high_z = z > high_z ? z : high_z;
  }
  Box box() const {
    return {{low_xy[0], low_xy[1], low_z[0]}, {high_xy[0], high_xy[1], high_z[0]}};
  }
};

}  // namespace

bool TissueBlocks::move(const CellComplex& complex, const Places& places, const Workers* workers) {
  const std::size_t vertices = complex.count(0);
  const bool first = empty(), followed = now_.size() == vertices;
  before_.swap(now_);
  boxes_before_.swap(boxes_now_);
  now_.resize(vertices);
  boxes_now_.resize(blocks_of(vertices, per_box));
  moved_.assign(boxes_now_.size(), -1);
  for_chunks(vertices, chunk_size, workers, [&](std::size_t begin, std::size_t end, std::size_t) {
    find_boxes(begin, end, places);
  });
  if (followed) return true;
  const auto from = first ? 0 : static_cast<std::ptrdiff_t>(before_.size());
  before_.insert(before_.end(), now_.begin() + from, now_.end());
  if (first) boxes_before_.clear();
  boxes_before_.resize(boxes_now_.size(), no_box);
  for (std::size_t v = static_cast<std::size_t>(from); v < vertices; ++v)
    include(boxes_before_[v / per_box], before_[v]);
  lists_.find(complex);
  return false;
}

/// Chunks of vertices are whole blocks.
void TissueBlocks::find_boxes(std::size_t first, std::size_t last, const Places& places) {
  for (std::size_t begin = first; begin < last; begin += per_box) {
    const std::size_t count = std::min<std::size_t>(per_box, last - begin);
    const double* x = places.rows + places.stride * begin;
    PairBox box;
    for (std::size_t v = 0; v < count; ++v) box.take(x + places.stride * v, now_[begin + v].data());
    boxes_now_[begin / per_box] = box.box();
  }
}

void TissueBlocks::follow(const CellComplex& complex, const TopologyChange& change) {
  if (empty()) return;
  for (const Split& split : change.splits[0]) {
    const Index block = split.new_cell / per_box;
    now_.push_back(now_[split.old_cell]);
    boxes_now_.resize(blocks_of(now_.size(), per_box), no_box);
    include(boxes_now_[block], now_.back());
  }
  lists_.follow(complex, change);
}

void TissueBlocks::state(Archive& archive) {
  archive("vertices", now_);
  archive.rows<double>("boxes", boxes_now_);
  archive_lists(archive, "lists", lists_.lists());
  archive.require(boxes_now_.size() == blocks_of(now_.size(), per_box),
                  "the boxes are not those of the vertices");
}

double TissueBlocks::vertices_moved(Index vertex_block) const {
  const std::size_t begin = std::size_t{vertex_block} * per_box;
  double largest = 0;
  for (std::size_t v = begin; v < std::min(begin + per_box, now_.size()); ++v) {
    const double x = now_[v][0] - before_[v][0], y = now_[v][1] - before_[v][1],
                 z = now_[v][2] - before_[v][2];
    largest = std::max(largest, x * x + y * y + z * z);
  }
  return std::sqrt(largest);
}

double TissueBlocks::moved(Index block) {
  double largest = 0;
  for (const Index v : lists_.lists()[block]) {
    if (moved_[v] < 0) moved_[v] = vertices_moved(v);
    largest = std::max(largest, moved_[v]);
  }
  return largest;
}

std::vector<Index> TissueBlocks::all() const {
  std::vector<Index> blocks(block_count());
  std::iota(blocks.begin(), blocks.end(), 0);
  return blocks;
}

std::vector<Index> TissueBlocks::near(const Box& box) const {
  Box enlarged = box;
  for (std::size_t a = 0; a < 3; ++a) {
    enlarged.low[a] -= 1e-14 * std::abs(box.low[a]);
    enlarged.high[a] += 1e-14 * std::abs(box.high[a]);
  }
  std::vector<std::uint8_t> beyond(boxes_now_.size());
  for (std::size_t b = 0; b < beyond.size(); ++b)
    beyond[b] = sides_beyond(enlarged, boxes_before_[b], boxes_now_[b]);
  std::vector<Index> blocks;
  for (std::size_t b = 0; b < block_count(); ++b) {
    const std::vector<Index>& list = lists_.lists()[b];
    unsigned all = list.empty() ? 0 : 0xFF;
    for (const Index v : list) all &= beyond[v];
    if (all == 0 && !list.empty()) blocks.push_back(static_cast<Index>(b));
  }
  return blocks;
}

}  // namespace suture
