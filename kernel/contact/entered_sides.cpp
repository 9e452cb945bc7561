// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/entered_sides.hpp"

#include <algorithm>

namespace suture {

const Vec3* EnteredSides::outside(std::size_t obstacle, Index vertex) const {
  if (obstacle >= places_.size() || vertex >= places_[obstacle].size()) return nullptr;
  const Index place = places_[obstacle][vertex];
  return place == none ? nullptr : &sides_[place].outside;
}

void EnteredSides::clear() {
  for (const Side& side : sides_) places_[side.obstacle][side.vertex] = none;
  sides_.clear();
}

void EnteredSides::add(std::size_t obstacle, Index vertex, const Vec3& outside) {
  if (obstacle >= places_.size()) places_.resize(obstacle + 1);
  std::vector<Index>& of = places_[obstacle];
  if (vertex >= of.size()) of.resize(std::size_t{vertex} + 1, none);
  of[vertex] = static_cast<Index>(sides_.size());
  sides_.push_back({static_cast<Index>(obstacle), vertex, outside});
}

void EnteredSides::find_places() {
  std::vector<Side> sides = std::move(sides_);
  sides_.clear();
  places_.clear();
  for (const Side& side : sides) add(side.obstacle, side.vertex, side.outside);
}

void EnteredSides::follow(const CellComplex& complex, const TopologyChange& change) {
  for (const Split& split : change.splits[0])
    for (std::size_t obstacle = 0; obstacle < places_.size(); ++obstacle)
      if (const Vec3* kept = outside(obstacle, split.old_cell))
        add(obstacle, split.new_cell, *kept);
  std::erase_if(sides_, [&](const Side& side) { return !complex.exists(0, side.vertex); });
  find_places();
}

void EnteredSides::state(Archive& archive, std::size_t obstacles, Index vertices) {
  archive.member("vertices", sides_, &Side::vertex);
  archive.member("obstacles", sides_, &Side::obstacle);
  archive.member("outside", sides_, &Side::outside);
  if (!archive.loads()) return;
  for (const Side& side : sides_)
    archive.require(side.obstacle < obstacles && side.vertex < vertices,
                    "contact is that of another body");
  find_places();
}

}  // namespace suture
