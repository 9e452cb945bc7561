// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/fill_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "kernel/base/sort_unique.hpp"
#include "kernel/geometry/surface_file.hpp"
#include "kernel/parts/carry_sets.hpp"
#include "kernel/parts/clip.hpp"
#include "kernel/parts/cube_sides.hpp"
#include "kernel/parts/filled_cubes.hpp"
#include "kernel/parts/moments.hpp"
#include "kernel/parts/shape_boundary.hpp"

namespace suture {
namespace {

/// The volume that a cell of the shape has in an element.
struct Share {
  Index element, cell;
  double volume;
};

/// Ascending by element, then by cell.
std::vector<Share> shares_of(const Mesh& shape, const FilledCubes& cubes) {
  std::vector<Share> shares;
  for (Index cell = 0; cell < shape.hexahedra.size(); ++cell) {
    std::array<Vec3, 8> corners;
    for (std::size_t i = 0; i < 8; ++i) corners[i] = shape.points[shape.hexahedra[cell][i]];
    for (const auto& tetrahedron : tetrahedra_of(corners)) {
      if (six_volumes(tetrahedron) == 0) continue;
      Box box = no_box;
      for (const Vec3& corner : tetrahedron) include(box, corner);
      cubes.for_each_in(box, [&](Index element) {
        const double volume = volume_within(tetrahedron, cubes.box_of(element));
        if (volume > 0) shares.push_back({element, cell, volume});
      });
    }
  }
  std::sort(shares.begin(), shares.end(), [](const Share& a, const Share& b) {
    return a.element != b.element ? a.element < b.element : a.cell < b.cell;
  });
  return shares;
}

/// Cells that belong to the same sets are one material.
struct Materials {
  std::vector<Index> of_cell;
  std::map<std::string, std::vector<Index>> sets;  ///< the materials of each set, ascending
};

Materials materials_of(const Mesh& shape) {
  Materials materials;
  materials.of_cell.assign(shape.hexahedra.size(), 0);
  Index count = 1;
  for (const auto& [name, cells] : shape.element_sets) {
    std::map<Index, Index> divided;  // by each set
    for (const Index cell : cells) {
      const auto [found, is_new] = divided.emplace(materials.of_cell[cell], count);
      if (is_new) ++count;
      materials.of_cell[cell] = found->second;
    }
  }
  for (const auto& [name, cells] : shape.element_sets) {
    std::vector<Index>& set = materials.sets[name];
    for (const Index cell : cells) set.push_back(materials.of_cell[cell]);
    sort_unique(set);
  }
  return materials;
}

/// Calls work(element, shares from, to) for each element that has some.
template <class Work>
void for_each_element(const std::vector<Share>& shares, Work&& work) {
  for (std::size_t i = 0, end = 0; i < shares.size(); i = end) {
    while (end < shares.size() && shares[end].element == shares[i].element) ++end;
    work(shares[i].element, shares.begin() + static_cast<std::ptrdiff_t>(i),
         shares.begin() + static_cast<std::ptrdiff_t>(end));
  }
}

void add_element_sets(const Mesh& shape, const std::vector<Share>& shares, Mesh& mesh,
                      Diagnostics& diagnostics) {
  if (shape.element_sets.empty()) return;
  const Materials materials = materials_of(shape);
  std::vector<Content> contents;
  for_each_element(shares, [&](Index element, auto share, auto end) {
    std::map<Index, double> volumes;
    for (; share != end; ++share) volumes[materials.of_cell[share->cell]] += share->volume;
    for (const auto& [material, volume] : volumes) contents.push_back({element, material, volume});
  });
  carry_sets(contents, materials.sets, mesh, diagnostics);
}

void add_arrays(const Mesh& shape, const std::vector<Share>& shares, Mesh& mesh) {
  for (MeshArray array : shape.arrays) {
    if (!array.of_elements && array.unreadable.empty())
      array.unreadable = "its values belong to points; save a value per cell";
    const std::size_t n = array.components;
    const std::vector<double> given = std::move(array.values);
    array.values.clear();
    if (array.of_elements && !given.empty()) {
      array.values.assign(n * mesh.hexahedra.size(), std::numeric_limits<double>::quiet_NaN());
      for_each_element(shares, [&](Index element, auto begin, auto end) {
        for (std::size_t c = 0; c < n; ++c) {
          double sum = 0, volume = 0;
          for (auto share = begin; share != end; ++share) {
            const double value = given[n * share->cell + c];
            if (std::isnan(value)) continue;
            sum += share->volume * value;
            volume += share->volume;
          }
          if (volume > 0) array.values[n * element + c] = sum / volume;
        }
      });
    }
    mesh.arrays.push_back(std::move(array));
  }
}

/// By node: whether it lies outside the material.
std::vector<std::uint8_t> outer_nodes(const Mesh& mesh) {
  std::vector<std::uint8_t> is_outer(mesh.points.size(), 0);
  for (const Index element : mesh.parts.elements)
    for (const Index node : mesh.hexahedra[element]) is_outer[node] = 1;
  for (const EmbeddedPoint& point : mesh.parts.points)
    if (const EdgeEnds ends(point.at); ends.is_corner())
      is_outer[mesh.hexahedra[point.element][ends.low]] = 0;
  return is_outer;
}

std::vector<Vec3> places_of(const Mesh& shape, const ShapeFace& face) {
  std::vector<Vec3> places;
  for (std::size_t c = 0; c < face.size; ++c) places.push_back(shape.points[face.corners[c]]);
  return places;
}

void add_point_sets(const Mesh& shape, const std::vector<ShapeFace>& faces,
                    const FilledCubes& cubes, Mesh& mesh) {
  const std::vector<std::uint8_t> is_outer = outer_nodes(mesh);
  for (const auto& [name, points] : shape.point_sets) {
    std::vector<Index>& members = mesh.point_sets[name];
    std::vector<Vec3> in_set;
    for (const Index point : points) in_set.push_back(shape.points[point]);
    std::sort(in_set.begin(), in_set.end());
    const auto is_in_set = [&](const Vec3& place) {
      return std::binary_search(in_set.begin(), in_set.end(), place);
    };
    for (const ShapeFace& face : faces) {
      const std::vector<Vec3> places = places_of(shape, face);
      if (!std::all_of(places.begin(), places.end(), is_in_set)) continue;
      Box box = no_box;
      for (const Vec3& place : places) include(box, place);
      cubes.for_each_in(box, [&](Index element) {
        if (!meets(places, cubes.box_of(element))) return;
        for (const Index node : mesh.hexahedra[element])
          if (is_outer[node] != 0) members.push_back(node);
      });
    }
    if (members.empty())
      for (const Vec3& place : in_set)
        cubes.for_each_in({place, place}, [&](Index element) {
          members.insert(members.end(), mesh.hexahedra[element].begin(),
                         mesh.hexahedra[element].end());
        });
    sort_unique(members);
  }
}

}  // namespace

Mesh fill_shape(const Mesh& shape, const CubeSize& size, bool repair, Diagnostics& diagnostics,
                const std::string& repair_option) {
  const std::vector<ShapeFace> faces = boundary_of(shape);
  Mesh mesh = fill_surface(close_surface(soup_of(shape, faces), repair, diagnostics, repair_option),
                           size, diagnostics);
  const FilledCubes cubes(mesh);
  const std::vector<Share> shares = shares_of(shape, cubes);
  add_element_sets(shape, shares, mesh, diagnostics);
  add_arrays(shape, shares, mesh);
  add_point_sets(shape, faces, cubes, mesh);
  return mesh;
}

}  // namespace suture
