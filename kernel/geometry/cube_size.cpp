// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/cube_size.hpp"

#include <cstdio>

namespace suture {
namespace {

// A lattice of 10,000 cubes for each that is wanted: a wire across its box is 200 times as long
// as thick. What is further away is a stray point, or a surface around next to nothing.
constexpr double max_outside = 1e4, always_allowed = 1e6;

// A lattice has more cubes than links can name, outside.
constexpr double max_lattice = 4e9;

int longest_axis(const Box& box) {
  int longest = 0;
  for (const int a : {1, 2})
    if (box.high[a] - box.low[a] > box.high[longest] - box.low[longest]) longest = a;
  return longest;
}

}  // namespace

std::string number_text(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}

std::string size_text(const Box& box) {
  return number_text(box.high[0] - box.low[0]) + " x " + number_text(box.high[1] - box.low[1]) +
         " x " + number_text(box.high[2] - box.low[2]) + " m";
}

// V = 1/6 sum over triangles of p . (q x r), by the divergence theorem; points are
// taken from the first one, against cancellation.
double volume_of(const TriangleSurface& surface) {
  double six = 0;
  const Vec3& o = surface.points[0];
  for (const Triangle& t : surface.triangles) {
    Vec3 x[3];
    for (int n = 0; n < 3; ++n)
      for (int a = 0; a < 3; ++a) x[n][a] = surface.points[t[n]][a] - o[a];
    six += x[0][0] * (x[1][1] * x[2][2] - x[1][2] * x[2][1]) +
           x[0][1] * (x[1][2] * x[2][0] - x[1][0] * x[2][2]) +
           x[0][2] * (x[1][0] * x[2][1] - x[1][1] * x[2][0]);
  }
  return std::abs(six) / 6;
}

void require_compact(const TriangleSurface& surface, const Box& box, const Vec3& layers,
                     double wanted) {
  const double cubes = layers[0] * layers[1] * layers[2];
  if (cubes <= std::max(always_allowed, max_outside * wanted)) return;
  const int a = longest_axis(box);
  throw InputError(
      surface.source + ": the surface encloses only " + number_text(volume_of(surface)) +
      " m^3 in a box of " + size_text(box) + ": " + number_text(wanted) +
      " cubes inside would need a lattice of " + number_text(cubes) + "; it extends from " +
      number_text(box.low[a]) + " to " + number_text(box.high[a]) + " m along " + "xyz"[a] +
      "; check for stray points, or give the edge of the cubes to use the surface as it is");
}

CubeGrid grid_around(const Box& box, double edge, const Vec3& layers, const std::string& source) {
  if (!(layers[0] * layers[1] * layers[2] <= max_lattice))
    throw InputError(source + ": cubes of " + number_text(edge) +
                     " m are too small for a body of this size: the lattice around it would have "
                     "more than 4,000,000,000 cubes; use fewer cells or a longer edge");
  CubeGrid grid{.edge = edge};
  for (std::size_t a = 0; a < 3; ++a) {
    grid.cells[a] = static_cast<Index>(layers[a]);
    grid.origin[a] = (box.low[a] + box.high[a]) / 2 - layers[a] * edge / 2;
  }
  return grid;
}

void require_size(const TriangleSurface& surface, std::size_t cells, double edge) {
  const bool by_edge = edge != 0;
  if (by_edge == (cells != 0) || (by_edge && !(edge > 0 && std::isfinite(edge))))
    throw InputError(
        surface.source +
        ": give either the number of cells or the edge of the cubes, as a positive number");
  if (surface.triangles.empty()) throw InputError(surface.source + ": the surface is empty");
}

}  // namespace suture
