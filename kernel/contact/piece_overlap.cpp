// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/piece_overlap.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <span>

#include "kernel/contact/overlap.hpp"
#include "kernel/contact/patch.hpp"

namespace suture {
namespace {

constexpr double ignored_depth = 1e-3;  // of a typical edge

bool is_within(const Box& inner, const Box& outer) {
  for (std::size_t c = 0; c < 3; ++c)
    if (inner.low[c] < outer.low[c] || inner.high[c] > outer.high[c]) return false;
  return true;
}

struct Piece {
  std::vector<Index> vertices;  ///< of its surface
  std::vector<BoundarySurface::Corners> faces;
  Box box = no_box;
  Index first_element = none;
};

class OverlapSearch {
 public:
  OverlapSearch(const Contact& contact, const CellComplex& complex, Attributes& attributes,
                double least)
      : contact_(contact),
        positions_(attributes.position().rows()),
        least_(least * contact.mean_edge()) {
    const std::vector<Index> islands = complex.islands();
    meeting_.piece_of.assign(attributes.vertex_count(), none);
    for (const Index v : contact.surface().vertices()) {
      const Index element = element_of(complex.dart_of(0, v));
      meeting_.piece_of[v] = islands[element];
      pieces_.resize(std::max<std::size_t>(pieces_.size(), islands[element] + 1));
      Piece& piece = pieces_[islands[element]];
      piece.vertices.push_back(v);
      include(piece.box, row(positions_, v));
    }
    for (const BoundarySurface::Corners& corners : contact.surface().corners())
      pieces_[meeting_.piece_of[corners[0]]].faces.push_back(corners);
    for (Index e = 0; e < islands.size(); ++e)
      if (complex.exists(3, e) && pieces_[islands[e]].first_element == none)
        pieces_[islands[e]].first_element = e;
  }

  std::vector<PieceOverlap> search() {
    find_crossing();
    find_nested();
    std::vector<PieceOverlap> overlaps;
    for (const auto& [a, b] : found_) {
      const PieceOverlap overlap = measure(a, b);
      if (overlap.depth > least_) overlaps.push_back(overlap);
    }
    return overlaps;
  }

 private:
  using Pair = std::pair<Index, Index>;
  static Pair ordered(Index a, Index b) { return std::minmax(a, b); }

  Patch patch(const BoundarySurface::Corners& corners) const {
    return {{row(positions_, corners[0]), row(positions_, corners[1]), row(positions_, corners[2]),
             row(positions_, corners[3])}};
  }

  /// Where surfaces cross that deeply, a vertex is behind the other one by at most an edge more.
  void find_crossing() {
    const double reach = contact_.longest_edge() + least_;
    const auto pairs = near_pairs(contact_.surface(), meeting_, positions_, reach);
    for (auto first = pairs.begin(); first != pairs.end();) {
      const auto last = std::find_if(first, pairs.end(),
                                     [&](const NearPair& p) { return p.vertex != first->vertex; });
      for (const NearPair& pair : std::span(first, last)) find_crossing(pair, {first, last});
      first = last;
    }
  }
  /// Where a vertex crosses a face; `all`: the pairs of the vertex.
  void find_crossing(const NearPair& pair, std::span<const NearPair> all) {
    const Index a = meeting_.piece_of[pair.vertex], b = piece_of(pair);
    if (found_.contains(ordered(a, b))) return;
    const Patch::Foot foot = foot_of(pair);
    const double gap = dot(foot.offset, foot.normal);
    const bool is_beside = norm(foot.offset) > 1.01 * std::abs(gap);
    if (gap > -least_ || is_beside) return;
    const bool is_shallow = std::ranges::any_of(all, [&](const NearPair& other) {
      return piece_of(other) == b && norm(foot_of(other).offset) <= least_;
    });
    if (!is_shallow && is_inside(pieces_[b].faces, positions_, row(positions_, pair.vertex)))
      found_.insert(ordered(a, b));
  }
  Index piece_of(const NearPair& pair) const {
    return meeting_.piece_of[contact_.surface().corners()[pair.face][0]];
  }
  Patch::Foot foot_of(const NearPair& pair) const {
    return patch(contact_.surface().corners()[pair.face]).foot(row(positions_, pair.vertex));
  }

  void find_nested() {
    for (Index a = 0; a < pieces_.size(); ++a)
      for (Index b = 0; b < pieces_.size(); ++b)
        if (a != b && is_within(pieces_[a].box, pieces_[b].box) &&
            is_inside(pieces_[b].faces, positions_, row(positions_, pieces_[a].vertices.front())))
          found_.insert(ordered(a, b));
  }

  PieceOverlap measure(Index a, Index b) const {
    PieceOverlap overlap{{pieces_[a].first_element, pieces_[b].first_element}};
    add_vertices(pieces_[a], pieces_[b], overlap);
    add_vertices(pieces_[b], pieces_[a], overlap);
    return overlap;
  }

  void add_vertices(const Piece& of, const Piece& inside, PieceOverlap& overlap) const {
    for (const Index v : of.vertices) {
      const Vec3 place = row(positions_, v);
      if (!is_within({place, place}, inside.box) || !is_inside(inside.faces, positions_, place))
        continue;
      double depth = std::numeric_limits<double>::infinity();
      for (const BoundarySurface::Corners& corners : inside.faces)
        depth = std::min(depth, norm(patch(corners).foot(place).offset));
      if (depth <= ignored_depth * contact_.mean_edge()) continue;
      ++overlap.vertices;
      if (depth <= overlap.depth) continue;
      overlap.depth = depth;
      overlap.place = place;
    }
  }

  const Contact& contact_;
  const double* positions_;
  double least_;  ///< depth, m
  Meeting meeting_;
  std::vector<Piece> pieces_;
  std::set<Pair> found_;
};

}  // namespace

std::vector<PieceOverlap> find_piece_overlaps(const Contact& contact, const CellComplex& complex,
                                              Attributes& attributes, double least) {
  return OverlapSearch(contact, complex, attributes, least).search();
}

}  // namespace suture
