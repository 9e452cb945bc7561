// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/forces/follower.hpp"
#include "kernel/parts/embedding.hpp"

namespace suture {

/// The partial elements of a body, and their embedding, which follows operations.
class EmbeddedParts final : public Follower {
 public:
  explicit EmbeddedParts(Parts parts) : parts_(std::move(parts)) {}
  /// From the numbers of the mesh to those of the complex.
  void renumber(const Renumbering& element_of) {
    parts_ = renumbered(std::move(parts_), element_of);
  }

  const Parts& parts() const { return parts_; }
  /// Call before cuts along blades: remembers which faces are the surface of the body now.
  void let_grow(const CellComplex& complex);
  /// Adds the parts of new elements, which follow all others, and their surface. `origins`: of the
  /// new elements.
  void append(const Parts& added, std::span<const Index> origins);
  /// Saves what was appended, and the rest with it.
  void state(Archive& archive);
  /// O(parts) at first and after an operation, else free.
  const Embedding& embedding(const CellComplex& complex) {
    if (!is_current_) embedding_ = Embedding(parts_, complex);
    is_current_ = true;
    return embedding_;
  }
  void follow(const CellComplex&, const TopologyChange&) override { is_current_ = false; }

 private:
  Parts parts_;
  bool has_grown_ = false;
  Embedding embedding_;
  bool is_current_ = false;
};

}  // namespace suture
