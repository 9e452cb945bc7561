// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/carry_sets.hpp"

#include <algorithm>

#include "kernel/mesh/file_text.hpp"

namespace suture {
namespace {

/// Elements without a material get that of one with which they share a node.
void spread(const Mesh& mesh, std::vector<Index>& material_of) {
  std::vector<Index> at_point(mesh.points.size(), none);
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    for (std::size_t e = 0; e < material_of.size(); ++e)
      for (const Index node : mesh.hexahedra[e])
        if (at_point[node] == none) at_point[node] = material_of[e];
    for (std::size_t e = 0; e < material_of.size(); ++e)
      for (const Index node : mesh.hexahedra[e])
        if (material_of[e] == none && at_point[node] != none) {
          material_of[e] = at_point[node];
          has_changed = true;
        }
  }
}

}  // namespace

void carry_sets(const std::vector<Content>& contents,
                const std::map<std::string, std::vector<Index>>& sets, Mesh& mesh,
                Diagnostics& diagnostics) {
  std::vector<Index> most(mesh.hexahedra.size(), none);
  std::size_t mixed = 0;
  for (std::size_t i = 0, end = 0; i < contents.size(); i = end) {
    std::size_t largest = i;
    double volume = 0;
    for (; end < contents.size() && contents[end].element == contents[i].element; ++end) {
      if (contents[end].volume > contents[largest].volume) largest = end;
      volume += contents[end].volume;
    }
    most[contents[i].element] = contents[largest].material;
    if (end == i + 1) continue;
    ++mixed;
    for (std::size_t c = i; c < end; ++c)
      mesh.mixtures.shares.push_back(
          {contents[c].element, contents[c].material, contents[c].volume / volume});
  }
  spread(mesh, most);
  for (const auto& [name, materials] : sets) {
    std::vector<Index>& members = mesh.element_sets[name];
    for (Index e = 0; e < most.size(); ++e)
      if (std::binary_search(materials.begin(), materials.end(), most[e])) members.push_back(e);
  }
  if (mixed == 0) return;
  mesh.mixtures.materials = sets;
  diagnostics.note(mesh.source + ": " + grouped(mixed) + " of " + grouped(most.size()) +
                   " elements hold more than one region; each belongs to the one that fills most "
                   "of it");
}

}  // namespace suture
