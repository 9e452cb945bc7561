// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "kernel/base/bulk.hpp"
#include "kernel/base/types.hpp"
#include "kernel/topology/dart.hpp"
#include "kernel/topology/face_matching.hpp"
#include "kernel/topology/hexahedron_tables.hpp"
#include "kernel/topology/incidence.hpp"

namespace suture {

class Archive;

namespace incidence {
struct HalfStars;
}

/// One cell became two: `new_cell` is the number of a component that separated from `old_cell`. New
/// numbers are consecutive, starting at the previous count.
struct Split {
  Index old_cell;
  Index new_cell;
};

/// The incident elements of some cells, in compressed rows: cell i has the darts darts[offsets[i]]
/// .. darts[offsets[i+1]-1], one per incident element, ascending (dimension 0: origin at the
/// vertex; 1: on the edge; 2: on the face). Each is the lowest such dart of its element.
struct Stars {
  BulkVector<Index> cells;
  BulkVector<Index> offsets{0};
  BulkVector<Dart> darts;

  std::size_t size() const { return cells.size(); }
  /// Appends a cell with `size` darts; the caller writes them to the returned address.
  Dart* append(Index cell, std::size_t size) {
    const std::size_t end = darts.size();
    cells.push_back(cell);
    offsets.push_back(static_cast<Index>(end + size));
    darts.resize(end + size);
    return darts.data() + end;
  }
  void append(Index cell, std::span<const Dart> star) {
    std::ranges::copy(star, append(cell, star.size()));
  }
  std::span<const Dart> operator[](std::size_t i) const {
    return std::span(darts).subspan(offsets[i], offsets[i + 1] - offsets[i]);
  }
};

/// Two cells became one: `gone` no longer exists and its number is not reused.
struct Merge {
  Index kept;
  Index gone;
};

/// Two darts that sew() links by beta3; the other darts of their faces follow edge by edge.
struct Seam {
  Dart one, other;
};

/// Copies of elements that take their places. Copy i, a copy of element origins[i], has the number
/// element_count() + i.
struct Cloning {
  std::vector<Index> origins;  ///< ascending; an element with n parts n times
  /// One dart of each face between copies, or between a copy and another element, in the new
  /// numbers: those that are still joined. The faces of their origins must be joined now.
  std::vector<Seam> seams;
  std::vector<Dart> cut;  ///< faces between elements that are not copied, as for cut()
  /// Other elements that go, ascending, and the copies that take their material.
  std::vector<Split> absorbed{};
};

/// What an operation changed in the cells. Attributes are updated from this alone.
struct TopologyChange {
  std::array<BulkVector<Split>, 3> splits;  ///< dimensions 0, 1, 2
  /// When several cells become one, the smallest number is kept: `kept` is never `gone` in another
  /// merge, and every `gone` appears once. Sorted by `kept`, then `gone`.
  std::array<std::vector<Merge>, 3> merges;
  /// The former stars of the `gone` cells, in the order of merges.
  std::array<Stars, 3> gone;
  /// Cells whose last element was removed, ascending; in dimension 3, the removed elements.
  std::array<std::vector<Index>, 4> removed;
  /// New elements, ascending: `old_cell` is the removed element of which each is a copy.
  std::vector<Split> copies;
  /// Removed elements, ascending, and the copies that have taken their material (Cloning).
  std::vector<Split> absorbed;
  /// Cells that lost or gained elements and still exist, per dimension, in their state after the
  /// operation: each old cell is followed by the new ones that separated from it.
  std::array<Stars, 3> stars;
  /// Elements incident to any of those stars, ascending.
  std::vector<Index> elements;
  /// Faces that two elements no longer share; after pierce(), those between a removed element and a
  /// remaining one (faces between removed elements are removed); after clone_volume(), those
  /// listed.
  Index faces_cut = 0;
  Index faces_sewn = 0;
  bool empty() const { return faces_cut == 0 && faces_sewn == 0 && removed[3].empty(); }
  /// The removed elements whose material is in copies, ascending, and these.
  std::vector<Split> successors() const;
};

/// The vertices, edges and faces that are new after a cut of `faces` faces, nearly all of which are
/// in a surface that divides the body or forms a part of one.
inline std::array<Index, 3> cells_of_cut(Index faces) {
  const auto rim = static_cast<Index>(4 * std::sqrt(double(faces))) + 8;
  return {faces + rim, 2 * faces + rim, faces};
}

/// The combinatorial 3-map of a set of hexahedra. Darts, numbered 24 e + 4 f + k, are not stored:
/// beta0..beta2 are tables, and beta3 is one word per face.
///
/// Cells are orbits of the map: elements that meet only along an edge or at a
/// vertex, without a chain of elements through common faces around it, do not
/// share that cell.
///
/// Memory per hexahedron: 24 B beta3, 32 B vertex ids, 48 B edge ids, 24 B face ids, half a byte of
/// marks; per vertex, edge and face one dart (4 B). A large grid (1 vertex, 3 edges and 3 faces per
/// element) takes 156 B per hexahedron, or 60 B without edges and faces.
class CellComplex {
 public:
  CellComplex() = default;
  /// Builds the map from conforming connectivity (import.hpp repairs and renumbers first). A
  /// non-manifold vertex, whose elements form several components around it, is split: the component
  /// of the smallest element keeps the number, the others get new ones from `vertex_count` on,
  /// which are appended to `splits` if it is given. Throws TopologyError naming the elements
  /// and the reason.
  CellComplex(std::vector<Hexahedron> hexahedra, Index vertex_count,
              std::vector<Split>* splits = nullptr, const Naming& naming = {});

  /// The number of elements so far, including removed ones (see exists()).
  Index element_count() const { return static_cast<Index>(vertices_.size()); }
  /// The number of cells so far, including removed ones (see exists()): 0 vertices, 1 edges, 2
  /// faces, 3 elements. Edges and faces are counted once they have been required.
  Index count(int dimension) const {
    return dimension == 3 ? element_count() : static_cast<Index>(first_dart_[dimension].size());
  }

  /// Builds the ids of edges and faces, in the order of their smallest darts (idempotent).
  void require_edges();
  void require_faces();
  bool has_edges() const { return !edges_.empty() || element_count() == 0; }
  bool has_faces() const { return !faces_.empty() || element_count() == 0; }

  /// X0..X7 of element e; order of suture_hexahedron_edges / _faces.
  const Hexahedron& vertices_of(Index e) const { return vertices_[e]; }
  const std::array<Index, 12>& edges_of(Index e) const { return edges_[e]; }
  const std::array<Index, 6>& faces_of(Index e) const { return faces_[e]; }
  std::span<const Hexahedron> vertices() const { return vertices_; }
  std::span<const std::array<Index, 12>> edges() const { return edges_; }
  std::span<const std::array<Index, 6>> faces() const { return faces_; }

  /// The paper's dart[6][4] of element e.
  static std::array<std::array<Dart, 4>, 6> darts(Index e);
  static constexpr Dart beta0(Dart d) { return (d & ~3u) | ((d + 3) & 3u); }
  static constexpr Dart beta1(Dart d) { return (d & ~3u) | ((d + 1) & 3u); }
  static constexpr Dart beta2(Dart d) { return d - d % 24 + hexahedron::beta2[d % 24]; }
  /// `none` on the boundary. O(1).
  Dart beta3(Dart d) const {
    const incidence::Link first = links_[d / 4];
    return first == none ? none : (incidence::dart_of(first) & ~3u) | ((first - d) & 3u);
  }
  /// Element on the other side of face f of element e, or `none`.
  Index neighbour(Index e, int f) const {
    const incidence::Link first = links_[6 * e + f];
    return first == none ? none : first >> 5;
  }

  /// Vertex where the dart starts.
  Index origin(Dart d) const { return vertices_[d / 24][hexahedron::dart_vertex[d % 24]]; }
  /// Edge id; needs require_edges().
  Index edge(Dart d) const { return edges_[d / 24][hexahedron::dart_edge[d % 24]]; }
  /// Face id; needs require_faces().
  Index face(Dart d) const { return faces_[d / 24][d % 24 / 4]; }
  /// The id of the cell of the given dimension (0..3) that contains the dart.
  Index cell(int dimension, Dart d) const;
  /// False for the number of a cell that was removed or merged into another; such numbers are not
  /// reused.
  bool exists(int dimension, Index id) const {
    return dimension == 3 ? vertices_[id][0] != none : first_dart_[dimension][id] != none;
  }
  /// The number of existing cells: count() minus the holes.
  Index existing(int dimension) const { return count(dimension) - holes_[dimension]; }
  /// The smallest dart of cell `id` (starting at the vertex, on the edge, ...). O(1).
  Dart dart_of(int dimension, Index id) const {
    return dimension == 3 ? 24 * id : first_dart_[dimension][id];
  }
  /// The elements around a cell: one dart per element, ascending, as in Stars. O(valence); O(n log
  /// n) for valences above 64.
  void star(int dimension, Index id, std::vector<Dart>& out) const;

  /// 3-unsews all given faces (any dart of each; both sides and repetitions allowed) in one batch.
  /// Throws TopologyError if !can_cut() for one of them; the map is then unchanged. The component
  /// of the smallest element keeps the old id. New ids do not depend on the order of `faces`: they
  /// are assigned by cut face (smallest dart first), within a face by dart, and around a cell by
  /// smallest element. O(faces cut), independent of the size of the map.
  TopologyChange cut(std::span<const Dart> faces);
  /// Makes room for what cuts of `faces` faces add, the largest of them of `largest`, in memory
  /// whose pages have been touched: the system's time for fresh pages is most of that of a large
  /// cut. O(faces).
  void make_room(Index faces, Index largest);
  /// True if the dart exists and its face separates two elements.
  bool can_cut(Dart face) const { return face / 24 < element_count() && beta3(face) != none; }

  /// Removes elements in one batch; repetitions are allowed. Throws TopologyError if one does not
  /// exist or none would be left; the map is then unchanged. Cells whose last element is removed
  /// are removed with it. Where the remaining elements around a vertex or an edge are no longer
  /// connected, it splits, as in a cut. A face shared with a remaining element becomes a boundary
  /// face. The vertex, edge and face ids of a removed element are `none`. The order of `elements`
  /// does not matter. O(removed elements and their neighbours), independent of the size of the map.
  TopologyChange pierce(std::span<const Index> elements);
  /// True if the element exists and is not the last one.
  bool can_pierce(Index element) const {
    return element < element_count() && exists(3, element) && existing(3) > 1;
  }

  /// Replaces elements by copies in one batch: each copy has the cells of its origin, as far as
  /// they are still connected. Cells split as in a cut; those of absorbed elements only are removed
  /// with them. Throws TopologyError if an element does not exist, if there would be too many, or
  /// if a seam joins what was not joined; the map is then unchanged. O(copies and the elements
  /// around them).
  TopologyChange clone_volume(const Cloning& cloning);

  /// 3-sews faces in one batch. Each face must be on the boundary, belong to a different element
  /// from its mate, and occur in no other seam, and no element may end up with the same vertex
  /// twice; otherwise throws TopologyError with the first reason found, and the map is unchanged.
  /// When cells become one, the smallest number is kept. The order of the seams and of their sides
  /// does not matter. The positions of the vertices are not considered. O(faces sewn and the
  /// elements around them).
  TopologyChange sew(std::span<const Seam> seams);
  /// True if sew() accepts this seam on its own.
  bool can_sew(Dart one, Dart other) const { return why_not_sew(one, other).empty(); }
  /// The reason why the seam is impossible, as a sentence for the user; empty if it is possible.
  std::string why_not_sew(Dart one, Dart other) const;

  /// Whether an operation was made: before the first one, the vertices alone determine the map.
  bool has_operated() const { return has_operated_; }

  /// The connected component of each element: ids 0, 1, ... in the order of their smallest
  /// elements; `none` for removed elements.
  std::vector<Index> islands(Index* count = nullptr) const;

  /// Bytes of the map and its ids, excluding the memory reserved for later cuts.
  std::size_t memory() const;

  /// Checks every law of the map and of the ids; throws TopologyError naming
  /// the broken law and dart. O(elements).
  void validate() const;

  /// Must be loaded into the map of the same mesh before any operation. Before the first operation,
  /// only the information which ids were built is saved.
  void state(Archive& archive);

 private:
  friend struct CellComplexAccess;  // lets tests corrupt a map

  void load_built(bool edges, bool faces);
  void arrays(Archive& archive, std::size_t elements);

  template <int Dimension>
  void collect_star(Dart start, std::vector<Dart>& out) const;
  void split_non_manifold_vertices(Index vertex_count, std::vector<Split>* splits);
  bool number_edge(Index e, incidence::Exit way, Index id);

  /// The vertex (dimension 0), edge (1) or face (2) ids, a row per element.
  template <int Dimension>
  auto* rows() {
    if constexpr (Dimension == 0) return vertices_.data();
    if constexpr (Dimension == 1) return edges_.data();
    if constexpr (Dimension == 2) return faces_.data();
  }

  // cut.cpp
  struct StarFlood;
  struct StarWork;
  BulkVector<incidence::Link> mark_leaving(std::span<const Dart> faces);
  /// Whether an operation removes links only, or elements too.
  enum class Loss { links, elements };
  template <Loss What>
  void split_cells(std::span<const incidence::Link> cut_faces, TopologyChange& change);
  template <int Dimension, Loss What>
  void split_cell(incidence::Link dart, StarWork& work, TopologyChange& change);
  template <int Dimension>
  void split_in_halves(Index cell, incidence::HalfStars& halves, TopologyChange& change);
  template <int Dimension>
  void flood_star(incidence::LocalCell start, Index cell, StarFlood& flood);
  template <int Dimension>
  void name_components(Index cell, const StarFlood& flood, TopologyChange& change);
  void split_faces(std::span<const incidence::Link> cut_faces, TopologyChange& change);
  static void add_elements(std::span<const incidence::Link> cut_faces,
                           std::vector<Index>& elements);

  // pierce.cpp
  bool is_removed(Index e) const { return removed_marks_[e / 64] >> e % 64 & 1; }
  std::vector<Index> mark_removed(std::span<const Index> elements);
  std::vector<incidence::Link> mark_rim(std::span<const Index> removed);
  void free_rim(std::span<const incidence::Link> rim, TopologyChange& change);
  template <int Dimension>
  bool lose_elements(Index cell, incidence::HalfStars& halves, TopologyChange& change);
  template <int Dimension>
  void remove_cells(std::span<const Index> elements, TopologyChange& change);

  // clone.cpp
  struct ClonedStars;
  std::string why_no_cloning(const Cloning& cloning) const;
  void append_copies(std::span<const Index> origins);
  void relink(const Cloning& cloning);
  template <int Dimension>
  ClonedStars stars_of_clones(const Cloning& cloning) const;
  template <int Dimension>
  void split_clones(const ClonedStars& stars, Index first_copy, TopologyChange& change);
  void remove_origins(const Cloning& cloning, TopologyChange& change);

  // sew.cpp
  struct MergedCells;
  std::string why_no_seam(Seam seam) const;
  template <int Dimension>
  MergedCells merged_cells(std::span<const Seam> seams) const;
  template <int Dimension>
  void merge_cells(const MergedCells& merged, TopologyChange& change);
  void merge_faces(std::span<const Seam> seams, TopologyChange& change);

  std::vector<Hexahedron> vertices_;
  std::vector<std::array<Index, 12>> edges_;
  std::vector<std::array<Index, 6>> faces_;
  std::vector<incidence::Link> links_;  ///< 6 e + f: beta3 of the face's first dart, or none
  bool has_operated_ = false;
  Index copies_ = 0;  ///< made so far; they follow the elements of the mesh
  std::array<std::vector<Dart>, 3> first_dart_;
  // One bit per vertex, edge and element; 0 between operations.
  std::array<std::vector<std::uint64_t>, 2> cell_marks_;
  std::vector<std::uint64_t> element_marks_;
  // One bit per element, set if it was removed; empty as long as none was. The number of holes per
  // dimension.
  std::vector<std::uint64_t> removed_marks_;
  std::array<Index, 4> holes_{};
};

}  // namespace suture
