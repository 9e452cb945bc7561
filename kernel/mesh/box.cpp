// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/mesh/box.hpp"

#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/mesh/file_text.hpp"

namespace suture {
namespace {

constexpr const char* box_axis_name[3] = {"x", "y", "z"};

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

void check(const BoxOptions& box) {
  double hexahedra = 1;
  for (int a = 0; a < 3; ++a) {
    const std::string axis = box_axis_name[a];
    if (box.cells[a] == 0) {
      throw InputError("box: 0 cells along " + axis + "; at least 1 is needed");
    }
    if (!(box.size[a] > 0) || !std::isfinite(box.size[a])) {
      throw InputError("box: size " + number(box.size[a]) + " m along " + axis +
                       " must be positive and finite");
    }
    if (!std::isfinite(box.origin[a]) || !std::isfinite(box.origin[a] + box.size[a])) {
      throw InputError("box: origin " + number(box.origin[a]) + " m along " + axis +
                       " must be finite, as must the opposite corner of the box");
    }
    if (!(box.grading[a] > 0) || !std::isfinite(box.grading[a])) {
      throw InputError("box: grading " + number(box.grading[a]) + " along " + axis +
                       " (last cell / first cell) must be positive and finite");
    }
    hexahedra *= box.cells[a];
  }
  require_numbers(hexahedra, "box: " + number(hexahedra) + " hexahedra");
}

// Share of the length that lies before node i of n cells whose widths grow by r
// from one to the next, r^(n-1) = grading >= 1:
//   S_i = (r^i - 1) / (r^n - 1)
double share_before(Index i, Index n, double grading) {
  const double log_r = std::log(grading) / (n - 1);
  return std::expm1(i * log_r) / std::expm1(n * log_r);
}

// A weighted mean of both ends, weights exchanged for the mirror image, so that
// what is symmetric in exact arithmetic stays so to the bit; a step added up from
// the origin would not be.
double coordinate(double begin, double end, Index i, Index n, double grading) {
  if (i == 0) return begin;
  if (i == n) return end;
  if (n == 1 || grading == 1) return (begin * (n - i) + end * i) / n;
  const double share =
      grading > 1 ? share_before(i, n, grading) : share_before(n - i, n, 1 / grading);
  return grading > 1 ? begin * (1 - share) + end * share : begin * share + end * (1 - share);
}

std::vector<double> ticks(const BoxOptions& box, int axis) {
  const Index n = box.cells[axis];
  const double begin = box.origin[axis];
  std::vector<double> x(n + 1);
  for (Index i = 0; i <= n; ++i) {
    x[i] = coordinate(begin, begin + box.size[axis], i, n, box.grading[axis]);
    if (i > 0 && !(x[i] > x[i - 1])) {
      throw InputError("box: cell " + std::to_string(i - 1) + " along " + box_axis_name[axis] +
                       " is thinner than the rounding of its coordinate " + number(x[i]) +
                       " m; use fewer cells, a milder grading or an origin nearer to 0");
    }
  }
  return x;
}

}  // namespace

Mesh make_box(const BoxOptions& box) {
  check(box);
  const std::array<std::vector<double>, 3> x{ticks(box, 0), ticks(box, 1), ticks(box, 2)};
  const auto [nx, ny, nz] = box.cells;
  const Index row = nx + 1, layer = (nx + 1) * (ny + 1);

  Mesh mesh;
  mesh.source =
      "box " + std::to_string(nx) + " x " + std::to_string(ny) + " x " + std::to_string(nz);
  mesh.points.reserve(std::size_t(layer) * (nz + 1));
  std::array<std::array<std::vector<Index>*, 2>, 3> side;
  for (int a = 0; a < 3; ++a) {
    for (int s = 0; s < 2; ++s) side[a][s] = &mesh.point_sets[box_axis_name[a] + std::to_string(s)];
  }
  for (Index k = 0; k <= nz; ++k) {
    for (Index j = 0; j <= ny; ++j) {
      for (Index i = 0; i <= nx; ++i) {
        const Index point = i + row * j + layer * k;
        mesh.points.push_back({x[0][i], x[1][j], x[2][k]});
        const std::array<Index, 3> at{i, j, k};
        for (int a = 0; a < 3; ++a) {
          if (at[a] == 0) side[a][0]->push_back(point);
          if (at[a] == box.cells[a]) side[a][1]->push_back(point);
        }
      }
    }
  }

  mesh.hexahedra.reserve(std::size_t(nx) * ny * nz);
  for (Index k = 0; k < nz; ++k) {
    for (Index j = 0; j < ny; ++j) {
      for (Index i = 0; i < nx; ++i) {
        const Index p = i + row * j + layer * k;
        mesh.hexahedra.push_back({p, p + 1, p + row, p + row + 1, p + layer, p + layer + 1,
                                  p + layer + row, p + layer + row + 1});
      }
    }
  }
  return mesh;
}

Mesh make_local_box(const BoxOptions& options) {
  check(options);
  for (int a = 0; a < 3; ++a) ticks(options, a);  // frames show the box where the scene has it
  BoxOptions local = options;
  local.origin = {};
  Mesh mesh = make_box(local);
  mesh.origin = options.origin;
  return mesh;
}

}  // namespace suture
