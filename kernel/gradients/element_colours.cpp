// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/gradients/element_colours.hpp"

#include <algorithm>
#include <utility>

namespace suture {
namespace {

/// Groups of things, each in the first one where nothing that it needs is taken.
class Groups {
 public:
  explicit Groups(std::size_t needed) : needed_(needed) {}

  template <class Needs>
  void add(Index thing, const Needs& needs) {
    const auto is_free = [&](const std::vector<bool>& used) {
      return std::ranges::none_of(needs, [&](Index need) { return used[need]; });
    };
    const auto group =
        static_cast<std::size_t>(std::ranges::find_if(taken_, is_free) - taken_.begin());
    if (group == taken_.size()) {
      taken_.emplace_back(needed_);
      groups_.emplace_back();
    }
    groups_[group].push_back(thing);
    for (const Index need : needs) taken_[group][need] = true;
  }
  std::vector<std::vector<Index>> take() { return std::move(groups_); }

 private:
  std::size_t needed_;
  std::vector<std::vector<bool>> taken_;  ///< by group and what is needed
  std::vector<std::vector<Index>> groups_;
};

}  // namespace

std::vector<std::vector<Index>> colour_elements(const CellComplex& complex,
                                                const CellSet& elements) {
  Groups groups(complex.count(0));
  for (Index row = 0; row < elements.size(); ++row)
    if (elements.is_live(row)) groups.add(row, complex.vertices_of(elements.cell(row)));
  return groups.take();
}

std::vector<std::vector<Index>> colour_vertices(const CellComplex& complex,
                                                const CellSet& elements) {
  std::vector<std::vector<Index>> around(complex.count(0));  // rows of elements, by vertex
  for (Index row = 0; row < elements.size(); ++row)
    if (elements.is_live(row))
      for (const Index v : complex.vertices_of(elements.cell(row))) around[v].push_back(row);
  Groups groups(elements.size());
  for (Index v = 0; v < complex.count(0); ++v)
    if (!around[v].empty()) groups.add(v, around[v]);
  return groups.take();
}

std::vector<std::vector<Index>> stars_of(const CellComplex& complex) {
  std::vector<std::vector<Index>> stars(complex.count(0));
  for (Index e = 0; e < complex.element_count(); ++e) {
    if (!complex.exists(3, e)) continue;
    const auto& vertices = complex.vertices_of(e);
    for (const Index v : vertices)
      stars[v].insert(stars[v].end(), vertices.begin(), vertices.end());
  }
  for (std::vector<Index>& star : stars) {
    std::ranges::sort(star);
    star.erase(std::unique(star.begin(), star.end()), star.end());
  }
  return stars;
}

std::vector<std::vector<Index>> colour_stars(const std::vector<std::vector<Index>>& stars) {
  Groups groups(stars.size());
  for (Index v = 0; v < stars.size(); ++v)
    if (!stars[v].empty()) groups.add(v, stars[v]);
  return groups.take();
}

}  // namespace suture
