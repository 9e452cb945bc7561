// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/forces/spring_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>

#include "kernel/attributes/cell_nodes.hpp"
#include "kernel/attributes/shape.hpp"

namespace spring_model {
namespace {

using suture::Index;
using suture::Vec3;

constexpr std::uint32_t lanes = SUTURE_LANES;
constexpr int diagonals[4][2] = {{0, 7}, {1, 6}, {2, 5}, {3, 4}};

struct Spring {
  Vec3 force{};  // on the first end
  double energy = 0;
};

/// f = k (l - L) u + c (w . u) u.
Spring spring(const double* rest, const double* x, const double* v, std::size_t a, std::size_t b,
              std::size_t stride, double k, double c) {
  Vec3 d, big, w{};
  for (std::size_t i = 0; i < 3; ++i) {
    d[i] = x[(b * 3 + i) * stride] - x[(a * 3 + i) * stride];
    big[i] = rest[(b * 3 + i) * stride] - rest[(a * 3 + i) * stride];
    if (v) w[i] = v[(b * 3 + i) * stride] - v[(a * 3 + i) * stride];
  }
  const double l = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  const double l0 = std::sqrt(big[0] * big[0] + big[1] * big[1] + big[2] * big[2]);
  const double rate = (w[0] * d[0] + w[1] * d[1] + w[2] * d[2]) / l;
  const double tension = k * (l - l0) + c * rate;
  Spring s;
  for (std::size_t i = 0; i < 3; ++i) s.force[i] = tension * d[i] / l;
  s.energy = 0.5 * k * (l - l0) * (l - l0);
  return s;
}

suture_status maybe_fail(const suture_context* context, const suture_batch* batch) {
  suture_status status = SUTURE_OK;
  for (std::uint32_t l = 0; l < batch->valid; ++l) {
    const std::uint32_t id = batch->cell_ids[l];
    if (id < context->parameters[fail_from] || id % 5 != 0) continue;
    if (status != SUTURE_OK && id >= context->error->cell) continue;
    status = static_cast<suture_status>(context->parameters[fail_how]);
    context->error->cell = id;
    context->error->step_factor = id % 2 ? 0.25 : 0.5;
    std::snprintf(context->error->text, sizeof context->error->text, "cell %u says no", id);
  }
  return status;
}

void add(const suture_batch* batch, std::size_t node, std::uint32_t lane, const Vec3& f,
         double sign) {
  for (std::size_t i = 0; i < 3; ++i) batch->force[(node * 3 + i) * lanes + lane] += sign * f[i];
}

suture_status edge_force(const suture_context* context, const suture_batch* batch) {
  std::memset(batch->force, 0, sizeof(double) * 6 * lanes);
  for (std::uint32_t l = 0; l < lanes; ++l) {
    const double factor = batch->cell_columns[0][l];
    const Spring s = spring(
        batch->rest + l, batch->position + l, batch->velocity ? batch->velocity + l : nullptr, 0, 1,
        lanes, context->parameters[edge_stiffness] * factor, context->parameters[edge_damping]);
    add(batch, 0, l, s.force, 1);
    add(batch, 1, l, s.force, -1);
  }
  return maybe_fail(context, batch);
}

suture_status edge_energy(const suture_context* context, const suture_batch* batch, double* out) {
  for (std::uint32_t l = 0; l < lanes; ++l)
    out[l] = spring(batch->rest + l, batch->position + l, nullptr, 0, 1, lanes,
                    context->parameters[edge_stiffness] * batch->cell_columns[0][l], 0)
                 .energy;
  return SUTURE_OK;
}

/// k (x_a - x_b)^2 <= 2 k x_a^2 + 2 k x_b^2, the same in all directions.
suture_status edge_bounds(const suture_context* context, const suture_batch* batch,
                          double* stiffness, double* damping) {
  for (std::uint32_t n = 0; n < 2; ++n)
    for (std::uint32_t c = 0; c < 6; ++c)
      for (std::uint32_t l = 0; l < lanes; ++l) {
        const double k = context->parameters[edge_stiffness] * batch->cell_columns[0][l];
        stiffness[(n * 6 + c) * lanes + l] = c < 3 ? 2 * k : 0;
        damping[(n * 6 + c) * lanes + l] = c < 3 ? 2 * context->parameters[edge_damping] : 0;
      }
  return SUTURE_OK;
}

std::int32_t edges_enabled(const suture_context* context, std::uint32_t* reads) {
  if (context->parameters[edge_damping] == 0) *reads &= ~std::uint32_t{SUTURE_READ_VELOCITY};
  return context->parameters[edge_stiffness] != 0 || context->parameters[edge_damping] != 0;
}

double diagonal_factor(std::uint32_t shape) { return shape == SUTURE_GENERAL ? 0.5 : 1; }

template <std::uint32_t Shape>
suture_status diagonal_force(const suture_context* context, const suture_batch* batch) {
  std::memset(batch->force, 0, sizeof(double) * 24 * lanes);
  for (std::uint32_t l = 0; l < lanes; ++l) {
    const double k = context->parameters[diagonal_stiffness] * batch->cell_columns[0][l] *
                     diagonal_factor(Shape);
    for (const auto& d : diagonals) {
      const auto a = static_cast<std::size_t>(d[0]), b = static_cast<std::size_t>(d[1]);
      const Spring s = spring(batch->rest + l, batch->position + l, nullptr, a, b, lanes, k, 0);
      add(batch, a, l, s.force, 1);
      add(batch, b, l, s.force, -1);
    }
  }
  return SUTURE_OK;
}

suture_status share_of_mass(const suture_context* context, const suture_batch* batch, double* out) {
  for (std::uint32_t l = 0; l < lanes; ++l) {
    suture::HexahedronNodes x;
    for (std::size_t n = 0; n < 8; ++n)
      for (std::size_t c = 0; c < 3; ++c) x[n][c] = batch->rest[(n * 3 + c) * lanes + l];
    const double m = context->parameters[density] * suture::hexahedron_volume(x) / 8;
    for (std::uint32_t n = 0; n < 8; ++n) out[n * lanes + l] = m;
  }
  return SUTURE_OK;
}

suture_status one_per_edge(const suture_context*, const suture_batch*, double* out) {
  for (std::uint32_t i = 0; i < 12 * lanes; ++i) out[i] = 0.25;
  return SUTURE_OK;
}

/// Differs from cell to cell, so that a column read at the wrong row shows.
suture_status volume_factor(const suture_context*, const suture_batch* batch, double* out) {
  for (std::uint32_t l = 0; l < lanes; ++l) out[l] = 1 + 0.001 * (batch->cell_ids[l] % 97);
  return SUTURE_OK;
}

const suture_energy_1 edge_energy_extension{sizeof(suture_energy_1), 0, edge_energy};
const suture_stable_dt_1 edge_bounds_extension{sizeof(suture_stable_dt_1), 0, edge_bounds};

const void* edge_extension(const char* id) {
  if (std::strcmp(id, SUTURE_ENERGY_1) == 0) return &edge_energy_extension;
  if (std::strcmp(id, SUTURE_STABLE_DT_1) == 0) return &edge_bounds_extension;
  return nullptr;
}

std::int32_t diagonals_enabled(const suture_context* context, std::uint32_t*) {
  return context->parameters[diagonal_stiffness] != 0;
}

constexpr double big = std::numeric_limits<double>::infinity();

suture_parameter parameter(const char* name, double value) {
  return {sizeof(suture_parameter), SUTURE_NUMBER, 0, 0, name, "1", "", value, -big, big, nullptr};
}

suture_attribute attribute(const char* name, std::uint32_t dimension,
                           const suture_contribution* sum) {
  return {sizeof(suture_attribute),
          dimension,
          1,
          SUTURE_FROM_VOLUMES,
          0,
          1,
          name,
          "1",
          "",
          0,
          sum,
          0,
          0};
}

suture_functor functor(const char* name, std::uint32_t dimension, std::uint32_t type,
                       std::uint32_t shape, std::uint32_t reads, const std::uint32_t* column,
                       suture_force_fn force) {
  suture_functor f{};
  f.size = sizeof f;
  f.dimension = dimension;
  f.cell_type = type;
  f.shape = shape;
  f.lanes = lanes;
  f.reads = reads;
  f.cell_column_count = 1;
  f.cell_columns = column;
  f.name = name;
  f.doc = "";
  f.force = force;
  return f;
}

struct Tables {
  Tables() {
    attributes[0] = attribute("mass", 0, &sums[0]);
    attributes[0].flags = SUTURE_SHARED_MASS;
    attributes[1] = attribute("factor", 1, &sums[1]);
    attributes[2] = attribute("volume-factor", 3, &sums[2]);
    constexpr std::uint32_t state = SUTURE_READ_REST | SUTURE_READ_POSITION;
    functors[0] =
        functor("edges", 1, SUTURE_EDGE, 0, state | SUTURE_READ_VELOCITY, &edge_column, edge_force);
    functors[0].extension = edge_extension;
    functors[0].enabled = edges_enabled;
    functors[1] = functor("boxes", 3, SUTURE_HEXAHEDRON, SUTURE_PARALLELEPIPED, state,
                          &volume_column, diagonal_force<SUTURE_PARALLELEPIPED>);
    functors[2] = functor("others", 3, SUTURE_HEXAHEDRON, SUTURE_GENERAL, state, &volume_column,
                          diagonal_force<SUTURE_GENERAL>);
    functors[1].enabled = functors[2].enabled = diagonals_enabled;
    model.size = sizeof model;
    model.id = "test-springs";
    model.doc = model.formula = model.citation = "";
    model.parameter_count = 6;
    model.attribute_count = 3;
    model.functor_count = 3;
    model.parameters = parameters;
    model.attributes = attributes;
    model.functors = functors;
  }
  suture_parameter parameters[6] = {parameter("k", 100),    parameter("c", 0),
                                    parameter("kd", 50),    parameter("rho", 1000),
                                    parameter("from", big), parameter("how", -1)};
  std::uint32_t edge_column = 1, volume_column = 2;
  suture_contribution sums[3] = {{sizeof(suture_contribution), SUTURE_HEXAHEDRON, share_of_mass},
                                 {sizeof(suture_contribution), SUTURE_HEXAHEDRON, one_per_edge},
                                 {sizeof(suture_contribution), SUTURE_HEXAHEDRON, volume_factor}};
  suture_attribute attributes[3]{};
  suture_functor functors[3]{};
  suture_model model{};
};

}  // namespace

const suture_model& model() {
  static const Tables tables;
  return tables.model;
}

std::vector<double> defaults() { return {100, 0, 50, 1000, big, -1}; }

suture::BoxOptions box(Index x, Index y, Index z) {
  suture::BoxOptions options;
  options.cells = {x, y, z};
  options.size = {0.1 * x, 0.1 * y, 0.1 * z};
  return options;
}

namespace {

suture::Imported block(const suture::BoxOptions& box, bool distorted) {
  suture::Diagnostics diagnostics;
  suture::Mesh grid = suture::make_box(box);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> shift(-0.1, 0.1);
  const double h = box.size[0] / box.cells[0];
  if (distorted)
    for (std::size_t i = 0; i < grid.points.size(); i += 29)
      for (double& c : grid.points[i]) c += h * shift(random);
  return suture::import_mesh(std::move(grid), {}, diagnostics);
}

}  // namespace

Body::Body(const suture::BoxOptions& box, bool distorted) : suture::Body(block(box, distorted)) {}

suture::Instance& Body::add(std::vector<double> parameters, std::vector<Index> region, bool skip) {
  return attributes().add(std::make_unique<suture::Instance>(
                              model(), "springs", std::move(parameters), diagnostics, skip),
                          complex(), std::move(region));
}

void Body::shake(double amount, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-amount, amount);
  for (Index v = 0; v < attributes().vertex_count(); ++v)
    for (int c = 0; c < 3; ++c) {
      attributes().position().set(v, c, attributes().rest().get(v, c) + shift(random));
      attributes().velocity().set(v, c, shift(random));
    }
}

std::vector<double> edges_only() {
  auto parameters = defaults();
  parameters[diagonal_stiffness] = 0;
  parameters[edge_damping] = 2;
  return parameters;
}

Worn::Worn() : Body(box(6, 5, 4), true) {
  std::vector<Index> region;
  for (Index e = 0; e < 120; e += 2) region.push_back(e);
  add(edges_only());
  add(edges_only(), region);
  compile(1);
  shake(0.02, 4);
  cut_random(30, 5);
  pierce({7, 8, 30, 77});
}

suture::TopologyChange Body::cut_random(unsigned count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<suture::Dart> faces;
  while (faces.size() < count) {
    const suture::Dart d = random() % (24 * complex().element_count()) / 4 * 4;
    if (complex().can_cut(d)) faces.push_back(d);
  }
  return cut(faces);
}

std::vector<Index> vertices_at(suture::Body& body, int axis, double where) {
  std::vector<Index> found;
  for (Index v = 0; v < body.attributes().vertex_count(); ++v)
    if (std::abs(body.attributes().rest().get(v, axis) - where) < 1e-9) found.push_back(v);
  return found;
}

std::vector<Index> all_vertices(const suture::Body& body) {
  std::vector<Index> all(body.attributes().vertex_count());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

std::vector<suture::Dart> boundary_faces(const suture::Body& body) {
  std::vector<suture::Dart> faces;
  for (suture::Dart d = 0; d < 24 * body.complex().element_count(); d += 4)
    if (body.complex().beta3(d) == suture::none) faces.push_back(d);
  return faces;
}

double volume(suture::Body& body) {
  double sum = 0;
  for (Index e = 0; e < body.complex().element_count(); ++e) {
    suture::HexahedronNodes x;
    for (std::size_t n = 0; n < 8; ++n)
      for (int c = 0; c < 3; ++c)
        x[n][static_cast<std::size_t>(c)] =
            body.attributes().position().get(body.complex().vertices_of(e)[n], c);
    sum += suture::hexahedron_volume(x);
  }
  return sum;
}

std::vector<double> forces_of(suture::Body& body, suture::ForceLoop& loop) {
  suture::Column& force = body.attributes().force();
  std::fill(force.rows(), force.rows() + std::size_t{force.size()} * 4, 0.0);
  loop.add_forces(0, 0);
  return {force.rows(), force.rows() + std::size_t{force.size()} * 4};
}

double largest_difference(const std::vector<double>& rows, const std::vector<Vec3>& reference) {
  EXPECT_EQ(rows.size(), 4 * reference.size());
  double largest = 0, scale = 0;
  for (std::size_t v = 0; v < reference.size(); ++v)
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_TRUE(std::isfinite(rows[4 * v + c])) << v;
      largest = std::max(largest, std::abs(rows[4 * v + c] - reference[v][c]));
      scale = std::max(scale, std::abs(reference[v][c]));
    }
  EXPECT_GT(scale, 0);
  return largest / scale;
}

namespace {

/// visit(ends a and b, their rest positions, k, c) for every spring of an instance.
template <class Visit>
void for_each_spring(Body& body, suture::Instance& instance, Visit visit) {
  const auto p = instance.parameters();
  const auto& complex = body.complex();
  const suture::RestPlaces rest = body.attributes().rest_places(complex);
  std::array<suture::hexahedron::Local, 8> corners{};
  const auto& edges = instance.table(1);
  for (Index row = 0; row < edges.cells.size(); ++row) {
    if (!edges.cells.is_live(row)) continue;
    const Index e = suture::cell_corners(complex, 1, edges.cells.cell(row), corners.data());
    const auto& nodes = complex.vertices_of(e);
    visit(nodes[corners[0]], nodes[corners[1]], rest.corner(e, corners[0]),
          rest.corner(e, corners[1]), p[edge_stiffness] * edges.columns[0].get(row, 0),
          p[edge_damping]);
  }
  const auto& volumes = instance.table(3);
  for (Index row = 0; row < volumes.cells.size(); ++row) {
    if (!volumes.cells.is_live(row)) continue;
    const Index e = volumes.cells.cell(row);
    const auto& nodes = complex.vertices_of(e);
    const double id = body.imported().user_element[e] % 97;
    const double k = p[diagonal_stiffness] * (1 + 0.001 * id) *
                     diagonal_factor(suture::is_parallelepiped(rest.of(e)) ? SUTURE_PARALLELEPIPED
                                                                           : SUTURE_GENERAL);
    for (const auto& d : diagonals) {
      const auto i = static_cast<std::size_t>(d[0]), j = static_cast<std::size_t>(d[1]);
      visit(nodes[i], nodes[j], rest.corner(e, i), rest.corner(e, j), k, 0.0);
    }
  }
}

Spring spring_between(Body& body, Index a, Index b, const double* rest_a, const double* rest_b,
                      double k, double c) {
  double rest[6], x[6], v[6];
  for (int i = 0; i < 3; ++i) {
    rest[i] = rest_a[i];
    rest[3 + i] = rest_b[i];
    x[i] = body.attributes().position().get(a, i);
    x[3 + i] = body.attributes().position().get(b, i);
    v[i] = body.attributes().velocity().get(a, i);
    v[3 + i] = body.attributes().velocity().get(b, i);
  }
  return spring(rest, x, v, 0, 1, 1, k, c);
}

}  // namespace

std::vector<Vec3> reference_forces(Body& body, suture::Instance& instance) {
  std::vector<Vec3> forces(body.attributes().vertex_count());
  for_each_spring(body, instance,
                  [&](Index a, Index b, const double* p, const double* q, double k, double c) {
                    const Spring s = spring_between(body, a, b, p, q, k, c);
                    for (std::size_t i = 0; i < 3; ++i) {
                      forces[a][i] += s.force[i];
                      forces[b][i] -= s.force[i];
                    }
                  });
  return forces;
}

double reference_energy(Body& body, suture::Instance& instance) {
  double sum = 0;
  for_each_spring(body, instance,
                  [&](Index a, Index b, const double* p, const double* q, double k, double c) {
                    sum += spring_between(body, a, b, p, q, k, c).energy;
                  });
  return sum;
}

}  // namespace spring_model
