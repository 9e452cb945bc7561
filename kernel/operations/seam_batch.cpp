// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/seam_batch.hpp"

#include <algorithm>

#include "kernel/topology/disjoint_sets.hpp"

namespace suture {
namespace {

/// The element that has two of the vertices, or `none`.
Index element_with_two(std::vector<Index>& elements) {
  std::ranges::sort(elements);
  const auto twice = std::ranges::adjacent_find(elements);
  return twice == elements.end() ? none : *twice;
}

}  // namespace

/// The vertex that represents all vertices with which this one is joined.
Index SeamBatch::joined(Index vertex) const {
  for (auto next = joined_.find(vertex); next != joined_.end(); next = joined_.find(vertex))
    vertex = next->second;
  return vertex;
}

SeamBatch::Elements SeamBatch::around(Index vertex) const {
  if (const auto found = elements_.find(vertex); found != elements_.end()) return found->second;
  std::vector<Dart> star;
  complex_.star(0, vertex, star);
  for (Dart& d : star) d = element_of(d);
  return star;
}

std::string SeamBatch::fold_text(Index element, const std::vector<Index>& group,
                                 const Naming& naming) const {
  std::string nodes;
  for (const Index v : complex_.vertices_of(element))
    if (std::ranges::find(group, joined(v)) != group.end())
      nodes += (nodes.empty() ? "" : " and ") + naming.vertex(v);
  return "nodes " + nodes + " of element " + naming.element(element) + " would be merged";
}

std::optional<std::string> SeamBatch::add(Seam seam, const Naming& naming) {
  for (const Dart face : {seam.one, seam.other})
    if (has(face))
      return "the face of element " + naming.element(element_of(face)) +
             " would be sewn to two other faces";
  std::vector<std::pair<Index, Index>> equal;
  for (Dart k = 0; k < 4; ++k) {
    const Index a = joined(corner_vertex(complex_, seam, k)),
                b = joined(partner_vertex(complex_, seam, k));
    if (a != b) equal.emplace_back(a, b);
  }
  const std::vector<std::vector<Index>> groups = groups_of_equal(equal);
  std::vector<Elements> merged(groups.size());
  for (std::size_t i = 0; i < groups.size(); ++i) {
    for (const Index vertex : groups[i]) {
      const Elements elements = around(vertex);
      merged[i].insert(merged[i].end(), elements.begin(), elements.end());
    }
    if (const Index e = element_with_two(merged[i]); e != none)
      return fold_text(e, groups[i], naming);
  }
  for (std::size_t i = 0; i < groups.size(); ++i) {
    for (const Index vertex : groups[i])
      if (vertex != groups[i][0]) {
        joined_[vertex] = groups[i][0];
        elements_.erase(vertex);
      }
    elements_[groups[i][0]] = std::move(merged[i]);
  }
  faces_.insert({face_of(seam.one), face_of(seam.other)});
  seams_.push_back(seam);
  return {};
}

}  // namespace suture
