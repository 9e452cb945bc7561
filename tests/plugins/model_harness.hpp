// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/base/aligned.hpp"
#include "kernel/base/types.hpp"
#include "suture/plugin.h"
#include "tests/plugins/parameter_columns.hpp"

namespace suture::testing {

/// Hexahedra for a test of a model. `identity` names the vertex that a point is
/// a copy of: in a periodic cell several points are one vertex.
struct HarnessMesh {
  std::vector<Vec3> points;
  std::vector<Hexahedron> elements;
  std::vector<Index> identity;
  Index vertices = 0;
};

/// nx x ny x nz boxes of the given edge lengths; `periodic` identifies opposite
/// sides (then at least 3 cells per direction: an edge is named by its vertices).
inline HarnessMesh box_mesh(std::array<Index, 3> n, Vec3 l, bool periodic = false) {
  HarnessMesh mesh;
  std::map<std::array<Index, 3>, Index> numbers;
  for (Index k = 0; k <= n[2]; ++k)
    for (Index j = 0; j <= n[1]; ++j)
      for (Index i = 0; i <= n[0]; ++i) {
        mesh.points.push_back({i * l[0], j * l[1], k * l[2]});
        const std::array<Index, 3> at =
            periodic ? std::array{i % n[0], j % n[1], k % n[2]} : std::array{i, j, k};
        mesh.identity.push_back(numbers.try_emplace(at, numbers.size()).first->second);
      }
  mesh.vertices = static_cast<Index>(numbers.size());
  const auto at = [&](Index i, Index j, Index k) { return i + (n[0] + 1) * (j + (n[1] + 1) * k); };
  for (Index k = 0; k < n[2]; ++k)
    for (Index j = 0; j < n[1]; ++j)
      for (Index i = 0; i < n[0]; ++i) {
        Hexahedron h;
        for (Index c = 0; c < 8; ++c) h[c] = at(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2 & 1));
        mesh.elements.push_back(h);
      }
  return mesh;
}

/// What a model reported.
struct Report {
  std::int32_t severity;
  std::uint32_t cell;
  std::string key, text;
};

/// Thrown when a function of the model returned a status.
struct ModelFailure : std::runtime_error {
  ModelFailure(suture_status s, const suture_error& e)
      : std::runtime_error(e.text), status(s), cell(e.cell) {}
  suture_status status;
  std::uint32_t cell;
};

/// A host as plain as can be: the model's functors over all cells in order, one
/// thread. Slow, and independent of the kernel's stages.
class ModelHarness {
 public:
  ModelHarness(const suture_model& model, const std::map<std::string, double>& given,
               HarnessMesh mesh)
      : model_(model), mesh_(std::move(mesh)) {
    for (std::uint32_t i = 0; i < model.parameter_count; ++i) {
      const auto at = given.find(model.parameters[i].name);
      parameters_.push_back(at == given.end() ? model.parameters[i].default_value : at->second);
    }
    instance_.resize(model.instance_bytes + 8);
    error_.size = sizeof error_;
    context_ = {sizeof(suture_context),
                model.parameter_count,
                parameters_.data(),
                instance_.data(),
                &host(),
                &error_,
                &reports_};
    if (model.prepare != nullptr) check(model.prepare(&context_, instance_.data()));
    uniform_ = std::make_unique<suture::test::ParameterColumns>(model, parameters_.data());
    find_edges();
    for (std::uint32_t a = 0; a < model.attribute_count; ++a) sum(a);
  }

  const HarnessMesh& mesh() const { return mesh_; }
  const std::vector<Report>& reports() const { return reports_; }
  const std::vector<double>& mass() const { return mass_; }
  std::size_t edge_count() const { return edges_.size(); }
  const std::array<Index, 2>& edge(std::size_t e) const { return edges_[e]; }

  /// Values of an attribute: cell-major, components inside.
  const std::vector<double>& column(const std::string& name) const {
    for (std::uint32_t a = 0; a < model_.attribute_count; ++a)
      if (name == model_.attributes[a].name) return columns_[a];
    throw std::out_of_range(name);
  }

  /// Forces on all points. Throws ModelFailure.
  std::vector<Vec3> forces(const std::vector<Vec3>& x, const std::vector<Vec3>& v = {}) {
    std::vector<Vec3> out(mesh_.points.size(), Vec3{});
    for_batches(x, v, [&](const suture_functor& f, suture_batch& batch, const auto& nodes) {
      AlignedVector<double> force(std::size_t{24} * SUTURE_LANES, 0.0);
      batch.force = force.data();
      const auto status = f.force(&context_, &batch);
      for (const double value : force)
        if (!std::isfinite(value)) throw std::logic_error("a force is not finite");
      check(status);
      scatter(batch, nodes, force.data(), out);
    });
    return out;
  }

  /// df = df/dx dx + df/dv dv.
  std::vector<Vec3> tangent(const std::vector<Vec3>& x, const std::vector<Vec3>& v,
                            const std::vector<Vec3>& dx, const std::vector<Vec3>& dv) {
    std::vector<Vec3> out(mesh_.points.size(), Vec3{});
    for_batches(x, v, [&](const suture_functor& f, suture_batch& batch, const auto& nodes) {
      const auto* e = static_cast<const suture_tangent_1*>(f.extension(SUTURE_TANGENT_1));
      AlignedVector<double> df(std::size_t{24} * SUTURE_LANES, 0.0);
      const auto dx_batch = gather(dx, nodes), dv_batch = gather(dv, nodes);
      check(e->apply(&context_, &batch, dx_batch.data(), dv_batch.data(), df.data()));
      scatter(batch, nodes, df.data(), out);
    });
    return out;
  }

  double energy(const std::vector<Vec3>& x) {
    double sum = 0;
    for_batches(x, {}, [&](const suture_functor& f, suture_batch& batch, const auto&) {
      const auto* e = static_cast<const suture_energy_1*>(f.extension(SUTURE_ENERGY_1));
      AlignedVector<double> out(SUTURE_LANES);
      check(e->energy(&context_, &batch, out.data()));
      for (std::uint32_t lane = 0; lane < batch.valid; ++lane) sum += out[lane];
    });
    return sum;
  }

  /// Summed bounds per point: 6 stiffness components, then 6 of damping.
  std::vector<std::array<double, 12>> bounds(const std::vector<Vec3>& x,
                                             const std::vector<Vec3>& v = {}) {
    std::vector<std::array<double, 12>> out(mesh_.points.size(), std::array<double, 12>{});
    for_batches(x, v, [&](const suture_functor& f, suture_batch& batch, const auto& nodes) {
      const auto* e = static_cast<const suture_stable_dt_1*>(f.extension(SUTURE_STABLE_DT_1));
      AlignedVector<double> k(std::size_t{48} * SUTURE_LANES), c(k.size());
      check(e->bounds(&context_, &batch, k.data(), c.data()));
      for (std::uint32_t lane = 0; lane < batch.valid; ++lane)
        for (std::size_t n = 0; n < batch.nodes; ++n)
          for (std::size_t i = 0; i < 6; ++i) {
            out[nodes[lane][n]][i] += k[(n * 6 + i) * SUTURE_LANES + lane];
            out[nodes[lane][n]][6 + i] += c[(n * 6 + i) * SUTURE_LANES + lane];
          }
    });
    return out;
  }

  /// A field of the functors on edges, per edge.
  std::vector<double> edge_field(const std::vector<Vec3>& x, const std::string& name) {
    std::vector<double> values;
    for_batches(x, {}, [&](const suture_functor& f, suture_batch& batch, const auto&) {
      if (f.dimension != 1) return;
      const auto* e = static_cast<const suture_output_1*>(f.extension(SUTURE_OUTPUT_1));
      AlignedVector<double> out(SUTURE_LANES);
      std::vector<double*> wanted;
      for (std::uint32_t i = 0; i < e->field_count; ++i)
        wanted.push_back(name == e->fields[i].name ? out.data() : nullptr);
      check(e->compute(&context_, &batch, wanted.data()));
      values.insert(values.end(), out.begin(), out.begin() + batch.valid);
    });
    return values;
  }

  void inspect() {
    for_batches(mesh_.points, {}, [&](const suture_functor& f, suture_batch& batch, const auto&) {
      const auto* e = static_cast<const suture_inspect_1*>(f.extension(SUTURE_INSPECT_1));
      if (e != nullptr) check(e->inspect(&context_, &batch));
    });
  }

  /// Names of the functors that run, and whether any of them reads velocities.
  std::string functors() {
    std::string names;
    for (std::uint32_t i = 0; i < model_.functor_count; ++i) {
      std::uint32_t reads = model_.functors[i].reads;
      if (!runs(model_.functors[i], reads)) continue;
      names += (names.empty() ? "" : ", ") + std::string(model_.functors[i].name);
      if ((reads & SUTURE_READ_VELOCITY) != 0) names += " (v)";
    }
    return names;
  }

 private:
  using Nodes = std::vector<std::vector<Index>>;  ///< points of each lane's cell
  static constexpr std::size_t lanes = SUTURE_LANES;

  static void report(const suture_context* context, std::int32_t severity, std::uint32_t cell,
                     const char* key, const char* text) {
    static_cast<std::vector<Report>*>(context->host_data)->push_back({severity, cell, key, text});
  }
  static std::int32_t has_extension(const char*) { return 1; }
  static const suture_host& host() {
    static const suture_host services{sizeof(suture_host), SUTURE_ABI_MINOR, report, has_extension};
    return services;
  }

  void check(suture_status status) const {
    if (status != SUTURE_OK) throw ModelFailure(status, error_);
  }

  bool enabled(const suture_functor& f, std::uint32_t& reads) {
    return f.enabled == nullptr || f.enabled(&context_, &reads) != 0;
  }

  /// Among alternatives, the first that is enabled.
  bool runs(const suture_functor& f, std::uint32_t& reads) {
    if (!enabled(f, reads)) return false;
    for (const suture_functor* other = model_.functors; other != &f; ++other) {
      std::uint32_t unused = other->reads;
      if (f.alternative != 0 && other->alternative == f.alternative && enabled(*other, unused))
        return false;
    }
    return true;
  }

  void find_edges() {
    std::map<std::array<Index, 2>, Index> numbers;
    for (const auto& h : mesh_.elements)
      for (const auto& ends : suture_hexahedron_edges) {
        std::array<Index, 2> name{mesh_.identity[h[ends[0]]], mesh_.identity[h[ends[1]]]};
        if (name[0] > name[1]) std::swap(name[0], name[1]);
        const auto [at, fresh] = numbers.try_emplace(name, numbers.size());
        if (fresh) edges_.push_back({h[ends[0]], h[ends[1]]});
        edge_of_.push_back(at->second);
      }
  }

  /// Cells of a dimension as lists of points.
  std::size_t cell_count(std::uint32_t dimension) const {
    return dimension == 1 ? edges_.size() : mesh_.elements.size();
  }
  std::vector<Index> points_of(std::uint32_t dimension, std::size_t cell) const {
    if (dimension == 1) return {edges_[cell].begin(), edges_[cell].end()};
    return {mesh_.elements[cell].begin(), mesh_.elements[cell].end()};
  }

  static AlignedVector<double> gather(const std::vector<Vec3>& values, const Nodes& nodes) {
    AlignedVector<double> out(nodes[0].size() * 3 * lanes);
    for (std::size_t lane = 0; lane < lanes; ++lane)
      for (std::size_t n = 0; n < nodes[lane].size(); ++n)
        for (std::size_t c = 0; c < 3; ++c)
          out[(n * 3 + c) * lanes + lane] = values.empty() ? 0 : values[nodes[lane][n]][c];
    return out;
  }

  static void scatter(const suture_batch& batch, const Nodes& nodes, const double* values,
                      std::vector<Vec3>& out) {
    for (std::size_t lane = 0; lane < batch.valid; ++lane)
      for (std::size_t n = 0; n < batch.nodes; ++n)
        for (std::size_t c = 0; c < 3; ++c)
          out[nodes[lane][n]][c] += values[(n * 3 + c) * lanes + lane];
  }

  /// Lanes behind the last cell repeat it.
  suture_batch batch_of(std::size_t first, std::size_t count, std::uint32_t dimension, Nodes& nodes,
                        std::array<std::uint32_t, lanes>& ids) const {
    suture_batch batch{};
    batch.size = sizeof batch;
    batch.lanes = SUTURE_LANES;
    batch.valid = static_cast<std::uint32_t>(std::min(lanes, count - first));
    nodes.clear();
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      ids[lane] = static_cast<std::uint32_t>(first + std::min<std::size_t>(lane, batch.valid - 1));
      nodes.push_back(points_of(dimension, ids[lane]));
    }
    batch.nodes = static_cast<std::uint32_t>(nodes[0].size());
    batch.cell_ids = ids.data();
    return batch;
  }

  void sum(std::uint32_t a) {
    const suture_attribute& attribute = model_.attributes[a];
    static constexpr std::size_t per_element[] = {8, 12, 6, 1};
    const std::size_t k = per_element[attribute.dimension], n = attribute.components;
    columns_.emplace_back();
    auto& out = (attribute.flags & SUTURE_SHARED_MASS) != 0 ? mass_ : columns_.back();
    const std::size_t cells[] = {mesh_.vertices, edges_.size(), 0, mesh_.elements.size()};
    out.assign(cells[attribute.dimension] * n, 0.0);
    if (const auto* given = uniform_->find(a)) out.assign(out.size(), given->front());
    if (attribute.policy != SUTURE_FROM_VOLUMES) return;
    Nodes nodes;
    std::array<std::uint32_t, lanes> ids;
    for (std::size_t first = 0; first < mesh_.elements.size(); first += lanes) {
      suture_batch batch = batch_of(first, mesh_.elements.size(), 3, nodes, ids);
      const auto rest = gather(mesh_.points, nodes);
      batch.rest = rest.data();
      batch.cell_columns = uniform_->all();
      AlignedVector<double> values(k * n * lanes);
      check(attribute.contributions[0].function(&context_, &batch, values.data()));
      for (std::size_t lane = 0; lane < batch.valid; ++lane)
        for (std::size_t i = 0; i < k * n; ++i)
          out[incident(attribute.dimension, first + lane, i / n) * n + i % n] +=
              values[i * lanes + lane];
    }
  }

  std::size_t incident(std::uint32_t dimension, std::size_t element, std::size_t k) const {
    if (dimension == 0) return mesh_.identity[mesh_.elements[element][k]];
    return dimension == 1 ? edge_of_[element * 12 + k] : element;
  }

  template <class Work>
  void for_batches(const std::vector<Vec3>& x, const std::vector<Vec3>& v, Work work) {
    for (std::uint32_t i = 0; i < model_.functor_count; ++i) {
      const suture_functor& f = model_.functors[i];
      std::uint32_t reads = f.reads;
      if (!runs(f, reads)) continue;
      for (std::size_t first = 0; first < cell_count(f.dimension); first += lanes) {
        Nodes nodes;
        std::array<std::uint32_t, lanes> ids;
        suture_batch batch = batch_of(first, cell_count(f.dimension), f.dimension, nodes, ids);
        const auto rest = gather(mesh_.points, nodes), position = gather(x, nodes),
                   velocity = gather(v, nodes);
        batch.rest = rest.data();
        batch.position = position.data();
        batch.velocity = (reads & SUTURE_READ_VELOCITY) != 0 ? velocity.data() : nullptr;
        std::vector<AlignedVector<double>> values;
        for (std::uint32_t c = 0; c < f.cell_column_count; ++c)
          values.push_back(cell_values(f.cell_columns[c], ids));
        for (std::uint32_t c = 0; c < f.vertex_column_count; ++c) values.push_back(masses(nodes));
        std::vector<const double*> cells, vertices;
        for (std::size_t c = 0; c < values.size(); ++c)
          (c < f.cell_column_count ? cells : vertices).push_back(values[c].data());
        batch.cell_columns = cells.data();
        batch.vertex_columns = vertices.data();
        work(f, batch, nodes);
      }
    }
  }

  AlignedVector<double> cell_values(std::uint32_t a,
                                    const std::array<std::uint32_t, lanes>& ids) const {
    const std::size_t n = model_.attributes[a].components;
    AlignedVector<double> out(n * lanes);
    for (std::size_t lane = 0; lane < lanes; ++lane)
      for (std::size_t c = 0; c < n; ++c) out[c * lanes + lane] = columns_[a][ids[lane] * n + c];
    return out;
  }
  /// The only vertex column that models under test use is the kernel's mass.
  AlignedVector<double> masses(const Nodes& nodes) const {
    AlignedVector<double> out(nodes[0].size() * lanes);
    for (std::size_t lane = 0; lane < lanes; ++lane)
      for (std::size_t n = 0; n < nodes[lane].size(); ++n)
        out[n * lanes + lane] = mass_[mesh_.identity[nodes[lane][n]]];
    return out;
  }

  const suture_model& model_;
  HarnessMesh mesh_;
  std::vector<double> parameters_;
  AlignedVector<char> instance_;
  suture_error error_{};
  std::vector<Report> reports_;
  suture_context context_{};
  std::vector<std::array<Index, 2>> edges_;  ///< two points of one element
  std::vector<Index> edge_of_;               ///< 12 per element
  std::vector<std::vector<double>> columns_;
  std::unique_ptr<suture::test::ParameterColumns> uniform_;
  std::vector<double> mass_;
};

}  // namespace suture::testing
