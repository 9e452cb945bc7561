// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kernel/topology/incidence.hpp"

namespace suture {

/// How messages name elements and vertices: by default with their own numbers,
/// on import with those of the user's file.
struct Naming {
  std::function<std::string(Index)> element = [](Index e) { return std::to_string(e); };
  std::function<std::string(Index)> vertex = [](Index v) { return std::to_string(v); };
};

/// Why some hexahedra are no 3-map.
struct MapFault {
  enum class Kind {
    index_out_of_range,  ///< vertices[0] does not exist
    repeated_vertex,     ///< vertices[0] twice in one element
    third_element,       ///< elements[2] has a face that [0] and [1] share already
    same_side,           ///< both turn the same way around their common face
    not_cyclic,          ///< same four vertices, but in another order around the face
  };
  Kind kind;
  std::array<Index, 3> elements{none, none, none};
  std::array<Index, 4> vertices{none, none, none, none};
};

/// beta3 of the first dart of each of the 6 faces of each element, or `none`:
/// all of beta3 in one word per face (CellComplex::beta3). Faults are appended;
/// with any fault the result is not to be used.
///
/// Each face is looked up in the list of faces that have the same largest vertex:
/// where vertices are numbered by first touch that is the newest one, so lists are
/// short even around an axis of thousands of elements, and near in memory.
/// Temporary memory 12 B per face and 4 B per vertex.
std::vector<incidence::Link> match_faces(std::span<const Hexahedron> hexahedra, Index vertex_count,
                                         std::vector<MapFault>& faults);

/// All faults, grouped by kind, as text: counts, then at most 20 of each kind.
std::string describe(std::span<const MapFault> faults, const Naming& naming);

}  // namespace suture
