// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "kernel/base/diagnostics.hpp"
#include "kernel/base/error.hpp"
#include "kernel/geometry/geometry_module.hpp"
#include "kernel/mesh/file_text.hpp"

namespace suture {

/// Four digits.
std::string number_text(double x);
/// "0.1 x 0.2 x 0.3 m".
std::string size_text(const Box& box);

/// The volume that a closed surface encloses, m^3.
double volume_of(const TriangleSurface& surface);

/// The lattice of these numbers of cubes that is centred on a box. Throws InputError if it has more
/// than 4,000,000,000 cubes.
CubeGrid grid_around(const Box& box, double edge, const Vec3& layers, const std::string& source);

/// Throws InputError for a lattice around a body of `wanted` ones that is mostly empty:
/// stray points extend it, or the surface encloses next to nothing.
void require_compact(const TriangleSurface& surface, const Box& box, const Vec3& layers,
                     double wanted);

/// Throws InputError if neither or both of the number of cells and the edge are given, or if the
/// surface is empty.
void require_size(const TriangleSurface& surface, std::size_t cells, double edge);

/// Finds the edge of cubes of which `cells` fill a surface. fill(edge) returns a filling with a
/// `count` of cubes. It is about volume / edge^3, with jumps where the lattice gets a layer more:
/// the edge follows that law, and is halved between those known to give too many and too few. Up to
/// 16 times, until the number is within 1 %; the best filling is returned, with a warning if it is
/// further off.
template <class Fill>
auto fill_with_cells(const TriangleSurface& surface, std::size_t cells, Fill fill,
                     Diagnostics& diagnostics) {
  const double wanted = double(cells);
  require_numbers(wanted, surface.source + ": " + grouped(cells) + " cells");
  double edge = std::cbrt(volume_of(surface) / wanted);
  if (!(edge > 0)) throw InputError(surface.source + ": the surface encloses no volume");
  double short_edge = 0, long_edge = std::numeric_limits<double>::infinity();
  decltype(fill(edge)) best;
  const auto error = [&](const auto& f) { return std::abs(double(f.count) - wanted) / wanted; };
  for (int round = 0; round < 16; ++round) {
    auto now = fill(edge);
    (double(now.count) > wanted ? short_edge : long_edge) = edge;
    edge *= std::cbrt(std::max(1.0, double(now.count)) / wanted);
    if (!(edge > short_edge && edge < long_edge)) edge = (short_edge + long_edge) / 2;
    if (round == 0 || error(now) < error(best)) best = std::move(now);
    if (error(best) <= 0.01) return best;
  }
  if (best.count != 0)
    diagnostics.warn(surface.source + ": " + grouped(best.count) + " cells instead of " +
                     grouped(cells) + ": no other cube size came closer");
  return best;
}

}  // namespace suture
