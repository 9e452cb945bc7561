// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/cut_along.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/parts/cube_sides.hpp"
#include "kernel/parts/division.hpp"
#include "kernel/parts/embedding.hpp"
#include "kernel/parts/moments.hpp"
#include "kernel/parts/part_materials.hpp"
#include "kernel/parts/side_triangles.hpp"
#include "kernel/topology/disjoint_sets.hpp"
#include "suture/plugin.h"

// How the copies are found
// ========================
//
//   sides      Each element is below or above the blade, or crossed by it.
//   divide     The material of a crossed element falls into parts (parts/division.hpp).
//   joints     At each face that a divided element shares, the triangles of both sides are
//              compared: parts of the same side of the blade that overlap stay joined.
//   unite      Parts that touch the same part behind a face become one copy.
//   copies     The rest of the cloning follows, and the surface that would not be seen otherwise:
//              triangles on faces that stay joined, but not to what lies behind them.

namespace suture {
namespace {

constexpr double tolerance_in_edges = 0.02;

/// A connected part of a divided element, or all of one that is left whole.
struct Piece {
  Index element;
  int side;  ///< 0: both
  DividedPart part;
  std::optional<SideTriangles> own_triangles;  ///< none: of a full element

  const SideTriangles& triangles() const {
    return own_triangles ? *own_triangles : SideTriangles::of_full_element();
  }
};

/// Pieces that overlap at a face, and by how much.
struct Touch {
  std::size_t one, other;
  Dart dart, mate;  ///< of the sides at which they touch
  double area;
  bool one_is_covered, other_is_covered;  ///< there, by the other
  bool is_tied;                           ///< not joined before
  unsigned side() const;                  ///< of `one`, by place in cube_sides
  unsigned other_side() const;            ///< of `other`
};

unsigned place_of_side(Dart side) { return side_with_face(local_face(side)); }
unsigned Touch::side() const { return place_of_side(dart); }
unsigned Touch::other_side() const { return place_of_side(mate); }

class Cutter {
 public:
  Cutter(const CellComplex& complex, const Parts& parts, const double* rows, const Blade& blade,
         const std::string& path, std::size_t stride, std::span<const Tie> ties)
      : complex_(complex),
        materials_(parts),
        rows_(rows),
        blade_(blade),
        path_(path),
        stride_(stride),
        ties_(ties),
        heights_(blade.heights(complex, rows, stride)),
        side_(complex.element_count(), 0),
        pieces_of_(complex.element_count(), {none, none}) {
    result_.parts.first.push_back(0);
  }

  BladeCut find() {
    find_sides();
    pieces_.reserve(4 * crossed_.size());
    for (const Index e : crossed_) divide_element(e);
    find_touches();
    DisjointSets sets = unite();
    number_copies(sets);
    join_copies(sets);
    find_cut_faces();
    resolve_ties();
    result_.heights = std::move(heights_);
    return std::move(result_);
  }

 private:
  struct Range {
    Index first, last;  ///< of the pieces of an element
  };
  bool is_divided(Index element) const {
    return pieces_of_[element].last - pieces_of_[element].first > 1;
  }
  Vec3 row(Index vertex) const {
    const double* x = rows_ + stride_ * vertex;
    return {x[0], x[1], x[2]};
  }

  /// The tolerance is one for all, so that neighbours agree: that of the shortest edge at the
  /// blade.
  void find_sides() {
    std::vector<Index> near;
    double shortest = std::numeric_limits<double>::infinity();
    for (Index e = 0; e < complex_.element_count(); ++e) {
      if (!complex_.exists(3, e)) continue;
      const Hexahedron& nodes = complex_.vertices_of(e);
      if (std::isnan(heights_[nodes[0]])) continue;  // far away, as below
      double low = heights_[nodes[0]], high = low, sum = 0;
      for (const Index v : nodes) {
        low = std::min(low, heights_[v]);
        high = std::max(high, heights_[v]);
        sum += heights_[v];
      }
      if (std::isnan(sum)) continue;  // far away; it touches no divided one
      side_[e] = high > -low ? 1 : -1;
      // Corners on a plane along a grid are beside it by rounding.
      if (std::min(high, -low) < -tolerance_in_edges * (high - low)) continue;
      near.push_back(e);
      for (const auto& [a, b] : hexahedron::edge_vertices) {
        const Vec3 edge = minus(row(nodes[a]), row(nodes[b]));
        shortest = std::min(shortest, dot(edge, edge));
      }
    }
    tolerance_ = tolerance_in_edges * std::sqrt(shortest);
    for (const Index e : near) {
      bool above = false, below = false;
      for (const Index v : complex_.vertices_of(e)) {
        above = above || heights_[v] > tolerance_;
        below = below || heights_[v] < -tolerance_;
      }
      if (above && below) crossed_.push_back(e);
    }
    materials_.find_surface(crossed_, complex_.element_count());
  }

  double height_at(const Hexahedron& nodes, const Vec3& at) const {
    const std::array<double, 8> weights = trilinear_weights(at);
    double height = 0;
    for (std::size_t n = 0; n < 8; ++n)
      if (weights[n] != 0) height += weights[n] * heights_[nodes[n]];
    return height;
  }

  void divide_element(Index element) {
    const Hexahedron& nodes = complex_.vertices_of(element);
    Material own;
    const Material& material = materials_.of(element, own);
    std::vector<double>& heights = point_heights_;
    heights.clear();
    for (const Vec3& at : material.points) heights.push_back(height_at(nodes, at));
    side_[element] = static_cast<std::int8_t>(side_of(material, heights, tolerance_));
    if (side_[element] == 0 && blade_.has_divided(element, heights_)) {
      // Its section is linear in each tetrahedron, heights are not.
      const auto [low, high] = std::ranges::minmax(heights);
      side_[element] = high > -low ? 1 : -1;
    }
    if (side_[element] != 0) return;
    std::vector<DividedPart> found = divider_.divide(material, heights, tolerance_);
    if (found.size() < 2 || !is_held(nodes, found)) return;
    const auto first = static_cast<Index>(pieces_.size());
    for (DividedPart& part : found) {
      if (part.material.tetrahedra.size() > max_fragments)
        throw NumericalError(path_ + ": a part of an element would consist of " +
                             std::to_string(part.material.tetrahedra.size()) +
                             " tetrahedra; the limit is " + std::to_string(max_fragments) +
                             ". Cut less often there, or use smaller elements");
      add_piece(element, part.side, std::move(part));
    }
    pieces_of_[element] = {first, static_cast<Index>(pieces_.size())};
    divided_.push_back(element);
  }

  void add_piece(Index element, int side, DividedPart part) {
    Piece& piece = pieces_.emplace_back(Piece{element, side, std::move(part), {}});
    piece.own_triangles.emplace(piece.part.material);
  }

  /// Whether the blade holds the whole section.
  bool is_held(const Hexahedron& nodes, const std::vector<DividedPart>& found) const {
    if (blade_.is_endless()) return true;
    for (const DividedPart& part : found)
      for (const Vec3& at : part.material.points)
        if (std::abs(height_at(nodes, at)) <= tolerance_ &&
            !blade_.holds(place_in(nodes, at, rows_, stride_)))
          return false;
    return true;
  }

  /// The pieces of an element; one that is left whole becomes one when it is asked for.
  Range pieces_of(Index element) {
    Range& range = pieces_of_[element];
    if (range.first == none) {
      range.first = static_cast<Index>(pieces_.size());
      Piece& piece = pieces_.emplace_back(Piece{element, side_[element], {}, {}});
      Material own;
      if (materials_.is_part(element)) piece.own_triangles.emplace(materials_.of(element, own));
      range.last = range.first + 1;
    }
    return range;
  }

  void find_touches() {
    for (const Index e : divided_)
      for (const CubeSide& cube_side : cube_sides) {
        const Dart side = face_dart(e, cube_side.face()), mate = complex_.beta3(side);
        if (mate == none || (element_of(mate) < e && is_divided(element_of(mate)))) continue;
        find_touches_at(side, mate, false);
      }
    for (const Tie& tie : ties_)
      if (is_open(tie) && is_changed(tie)) find_touches_at(tie.side, tie.mate, true);
  }

  /// Whether a tie has neither been sewn nor lost an element.
  bool is_open(const Tie& tie) const {
    return complex_.exists(3, element_of(tie.side)) && complex_.exists(3, element_of(tie.mate)) &&
           complex_.beta3(tie.side) == none;
  }
  bool is_changed(const Tie& tie) const {
    return is_divided(element_of(tie.side)) || is_divided(element_of(tie.mate));
  }

  /// Sews tied elements that stay as they are if the blade has passed both on one side, and has
  /// separated the one that was joined.
  void resolve_ties() {
    for (const Tie& tie : ties_) {
      if (!is_open(tie) || is_changed(tie)) continue;
      const Index copy = element_of(tie.side), whole = element_of(tie.mate);
      const Dart now = complex_.beta3(tie.mate);
      const bool is_free = now == none || is_cut(tie.mate) || is_cut(now);
      if (is_free && side_[copy] * side_[whole] > 0)
        result_.seams.push_back({tie.side, tie.mate});
      else
        result_.ties.push_back(tie);
    }
  }
  bool is_cut(Dart side) const {
    return std::ranges::find(result_.cloning.cut, face_of(side)) != result_.cloning.cut.end();
  }

  void find_touches_at(Dart side, Dart mate, bool is_tied) {
    const Range here = pieces_of(element_of(side)), there = pieces_of(element_of(mate));
    const unsigned here_side = place_of_side(side), there_side = place_of_side(mate);
    for (std::size_t one = here.first; one < here.last; ++one)
      for (std::size_t other = there.first; other < there.last; ++other) {
        const Piece &a = pieces_[one], &b = pieces_[other];
        if (a.side * b.side < 0) continue;
        const auto mine = a.triangles()[here_side], theirs = b.triangles()[there_side];
        const Covered here_covered = covered(mine, theirs), there_covered = covered(theirs, mine);
        const double area = here_covered.area + there_covered.area;
        if (area > 0)
          touches_.push_back(
              {one, other, side, mate, area, here_covered.is_all, there_covered.is_all, is_tied});
      }
  }

  /// Unites pieces of one element and side that touch the same piece, or pieces that were united,
  /// at one of its sides.
  DisjointSets unite() {
    DisjointSets sets(pieces_.size());
    for (bool again = true; again;) {
      again = false;
      // The first piece met behind each side, below the blade, across it and above.
      std::vector<std::size_t> behind(pieces_.size() * 18, pieces_.size());
      const auto meet = [&](std::size_t one, std::size_t other, unsigned side) {
        const auto where = static_cast<unsigned>(pieces_[other].side + 1);
        std::size_t& first = behind[sets.find(one) * 18 + side * 3 + where];
        if (first == pieces_.size()) first = other;
        // Those behind a tied side may be copies that are elements of their own by now.
        if (sets.find(first) == sets.find(other) ||
            pieces_[first].element != pieces_[other].element)
          return;
        sets.unite(first, other);
        again = true;
      };
      for (const Touch& touch : touches_) {
        meet(touch.one, touch.other, touch.side());
        meet(touch.other, touch.one, touch.other_side());
      }
    }
    return sets;
  }

  void number_copies(DisjointSets& sets) {
    copy_of_.assign(pieces_.size(), none);
    reserve_copies();
    for (const Index e : divided_) {
      const Range range = pieces_of_[e];
      for (Index p = range.first; p < range.last; ++p) {
        const std::size_t first = sets.find(p);
        if (first == p) {
          copy_of_[p] =
              complex_.element_count() + static_cast<Index>(result_.cloning.origins.size());
          result_.cloning.origins.push_back(e);
        } else {
          copy_of_[p] = copy_of_[first];
        }
      }
      add_copies(range);
    }
    for (std::size_t p = 0; p < pieces_.size(); ++p)
      if (copy_of_[p] == none) copy_of_[p] = pieces_[p].element;
    result_.divided = static_cast<Index>(divided_.size());
  }

  void reserve_copies() {
    std::size_t points = 0, tetrahedra = 0, triangles = 0;
    for (const Piece& piece : pieces_) {
      points += piece.part.material.points.size();
      tetrahedra += piece.part.material.tetrahedra.size();
      triangles += piece.part.material.triangles.size();
    }
    Parts& parts = result_.parts;
    parts.points.reserve(points);
    parts.tetrahedra.reserve(tetrahedra);
    parts.triangles.reserve(triangles);
    parts.is_cut.reserve(triangles);
  }

  /// The parts of the copies of an element: each of all pieces that became one.
  void add_copies(Range range) {
    Parts& parts = result_.parts;
    for (Index p = range.first; p < range.last; ++p) {
      const Index copy = copy_of_[p];
      if (!parts.elements.empty() && parts.elements.back() >= copy) continue;
      parts.elements.push_back(copy);
      parts.moments.push_back(moments_of(copy, p, range.last));
      for (Index q = p; q < range.last; ++q)
        if (copy_of_[q] == copy) add_material(copy, pieces_[q].part.material);
      parts.first.push_back(static_cast<Index>(parts.tetrahedra.size()));
    }
  }

  /// Together, the pieces from `first` to before `last` that became a copy; the first is one of
  /// them.
  PartMoments moments_of(Index copy, Index first, Index last) const {
    if (std::count(&copy_of_[first], &copy_of_[first] + (last - first), copy) == 1)
      return pieces_[first].part.moments;
    MomentSum sum;
    for (Index p = first; p < last; ++p) {
      if (copy_of_[p] != copy) continue;
      const std::vector<Vec3>& x = pieces_[p].part.material.points;
      for (const auto& [a, b, c, d] : pieces_[p].part.material.tetrahedra)
        sum.add({x[a], x[b], x[c], x[d]});
    }
    return sum.moments();
  }

  void add_material(Index copy, const Material& material) {
    Parts& parts = result_.parts;
    const auto first = static_cast<Index>(parts.points.size());
    for (const Vec3& at : material.points) parts.points.push_back({copy, at});
    for (const auto& [a, b, c, d] : material.tetrahedra)
      parts.tetrahedra.push_back({first + a, first + b, first + c, first + d});
    for (const auto& [a, b, c] : material.triangles)
      parts.triangles.push_back({first + a, first + b, first + c});
    parts.is_cut.insert(parts.is_cut.end(), material.is_cut.begin(), material.is_cut.end());
  }

  /// Joins the copies that touch, each face once: the largest contact first.
  void join_copies(DisjointSets& sets) {
    std::ranges::stable_sort(touches_, std::ranges::greater{}, &Touch::area);
    std::vector<Index> joined(6 * pieces_.size(), none);  // behind the sides of sets of pieces
    for (const Touch& touch : touches_) {
      Index& behind = joined[6 * sets.find(touch.one) + touch.side()];
      Index& before = joined[6 * sets.find(touch.other) + touch.other_side()];
      const Index one = copy_of_[touch.one], other = copy_of_[touch.other];
      const Seam seam{24 * one + local(touch.dart), 24 * other + local(touch.mate)};
      const bool one_is_free = behind == none && !is_joined_elsewhere(touch, touch.dart),
                 other_is_free = before == none && !is_joined_elsewhere(touch, touch.mate);
      if (one_is_free && other_is_free) {
        behind = other;
        before = one;
        (touch.is_tied ? result_.seams : result_.cloning.seams).push_back(seam);
      } else if (one_is_free && !is_divided(pieces_[touch.other].element)) {
        result_.ties.push_back({seam.one, seam.other});
      } else if (other_is_free && !is_divided(pieces_[touch.one].element)) {
        result_.ties.push_back({seam.other, seam.one});
      }
    }
    std::vector<std::uint8_t> is_hidden(6 * pieces_.size());  // by what is joined there
    const auto hide = [&](std::size_t piece, unsigned side, std::size_t other) {
      if (is_divided(pieces_[piece].element) &&
          joined[6 * sets.find(piece) + side] == copy_of_[other])
        is_hidden[6 * piece + side] = 1;
    };
    for (const Touch& touch : touches_) {
      if (touch.one_is_covered) hide(touch.one, touch.side(), touch.other);
      if (touch.other_is_covered) hide(touch.other, touch.other_side(), touch.one);
    }
    for (std::size_t p = 0; p < pieces_.size(); ++p)
      for (unsigned s = 0; s < cube_sides.size(); ++s)
        if (const Index behind = joined[6 * sets.find(p) + s];
            behind != none && is_hidden[6 * p + s] == 0)
          show_uncovered(p, s, behind);
  }

  /// Whether a side of a tie is joined to another element, and neither is divided.
  bool is_joined_elsewhere(const Touch& touch, Dart side) const {
    const Dart mate = complex_.beta3(side);
    return touch.is_tied && mate != none && !is_divided(element_of(side)) &&
           !is_divided(element_of(mate));
  }

  /// Returns the origin of a copy, and other elements as they are.
  Index element_before(Index element) const {
    return element < complex_.element_count()
               ? element
               : result_.cloning.origins[element - complex_.element_count()];
  }

  /// Adds the triangles of a piece on a side that stays joined where nothing that is joined lies
  /// behind them, and, of a whole element, what copies have left that are not joined.
  void show_uncovered(std::size_t piece, unsigned side, Index behind) {
    const Index element = pieces_[piece].element;
    const Range others = pieces_of_[element_before(behind)];
    const auto is_behind = [&](const SideTriangle& triangle) {
      for (Index q = others.first; q < others.last; ++q)
        if (copy_of_[q] == behind && is_covered(triangle, pieces_[q].triangles()[side ^ 1]))
          return true;
      return false;
    };
    const auto own = pieces_[piece].triangles()[side];
    if (is_divided(element)) {
      for (const SideTriangle& triangle : own)
        if (!is_behind(triangle)) add_triangle(copy_of_[piece], triangle.places(cube_sides[side]));
      return;
    }
    for (Index q = others.first; q < others.last; ++q) {
      if (copy_of_[q] == behind) continue;
      for (const SideTriangle& triangle : pieces_[q].triangles()[side ^ 1]) {
        if (!is_covered(triangle, own)) continue;
        const auto [a, b, c] = triangle.places(cube_sides[side]);
        add_triangle(element, {a, c, b});
      }
    }
  }

  void add_triangle(Index element, const std::array<Vec3, 3>& corners) {
    Parts& parts = result_.parts;
    const auto first = static_cast<Index>(parts.points.size());
    for (const Vec3& at : corners) parts.points.push_back({element, at});
    parts.triangles.push_back({first, first + 1, first + 2});
    parts.is_cut.push_back(1);
  }

  /// Between elements on different sides that are not divided.
  void find_cut_faces() {
    for (Index e = 0; e < complex_.element_count(); ++e) {
      if (!complex_.exists(3, e) || side_[e] != 1 || is_divided(e)) continue;
      for (int f = 0; f < hexahedron::faces; ++f) {
        const Index n = complex_.neighbour(e, f);
        if (n == none || is_divided(n) || side_[n] != -1) continue;
        if (is_face_held(e, f)) result_.cloning.cut.push_back(face_dart(e, f));
      }
    }
  }
  bool is_face_held(Index element, int face) const {
    if (blade_.is_endless()) return true;
    Vec3 middle{};
    for (const auto n : suture_hexahedron_faces[face])
      middle = plus(middle, scaled(0.25, row(complex_.vertices_of(element)[n])));
    return blade_.holds(middle);
  }

  const CellComplex& complex_;
  PartMaterials materials_;
  const double* rows_;
  const Blade& blade_;
  const std::string& path_;
  std::size_t stride_;
  std::span<const Tie> ties_;
  std::vector<double> heights_;  ///< above the blade, by vertex, m; NaN: far from it
  double tolerance_ = 0;         ///< m
  std::vector<std::int8_t> side_;
  std::vector<Index> crossed_, divided_;
  Divider divider_;
  std::vector<double> point_heights_;  ///< of the element that is divided, by point
  std::vector<Range> pieces_of_;       ///< by element
  std::vector<Piece> pieces_;
  std::vector<Touch> touches_;
  std::vector<Index> copy_of_;  ///< by piece: the copy, or the element that is left whole
  BladeCut result_;
};

}  // namespace

BladeCut cut_along(const CellComplex& complex, const Parts& parts, const double* rows,
                   const Blade& blade, const std::string& path, std::size_t stride,
                   std::span<const Tie> ties) {
  return Cutter(complex, parts, rows, blade, path, stride, ties).find();
}

}  // namespace suture
