// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/cut_case.hpp"

#include <algorithm>
#include <cmath>

#include "apps/suture-bench/paper_body.hpp"
#include "kernel/geometry/voxelize.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/topology/dart.hpp"
#include "kernel/topology/face_matching.hpp"

namespace suture::bench {
namespace {

Mesh filled_body(const BodyPreset& preset) {
  Diagnostics diagnostics;
  return voxelize(generate_body(preset.parameters), {.cells = preset.cells}, diagnostics);
}

Vec3 centroid(const Mesh& mesh, Index element) {
  Vec3 sum{};
  for (const Index v : mesh.hexahedra[element])
    for (std::size_t c = 0; c < 3; ++c) sum[c] += mesh.points[v][c] / 8;
  return sum;
}

/// Faces between elements on different sides of planes; a face goes to the first plane.
class Slicer {
 public:
  explicit Slicer(const Mesh& mesh) : mesh_(mesh) {
    std::vector<MapFault> faults;
    links_ = match_faces(mesh.hexahedra, static_cast<Index>(mesh.points.size()), faults);
  }

  std::vector<Dart> slice(const Vec3& point, const Vec3& normal) {
    std::vector<bool> above(mesh_.hexahedra.size());
    for (Index e = 0; e < above.size(); ++e) {
      const Vec3 x = centroid(mesh_, e);
      double height = 0;
      for (std::size_t c = 0; c < 3; ++c) height += (x[c] - point[c]) * normal[c];
      above[e] = height >= 0;
    }
    std::vector<Dart> faces;
    for (Index e = 0; e < above.size(); ++e)
      for (const Dart face : sides_of(e)) {
        incidence::Link& link = links_[face / hexahedron::darts_per_face];
        if (link == none || above[link >> 5] == above[e]) continue;
        links_[corresponding_dart(link >> 5, link & 31) / hexahedron::darts_per_face] = none;
        link = none;
        faces.push_back(face);
      }
    return faces;
  }

 private:
  const Mesh& mesh_;
  std::vector<incidence::Link> links_;
};

}  // namespace

std::size_t CutCase::faces() const {
  std::size_t sum = 0;
  for (const auto& cut : cuts) sum += cut.size();
  return sum;
}

CutCase two_layers(Index n, std::size_t most) {
  CutCase result;
  result.name = std::to_string(n) + "x" + std::to_string(n) + "x2";
  const auto length = static_cast<double>(n);
  result.mesh = make_box({.size = {length, length, 2}, .cells = {n, n, 2}});
  std::vector<Dart>& faces = result.cuts.emplace_back();
  for (Index e = 0; e < n * n && faces.size() < most; ++e) faces.push_back(face_dart(e, 5));
  return result;
}

CutCase body_case(const std::string& name) {
  const BodyPreset& preset = body_preset(name);
  CutCase result;
  result.name = name;
  result.mesh = filled_body(preset);
  result.cuts.push_back(Slicer(result.mesh).slice(preset.cut_point, preset.cut_normal));
  return result;
}

CutCase ten_cuts() {
  CutCase result;
  result.name = "giraffe, ten cuts";
  result.mesh = filled_body(body_preset("giraffe"));
  Vec3 low = result.mesh.points[0], high = low;
  for (const Vec3& p : result.mesh.points)
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], p[c]);
      high[c] = std::max(high[c], p[c]);
    }
  Slicer slicer(result.mesh);
  for (int i = 0; i < 10; ++i) {
    const double t = (i + 0.5) / 10, angle = 2.4 * i;
    Vec3 point;
    for (std::size_t c = 0; c < 3; ++c) point[c] = low[c] + t * (high[c] - low[c]);
    result.cuts.push_back(
        slicer.slice(point, {std::cos(angle), 0.3 * std::sin(3 * angle), std::sin(angle)}));
  }
  return result;
}

}  // namespace suture::bench
