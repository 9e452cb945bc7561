// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/near_pairs.hpp"

#include <algorithm>
#include <bit>

#include "kernel/base/box.hpp"
#include "kernel/contact/vectors.hpp"

namespace suture {
namespace {

bool contains(const Box& box, const Vec3& p) {
  return p[0] >= box.low[0] && p[0] <= box.high[0] && p[1] >= box.low[1] && p[1] <= box.high[1] &&
         p[2] >= box.low[2] && p[2] <= box.high[2];
}

Box box_around(const BoundarySurface::Corners& corners, const double* positions, double reach) {
  Box box = no_box;
  for (const Index corner : corners) include(box, row(positions, corner));
  for (std::size_t c = 0; c < 3; ++c) {
    box.low[c] -= reach;
    box.high[c] += reach;
  }
  return box;
}

/// Vertices in cubes, in the order of the hash of their cube: that of its row along x, plus its
/// place in the row. So the cubes of a box are a few stretches of entries, which are in memory one
/// after the other; entries of other cubes among them are found to be outside the box.
class Grid {
 public:
  struct Entry {
    Vec3 place;
    Index vertex, piece;
  };

  Grid(const BoundarySurface& surface, const Meeting& meeting, const double* positions, double cell,
       double reach)
      : per_cell_(1 / cell), start_(std::bit_ceil(surface.vertices().size() + 1) + 1) {
    const std::span<const Index> vertices = surface.vertices();
    Box box = no_box;
    for (const Index v : vertices) include(box, row(positions, v));
    for (std::size_t c = 0; c < 3; ++c) origin_[c] = box.low[c] - 2 * reach;
    std::vector<Index> slots(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      slots[i] = static_cast<Index>(slot(cube(row(positions, vertices[i]))));
      ++start_[slots[i] + 1];
    }
    for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
    std::vector<Index> next(start_.begin(), start_.end() - 1);
    entries_.resize(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const Index v = vertices[i];
      entries_[next[slots[i]]++] = {row(positions, v), v, meeting.piece_of[v]};
    }
  }

  /// visit(entry) for those in a box, some more than once.
  template <class Visit>
  void for_each(const Box& box, Visit visit) const {
    const Cube low = cube(box.low), high = cube(box.high);
    const std::uint64_t length = high[0] - low[0] + 1, slots = start_.size() - 1;
    const std::uint64_t rows = (high[1] - low[1] + 1) * (high[2] - low[2] + 1);
    if (length >= slots || rows > slots) return scan(box, 0, slots, visit);
    for (std::uint64_t z = low[2]; z <= high[2]; ++z)
      for (std::uint64_t y = low[1]; y <= high[1]; ++y) {
        const std::size_t first = slot({low[0], y, z}), last = first + length;
        scan(box, first, std::min(last, slots), visit);
        if (last > slots) scan(box, 0, last - slots, visit);
      }
  }

 private:
  using Cube = std::array<std::uint64_t, 3>;

  template <class Visit>
  void scan(const Box& box, std::size_t first, std::size_t last, Visit visit) const {
    for (Index i = start_[first]; i < start_[last]; ++i)
      if (contains(box, entries_[i].place)) visit(entries_[i]);
  }
  /// A place that is not finite, too, has a cube; the step finds it out and says so.
  Cube cube(const Vec3& p) const {
    constexpr double most = 1 << 30;
    Cube cube;
    for (std::size_t c = 0; c < 3; ++c) {
      const double at = (p[c] - origin_[c]) * per_cell_;
      cube[c] = at > 0 ? static_cast<std::uint64_t>(at < most ? at : most) : 0;
    }
    return cube;
  }
  std::size_t slot(const Cube& cube) const {
    const std::uint64_t row = cube[1] * 0x9E3779B97F4A7C15u + cube[2] * 0xC2B2AE3D27D4EB4Fu;
    return ((row >> 32) + cube[0]) & (start_.size() - 2);
  }

  double per_cell_;
  Vec3 origin_{};
  std::vector<Index> start_;  ///< by slot, of which there are a power of two
  std::vector<Entry> entries_;
};

/// By counting: pairs are in the order of faces.
std::vector<NearPair> sorted_once(std::span<const NearPair> pairs, std::size_t vertices) {
  std::vector<Index> next(vertices + 1, 0);
  for (const NearPair& pair : pairs) ++next[pair.vertex + 1];
  for (std::size_t v = 0; v < vertices; ++v) next[v + 1] += next[v];
  std::vector<NearPair> sorted(pairs.size());
  for (const NearPair& pair : pairs) sorted[next[pair.vertex]++] = pair;
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  return sorted;
}

}  // namespace

std::vector<NearPair> near_pairs(const BoundarySurface& surface, const Meeting& meeting,
                                 const double* positions, double reach) {
  const Grid grid(surface, meeting, positions, 3 * reach, reach);
  std::vector<NearPair> pairs;
  for (Index face = 0; face < surface.corners().size(); ++face) {
    const BoundarySurface::Corners& corners = surface.corners()[face];
    const Index piece = meeting.piece_of[corners[0]];
    const bool meets_own = !meeting.face_meets_own.empty() && meeting.face_meets_own[face];
    grid.for_each(box_around(corners, positions, reach), [&](const Grid::Entry& entry) {
      if (entry.piece == piece && !(meets_own && meeting.vertex_meets_own[entry.vertex] &&
                                    std::ranges::find(corners, entry.vertex) == corners.end()))
        return;
      pairs.push_back({entry.vertex, face});
    });
  }
  return sorted_once(pairs, meeting.piece_of.size());
}

}  // namespace suture
