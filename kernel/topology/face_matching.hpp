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

/// Why some hexahedra do not form a 3-map.
struct MapFault {
  enum class Kind {
    index_out_of_range,  ///< vertices[0] does not exist
    repeated_vertex,     ///< vertices[0] twice in one element
    third_element,       ///< elements[2] has a face that [0] and [1] already share
    same_side,           ///< both have the same orientation on their common face
    not_cyclic,          ///< the same four vertices, but in a different order around the face
  };
  Kind kind;
  std::array<Index, 3> elements{none, none, none};
  std::array<Index, 4> vertices{none, none, none, none};
};

/// beta3 of the first dart of each of the 6 faces of each element, or `none`: all of beta3 in one
/// word per face (CellComplex::beta3). Faults are appended; if there are any, the result must not
/// be used.
///
/// Each face is looked up in the list of faces with the same largest vertex. If vertices are
/// numbered by first use, that is the newest one, so lists are short, even around an axis of
/// thousands of elements, and close in memory. Temporary memory 12 B per face and 4 B per vertex.
std::vector<incidence::Link> match_faces(std::span<const Hexahedron> hexahedra, Index vertex_count,
                                         std::vector<MapFault>& faults);

/// All faults as text, grouped by kind: the counts, then at most 20 of each kind.
std::string describe(std::span<const MapFault> faults, const Naming& naming);

}  // namespace suture
