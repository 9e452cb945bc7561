// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kernel/build/built_scene.hpp"

namespace suture {

/// Reports loads and constraints that lose nodes or faces when elements are removed: for each, once
/// when it loses a part, and once when nothing is left.
class RemovalWatch {
 public:
  RemovalWatch(const Scene& scene, BuiltScene& built) : scene_(scene), built_(built) {}

  /// Evaluates the selections of all loads and constraints, unless that has been done. O(vertices).
  void find_holders();
  /// Call before these elements are removed. Calls find_holders(); otherwise O(removed elements).
  void before(std::span<const Index> elements);
  /// Call after the removal; returns the warnings. O(elements) per load or constraint that lost
  /// something, until nothing is left of it.
  std::vector<std::string> after();
  void state(Archive& archive);

 private:
  /// A load or a constraint.
  struct Holder {
    std::string path;            ///< "/loads/0"
    std::vector<char> point;     ///< per user point: whether it acts there
    int corners;                 ///< corners that an element must have in it to carry a part
    bool by_nodes;               ///< loses something only where a node is removed
    std::vector<Index> nodes{};  ///< of the elements to be removed
    bool loses = false, reported = false, is_empty = false;
  };
  void add(std::string path, const Selection& where, int corners, bool by_nodes);
  bool carries(Index element, const Holder& holder) const;

  const Scene& scene_;
  BuiltScene& built_;
  bool found_ = false;
  std::vector<Holder> holders_;
};

}  // namespace suture
