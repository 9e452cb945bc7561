// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/solid_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "kernel/base/vec3.hpp"

namespace suture::bench {
namespace {

// The corners of CalculiX's element in X0..X7, and its edges and sides in its own corners.
constexpr std::size_t corner_order[8] = {0, 1, 3, 2, 4, 5, 7, 6};
constexpr std::size_t edges[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                      {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
/// Four corners around a side, then the nodes between them.
constexpr std::size_t sides[6][8] = {{0, 1, 2, 3, 8, 9, 10, 11},   {4, 5, 6, 7, 12, 13, 14, 15},
                                     {0, 1, 5, 4, 8, 17, 12, 16},  {1, 2, 6, 5, 9, 18, 13, 17},
                                     {2, 3, 7, 6, 10, 19, 14, 18}, {3, 0, 4, 7, 11, 16, 15, 19}};

Vec3 middle(const Vec3& a, const Vec3& b) {
  return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
}

/// The same for every element that has the side.
std::array<Index, 4> name_of_side(const std::vector<Index>& element, std::size_t side) {
  std::array<Index, 4> name{};
  for (std::size_t i = 0; i < 4; ++i) name[i] = element[sides[side][i]];
  std::ranges::sort(name);
  return name;
}

std::map<std::array<Index, 4>, std::vector<Index>> elements_of_sides(const SolidMesh& mesh) {
  std::map<std::array<Index, 4>, std::vector<Index>> found;
  for (Index e = 0; e < mesh.elements.size(); ++e)
    for (std::size_t s = 0; s < 6; ++s) found[name_of_side(mesh.elements[e], s)].push_back(e);
  return found;
}

// Shape functions of a side with four nodes, and with eight (serendipity), at (a, b) in [-1, 1]^2:
//   N_i = (1 + a a_i) (1 + b b_i) / 4
//   N_i = (1 + a a_i) (1 + b b_i) (a a_i + b b_i - 1) / 4 at corners,
//   N_i = (1 - a^2) (1 + b b_i) / 2 and (1 + a a_i) (1 - b^2) / 2 between them.
constexpr double place[8][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1},
                                {0, -1},  {1, 0},  {0, 1}, {-1, 0}};

double bilinear(std::size_t i, double a, double b) {
  return (1 + a * place[i][0]) * (1 + b * place[i][1]) / 4;
}

double serendipity(std::size_t i, double a, double b) {
  const double x = a * place[i][0], y = b * place[i][1];
  if (i < 4) return (1 + x) * (1 + y) * (x + y - 1) / 4;
  return i % 2 == 0 ? (1 - a * a) * (1 + y) / 2 : (1 + x) * (1 - b * b) / 2;
}

/// Area per (a, b) of the side with these corners.
double area_at(const std::array<Vec3, 4>& x, double a, double b) {
  Vec3 along{}, across{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      along[c] += place[i][0] * (1 + b * place[i][1]) / 4 * x[i][c];
      across[c] += place[i][1] * (1 + a * place[i][0]) / 4 * x[i][c];
    }
  const Vec3 normal = cross(along, across);
  return std::sqrt(dot(normal, normal));
}

/// Integral of each shape function over a side, by 3 x 3 Gauss points.
std::vector<double> shares(const std::array<Vec3, 4>& corners, bool quadratic) {
  const double points[3] = {-std::sqrt(0.6), 0, std::sqrt(0.6)};
  const double weights[3] = {5.0 / 9, 8.0 / 9, 5.0 / 9};
  std::vector<double> result(quadratic ? 8 : 4);
  for (int p = 0; p < 9; ++p) {
    const double a = points[p % 3], b = points[p / 3];
    const double area = weights[p % 3] * weights[p / 3] * area_at(corners, a, b);
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] += area * (quadratic ? serendipity(i, a, b) : bilinear(i, a, b));
  }
  return result;
}

}  // namespace

SolidMesh solid_mesh(const Mesh& mesh, bool quadratic) {
  SolidMesh solid{mesh.points, {}, {}, quadratic};
  for (Index v = 0; v < mesh.points.size(); ++v) solid.nodes.push_back({v, v});
  std::map<std::pair<Index, Index>, Index> middles;
  for (const Hexahedron& hexahedron : mesh.hexahedra) {
    std::vector<Index>& element = solid.elements.emplace_back();
    for (const std::size_t i : corner_order) element.push_back(hexahedron[i]);
    for (const auto& [i, j] : edges) {
      if (!quadratic) break;
      const auto [first, second] = std::minmax({element[i], element[j]});
      const auto [known, is_new] =
          middles.try_emplace({first, second}, static_cast<Index>(solid.nodes.size()));
      element.push_back(known->second);
      if (!is_new) continue;
      solid.nodes.push_back({first, second});
      solid.points.push_back(middle(mesh.points[first], mesh.points[second]));
    }
  }
  return solid;
}

Mesh with_slit(Mesh mesh, std::span<const std::pair<Index, Index>> cut) {
  if (cut.empty()) return mesh;
  const SolidMesh solid = solid_mesh(mesh, false);
  // Copies of nodes at elements' corners that uncut faces connect are one: union-find over 8 e + i.
  std::vector<std::size_t> parent(8 * solid.elements.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t c) {
    while (parent[c] != c) c = parent[c] = parent[parent[c]];
    return c;
  };
  const auto corner = [&](Index e, Index node) {
    return 8 * e + static_cast<std::size_t>(std::ranges::find(solid.elements[e], node) -
                                            solid.elements[e].begin());
  };
  for (const auto& [side, owners] : elements_of_sides(solid)) {
    if (owners.size() < 2) continue;
    const auto is_this = [&owners = owners](const auto& pair) {
      return std::minmax(pair.first, pair.second) == std::minmax(owners[0], owners[1]);
    };
    if (std::ranges::any_of(cut, is_this)) continue;
    for (const Index node : side)
      parent[root(corner(owners[0], node))] = root(corner(owners[1], node));
  }
  std::vector<std::size_t> owner(mesh.points.size(), parent.size());
  std::map<std::size_t, Index> copies;
  for (Index e = 0; e < solid.elements.size(); ++e)
    for (std::size_t i = 0; i < 8; ++i) {
      Index& node = mesh.hexahedra[e][corner_order[i]];
      const std::size_t group = root(8 * e + i);
      if (owner[node] == parent.size()) owner[node] = group;
      if (owner[node] == group) continue;
      const auto [copy, is_new] = copies.try_emplace(group, static_cast<Index>(mesh.points.size()));
      if (is_new) mesh.points.push_back(mesh.points[node]);
      node = copy->second;
    }
  return mesh;
}

std::vector<std::pair<Index, double>> loaded_nodes(
    const SolidMesh& mesh, const std::function<bool(Index corner)>& is_selected) {
  const auto owners = elements_of_sides(mesh);
  std::map<Index, double> sums;
  for (const std::vector<Index>& element : mesh.elements)
    for (std::size_t s = 0; s < 6; ++s) {
      const auto name = name_of_side(element, s);
      if (owners.at(name).size() > 1 || !std::ranges::all_of(name, is_selected)) continue;
      std::array<Vec3, 4> corners;
      for (std::size_t i = 0; i < 4; ++i) corners[i] = mesh.points[element[sides[s][i]]];
      const std::vector<double> of_nodes = shares(corners, mesh.quadratic);
      for (std::size_t i = 0; i < of_nodes.size(); ++i) sums[element[sides[s][i]]] += of_nodes[i];
    }
  return {sums.begin(), sums.end()};
}

}  // namespace suture::bench
