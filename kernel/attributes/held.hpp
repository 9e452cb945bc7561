// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/attributes/attributes.hpp"

namespace suture {

/// The components of a vertex that no force moves, as bits 1 x, 2 y, 4 z: those that are
/// constrained; all, where there is no mass.
inline unsigned held_components(Attributes& attributes, Index vertex) {
  if (!(attributes.mass().get(vertex, 0) > 0)) return 7;
  return static_cast<unsigned>(attributes.fixed().get(vertex, 0));
}

inline bool is_held(unsigned held, std::size_t component) { return (held >> component & 1) != 0; }

}  // namespace suture
