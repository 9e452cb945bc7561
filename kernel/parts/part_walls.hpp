// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "kernel/geometry/surface.hpp"
#include "kernel/parts/coarse_parts.hpp"

namespace suture {

/// The place of a point in the mesh: vertices and weights on the boundary of an element; inside,
/// the element, and the place in its cube.
struct PlaceInMesh {
  std::array<Index, 4> cells{none, none, none, none};
  std::array<double, 4> numbers{};
  bool operator==(const PlaceInMesh&) const = default;
};
struct HashOfPlace {
  std::size_t operator()(const PlaceInMesh& place) const;
};

/// The materials of some elements and of all around them, as cells with walls between them.
/// Points of elements at the same place of the mesh have one number.
class PartWalls {
 public:
  struct Element {
    Index number;
    std::size_t place;  ///< in parts.elements, or their number: it is full
    bool is_wanted;
    std::vector<std::pair<Index, Vec3>> points;  ///< number and place, ascending by number
  };
  struct Tetrahedron {
    std::array<Index, 4> corners;
    Index element;  ///< position in elements()
    Index cell;
  };
  struct Cell {
    Index element;
    unsigned kuhn = 0;  ///< stands for one of the six tetrahedra of the element
    double volume = 0;  ///< six times
    std::vector<Index> tetrahedra;
    std::vector<Index> walls;
  };
  static constexpr std::uint8_t hidden = 2;
  /// How the surface of the body shows a side of a wall.
  struct Mark {
    std::uint8_t is_cut = hidden;
    Index cut = none;
    bool operator==(const Mark&) const = default;
  };
  struct Side {
    Index tetrahedron = none;
    Triangle outward{};
    Mark mark;
  };
  /// A triangle between two cells, or at one.
  struct Wall {
    std::array<Side, 2> sides;
    unsigned count = 0;  ///< of tetrahedra at it; more than 2 where something is wrong: it stays

    std::span<const Side> known_sides() const { return {sides.data(), std::min(count, 2u)}; }
  };

  /// Of `elements`, and of all that share a corner of the mesh with one of them.
  PartWalls(const Parts& parts, const std::vector<Index>& cut_of_triangle,
            const CellComplex& complex, const LatticePlaces& places,
            std::span<const Index> elements);

  const std::vector<Element>& elements() const { return elements_; }  ///< ascending
  const std::vector<Tetrahedron>& tetrahedra() const { return tetrahedra_; }
  const std::vector<Cell>& cells() const { return cells_; }  ///< element by element
  const std::vector<Wall>& walls() const { return walls_; }
  /// The points of a wall, ascending.
  const Triangle& points_of(Index wall) const { return keys_[wall]; }
  std::size_t point_count() const { return numbers_.size(); }

  Index cell_of(const Side& side) const { return tetrahedra_[side.tetrahedron].cell; }
  Index element_of(const Side& side) const { return tetrahedra_[side.tetrahedron].element; }
  /// Whether it is on a wanted element.
  bool is_wanted(const Wall& wall) const;

  /// The place of a point in the cube of an element that has it.
  const Vec3& place(Index element, Index point) const;
  bool has(Index element, Index point) const;
  /// The number of the point there, which is known.
  Index known_number(Index element, const Vec3& at) const;

  /// Whether a triangle of the parts is a wall's.
  bool is_matched(std::size_t triangle) const { return is_matched_[triangle] != 0; }
  /// Whether other triangles of the parts have the point or the edge, low point first.
  bool is_kept(Index point) const { return is_kept_[point] != 0; }
  bool is_kept(Index low, Index high) const;

 private:
  struct Face {
    Triangle key;
    Index tetrahedron;
    unsigned face;
  };
  void find_elements(const CellComplex& complex, std::span<const Index> wanted);
  void read_element(Index i);
  Index number(Index element, const Vec3& at);
  Triangle outward(const Face& face) const;
  void find_walls();
  void match_surface(const std::vector<Index>& cuts);
  bool mark(const Triangle& points, Index element, const Mark& mark);

  const Parts& parts_;
  const LatticePlaces& places_;
  std::vector<Element> elements_;
  std::unordered_map<PlaceInMesh, Index, HashOfPlace> numbers_;
  std::vector<Tetrahedron> tetrahedra_;
  std::vector<Cell> cells_;
  std::vector<Triangle> keys_;  ///< of walls, ascending
  std::vector<Wall> walls_;
  std::vector<std::uint8_t> is_matched_, is_kept_;  ///< by triangle of the parts; by point
  std::vector<std::pair<Index, Index>> kept_edges_;
};

}  // namespace suture
