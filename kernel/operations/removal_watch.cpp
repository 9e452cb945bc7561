// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/removal_watch.hpp"

#include <algorithm>
#include <utility>

namespace suture {

void RemovalWatch::add(std::string path, const Selection& where, int corners, bool by_nodes) {
  Holder holder{std::move(path), std::vector<char>(built_.names().point_count), corners, by_nodes};
  for (const Index v : built_.selector().vertices(where))
    holder.point[built_.body().user_vertex()[v]] = 1;
  holders_.push_back(std::move(holder));
}

// A force is carried by all elements around its nodes, a load in Pa by faces; what
// holds a node does so as long as one of its elements is left.
void RemovalWatch::find_holders() {
  if (std::exchange(found_, true)) return;
  for (std::size_t i = 0; i < scene_.loads.size(); ++i) {
    const Load& load = scene_.loads[i];
    add("/loads/" + std::to_string(i), load.where, load.kind == Load::Kind::force ? 1 : 4, false);
  }
  for (std::size_t i = 0; i < scene_.constraints.size(); ++i)
    add("/constraints/" + std::to_string(i), scene_.constraints[i].where, 1, true);
}

bool RemovalWatch::carries(Index element, const Holder& holder) const {
  const CellComplex& complex = built_.body().complex();
  if (!complex.exists(3, element)) return false;
  const Hexahedron& nodes = complex.vertices_of(element);
  return std::ranges::count_if(nodes, [&](Index v) {
           return holder.point[built_.body().user_vertex()[v]] != 0;
         }) >= holder.corners;
}

void RemovalWatch::before(std::span<const Index> elements) {
  find_holders();
  const CellComplex& complex = built_.body().complex();
  for (Holder& holder : holders_) {
    holder.nodes.clear();
    holder.loses = false;
    for (const Index e : elements) {
      if (holder.is_empty || !carries(e, holder)) continue;
      holder.loses = true;
      for (const Index v : complex.vertices_of(e))
        if (holder.point[built_.body().user_vertex()[v]]) holder.nodes.push_back(v);
    }
  }
}

std::vector<std::string> RemovalWatch::after() {
  std::vector<std::string> losses;
  const CellComplex& complex = built_.body().complex();
  for (Holder& holder : holders_) {
    const bool keeps_nodes =
        std::ranges::all_of(holder.nodes, [&](Index v) { return complex.exists(0, v); });
    if (!holder.loses || (holder.by_nodes && keeps_nodes)) continue;
    holder.is_empty = true;
    for (Index e = 0; e < complex.element_count() && holder.is_empty; ++e)
      holder.is_empty = !carries(e, holder);
    if (holder.is_empty)
      losses.push_back("removes all nodes or faces on which " + holder.path +
                       " acts; it has no effect from now on");
    else if (!std::exchange(holder.reported, true))
      losses.push_back("removes some of the nodes or faces on which " + holder.path +
                       " acts; it continues to act on the others");
  }
  return losses;
}

void RemovalWatch::state(Archive& archive) {
  archive("found", found_);
  archive.each("holders", holders_, [](Archive& each, Holder& holder) {
    each("path", holder.path);
    each("point", holder.point);
    each("corners", holder.corners);
    each("by nodes", holder.by_nodes);
    each("reported", holder.reported);
    each("gone", holder.is_empty);
  });
}

}  // namespace suture
