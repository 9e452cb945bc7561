// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/mesh/voxels.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/mesh/file_text.hpp"

namespace suture {
namespace {

bool is_empty(char c) { return c == '.' || c == ' '; }

void check(const VoxelOptions& voxels, std::size_t columns) {
  if (!(voxels.size > 0) || !std::isfinite(voxels.size)) {
    throw InputError("voxels: the size of a cube must be positive and finite");
  }
  for (const double x : voxels.origin) {
    if (!std::isfinite(x)) throw InputError("voxels: the origin must be finite");
  }
  if (voxels.layers == 0) throw InputError("voxels: 0 layers; at least 1 is needed");
  require_numbers(double(columns) * double(voxels.rows.size()) * voxels.layers,
                  "voxels: the cells of the drawing");
}

/// Numbers the corners of the lattice that some cube uses, in the order met.
class Corners {
 public:
  Corners(const VoxelOptions& voxels, std::size_t columns, Mesh& mesh)
      : voxels_(voxels),
        nx_(columns + 1),
        ny_(voxels.rows.size() + 1),
        number_(nx_ * ny_ * (voxels.layers + 1), none),
        mesh_(mesh) {}

  Index at(std::size_t i, std::size_t j, std::size_t k) {
    Index& number = number_[i + nx_ * (j + ny_ * k)];
    if (number != none) return number;
    number = static_cast<Index>(mesh_.points.size());
    const std::array<std::size_t, 3> lattice{i, j, k};
    Vec3 point;
    for (int a = 0; a < 3; ++a) {
      point[a] = voxels_.origin[a] + voxels_.size * static_cast<double>(lattice[a]);
    }
    mesh_.points.push_back(point);
    return number;
  }

 private:
  const VoxelOptions& voxels_;
  std::size_t nx_, ny_;
  std::vector<Index> number_;
  Mesh& mesh_;
};

void add_side_sets(Mesh& mesh) {
  constexpr const char* axis_name[3] = {"x", "y", "z"};
  for (int a = 0; a < 3; ++a) {
    const auto [low, high] =
        std::minmax_element(mesh.points.begin(), mesh.points.end(),
                            [a](const Vec3& p, const Vec3& q) { return p[a] < q[a]; });
    const double ends[2] = {(*low)[a], (*high)[a]};
    for (int side = 0; side < 2; ++side) {
      std::vector<Index>& set = mesh.point_sets[axis_name[a] + std::to_string(side)];
      for (Index p = 0; p < mesh.points.size(); ++p) {
        if (mesh.points[p][a] == ends[side]) set.push_back(p);
      }
    }
  }
}

}  // namespace

Mesh make_voxels(const VoxelOptions& voxels) {
  std::size_t columns = 0;
  for (const std::string& row : voxels.rows) columns = std::max(columns, row.size());
  check(voxels, columns);

  Mesh mesh;
  Corners corners(voxels, columns, mesh);
  for (std::size_t k = 0; k < voxels.layers; ++k) {
    for (std::size_t j = 0; j < voxels.rows.size(); ++j) {
      const std::string& row = voxels.rows[voxels.rows.size() - 1 - j];
      for (std::size_t i = 0; i < row.size(); ++i) {
        if (is_empty(row[i])) continue;
        Hexahedron nodes;
        for (std::size_t n = 0; n < 8; ++n) {
          nodes[n] = corners.at(i + (n & 1), j + (n >> 1 & 1), k + (n >> 2 & 1));
        }
        if (row[i] != '#') {
          const std::string name(1, row[i]);
          mesh.element_sets[name].push_back(static_cast<Index>(mesh.hexahedra.size()));
          std::vector<Index>& points = mesh.point_sets[name];
          points.insert(points.end(), nodes.begin(), nodes.end());
        }
        mesh.hexahedra.push_back(nodes);
      }
    }
  }
  if (mesh.hexahedra.empty()) {
    throw InputError("voxels: the drawing is empty; every character except '.' and ' ' is a cube");
  }
  for (auto& [name, points] : mesh.point_sets) sort_unique(points);
  add_side_sets(mesh);
  mesh.source = "voxels " + std::to_string(columns) + " x " + std::to_string(voxels.rows.size()) +
                " x " + std::to_string(voxels.layers);
  return mesh;
}

Mesh make_local_voxels(const VoxelOptions& options) {
  VoxelOptions local = options;
  local.origin = {};
  Mesh mesh = make_voxels(local);
  mesh.origin = options.origin;
  return mesh;
}

}  // namespace suture
