// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "kernel/operations/blade.hpp"
#include "kernel/parts/part_materials.hpp"
#include "kernel/parts/part_writer.hpp"
#include "kernel/parts/side_triangles.hpp"

namespace suture {

/// A connected part of a divided element, or all of one that is left whole.
struct BladePiece {
  Index element;
  int side;  ///< of the blade, 1 above it; 0: both
  DividedPart part;
  std::optional<SideTriangles> own_triangles;  ///< none: of a full element

  const SideTriangles& triangles() const {
    return own_triangles ? *own_triangles : SideTriangles::of_full_element();
  }
};

/// Into what a blade divides the elements of a body (cut_along.hpp). Pieces have numbers; those of
/// an element follow each other.
class BladePieces {
 public:
  struct Range {
    Index first, last;
  };

  /// Finds the sides of the elements, and divides those that the blade crosses. All must outlive
  /// this.
  BladePieces(const CellComplex& complex, const Parts& parts, const double* rows,
              const Blade& blade, std::size_t stride);

  /// Elements with nodes on both sides of the blade, or nearer to it than a fiftieth of the
  /// element.
  const std::vector<Index>& near() const { return near_; }
  const std::vector<Index>& divided() const { return divided_; }  ///< elements, ascending
  bool is_divided(Index element) const {
    return pieces_of_[element].last - pieces_of_[element].first > 1;
  }
  /// Where an element that is not divided is: 1 above the blade, -1 below, 0 far from it.
  int side(Index element) const { return side_[element]; }
  /// The pieces of an element; one that is left whole becomes one when it is asked for.
  Range of(Index element);
  std::size_t size() const { return pieces_.size(); }
  const BladePiece& operator[](std::size_t piece) const { return pieces_[piece]; }
  const std::vector<BladePiece>& all() const { return pieces_; }
  /// Whether the blade holds the middle of a face that separates its sides. Adds its area.
  bool opens_face(Index element, int face);
  /// Of divided elements and faces; not measured for every blade (Blade::is_measured).
  const CutArea& area() const { return area_; }
  /// Above the blade, by vertex, m; NaN: far from it. No longer here afterwards.
  std::vector<double> take_heights() { return std::move(heights_); }
  /// Elements beside divided ones that are left whole, in tetrahedra that fit to theirs. No longer
  /// here afterwards.
  RefinedParts take_refined() { return std::move(refined_); }

 private:
  using NodeHeights = std::array<double, 8>;
  using NodesByPlace = std::vector<std::pair<Vec3, Index>>;
  void find_sides();
  NodeHeights node_heights(const Hexahedron& nodes) const;
  void find_point_heights(const Material& material, const NodeHeights& heights);
  void divide(Index element);
  void refine_beside_divided();
  void add_other_lips(const NodesByPlace& divided);
  double rim_height(const NodesByPlace& divided, Index vertex) const;
  void refine(Index element, const NodeHeights& heights, PartWriter& writer);
  void add_whole(Index element);
  void leave_whole(Index element) {
    undivided_.push_back(element);
    has_rim_ = true;
  }
  bool is_opened(const Hexahedron& nodes, const Material& material,
                 const std::vector<DividedPart>& found);
  void measure(const Corners3& triangle, bool is_opened);
  bool is_held(const Hexahedron& nodes, const std::vector<DividedPart>& found) const;
  Vec3 row(Index vertex) const {
    const double* x = rows_ + stride_ * vertex;
    return {x[0], x[1], x[2]};
  }

  const CellComplex& complex_;
  PartMaterials materials_;
  const double* rows_;
  const Blade& blade_;
  std::size_t stride_;
  std::vector<double> heights_;
  double tolerance_ = 0;  ///< m
  std::vector<std::int8_t> side_;
  std::vector<Index> near_, crossed_, divided_;
  std::vector<Index> undivided_;  ///< of those whose nodes are on both sides
  bool has_rim_ = false;          ///< the material of one of these may be, too
  Divider divider_;
  Material own_;                       ///< of the element that is divided
  std::vector<double> point_heights_;  ///< of its points
  std::vector<Range> pieces_of_;       ///< by element
  std::vector<BladePiece> pieces_;
  RefinedParts refined_;
  CutArea area_;
};

}  // namespace suture
