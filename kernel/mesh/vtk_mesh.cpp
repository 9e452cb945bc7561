// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/mesh/vtk_mesh.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"
#include "kernel/mesh/solid_cells.hpp"

namespace suture {
namespace {

[[noreturn]] void fail(const FileText& file, const std::string& what) {
  throw InputError(file.name() + ": " + what);
}

struct TypeName {
  std::uint8_t type;
  const char* name;
};
// vtkCellType.h of VTK 9.1.
constexpr TypeName type_names[] = {
    {0, "empty cells"},
    {1, "vertices as cells"},
    {2, "vertices as cells"},
    {3, "lines"},
    {4, "polylines"},
    {5, "triangles"},
    {6, "triangle strips"},
    {7, "polygons"},
    {8, "pixels"},
    {9, "quadrilaterals"},
    {10, "tetrahedra"},
    {13, "wedges"},
    {14, "pyramids"},
    {15, "pentagonal prisms"},
    {16, "hexagonal prisms"},
    {21, "quadratic edges"},
    {22, "quadratic triangles"},
    {23, "quadratic quadrilaterals"},
    {24, "quadratic tetrahedra"},
    {26, "quadratic wedges"},
    {27, "quadratic pyramids"},
    {42, "polyhedra"},
};

std::string name_of(std::uint8_t type) {
  for (const TypeName& known : type_names) {
    if (known.type == type) return known.name;
  }
  return "cells of VTK type " + std::to_string(type);
}

// Quadratic, triquadratic, biquadratic, Lagrange and Bezier hexahedra.
bool is_curved_hexahedron(std::uint8_t type) {
  constexpr std::array<std::uint8_t, 5> curved{25, 29, 33, 72, 79};
  return std::find(curved.begin(), curved.end(), type) != curved.end();
}

void check_sizes(const VtkGrid& grid, const FileText& file) {
  check_count(file, grid.points.size(), "points");
  check_count(file, grid.types.size(), "cells");
  const bool matches = grid.offsets.size() == grid.types.size() + 1 && grid.offsets.front() == 0 &&
                       grid.offsets.back() <= std::int64_t(grid.connectivity.size()) &&
                       std::is_sorted(grid.offsets.begin(), grid.offsets.end());
  if (!matches && !grid.types.empty()) {
    fail(file, "offsets, connectivity and types of the cells do not match");
  }
  for (std::size_t i = 0; i < grid.points.size(); ++i) {
    for (const double x : grid.points[i]) {
      if (x - x != 0)
        fail(file, "point " + std::to_string(i) + " has a coordinate that is not finite");
    }
  }
}

void repair_types(VtkGrid& grid, const FileText& file, Diagnostics& diagnostics) {
  constexpr std::uint8_t tetrahedron = 10;
  std::size_t repaired = 0;
  for (std::size_t cell = 0; cell < grid.types.size(); ++cell) {
    if (grid.types[cell] != tetrahedron || grid.offsets[cell + 1] - grid.offsets[cell] != 8)
      continue;
    grid.types[cell] = vtk_hexahedron;
    ++repaired;
  }
  if (repaired > 0) {
    diagnostics.warn(file.name() + ": " + grouped(repaired) +
                     " cells of VTK type 10 (tetrahedron) have 8 nodes; read as hexahedra");
  }
}

/// Solids of the grid; of quadratic ones, the corners are the first nodes.
struct Solid {
  std::uint8_t type;
  const char* name;
  int corners, nodes;
};
constexpr Solid solids[] = {{vtk_hexahedron, "hexahedron", 8, 8},
                            {vtk_voxel, "hexahedron", 8, 8},
                            {10, "tetrahedron", 4, 4},
                            {13, "wedge", 6, 6},
                            {14, "pyramid", 5, 5},
                            {24, "quadratic tetrahedron", 4, 10},
                            {26, "quadratic wedge", 6, 15},
                            {27, "quadratic pyramid", 5, 13}};

/// Null if cells of the type are not read.
const Solid* find_solid(std::uint8_t type, bool all_solids) {
  for (const Solid& solid : solids)
    if (solid.type == type && (all_solids || solid.corners == 8)) return &solid;
  return nullptr;
}

Hexahedron nodes_of(const VtkGrid& grid, std::size_t cell, const Solid& solid,
                    const FileText& file) {
  const std::int64_t begin = grid.offsets[cell], count = grid.offsets[cell + 1] - begin;
  if (count != solid.nodes) {
    fail(file, "cell " + std::to_string(cell) + " is a " + solid.name + " with " +
                   std::to_string(count) + " nodes; expected " + std::to_string(solid.nodes));
  }
  std::array<Index, 8> nodes;
  for (int i = 0; i < solid.corners; ++i) {
    const std::int64_t node = grid.connectivity[begin + i];
    if (node < 0 || node >= std::int64_t(grid.points.size())) {
      fail(file, "cell " + std::to_string(cell) + " has point " + std::to_string(node) +
                     "; the points are numbered 0 to " +
                     std::to_string(std::int64_t(grid.points.size()) - 1));
    }
    nodes[i] = static_cast<Index>(node);
  }
  if (solid.type == vtk_voxel) return nodes;
  return collapsed(std::span<const Index>(nodes.data(), std::size_t(solid.corners)));
}

// Byte arrays of 0 and 1 are flags, other integers are labels. Arrays with more values
// than a user would name (numbers of points) are not labels.
void add_sets(Sets& sets, const VtkGrid::Labels& labels) {
  constexpr std::size_t max_labels = 256;
  const bool flags = labels.bytes && std::all_of(labels.values.begin(), labels.values.end(),
                                                 [](std::int64_t v) { return v == 0 || v == 1; });
  std::map<std::int64_t, std::vector<Index>> by_value;
  for (std::size_t i = 0; i < labels.values.size(); ++i) {
    by_value[labels.values[i]].push_back(static_cast<Index>(i));
    if (by_value.size() > max_labels) return;
  }
  for (auto& [value, members] : by_value) {
    if (flags && value == 0) continue;
    sets[flags ? labels.name : labels.name + " " + std::to_string(value)] = std::move(members);
  }
}

void add_labels(Mesh& mesh, VtkGrid::Labels& labels, const std::vector<Index>& cells) {
  if (labels.of_cells) {
    for (std::size_t e = 0; e < cells.size(); ++e) labels.values[e] = labels.values[cells[e]];
    labels.values.resize(cells.size());
  }
  if (labels.global_ids) {
    auto& ids = labels.of_cells ? mesh.element_ids : mesh.point_ids;
    ids.assign(labels.values.begin(), labels.values.end());
  } else {
    add_sets(labels.of_cells ? mesh.element_sets : mesh.point_sets, labels);
  }
}

/// Flags are sets already.
bool is_set(const Mesh& mesh, const MeshArray& array) {
  const auto& sets = array.of_elements ? mesh.element_sets : mesh.point_sets;
  return array.components == 1 && sets.contains(array.name);
}

void add_array(Mesh& mesh, MeshArray array, const std::vector<Index>& cells) {
  if (is_set(mesh, array)) return;
  for (std::size_t e = 0; e < cells.size(); ++e) array.move_element(cells[e], e);
  array.keep_elements(cells.size());
  mesh.arrays.push_back(std::move(array));
}

}  // namespace

Mesh mesh_from_vtk(VtkGrid grid, const FileText& file, bool all_solids, Diagnostics& diagnostics) {
  check_sizes(grid, file);
  repair_types(grid, file, diagnostics);
  Mesh mesh;
  std::vector<Index> cells;  // element -> cell of the file
  std::array<std::size_t, 256> skipped{};
  bool is_curved = false;
  for (std::size_t cell = 0; cell < grid.types.size(); ++cell) {
    const std::uint8_t type = grid.types[cell];
    if (is_curved_hexahedron(type)) {
      fail(file, "cell " + std::to_string(cell) + ": " +
                     too_many_nodes(std::size_t(grid.offsets[cell + 1] - grid.offsets[cell])));
    }
    const Solid* solid = find_solid(type, all_solids);
    if (solid == nullptr) {
      ++skipped[type];
      continue;
    }
    is_curved = is_curved || solid->nodes > solid->corners;
    mesh.hexahedra.push_back(nodes_of(grid, cell, *solid, file));
    cells.push_back(static_cast<Index>(cell));
  }
  if (is_curved) warn_of_curved_cells(file, diagnostics);
  for (std::size_t type = 0; type < skipped.size(); ++type) {
    if (skipped[type] > 0) mesh.skipped_cells[name_of(std::uint8_t(type))] += skipped[type];
  }
  mesh.points = std::move(grid.points);
  for (VtkGrid::Labels& labels : grid.labels) {
    const std::size_t expected = labels.of_cells ? grid.types.size() : mesh.points.size();
    if (labels.values.size() != expected) {
      fail(file, "array " + quote(labels.name) + " has " + grouped(labels.values.size()) +
                     " values for " + grouped(expected) + (labels.of_cells ? " cells" : " points"));
    }
    add_labels(mesh, labels, cells);
  }
  for (MeshArray& array : grid.arrays) {
    const std::size_t expected = array.of_elements ? grid.types.size() : mesh.points.size();
    if (!array.values.empty() && array.values.size() != array.components * expected) {
      array.values.clear();
      array.unreadable = "its number of values is not that of the " +
                         std::string(array.of_elements ? "cells" : "points");
    }
    add_array(mesh, std::move(array), cells);
  }
  return mesh;
}

}  // namespace suture
