// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/solid_cases.hpp"

#include <algorithm>
#include <map>

#include "apps/suture-bench/isosurface.hpp"
#include "kernel/geometry/voxelize.hpp"
#include "kernel/mesh/box.hpp"

namespace suture::bench {
namespace {

using Json = nlohmann::json;

std::vector<WorkMesh> bars(std::initializer_list<Index> sections) {
  std::vector<WorkMesh> meshes;
  for (const Index n : sections) meshes.push_back({{4 * n, n, n}});
  return meshes;
}

std::vector<WorkMethod> both_elements(const std::vector<WorkMesh>& meshes) {
  return {static_method("tm-faure", "mean-gradient", meshes),
          static_method("tm-faure", "trilinear", meshes)};
}

Json node_at(const Vec3& p) {
  constexpr double tolerance = 1e-7;
  Vec3 low = p, high = p;
  for (std::size_t c = 0; c < 3; ++c) {
    low[c] -= tolerance;
    high[c] += tolerance;
  }
  return {{"name", "tip"},
          {"fields", {"displacement"}},
          {"where", {{"box", {{"min", low}, {"max", high}}}}}};
}

// --------------------------------------------------------------------- twist --

Json twist_scene(const WorkMesh& mesh, const WorkMethod& method) {
  Json scene = box_scene(mesh, {1, 0.25, 0.25}, method, {{"E", 4e5}, {"nu", 0.3}, {"rho", 1000}});
  scene["mesh"]["box"]["origin"] = {0, -0.125, -0.125};
  scene["constraints"] = {held("x0"),
                          {{"move", {{"rotation", {{"axis", {1, 0, 0}}, {"angle", 90}}}}},
                           {"ramp", 1},
                           {"where", {{"set", "x1"}}}}};
  scene["output"] =
      tables({{"name", "grip"}, {"fields", {"reaction_moment"}}, {"where", {{"set", "x1"}}}});
  return scene;
}

// ------------------------------------------------------------------ membrane --

// A plate with corners (0, 0), (48, 44), (48, 60), (0, 44) mm, E = 70 MPa, nu = 1/3, plane strain,
// a shear traction of 6.25 MPa on its right side: here a hundred-thousandth of it, so that the
// problem is the linear one.
constexpr double membrane_part = 1e-5, membrane_thickness = 1e-3;

Mesh membrane(const WorkMesh& cells) {
  Mesh mesh = make_box({{}, {1, 1, 1}, cells.cells, {1, 1, 1}});
  for (Vec3& p : mesh.points) {
    const double low = 0.044 * p[0], high = 0.044 + 0.016 * p[0];
    p = {0.048 * p[0], low + (high - low) * p[1], membrane_thickness * p[2]};
  }
  return mesh;
}

Json membrane_scene(const WorkMesh& mesh, const WorkMethod& method) {
  Json scene = box_scene(mesh, {1, 1, 1}, method, {{"E", 70e6}, {"nu", 1.0 / 3}, {"rho", 1000}});
  scene["mesh"] = {{"file", WorkCase::mesh_file}};
  scene["constraints"] = {held("x0"),
                          {{"fix", "z"}, {"where", {{"set", "z0"}}}},
                          {{"fix", "z"}, {"where", {{"set", "z1"}}}}};
  scene["loads"] = {{{"traction", {0, 6.25e6 * membrane_part, 0}}, {"where", {{"set", "x1"}}}}};
  scene["output"] = tables(node_at({0.048, 0.060, 0}));
  return scene;
}

// --------------------------------------------------------------------- slit --

/// The faces of the middle section in its upper half, by the elements on both sides.
Json slit_faces(const WorkMesh& mesh) {
  const auto [nx, ny, nz] = mesh.cells;
  Json faces = Json::array();
  for (Index z = 0; z < nz; ++z)
    for (Index y = ny / 2; y < ny; ++y) {
      const Index left = nx / 2 - 1 + nx * (y + ny * z);
      faces.push_back({left, left + 1});
    }
  return faces;
}

Json slit_scene(const WorkMesh& mesh, const WorkMethod& method) {
  static const Cantilever what{"slit", 0.98, 0.3, {}, 0};
  Json scene = cantilever_scene(what, mesh, method);
  scene["events"] = {{{"at", 0}, {"cut", {{"faces", slit_faces(mesh)}}}}};
  return scene;
}

// -------------------------------------------------------------------- organ --

/// A bent ellipsoid, 11 x 6 x 4.4 cm, in about 300 cubes.
const Mesh& kidney() {
  static const Mesh mesh = [] {
    const auto value = [](const Vec3& p) {
      const double x = p[0] / 0.055, y = (p[1] + 0.01 - 10 * p[0] * p[0]) / 0.03, z = p[2] / 0.022;
      return x * x + y * y + z * z - 1;
    };
    Diagnostics ignored;
    return voxelize(isosurface(value, {0, 0, 0}, 0.1, 0.004), {.cells = 300}, ignored);
  }();
  return mesh;
}

/// Every hexahedron in n x n x n parts. Points are known by the corners that they lie between, with
/// their weights.
Mesh divided(const Mesh& coarse, Index n) {
  Mesh fine;
  std::map<std::vector<std::pair<Index, Index>>, Index> numbers;
  const auto point = [&](const Hexahedron& corners, Index x, Index y, Index z) {
    std::vector<std::pair<Index, Index>> weights;
    for (Index i = 0; i < 8; ++i) {
      const Index weight = (i & 1 ? x : n - x) * (i & 2 ? y : n - y) * (i & 4 ? z : n - z);
      if (weight > 0) weights.emplace_back(corners[i], weight);
    }
    std::ranges::sort(weights);
    const auto [known, is_new] =
        numbers.try_emplace(weights, static_cast<Index>(fine.points.size()));
    if (!is_new) return known->second;
    Vec3 p{};
    for (const auto& [corner, weight] : weights)
      for (std::size_t c = 0; c < 3; ++c)
        p[c] += coarse.points[corner][c] * weight / (1.0 * n * n * n);
    fine.points.push_back(p);
    return known->second;
  };
  for (const Hexahedron& corners : coarse.hexahedra)
    for (Index part = 0; part < n * n * n; ++part) {
      const Index x = part % n, y = part / n % n, z = part / n / n;
      Hexahedron& hexahedron = fine.hexahedra.emplace_back();
      for (Index i = 0; i < 8; ++i)
        hexahedron[i] = point(corners, x + (i & 1), y + (i >> 1 & 1), z + (i >> 2 & 1));
    }
  return fine;
}

/// Held are the first two layers of voxels, loaded by a tenth of its weight, as in a liquid.
Json organ_scene(const WorkMesh& mesh, const WorkMethod& method) {
  const std::vector<Vec3>& points = kidney().points;
  const auto along = [](const Vec3& p) { return p[0]; };
  const auto [first, last] = std::ranges::minmax_element(points, {}, along);
  const Hexahedron& voxel = kidney().hexahedra.front();
  const double edge = points[voxel[1]][0] - points[voxel[0]][0];
  Json scene = box_scene(mesh, {1, 1, 1}, method, {{"E", 4e4}, {"nu", 0.45}, {"rho", 1050}});
  scene["mesh"] = {{"file", WorkCase::mesh_file}};
  scene["gravity"] = {0, 0, -0.98};
  scene["constraints"] = {
      {{"fix", "xyz"},
       {"where", {{"box", {{"min", {-1, -1, -1}}, {"max", {(*first)[0] + 2.01 * edge, 1, 1}}}}}}}};
  scene["output"] = tables(node_at(*last));
  return scene;
}

}  // namespace

// --------------------------------------------------------------------- cases --

WorkCase twist_case() {
  return {"twist by 90 degrees",
          135.254,
          "CalculiX, C3D20R on 12x3x3 to 24x6x6 elements, extrapolated with their order of 2.3; "
          "the last is 0.04 % above",
          twist_scene,
          "grip reaction_moment x [N m]",
          1,
          both_elements(bars({1, 2, 3, 5, 8, 10, 14, 20})),
          {{"C3D8", "SPOOLES", bars({3, 5, 8})},
           {"C3D8I", "SPOOLES", bars({1, 2, 3, 5, 8})},
           {"C3D20R", "SPOOLES", bars({2, 3, 4, 5})},
           {"C3D8I", "ITERATIVE CHOLESKY", bars({8})},
           {"C3D20R", "ITERATIVE CHOLESKY", bars({5})}},
          {},
          {"C3D20R", "SPOOLES", bars({3, 4, 6})}};
}

WorkCase membrane_case() {
  std::vector<WorkMesh> meshes;
  for (const Index n : {2u, 4u, 8u, 16u, 32u, 64u, 128u}) meshes.push_back({{n, n, 1}});
  return {"Cook's membrane",
          3.22998e-7,
          "CalculiX, C3D20 on 32x32 to 128x128 elements, extrapolated with their order of 1.1; the "
          "last is 0.06 % below. Very fine meshes of CalculiX and Elmer by others: 3.227e-7 and "
          "3.228e-7 (solids4foam, tutorial cooksMembrane)",
          membrane_scene,
          "tip displacement y [m]",
          1,
          both_elements(meshes),
          {{"C3D8", "SPOOLES", {meshes.begin(), meshes.end() - 1}},
           {"C3D8I", "SPOOLES", {meshes.begin(), meshes.end() - 1}},
           {"C3D20", "SPOOLES", {meshes.begin(), meshes.end() - 2}},
           {"C3D8I", "ITERATIVE CHOLESKY", {meshes[4]}}},
          membrane,
          {"C3D20", "SPOOLES", {{{32, 32, 1}}, {{64, 64, 1}}, {{128, 128, 1}}}}};
}

WorkCase slit_case() {
  return {"cantilever with a slit",
          -0.0861762,
          "CalculiX, C3D20R on 16x4x4 to 40x10x10 elements, extrapolated with their order of 1.05 "
          "(theory, at the tip of a crack: 1); the last is 1.5 % below",
          slit_scene,
          "tip displacement y [m]",
          1,
          both_elements(bars({2, 4, 6, 8, 10, 14, 20})),
          {{"C3D8", "SPOOLES", bars({2, 4, 6, 8})},
           {"C3D8I", "SPOOLES", bars({2, 4, 6, 8})},
           {"C3D20R", "SPOOLES", bars({2, 4, 6})},
           {"C3D8I", "ITERATIVE CHOLESKY", bars({8})},
           {"C3D20R", "ITERATIVE CHOLESKY", bars({6})}},
          {},
          {"C3D20R", "SPOOLES", bars({4, 6, 10})}};
}

WorkCase organ_case() {
  const std::vector<WorkMesh> meshes{{{1, 1, 1}}, {{2, 2, 2}}, {{3, 3, 3}}, {{4, 4, 4}}};
  return {
      "organ of voxels",
      -0.00349,
      "CalculiX, C3D20 with 1 and 2 and C3D8I with 2 and 3 cubes along the edge of a voxel, each "
      "extrapolated with the order 1.09 of a re-entrant edge: -0.003499 and -0.003485",
      organ_scene,
      "tip displacement z [m]",
      1,
      both_elements(meshes),
      {{"C3D8", "SPOOLES", {meshes.begin(), meshes.begin() + 2}},
       {"C3D8I", "SPOOLES", {meshes.begin(), meshes.begin() + 2}},
       {"C3D20", "SPOOLES", {meshes.begin(), meshes.begin() + 1}},
       {"C3D8I", "ITERATIVE CHOLESKY", {meshes[1], meshes[2]}}},
      [](const WorkMesh& mesh) { return divided(kidney(), mesh.cells[0]); },
      {"C3D8I", "ITERATIVE CHOLESKY", {meshes.begin() + 1, meshes.end()}}};
}

}  // namespace suture::bench
