// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kernel/topology/cell_complex.hpp"

namespace suture {

// Which faces an event cuts is decided here, by geometry or by a list of the user's;
// CellComplex::cut() then cuts them.

/// The faces whose two elements lie on different sides of the plane, one dart each,
/// ascending; empty if the plane meets none. An element lies where its centroid does
/// (the mean of its corners); a centroid on the plane, to rounding, counts as on the
/// side of the normal, which need not have unit length. Vertex v is at
/// rows[stride * v], 3 doubles, m, deformed or at rest. Throws InputError if point or
/// normal are not finite or the normal is zero. O(elements), about 17 ns each.
std::vector<Dart> faces_across_plane(const CellComplex& complex, const double* rows,
                                     const Vec3& point, const Vec3& normal, std::size_t stride = 4);

/// Two of the user's element numbers.
using ElementPair = std::array<std::uint64_t, 2>;

/// A dart of the face between two elements. `element_of` gives the complex's number
/// of a user's, or `none`; `path` is where the pair stands in the scene, for messages.
/// Throws InputError if a number is unknown, both are the same, or the elements have
/// no common face. If it was cut before, `point_of_vertex` (the user's point of every
/// vertex, also of those that cuts made) tells that: the answer is `none` then, as for
/// an element that was removed.
Dart face_between(const CellComplex& complex, const std::string& path, const ElementPair& pair,
                  const std::function<Index(std::uint64_t)>& element_of,
                  std::span<const Index> point_of_vertex = {});

/// A list of pairs: the faces, the pairs that were cut before, and those of which an
/// element was removed. Throws one
/// InputError with a line per pair at fault ("<path>/3: ..."). O(pairs).
struct ListedFaces {
  std::vector<Dart> faces;
  std::vector<ElementPair> cut_before, gone;
};
ListedFaces faces_between(const CellComplex& complex, const std::string& path,
                          std::span<const ElementPair> pairs,
                          const std::function<Index(std::uint64_t)>& element_of,
                          std::span<const Index> point_of_vertex);

}  // namespace suture
