// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <random>

#include "kernel/dynamics/body.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/plugin_host/plugin_host.hpp"
#include "kernel/solvers/tangent_matrix.hpp"

namespace suture::test {

/// Elements of unit edge, so that centres of boxes are multiples of 1/2.
inline Mesh unit_box(std::array<Index, 3> cells, const Vec3& edges = {1, 1, 1}) {
  BoxOptions options;
  options.cells = cells;
  for (std::size_t c = 0; c < 3; ++c) options.size[c] = edges[c] * cells[c];
  return make_box(options);
}

/// The parts of a mesh that `keep` wants, by centre.
template <class Keep>
Mesh part_of(Mesh mesh, Keep keep) {
  std::erase_if(mesh.hexahedra, [&](const Hexahedron& x) {
    const Vec3 &low = mesh.points[x[0]], &high = mesh.points[x[7]];
    return !keep(Vec3{(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2});
  });
  return mesh;
}

/// Points moved by up to `part` of an edge.
inline Mesh distorted(Mesh mesh, double part) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> shift(-part, part);
  for (Vec3& point : mesh.points)
    for (double& x : point) x += shift(random);
  return mesh;
}

/// Whether to cut between two elements, by centre.
using IsCut = std::function<bool(const Vec3&, const Vec3&)>;

/// A body of one model whose vertices up to z = `held` are held, with its matrix at rest.
class SolverBody {
 public:
  struct Options {
    IsCut is_cut{};
    double nu = 0.3;
    const char* model = "tm-faure";
    double held = 1e-9;
    unsigned threads = 1;
  };
  explicit SolverBody(Mesh mesh) : SolverBody(std::move(mesh), Options()) {}
  SolverBody(Mesh mesh, const Options& options)
      : body_(import_mesh(std::move(mesh), {}, ignored_)) {
    add_model(options);
    if (options.is_cut) cut(options.is_cut);
    std::vector<Index> low;
    for (Index v = 0; v < attributes().vertex_count(); ++v)
      if (attributes().rest().get(v, 2) <= options.held) low.push_back(v);
    body_.constraints().add(low, 7, {}, attributes());
    matrix_.emplace(attributes(), body_.terms(), body_.models().workers());
    matrix_->set(0);
  }

  Body& body() { return body_; }
  const CellComplex& complex() { return body_.complex(); }
  Attributes& attributes() { return body_.attributes(); }
  TangentMatrix& matrix() { return *matrix_; }

  /// Weight along -y, N.
  std::vector<double> weight() {
    std::vector<double> b(matrix_->size());
    for (Index v = 0; v < attributes().vertex_count(); ++v)
      b[std::size_t{v} * 3 + 1] = -attributes().mass().get(v, 0);
    matrix_->restrict(b);
    return b;
  }
  /// The forces of a random displacement: what floats is in balance.
  std::vector<double> balanced_load() {
    std::mt19937 random(3);
    std::normal_distribution<double> value;
    std::vector<double> x(matrix_->size()), b(x.size());
    for (double& d : x) d = value(random);
    matrix_->restrict(x);
    matrix_->apply(x.data(), b.data());
    return b;
  }
  void cut(const IsCut& is_cut) {
    std::vector<Dart> faces;
    for (Index e = 0; e < complex().element_count(); ++e)
      for (int f = 0; f < 6; ++f) {
        const Index other = complex().neighbour(e, f);
        if (other != none && other > e && is_cut(centre(e), centre(other)))
          faces.push_back(24 * e + 4 * static_cast<Dart>(f));
      }
    body_.cut(faces);
  }

 private:
  void add_model(const Options& options) {
    static PluginHost host;
    const suture_model& model = host.model(options.model);
    std::vector<double> values;
    for (const suture_parameter& p : std::span(model.parameters, model.parameter_count)) {
      const std::string_view parameter = p.name;
      values.push_back(parameter == "E"     ? 1e5
                       : parameter == "nu"  ? options.nu
                       : parameter == "rho" ? 1000
                                            : p.default_value);
    }
    attributes().add(std::make_unique<Instance>(model, options.model, values, ignored_),
                     body_.complex(), {});
    body_.compile(ignored_, options.threads);
  }
  Vec3 centre(Index element) {
    Vec3 sum{};
    for (const Index v : complex().vertices_of(element))
      for (int c = 0; c < 3; ++c)
        sum[static_cast<std::size_t>(c)] += attributes().rest().get(v, c) / 8;
    return sum;
  }
  Diagnostics ignored_;
  Body body_;
  std::optional<TangentMatrix> matrix_;
};

/// A slit through half of the body, along its height.
inline bool slit(const Vec3& a, const Vec3& b) {
  return std::min(a[0], b[0]) < 2 && std::max(a[0], b[0]) > 2 && std::min(a[2], b[2]) > 4;
}

}  // namespace suture::test
