// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kernel/mesh/parts.hpp"

namespace suture {

class Archive;

/// The elements of a complex of which only a part is material, and the moments of their parts.
/// Full elements take no memory.
class ElementParts {
 public:
  ElementParts() = default;
  /// `elements`: ascending.
  ElementParts(std::vector<Index> elements, std::vector<PartMoments> moments,
               std::vector<GeneralPart> general = {});

  bool empty() const { return elements_.empty(); }
  std::span<const Index> elements() const { return elements_; }
  /// Null for full elements. Its fraction is that of the volume at rest. O(log n).
  const PartMoments* of(Index element) const;
  /// Whether parts are described as those of general hexahedra: some element is, or may become, a
  /// part that is no parallelepiped.
  bool are_general() const { return are_general_; }
  /// From now on they are; those that are there are parallelepipeds.
  void make_general();
  /// Requires that they are, and that the element is a part. O(log n).
  const GeneralPart& general(Index element) const {
    return general_[position_in(elements_, element)];
  }
  /// The part of the element's volume that is material; 1 for full elements.
  double fraction(Index element) const {
    const PartMoments* const part = of(element);
    return part ? part->fraction : 1;
  }
  /// Exchanges the ends of the first axis of an element.
  void mirror(Index element);

  /// Whether cuts along blades may add parts while a run goes on; models must then allow them.
  bool may_grow() const { return may_grow_; }
  void let_grow() { may_grow_ = true; }
  /// Adds the parts of copies, which follow all others; `copies` outlives the operation. `general`:
  /// of each of them if are_general(), else empty. Those that are whole again are full elements.
  void begin_copies(const Parts& copies, std::span<const GeneralPart> general);
  void end_copies() { copies_ = nullptr; }
  /// During an operation that makes copies, and for its followers: their material; null otherwise.
  const Parts* copies() const { return copies_; }
  void state(Archive& archive);

 private:
  std::vector<Index> elements_;
  std::vector<PartMoments> moments_;
  std::vector<GeneralPart> general_;
  const Parts* copies_ = nullptr;
  bool are_general_ = false;
  bool may_grow_ = false;
};

/// The parts of a mesh of `element_count` elements, in the numbers of a complex. Throws InputError,
/// with the element's name, for moments that no part of a cube has. O(n log n).
ElementParts number_parts(const Parts& parts, Index element_count,
                          const std::function<Index(Index)>& element_of,
                          const std::function<std::string(Index)>& name);

}  // namespace suture
