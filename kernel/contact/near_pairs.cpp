// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/near_pairs.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "kernel/base/box.hpp"
#include "kernel/contact/vectors.hpp"

namespace suture {
namespace {

bool contains(const Box& box, const Vec3& p) {
  for (std::size_t c = 0; c < 3; ++c)
    if (p[c] < box.low[c] || p[c] > box.high[c]) return false;
  return true;
}

bool overlap(const Box& a, const Box& b) {
  for (std::size_t c = 0; c < 3; ++c)
    if (a.high[c] < b.low[c] || b.high[c] < a.low[c]) return false;
  return true;
}

void enlarge(Box& box, double reach) {
  for (std::size_t c = 0; c < 3; ++c) {
    box.low[c] -= reach;
    box.high[c] += reach;
  }
}

/// Vertices in cubes, by the hash of the cube.
class Grid {
 public:
  Grid(std::span<const Index> vertices, const double* positions, double cell)
      : cell_(cell), start_(std::bit_ceil(vertices.size() + 1) + 1) {
    for (const Index v : vertices) ++start_[slot(cube(row(positions, v))) + 1];
    for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
    std::vector<Index> next(start_.begin(), start_.end() - 1);
    entries_.resize(vertices.size());
    for (const Index v : vertices) {
      const Cube place = cube(row(positions, v));
      entries_[next[slot(place)]++] = {v, place};
    }
  }

  /// visit(vertex) for those in the cubes that a box touches.
  template <class Visit>
  void for_each(const Box& box, Visit visit) const {
    const Cube low = cube(box.low), high = cube(box.high);
    for (std::int64_t z = low[2]; z <= high[2]; ++z)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t x = low[0]; x <= high[0]; ++x) {
          const Cube here{x, y, z};
          const std::size_t place = slot(here);
          for (Index i = start_[place]; i < start_[place + 1]; ++i)
            if (entries_[i].cube == here) visit(entries_[i].vertex);
        }
  }

 private:
  using Cube = std::array<std::int64_t, 3>;
  struct Entry {
    Index vertex;
    Cube cube;
  };
  Cube cube(const Vec3& p) const {
    Cube cube;
    for (std::size_t c = 0; c < 3; ++c)
      cube[c] = static_cast<std::int64_t>(std::floor(p[c] / cell_));
    return cube;
  }
  std::size_t slot(const Cube& cube) const {
    constexpr std::uint64_t primes[] = {73856093, 19349663, 83492791};
    std::uint64_t hash = 0;
    for (std::size_t c = 0; c < 3; ++c) hash ^= static_cast<std::uint64_t>(cube[c]) * primes[c];
    return hash & (start_.size() - 2);
  }

  double cell_;
  std::vector<Index> start_;
  std::vector<Entry> entries_;
};

/// The boxes around the pieces.
std::map<Index, Box> boxes_of(const BoundarySurface& surface, std::span<const Index> piece_of,
                              const double* positions) {
  std::map<Index, Box> boxes;
  for (const Index v : surface.vertices())
    include(boxes.try_emplace(piece_of[v], no_box).first->second, row(positions, v));
  return boxes;
}

/// The parts of a piece's surroundings in which other pieces are.
std::map<Index, std::vector<Box>> others_near(std::map<Index, Box> boxes, double reach) {
  std::map<Index, std::vector<Box>> others;
  for (auto& [piece, box] : boxes) enlarge(box, reach);
  for (const auto& [piece, box] : boxes)
    for (const auto& [other, around] : boxes)
      if (other != piece && overlap(box, around)) others[piece].push_back(around);
  return others;
}

}  // namespace

std::vector<NearPair> near_pairs(const BoundarySurface& surface, std::span<const Index> piece_of,
                                 const double* positions, double reach) {
  std::vector<NearPair> pairs;
  const auto others = others_near(boxes_of(surface, piece_of, positions), reach);
  std::vector<Index> vertices;
  const auto meets_others = [&](Index piece, const Box& box) {
    const auto found = others.find(piece);
    return found != others.end() &&
           std::ranges::any_of(found->second, [&](const Box& b) { return overlap(b, box); });
  };
  for (const Index v : surface.vertices()) {
    const Vec3 p = row(positions, v);
    if (meets_others(piece_of[v], {p, p})) vertices.push_back(v);
  }
  if (vertices.empty()) return pairs;
  const Grid grid(vertices, positions, 4 * reach);
  for (Index face = 0; face < surface.corners().size(); ++face) {
    Box box = no_box;
    for (const Index corner : surface.corners()[face]) include(box, row(positions, corner));
    enlarge(box, reach);
    const Index piece = piece_of[surface.corners()[face][0]];
    if (!meets_others(piece, box)) continue;
    grid.for_each(box, [&](Index v) {
      if (piece_of[v] != piece && contains(box, row(positions, v))) pairs.push_back({v, face});
    });
  }
  std::ranges::sort(pairs);
  return pairs;
}

}  // namespace suture
