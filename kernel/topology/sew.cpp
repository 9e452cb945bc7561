// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "kernel/base/error.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/topology/cell_complex.hpp"
#include "kernel/topology/disjoint_sets.hpp"
#include "kernel/topology/incidence.hpp"

namespace suture {

using namespace incidence;

namespace {

std::string face_text(Dart d) {
  return "face " + std::to_string(d % 24 / 4) + " of element " + std::to_string(d / 24);
}

/// The pairs of cells that the seams glue, where they are not one already.
template <int Dimension>
std::vector<std::pair<Index, Index>> glued(const CellComplex& map, std::span<const Seam> seams) {
  std::vector<std::pair<Index, Index>> result;
  for (Seam seam : seams)
    for (int k = 0; k < 4; ++k) {
      const Dart facing = Dimension == 0 ? CellComplex::beta1(seam.other) : seam.other;
      const Index a = map.cell(Dimension, seam.one), b = map.cell(Dimension, facing);
      if (a != b) result.emplace_back(a, b);
      seam = {CellComplex::beta1(seam.one), CellComplex::beta0(seam.other)};
    }
  return result;
}

/// The face that is in two seams, as one of its darts, or `none`.
Dart repeated_face(std::span<const Seam> seams) {
  std::vector<Dart> sides;
  for (const Seam& seam : seams) sides.insert(sides.end(), {seam.one & ~3u, seam.other & ~3u});
  std::ranges::sort(sides);
  const auto twice = std::ranges::adjacent_find(sides);
  return twice == sides.end() ? none : *twice;
}

}  // namespace

/// What becomes of the cells of one dimension.
struct CellComplex::MergedCells {
  std::vector<Merge> merges;
  Stars stars;  ///< of the cells kept, afterwards
  Stars gone;   ///< of the others, before

  /// Why the result would be no map; empty if it is one.
  std::string fault(const CellComplex& map) const {
    for (std::size_t i = 0; i < stars.size(); ++i) {
      const auto element = [](Dart d) { return d / 24; };
      const auto twice = std::ranges::adjacent_find(stars[i], {}, element);
      if (twice == stars[i].end()) continue;
      return "element " + std::to_string(element(*twice)) +
             " would contain a vertex twice: " + std::to_string(map.origin(twice[0])) + " and " +
             std::to_string(map.origin(twice[1])) + " would be merged";
    }
    return {};
  }
};

/*        before                              after
 *
 *    v-------w     w'-------v'            v-------w-------v'
 *    |   e   F     G   g    |             |   e   F   g   |
 *    |        \   /         |             |       |       |
 *    |- - - - - u - - - - - |  sew F, G   |- - - -u- - - -|
 *    |   e'     |     g'    |  ------->   |   e'  |   g'  |
 *    +----------+-----------+             +-------+-------+
 *
 *   F and G on the boundary              beta3 joins F and G
 *
 * w' becomes w, the face G becomes F and the edges below w' those below w: the smallest
 * number stays. Glueing is transitive, so which cells become one is found for the
 * whole batch before anything is changed.
 */
TopologyChange CellComplex::sew(std::span<const Seam> seams) {
  for (const Seam& seam : seams)
    if (const std::string reason = why_no_seam(seam); !reason.empty()) throw TopologyError(reason);
  if (const Dart face = repeated_face(seams); face != none)
    throw TopologyError(face_text(face) +
                        " is in two seams of one batch; a face can be sewn to only one other");
  const MergedCells vertices = merged_cells<0>(seams);
  if (const std::string fault = vertices.fault(*this); !fault.empty())
    throw TopologyError("these faces cannot be sewn: " + fault);
  const MergedCells edges = has_edges() ? merged_cells<1>(seams) : MergedCells{};

  has_operated_ = true;
  TopologyChange change;
  change.faces_sewn = static_cast<Index>(seams.size());
  for (const auto& [one, other] : seams) {
    const Dart turn = one + other;  // beta3(d) = turn - d around the face
    links_[one / 4] = link_of(other / 24, (other % 24 & ~3u) | (turn & 3));
    links_[other / 4] = link_of(one / 24, (one % 24 & ~3u) | (turn & 3));
    change.elements.insert(change.elements.end(), {one / 24, other / 24});
  }
  merge_cells<0>(vertices, change);
  merge_cells<1>(edges, change);
  if (has_faces()) merge_faces(seams, change);
  sort_unique(change.elements);
  return change;
}

std::string CellComplex::why_not_sew(Dart one, Dart other) const {
  const Seam seam{one, other};
  std::string reason = why_no_seam(seam);
  if (!reason.empty()) return reason;
  reason = merged_cells<0>(std::span(&seam, 1)).fault(*this);
  if (reason.empty()) return {};
  return face_text(one) + " cannot be sewn to " + face_text(other) + ": " + reason;
}

/// What the two faces say before anybody asks about the cells around them.
std::string CellComplex::why_no_seam(Seam seam) const {
  for (const Dart d : {seam.one, seam.other}) {
    if (d / 24 >= element_count())
      return "dart " + std::to_string(d) + " does not exist: the map has " +
             std::to_string(element_count()) + " elements";
    if (!exists(3, d / 24)) return face_text(d) + " does not exist: its element was removed";
    if (beta3(d) != none)
      return face_text(d) + " is already joined to element " + std::to_string(beta3(d) / 24) +
             "; only boundary faces can be sewn";
  }
  if (seam.one / 24 == seam.other / 24)
    return face_text(seam.one) + " and face " + std::to_string(seam.other % 24 / 4) +
           " belong to the same element; only faces of different elements can be sewn";
  return {};
}

template <int Dimension>
CellComplex::MergedCells CellComplex::merged_cells(std::span<const Seam> seams) const {
  MergedCells merged;
  std::vector<Dart> star;
  for (const std::vector<Index>& group : groups_of_equal(glued<Dimension>(*this, seams))) {
    Stars& stars = merged.stars;
    for (const Index cell : group) {
      collect_star<Dimension>(first_dart_[Dimension][cell], star);
      if (cell != group[0]) {
        merged.merges.push_back({group[0], cell});
        merged.gone.append(cell, star);
      }
      stars.darts.insert(stars.darts.end(), star.begin(), star.end());
    }
    std::sort(stars.darts.begin() + stars.offsets.back(), stars.darts.end());
    stars.cells.push_back(group[0]);
    stars.offsets.push_back(static_cast<Index>(stars.darts.size()));
  }
  return merged;
}

template <int Dimension>
void CellComplex::merge_cells(const MergedCells& merged, TopologyChange& change) {
  auto* const label = rows<Dimension>();
  for (const Merge& merge : merged.merges) first_dart_[Dimension][merge.gone] = none;
  for (std::size_t i = 0; i < merged.stars.size(); ++i) {
    const Index kept = merged.stars.cells[i];
    first_dart_[Dimension][kept] = merged.stars[i][0];
    for (const Dart d : merged.stars[i]) {
      label[d / 24][local_of<Dimension>(static_cast<int>(d % 24))] = kept;
      change.elements.push_back(d / 24);
    }
  }
  holes_[Dimension] += static_cast<Index>(merged.merges.size());
  change.merges[Dimension] = merged.merges;
  change.gone[Dimension] = merged.gone;
  change.stars[Dimension] = merged.stars;
}

void CellComplex::merge_faces(std::span<const Seam> seams, TopologyChange& change) {
  std::vector<std::pair<Merge, Dart>> merged;  // with the dart of the face that goes
  for (const auto& [one, other] : seams) {
    const Index kept = std::min(face(one), face(other)), gone = std::max(face(one), face(other));
    merged.push_back({{kept, gone}, first_dart_[2][gone]});
    faces_[one / 24][one % 24 / 4] = faces_[other / 24][other % 24 / 4] = kept;
    first_dart_[2][gone] = none;
    first_dart_[2][kept] = std::min(one & ~3u, other & ~3u);
  }
  holes_[2] += static_cast<Index>(seams.size());
  std::ranges::sort(merged, {}, [](const auto& m) { return m.first.kept; });
  for (const auto& [merge, dart_of_gone] : merged) {
    change.merges[2].push_back(merge);
    change.gone[2].append(merge.gone, std::span(&dart_of_gone, 1));
    const Dart first = first_dart_[2][merge.kept];
    change.stars[2].append(merge.kept, std::array{first, beta3(first) & ~3u});
  }
}

}  // namespace suture
