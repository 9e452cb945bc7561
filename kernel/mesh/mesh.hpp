// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "kernel/base/types.hpp"
#include "kernel/mesh/parts.hpp"

namespace suture {

/// An array of numbers of a mesh file: a value, or several components, per point or element.
struct MeshArray {
  std::string name;
  bool of_elements = false;
  std::size_t components = 1;
  /// All components of point or element 0, then those of 1, ...; NaN where the file has no value.
  /// Empty unless the values were asked for.
  std::vector<double> values;
  std::string unreadable;  ///< why the values cannot be read; else empty

  /// For elements that are left out: copies the values of one of an array of elements to a place
  /// before it; drops all but the first ones.
  void move_element(std::size_t from, std::size_t to) {
    if (!of_elements || values.empty()) return;
    for (std::size_t c = 0; c < components; ++c)
      values[to * components + c] = values[from * components + c];
  }
  void keep_elements(std::size_t count) {
    if (of_elements && !values.empty()) values.resize(count * components);
  }
};

/// What the elements consist of that hold several materials, by volume.
struct Mixtures {
  struct Share {
    Index element, material;
    double fraction;  ///< those of an element add up to 1
  };
  std::vector<Share> shares;                            ///< ascending by element, then material
  std::map<std::string, std::vector<Index>> materials;  ///< of each set of elements, ascending
};

/// Points and hexahedra from a file or a generator; only the syntax has been checked. The node
/// order is X0..X7 (converted from the order of the file by the reader); numbers are positions in
/// these vectors.
struct Mesh {
  std::string source;        ///< file name or "box 20 x 5 x 5", for messages
  std::vector<Vec3> points;  ///< m, after the scene's "scale", from `origin`
  Vec3 origin{};             ///< position in the scene of the origin of `points`, m
  std::vector<Hexahedron> hexahedra;
  Parts parts;  ///< where the body's surface crosses elements; empty if all are full
  /// Named sets of the file: Gmsh physical groups, Medit references ("ref 3"),
  /// VTK arrays of flags. Values are positions in `points` / `hexahedra`.
  std::map<std::string, std::vector<Index>> point_sets;
  std::map<std::string, std::vector<Index>> element_sets;
  Mixtures mixtures;  ///< of elements that are made from a shape or an image
  /// The file's own numbers (Gmsh tags) where they are not 0, 1, 2, ...; else empty.
  std::vector<std::uint64_t> point_ids;
  std::vector<std::uint64_t> element_ids;
  std::vector<MeshArray> arrays;  ///< all arrays of the file, in its order
  /// Cells of other types in the file, which are not read: name -> count.
  std::map<std::string, std::size_t> skipped_cells;
};

}  // namespace suture
