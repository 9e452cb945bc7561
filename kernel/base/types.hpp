// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

namespace suture {

/// Number of a cell, a vertex or an element. 32 bits halve the memory traffic of 64, and suffice
/// for the hexahedra that links can address.
using Index = std::uint32_t;
inline constexpr Index none = 0xFFFFFFFFu;
/// The most hexahedra of a body: links number fewer than 2^26 (topology/incidence.hpp).
inline constexpr Index max_elements = (Index{1} << 26) - 1;

/// 24 e + 4 f + k: element e, face f of dart[6][4], position k.
using Dart = std::uint32_t;

using Vec3 = std::array<double, 3>;
/// The eight nodes X0..X7, X_i = (i&1, (i>>1)&1, (i>>2)&1).
using Hexahedron = std::array<Index, 8>;

}  // namespace suture
