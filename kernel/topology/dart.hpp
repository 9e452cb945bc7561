// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "kernel/base/types.hpp"
#include "kernel/topology/hexahedron_tables.hpp"

/// The arithmetic of darts. Dart 24 e + 4 f + k is position k on side f of element e:
///
///     dart  ... | 24 e .. 24 e + 3 | 24 e + 4 .. 24 e + 7 | ... | 24 e + 20 .. 24 e + 23 | ...
///     side      |        0         |          1           | ... |           5            |
///
/// Code outside topology and the loops uses these functions, so that only they know the numbers of
/// a hexahedron.
namespace suture {

constexpr Index element_of(Dart d) { return d / hexahedron::darts; }

/// The number of a dart inside its element, an index of the tables in hexahedron_tables.hpp.
constexpr Dart local(Dart d) { return d % hexahedron::darts; }

/// The dart that lies in element e as `dart` does in its own.
constexpr Dart corresponding_dart(Index e, Dart dart) {
  return hexahedron::darts * e + local(dart);
}

/// The side of its element on which a dart lies, an index of dart[6][4].
constexpr Dart local_face(Dart d) { return local(d) / hexahedron::darts_per_face; }

/// The first dart of side f of element e.
constexpr Dart face_dart(Index e, int f) {
  return hexahedron::darts * e + hexahedron::darts_per_face * static_cast<Dart>(f);
}

/// The first dart of the face on which a dart lies.
constexpr Dart face_of(Dart d) { return d - d % hexahedron::darts_per_face; }

/// The first darts of the sides of element e.
constexpr std::array<Dart, hexahedron::faces> sides_of(Index e) {
  std::array<Dart, hexahedron::faces> sides{};
  for (int f = 0; f < hexahedron::faces; ++f) sides[static_cast<std::size_t>(f)] = face_dart(e, f);
  return sides;
}

}  // namespace suture
