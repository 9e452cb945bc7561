// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/solve_case.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include "apps/suture-bench/body.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/dynamics/pieces.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "kernel/topology/dart.hpp"

namespace suture::bench {
namespace {

Mesh box(std::array<Index, 3> cells, Vec3 proportions = {1, 1, 1}) {
  BoxOptions options;
  options.cells = cells;
  const double edge = 0.25 / std::max(cells[0], cells[1]);
  for (std::size_t c = 0; c < 3; ++c) options.size[c] = edge * proportions[c] * cells[c];
  return make_box(options);
}

Mesh distorted(Mesh mesh, double part) {
  std::mt19937 random(1);
  const double edge = mesh.points[1][0] - mesh.points[0][0];
  std::uniform_real_distribution<double> shift(-part * edge, part * edge);
  for (Vec3& point : mesh.points)
    for (double& x : point) x += shift(random);
  return mesh;
}

/// The cells of a grid whose centres satisfy `is_inside`, by their distance from the middle.
template <class Inside>
Mesh voxels(Index n, Inside is_inside) {
  Mesh mesh = box({n, n, n});
  const double edge = mesh.points[1][0] - mesh.points[0][0], middle = n * edge / 2;
  std::erase_if(mesh.hexahedra, [&](const Hexahedron& x) {
    Vec3 from{};
    for (std::size_t c = 0; c < 3; ++c) from[c] = mesh.points[x[0]][c] + edge / 2 - middle;
    return !is_inside(std::sqrt(dot(from, from)) / middle);
  });
  return mesh;
}

/// Cuts between elements on both sides of a wave across x, over most of the body's height.
auto zigzag(Index n) {
  return [n](const Vec3& a, const Vec3& b) {
    const double middle = n / 2.0;
    const auto side = [&](const Vec3& p) {
      return p[0] > middle + std::abs(std::fmod(p[2], 8.0) - 4) - 2;
    };
    return side(a) != side(b) && std::max(a[1], b[1]) < 0.8 * n && std::min(a[2], b[2]) > n / 2.0;
  };
}

/// Slits every 4 cells, from both sides in turn, that leave a fifth of the width.
auto comb(Index n) {
  return [n](const Vec3& a, const Vec3& b) {
    const double slit = std::floor(std::max(a[2], b[2]) / 4);
    if (slit == std::floor(std::min(a[2], b[2]) / 4)) return false;
    const bool from_left = std::fmod(slit, 2) == 0;
    return from_left ? a[0] < 0.8 * n : a[0] > 0.2 * n;
  };
}

auto random_cuts(double part) {
  return [part, random = std::mt19937(1)](const Vec3&, const Vec3&) mutable {
    return std::uniform_real_distribution<double>()(random) < part;
  };
}

void cut(Body& body, const SolveCase& what, double edge) {
  const CellComplex& complex = body.complex();
  const auto scaled_centre = [&](Index e) {
    Vec3 centre = centre_of(body, e);
    for (double& x : centre) x /= edge;
    return centre;
  };
  std::vector<Dart> faces;
  for (Index e = 0; e < complex.element_count(); ++e)
    for (int f = 0; f < hexahedron::faces; ++f) {
      const Index other = complex.neighbour(e, f);
      if (other != none && other > e && what.is_cut(scaled_centre(e), scaled_centre(other)))
        faces.push_back(face_dart(e, f));
    }
  body.cut(faces);
}

/// Holds the lowest part, and the pieces that hang on none of it.
void hold(Body& body, double part) {
  Attributes& attributes = body.attributes();
  const auto height = [&](Index v) { return attributes.rest().get(v, 2); };
  double low = height(0), top = low;
  for (Index v = 0; v < attributes.vertex_count(); ++v) {
    low = std::min(low, height(v));
    top = std::max(top, height(v));
  }
  const std::vector<Index> piece = pieces_of(body.complex(), attributes);
  const auto is_low = [&](Index v) { return height(v) <= low + (part + 1e-9) * (top - low); };
  std::vector<bool> hangs(piece.size());
  for (Index v = 0; v < piece.size(); ++v)
    if (piece[v] != none && is_low(v)) hangs[piece[v]] = true;
  std::vector<Index> held;
  for (Index v = 0; v < piece.size(); ++v)
    if (piece[v] != none && (is_low(v) || !hangs[piece[v]])) held.push_back(v);
  body.constraints().add(held, 7, {}, attributes);
}

}  // namespace

Vec3 centre_of(const Body& body, Index element) {
  Vec3 centre{};
  const double* rest = const_cast<Body&>(body).attributes().rest().rows();  // NOLINT: read only
  for (const Index v : body.complex().vertices_of(element))
    for (std::size_t c = 0; c < 3; ++c) centre[c] += rest[std::size_t{v} * 4 + c] / 8;
  return centre;
}

std::vector<SolveCase> solve_cases(Index n) {
  const Mesh beam = box({n, n, 4 * n});
  const Index across = std::max(n / 2, Index{2}), ball = n * 2;
  const double thickness = 2.5 / n;
  std::vector<SolveCase> cases;
  cases.push_back({.name = "beam", .mesh = beam});
  cases.push_back({.name = "zig-zag", .mesh = beam, .is_cut = zigzag(n)});
  cases.push_back({.name = "comb", .mesh = beam, .is_cut = comb(n)});
  cases.push_back({.name = "random 10 %", .mesh = beam, .is_cut = random_cuts(0.1)});
  cases.push_back({.name = "random 25 %", .mesh = beam, .is_cut = random_cuts(0.25)});
  cases.push_back({.name = "nu 0.45", .mesh = beam, .nu = 0.45});
  cases.push_back({.name = "nu 0.49", .mesh = beam, .nu = 0.49});
  cases.push_back({.name = "nu 0.499", .mesh = beam, .nu = 0.499});
  cases.push_back({.name = "box 10:1:1", .mesh = box({n, n, 4 * n}, {1, 1, 10})});
  cases.push_back({.name = "box 10:10:1", .mesh = box({n, n, 4 * n}, {10, 10, 1})});
  cases.push_back({.name = "plate", .mesh = box({1, 4 * across, 8 * across})});
  cases.push_back(
      {.name = "ball", .mesh = voxels(ball, [](double r) { return r < 1; }), .held = 0.1});
  cases.push_back({.name = "shell",
                   .mesh = voxels(ball, [&](double r) { return r < 1 && r > 1 - thickness; }),
                   .held = 0.1});
  cases.push_back({.name = "distorted", .mesh = distorted(beam, 0.2), .held = 0.02});
  cases.push_back(
      {.name = "distorted comb", .mesh = distorted(beam, 0.2), .held = 0.02, .is_cut = comb(n)});
  cases.push_back({.name = "springs", .mesh = beam, .model = "mss-baudet"});
  return cases;
}

SolveCase case_of_file(const std::string& path) {
  Diagnostics ignored;
  return {
      .name = std::filesystem::path(path).stem(), .mesh = read_mesh(path, 1, ignored), .held = 0.1};
}

std::unique_ptr<Body> body_of(const SolveCase& what, PluginHost& host) {
  Diagnostics ignored;
  Mesh mesh = what.mesh;
  auto body = std::make_unique<Body>(import_mesh(std::move(mesh), {}, ignored));
  const suture_model& model = host.model(what.model);
  body->attributes().add(std::make_unique<Instance>(
                             model, what.model, parameters_of(model, {{"nu", what.nu}}), ignored),
                         body->complex(), {});
  body->compile(ignored, 1);
  const double edge =
      what.mesh.points.size() > 1 ? what.mesh.points[1][0] - what.mesh.points[0][0] : 1;
  if (what.is_cut) cut(*body, what, edge);
  hold(*body, what.held);
  return body;
}

}  // namespace suture::bench
