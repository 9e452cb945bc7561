// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/base/box.hpp"

namespace suture {

/// Finds the elements of the deformed body that contain a place.
class ElementFinder {
 public:
  ElementFinder(const CellComplex& complex, Attributes& attributes)
      : complex_(complex), attributes_(attributes) {}

  /// Call before places in `box` are asked for, after each step of length dt: keeps the elements
  /// near the box, up to `margin` (m; about two edges) beyond it. 1 ns per vertex, which bounds how
  /// far the tissue has moved; 10 ns per element whenever box and tissue may have moved by the
  /// margin since elements were last collected.
  void update(const Box& box, double dt, double margin);
  /// Positions have jumped.
  void forget() { is_current_ = false; }
  /// Call after operations. O(elements that have changed).
  void follow(const TopologyChange& change);

  /// Where in the reference cube [-1, 1]^3 the element has the place, also outside; none where
  /// Newton's method for x(at) = place does not converge, far away from the element.
  std::optional<Vec3> locate(Index element, const Vec3& place) const;
  /// The same if the place is in the element, with its surface.
  std::optional<Vec3> inside(Index element, const Vec3& place) const;

  /// visit(element, at) for the elements that contain the place, ascending, until it returns true.
  template <class Visit>
  bool any_around(const Vec3& place, Visit visit) const {
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      if (!may_contain(groups_[g], place)) continue;
      for (const Near& near : group(g)) {
        if (!may_contain(near.box, place)) continue;
        if (const auto at = inside(near.element, place); at && visit(near.element, *at))
          return true;
      }
    }
    return false;
  }

 private:
  /// An element and its box when elements were collected.
  struct Near {
    Index element;
    Box box;
  };
  static constexpr std::size_t in_group = 32;
  std::span<const Near> group(std::size_t g) const {
    return std::span(near_).subspan(g * in_group, std::min(in_group, near_.size() - g * in_group));
  }
  void make_groups();
  bool may_contain(const Box& box, const Vec3& place) const;
  Box box_of(Index element) const;

  const CellComplex& complex_;
  Attributes& attributes_;
  bool is_current_ = false;
  Box searched_ = no_box;    ///< in which the elements were collected
  double moved_ = 0;         ///< the tissue since then, at most, m
  std::vector<Near> near_;   ///< ascending
  std::vector<Box> groups_;  ///< around as many consecutive elements each
};

}  // namespace suture
