// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

#include "kernel/base/diagnostics.hpp"
#include "kernel/mesh/mesh.hpp"

namespace suture {

/// The volume of a material in an element.
struct Content {
  Index element, material;
  double volume;
};

/// Gives the elements that fill a body the sets of its materials.
///
/// An element belongs to the sets of the material that fills most of it; one that holds none, as at
/// the edges of a body, to those of an element next to it. What elements of several materials hold
/// is kept in Mesh::mixtures; a note gives their number. `contents`: ascending by element, then
/// material, each pair once. `sets`: the materials of each set, ascending. O(elements) per set.
void carry_sets(const std::vector<Content>& contents,
                const std::map<std::string, std::vector<Index>>& sets, Mesh& mesh,
                Diagnostics& diagnostics);

}  // namespace suture
