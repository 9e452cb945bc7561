// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gmock/gmock.h>

#include <map>
#include <string>

#include "kernel/plugin_host/plugin_host.hpp"
#include "kernel/topology/import.hpp"
#include "tests/dynamics/rig.hpp"
#include "tests/parts/plane_parts.hpp"

namespace parts_test {

using Values = std::map<std::string, double>;

/// A body of one model from a mesh with parts. `may_grow`: cuts along blades make more of them.
struct PartBody : suture::Body {
  PartBody(const Mesh& mesh, const std::string& id, const Values& wanted, unsigned threads = 1,
           bool skip = true, bool may_grow = false)
      : suture::Body(import(mesh)) {
    if (may_grow) attributes().let_parts_grow(complex());
    static suture::PluginHost host;
    const suture_model& model = host.model(id);
    std::vector<double> values;
    for (const suture_parameter& p : std::span(model.parameters, model.parameter_count))
      values.push_back(wanted.contains(p.name) ? wanted.at(p.name) : p.default_value);
    suture::Diagnostics diagnostics;
    attributes().add(std::make_unique<suture::Instance>(model, id, values, diagnostics, skip),
                     complex(), {});
    compile(diagnostics, threads);
  }
  static suture::Imported import(const Mesh& mesh) {
    suture::Diagnostics diagnostics;
    return suture::import_mesh(mesh, {}, diagnostics);
  }

  Vec3 rest(Index v) { return row(attributes().rest(), v); }
  static Vec3 row(const suture::Column& column, Index v) {
    return {column.get(v, 0), column.get(v, 1), column.get(v, 2)};
  }
  void place(const std::function<Vec3(const Vec3&)>& where) {
    for (Index v = 0; v < attributes().vertex_count(); ++v) {
      const Vec3 x = where(rest(v));
      for (int c = 0; c < 3; ++c) attributes().position().set(v, c, x[static_cast<std::size_t>(c)]);
    }
  }
  /// Moves nodes at random, the same in all bodies with the same nodes.
  void shake(double amount, unsigned seed) {
    place([&](const Vec3& x) {
      const auto key = static_cast<std::uint64_t>(
          static_cast<std::int64_t>(1e6 * (x[0] + 7 * x[1] + 53 * x[2])));
      std::mt19937_64 random(seed + key);
      Vec3 moved = x;
      for (double& c : moved) c += between(random, -amount, amount);
      return moved;
    });
  }
  /// 3 numbers per vertex.
  std::vector<double> forces(double dt = 0) {
    suture::Column& force = attributes().force();
    std::fill(force.rows(), force.rows() + std::size_t{force.size()} * 4, 0.0);
    models().add_forces(0, dt);
    std::vector<double> values;
    for (Index v = 0; v < attributes().vertex_count(); ++v)
      for (int c = 0; c < 3; ++c) values.push_back(force.get(v, c));
    return values;
  }
  void state(suture::Archive& archive) {
    archive("map", complex());
    archive("attributes", attributes());
    archive("loop", models());
  }
  double total_mass() {
    double sum = 0;
    for (Index v = 0; v < attributes().vertex_count(); ++v) sum += attributes().mass().get(v, 0);
    return sum;
  }
  Vec3 momentum() {
    Vec3 sum{};
    for (Index v = 0; v < attributes().vertex_count(); ++v)
      for (std::size_t c = 0; c < 3; ++c)
        sum[c] +=
            attributes().mass().get(v, 0) * attributes().velocity().get(v, static_cast<int>(c));
    return sum;
  }
  std::vector<suture::Dart> inner_faces() {
    std::vector<suture::Dart> faces;
    for (Index e = 0; e < complex().element_count(); ++e)
      for (int f = 0; f < 6; ++f)
        if (const suture::Dart d = 24 * e + 4 * static_cast<suture::Dart>(f);
            complex().can_cut(d) && complex().beta3(d) > d)
          faces.push_back(d);
    return faces;
  }
};

using Matrix = std::array<Vec3, 3>;
/// A gradient of a deformation.
inline constexpr Matrix stretched{{{1.1, 0.2, -0.1}, {0.05, 0.9, 0.1}, {-0.15, 0.1, 1.2}}};

inline Vec3 mapped(const Matrix& m, const Vec3& x) {
  return {suture::dot(m[0], x), suture::dot(m[1], x), suture::dot(m[2], x)};
}

/// First Piola-Kirchhoff stress of a St Venant-Kirchhoff solid.
inline Matrix stress_of(const Matrix& F, double young, double nu) {
  const double lambda = young * nu / ((1 + nu) * (1 - 2 * nu)), mu = young / (2 * (1 + nu));
  Matrix E{}, S{}, P{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) E[i][j] += F[k][i] * F[k][j] / 2;
      E[i][j] -= i == j ? 0.5 : 0;
    }
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      S[i][j] = 2 * mu * E[i][j] + (i == j ? lambda * (E[0][0] + E[1][1] + E[2][2]) : 0);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) P[i][j] += F[i][k] * S[k][j];
  return P;
}

/// All vertices have moved by the same amount, downwards along y.
inline void expect_uniform_fall(const rig::Rig& rig, Index vertices) {
  const double fallen = rig.shift(0, 1);
  EXPECT_LT(fallen, 0);
  for (Index v = 0; v < vertices; ++v) {
    EXPECT_NEAR(rig.shift(v, 1) / fallen, 1, 1e-9);
    EXPECT_NEAR(rig.shift(v, 0) / fallen, 0, 1e-9);
  }
}

}  // namespace parts_test
