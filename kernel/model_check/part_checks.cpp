// SPDX-License-Identifier: GPL-3.0-or-later
//
// Elements of which only a part is material, beside whole ones.
#include <algorithm>
#include <cmath>

#include "kernel/attributes/shape.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/model_check/checks.hpp"
#include "kernel/model_check/sample_parts.hpp"
#include "kernel/plugin_host/part_functors.hpp"

namespace suture::checks {
namespace {

using Values = AlignedVector<double>;

Vec3 vector_of_node(const Values& values, std::size_t node, std::size_t lane) {
  return {values[CellBatch::place(node, 0, lane)], values[CellBatch::place(node, 1, lane)],
          values[CellBatch::place(node, 2, lane)]};
}

HexahedronNodes nodes_of(const Values& values, std::size_t lane) {
  HexahedronNodes x;
  for (std::size_t n = 0; n < x.size(); ++n) x[n] = vector_of_node(values, n, lane);
  return x;
}

/// The functor that `on_parts` replaces.
const suture_functor* functor_of_whole(const Instance& instance, const suture_functor* on_parts) {
  for (std::size_t i = 0; i < instance.model().functor_count; ++i)
    if (instance.part_functor(i) == on_parts) return &instance.model().functors[i];
  return nullptr;
}

/// The same cells as whole elements, for their functor. If that reads columns that parts have not,
/// they are parts that fill their elements.
CellBatch whole(const CellBatch& parts, const suture_functor& functor) {
  CellBatch batch = parts;
  const std::span places(parts.functor->cell_columns, parts.functor->cell_column_count);
  for (std::size_t i = 0; i < places.size(); ++i)
    if (is_part_column(places[i])) {
      std::ranges::fill(batch.cell_columns[i], 0.0);
      std::fill_n(batch.cell_columns[i].begin(), SUTURE_LANES, 1.0);  // the fraction
    }
  std::vector<Values> columns;
  for (const std::uint32_t column : std::span(functor.cell_columns, functor.cell_column_count)) {
    const auto at = std::ranges::find(places, column);
    if (at == places.end()) return batch;
    columns.push_back(batch.cell_columns[static_cast<std::size_t>(at - places.begin())]);
  }
  batch.functor = &functor;
  batch.cell_columns = std::move(columns);
  return batch;
}

/// A homogeneous deformation, without motion, where fields have the value of the first node.
void deform(CellBatch& batch, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::array<Vec3, 3> F{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (Vec3& row : F)
    for (double& x : row) x += between(random, -0.1, 0.1);
  for (std::size_t n = 0; n < hexahedron::vertices; ++n)
    for (std::size_t l = 0; l < SUTURE_LANES; ++l) {
      const Vec3 x = rotated(F, vector_of_node(batch.rest, n, l));
      for (std::size_t c = 0; c < 3; ++c) batch.position[CellBatch::place(n, c, l)] = x[c];
    }
  std::ranges::fill(batch.velocity, 0.0);
  for (Values& column : batch.vertex_columns) {
    const std::size_t size = column.size() / batch.nodes();
    for (std::size_t i = size; i < column.size(); ++i) column[i] = column[i - size];
  }
}

/// P of an element in a homogeneous state: the virial of its forces, -sum f_n x X_n / V.
std::array<Vec3, 3> stress_of(const Values& force, const Values& rest, std::size_t lane) {
  const double volume = hexahedron_volume(nodes_of(rest, lane));
  std::array<Vec3, 3> P{};
  for (std::size_t n = 0; n < hexahedron::vertices; ++n) {
    const Vec3 f = vector_of_node(force, n, lane);
    const Vec3 X = minus(vector_of_node(rest, n, lane), vector_of_node(rest, 0, lane));
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) P[i][j] -= f[i] * X[j] / volume;
  }
  return P;
}

}  // namespace

// The patch test: in a homogeneous state, the force on a node is -P times the integral of the
// gradient of its shape function over the material. The sum over elements then vanishes inside a
// body. P is that of whole elements in the same state.
Result patch(const BatchCase& of) {
  const suture_functor* const functor = functor_of_whole(of.instance, of.batch.functor);
  if (functor == nullptr || functor->field != 0 ||
      (of.instance.model().flags & SUTURE_CONTINUUM) == 0)
    return {};
  CellBatch batch = of.batch;
  deform(batch, of.seed);
  BatchCaller caller(of.instance);
  const Values found = caller.force(batch).force;
  const Values forces = caller.force(whole(batch, *functor)).force;
  Measured worst;
  for (std::size_t l = 0; l < batch.valid; ++l) {
    const std::array<Vec3, 3> P = stress_of(forces, batch.rest, l);
    const HexahedronNodes rest = nodes_of(batch.rest, l);
    double size = 0, difference = 0;
    for (int n = 0; n < hexahedron::vertices; ++n) {
      const Vec3 gradient = integral_of_gradient(batch.ids[l], n, rest);
      const Vec3 expected{-dot(P[0], gradient), -dot(P[1], gradient), -dot(P[2], gradient)};
      size = std::max(size, norm(expected));
      difference = std::max(
          difference, norm(minus(vector_of_node(found, static_cast<std::size_t>(n), l), expected)));
    }
    if (!(difference <= worst.figure * size))
      worst = {difference / size, "the force on a node of element " + std::to_string(batch.ids[l]) +
                                      " is not that of the mean gradient of its part"};
  }
  return worst;
}

}  // namespace suture::checks
