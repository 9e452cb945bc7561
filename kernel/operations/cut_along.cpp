// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/cut_along.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "kernel/base/sort_unique.hpp"
#include "kernel/operations/blade_pieces.hpp"
#include "kernel/parts/cube_sides.hpp"
#include "kernel/parts/moments.hpp"
#include "kernel/parts/part_writer.hpp"
#include "kernel/topology/disjoint_sets.hpp"

// How the copies are found
// ========================
//
//   divide     Each element is below or above the blade, or crossed by it; then its material falls
//              into pieces (blade_pieces.hpp).
//   joints     At each face that a divided element shares, the triangles of both sides are
//              compared: parts of the same side of the blade that overlap stay joined.
//   unite      Parts that touch the same part behind a face become one copy.
//   copies     The rest of the cloning follows, and the surface that would not be seen otherwise:
//              triangles on faces that stay joined, but not to what lies behind them.

namespace suture {
namespace {

/// Pieces that overlap at a face, and by how much.
struct Touch {
  Index one, other;
  Dart dart, mate;  ///< of the sides at which they touch
  double area;
  bool one_is_covered, other_is_covered;  ///< there, by the other
  bool is_tied;                           ///< not joined before
  unsigned side() const;                  ///< of `one`, by place in cube_sides
  unsigned other_side() const;            ///< of `other`
};

unsigned Touch::side() const { return cube_side_of(dart); }
unsigned Touch::other_side() const { return cube_side_of(mate); }

class Cutter {
 public:
  Cutter(const CellComplex& complex, const Parts& parts, const double* rows, const Blade& blade,
         std::size_t stride, std::span<const Tie> ties)
      : complex_(complex),
        ties_(ties),
        pieces_(complex, parts, rows, blade, stride),
        writer_(result_.parts) {}

  BladeCut find() {
    find_touches();
    DisjointSets sets = unite();
    number_copies(sets);
    join_copies(sets);
    find_cut_faces();
    resolve_ties();
    result_.area = pieces_.area();
    result_.heights = pieces_.take_heights();
    result_.refined = pieces_.take_refined();
    return std::move(result_);
  }

 private:
  using Range = BladePieces::Range;

  bool is_divided(Index element) const { return pieces_.is_divided(element); }

  void find_touches() {
    for (const Index e : pieces_.divided())
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
      if (is_free && pieces_.side(copy) * pieces_.side(whole) > 0 && fit(tie))
        result_.seams.push_back({tie.side, tie.mate});
      else
        result_.ties.push_back(tie);
    }
  }
  bool fit(const Tie& tie) {
    const Index one = pieces_.of(element_of(tie.side)).first,
                other = pieces_.of(element_of(tie.mate)).first;
    const auto mine = pieces_[one].triangles()[cube_side_of(tie.side)],
               theirs = pieces_[other].triangles()[cube_side_of(tie.mate)];
    return fit(covered(mine, theirs), covered(theirs, mine));
  }
  /// Whether what two sides cover of each other is the same. Where a blade has crossed its own
  /// slit, it may not be: their triangles differ, and joined they would leave a hole in the
  /// surface.
  static bool fit(const Covered& here, const Covered& there) {
    return here.area > 0 && std::abs(here.area - there.area) < 1e-9;
  }
  bool is_cut(Dart side) const {
    return std::ranges::find(result_.cloning.cut, face_of(side)) != result_.cloning.cut.end();
  }

  void find_touches_at(Dart side, Dart mate, bool is_tied) {
    const Range here = pieces_.of(element_of(side)), there = pieces_.of(element_of(mate));
    const unsigned here_side = cube_side_of(side), there_side = cube_side_of(mate);
    for (Index one = here.first; one < here.last; ++one)
      for (Index other = there.first; other < there.last; ++other) {
        const BladePiece &a = pieces_[one], &b = pieces_[other];
        if (a.side * b.side < 0) continue;
        const auto mine = a.triangles()[here_side], theirs = b.triangles()[there_side];
        const Covered here_covered = covered(mine, theirs), there_covered = covered(theirs, mine);
        if (fit(here_covered, there_covered))
          touches_.push_back({one, other, side, mate, here_covered.area, here_covered.is_all,
                              there_covered.is_all, is_tied});
      }
  }

  /// Unites pieces of one element and side that touch the same piece, or pieces that were united,
  /// at one of its sides.
  DisjointSets unite() {
    DisjointSets sets(pieces_.size());
    for (bool again = true; again;) {
      again = false;
      // The first piece met behind each side, below the blade, across it and above.
      std::vector<Index> behind(pieces_.size() * 18, none);
      const auto meet = [&](Index one, Index other, unsigned side) {
        const auto where = static_cast<unsigned>(pieces_[other].side + 1);
        Index& first = behind[sets.find(one) * 18 + side * 3 + where];
        if (first == none) first = other;
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
    for (const Index e : pieces_.divided()) {
      const Range range = pieces_.of(e);
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
    result_.divided = static_cast<Index>(pieces_.divided().size());
  }

  void reserve_copies() {
    std::size_t points = 0, tetrahedra = 0, triangles = 0;
    for (const BladePiece& piece : pieces_.all()) {
      points += piece.part.material.points.size();
      tetrahedra += piece.part.material.tetrahedra.size();
      triangles += piece.part.material.triangles.size();
    }
    writer_.reserve(points, tetrahedra, triangles);
  }

  /// The parts of the copies of an element: each of all pieces that became one.
  void add_copies(Range range) {
    for (Index p = range.first; p < range.last; ++p) {
      const Index copy = copy_of_[p];
      const std::vector<Index>& before = result_.parts.elements;
      if (!before.empty() && before.back() >= copy) continue;
      for (Index q = p; q < range.last; ++q)
        if (copy_of_[q] == copy) add_material(copy, pieces_[q].part.material);
      writer_.end_copy(copy, moments_of(copy, p, range.last));
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
    const Index first = writer_.add_volume(copy, material);
    for (std::size_t t = 0; t < material.triangles.size(); ++t)
      writer_.add_triangle(first, material.triangles[t], material.is_cut[t] != 0);
  }

  /// Joins the copies that touch, each face once: the largest contact first.
  void join_copies(DisjointSets& sets) {
    std::vector<Index> joined(6 * pieces_.size(), none);  // behind the sides of sets of pieces
    for (const auto& [area, number] : by_area()) {
      const Touch& touch = touches_[number];
      Index& behind = joined[6 * sets.find(touch.one) + touch.side()];
      Index& before = joined[6 * sets.find(touch.other) + touch.other_side()];
      const Index one = copy_of_[touch.one], other = copy_of_[touch.other];
      const Seam seam{corresponding_dart(one, touch.dart), corresponding_dart(other, touch.mate)};
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

  /// The negative areas of touches and their numbers, the largest first.
  std::vector<std::pair<double, Index>> by_area() const {
    std::vector<std::pair<double, Index>> order;
    order.reserve(touches_.size());
    for (const Touch& touch : touches_)
      order.emplace_back(-touch.area, static_cast<Index>(order.size()));
    std::ranges::sort(order);
    return order;
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
    const Range others = pieces_.of(element_before(behind));
    const auto is_behind = [&](const SideTriangle& triangle) {
      for (Index q = others.first; q < others.last; ++q)
        if (copy_of_[q] == behind && is_covered(triangle, pieces_[q].triangles()[side ^ 1]))
          return true;
      return false;
    };
    const auto own = pieces_[piece].triangles()[side];
    if (is_divided(element)) {
      for (const SideTriangle& triangle : own)
        if (!is_behind(triangle))
          writer_.add_open_triangle(copy_of_[piece], triangle.places(cube_sides[side]));
      return;
    }
    for (Index q = others.first; q < others.last; ++q) {
      if (copy_of_[q] == behind) continue;
      for (const SideTriangle& triangle : pieces_[q].triangles()[side ^ 1]) {
        if (!is_covered(triangle, own)) continue;
        const auto [a, b, c] = triangle.places(cube_sides[side]);
        writer_.add_open_triangle(element, {a, c, b});
      }
    }
  }

  /// Between elements on different sides that are not divided, from the one above. At least one of
  /// them is near the blade, or all of their common nodes would be on both sides.
  void find_cut_faces() {
    std::vector<Dart>& cut = result_.cloning.cut;
    for (const Index e : pieces_.near()) {
      if (pieces_.side(e) == 0 || is_divided(e)) continue;
      for (int f = 0; f < hexahedron::faces; ++f) {
        const Dart side = face_dart(e, f), mate = complex_.beta3(side);
        if (mate == none || is_divided(element_of(mate))) continue;
        if (pieces_.side(e) * pieces_.side(element_of(mate)) == -1)
          cut.push_back(pieces_.side(e) == 1 ? side : face_of(mate));
      }
    }
    sort_unique(cut);
    std::erase_if(cut, [&](Dart side) {
      return !pieces_.opens_face(element_of(side), static_cast<int>(local_face(side)));
    });
  }
  const CellComplex& complex_;
  std::span<const Tie> ties_;
  BladePieces pieces_;
  std::vector<Touch> touches_;
  std::vector<Index> copy_of_;  ///< by piece: the copy, or the element that is left whole
  BladeCut result_;
  PartWriter writer_;  ///< of the result
};

}  // namespace

BladeCut cut_along(const CellComplex& complex, const Parts& parts, const double* rows,
                   const Blade& blade, std::size_t stride, std::span<const Tie> ties) {
  return Cutter(complex, parts, rows, blade, stride, ties).find();
}

}  // namespace suture
