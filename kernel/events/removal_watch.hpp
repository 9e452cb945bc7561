// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kernel/scene/built_scene.hpp"

namespace suture {

/// Tells of loads and constraints that lose what they act on when elements are
/// removed: of each once that it lost a part, and once that nothing is left.
class RemovalWatch {
 public:
  RemovalWatch(const Scene& scene, BuiltScene& built) : scene_(scene), built_(built) {}

  /// These elements are about to go. The first call selects anew what every load and
  /// constraint acts on; then O(removed elements) each.
  void before(std::span<const Index> elements);
  /// They are gone: what is to be told. O(elements) per load or constraint that lost
  /// something, until nothing is left of it.
  std::vector<std::string> after();
  void state(Archive& archive);

 private:
  /// A load or a constraint.
  struct Holder {
    std::string path;            ///< "/loads/0"
    std::vector<char> point;     ///< by the user's point: whether it acts there
    int corners;                 ///< that an element has in it if it carries a part
    bool by_nodes;               ///< loses something only where a node goes
    std::vector<Index> nodes{};  ///< of the elements about to go
    bool loses = false, told = false, gone = false;
  };
  void find_holders();
  void add(std::string path, const Selection& where, int corners, bool by_nodes);
  bool carries(Index element, const Holder& holder) const;

  const Scene& scene_;
  BuiltScene& built_;
  bool found_ = false;
  std::vector<Holder> holders_;
};

}  // namespace suture
