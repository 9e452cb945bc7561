// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kernel/geometry/element_blocks.hpp"

namespace suture {

// Decides which faces an event cuts, by geometry or from a list given by the user;
// CellComplex::cut() then cuts them.

/// The faces whose two elements lie on different sides of the plane, one dart each, ascending;
/// empty if there are none. The position of an element is its centroid (the mean of its corners); a
/// centroid on the plane, to within rounding, counts as lying on the side of the normal, which need
/// not have unit length. Vertex v is at rows[stride * v], 3 doubles, m, deformed or at rest. Throws
/// InputError if the point or the normal is not finite or the normal is zero. O(elements), about 17
/// ns each; with `blocks`, of the vertices where they are, only those near the plane and `within`.
std::vector<Dart> faces_across_plane(const CellComplex& complex, const double* rows,
                                     const Vec3& point, const Vec3& normal, std::size_t stride = 4,
                                     const ElementBlocks* blocks = nullptr,
                                     const Box& within = everywhere);

/// Two element numbers of the user.
using ElementPair = std::array<std::uint64_t, 2>;

/// A dart of the face between two elements. `element_of` converts a user number to that of the
/// complex, or `none`; `path` is the JSON path of the pair, for messages. Throws InputError if a
/// number is unknown, both are the same, or the elements have no common face. Returns `none` if the
/// face has already been cut, as determined from `point_of_vertex` (the user's point of every
/// vertex, including those created by cuts), or if an element was removed.
Dart face_between(const CellComplex& complex, const std::string& path, const ElementPair& pair,
                  const std::function<Index(std::uint64_t)>& element_of,
                  std::span<const Index> point_of_vertex = {});

/// The result for a list of pairs: the faces, the pairs that have already been cut, and those with
/// a removed element. faces_between() throws one InputError with a line per invalid pair
/// ("<path>/3: ..."). O(pairs).
struct ListedFaces {
  std::vector<Dart> faces;
  std::vector<ElementPair> already_cut, removed;
};
ListedFaces faces_between(const CellComplex& complex, const std::string& path,
                          std::span<const ElementPair> pairs,
                          const std::function<Index(std::uint64_t)>& element_of,
                          std::span<const Index> point_of_vertex);

}  // namespace suture
