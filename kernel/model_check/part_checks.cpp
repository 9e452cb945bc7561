// SPDX-License-Identifier: GPL-3.0-or-later
//
// Elements of which only a part is material, beside whole ones.
#include <algorithm>
#include <cmath>

#include "kernel/attributes/mean_gradient.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/model_check/checks.hpp"
#include "kernel/model_check/sample_parts.hpp"
#include "suture/parts.h"

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

/// The same cells as whole elements.
CellBatch whole(const CellBatch& parts, const suture_functor& functor) {
  CellBatch batch = parts;
  const std::span places(parts.functor->cell_columns, parts.functor->cell_column_count);
  batch.functor = &functor;
  batch.cell_columns.clear();
  for (std::uint32_t i = 0; i < functor.cell_column_count; ++i) {
    const auto at = std::ranges::find(places, functor.cell_columns[i]);
    batch.cell_columns.push_back(parts.cell_columns[static_cast<std::size_t>(at - places.begin())]);
  }
  return batch;
}

/// A homogeneous deformation, without motion.
void deform(CellBatch& batch, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::array<Vec3, 3> F{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (Vec3& row : F)
    for (double& x : row) x += between(random, -0.1, 0.1);
  for (std::size_t n = 0; n < 8; ++n)
    for (std::size_t l = 0; l < SUTURE_LANES; ++l) {
      const Vec3 x = rotated(F, vector_of_node(batch.rest, n, l));
      for (std::size_t c = 0; c < 3; ++c) batch.position[CellBatch::place(n, c, l)] = x[c];
    }
  std::ranges::fill(batch.velocity, 0.0);
}

/// P of a parallelepiped in a homogeneous state: the virial of its forces, -sum f_n x X_n / V.
std::array<Vec3, 3> stress_of(const Values& force, const Values& rest, std::size_t lane) {
  const double volume = determinant(mean_edges(nodes_of(rest, lane)));
  std::array<Vec3, 3> P{};
  for (std::size_t n = 0; n < 8; ++n) {
    const Vec3 f = vector_of_node(force, n, lane);
    const Vec3 X = minus(vector_of_node(rest, n, lane), vector_of_node(rest, 0, lane));
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) P[i][j] -= f[i] * X[j] / volume;
  }
  return P;
}

/// -P times the integral of grad N over the material: with the edges A and their reciprocals G,
/// grad N = sum_a 2 G_a dN/dx_a in coordinates [-1, 1]^3, of which the element has V / 8 per unit.
Vec3 expected_force(const std::array<Vec3, 3>& P, const std::array<Vec3, 3>& A, Index element,
                    int node) {
  const std::array<Vec3, 3> G = reciprocals(A);
  const Vec3 local = integral_of_gradient(element, node);
  Vec3 gradient{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t c = 0; c < 3; ++c) gradient[c] += determinant(A) / 4 * G[a][c] * local[a];
  return {-dot(P[0], gradient), -dot(P[1], gradient), -dot(P[2], gradient)};
}

}  // namespace

// The patch test: in a homogeneous state, the force on a node is -P times the integral of the
// gradient of its shape function over the material. The sum over elements then vanishes inside a
// body. P is that of whole elements in the same state.
Result patch(const BatchCase& of) {
  const suture_functor* const functor = functor_of_whole(of.instance, of.batch.functor);
  if (functor == nullptr || (of.instance.model().flags & SUTURE_CONTINUUM) == 0) return {};
  CellBatch batch = of.batch;
  deform(batch, of.seed);
  BatchCaller caller(of.instance);
  const Values found = caller.force(batch).force;
  const Values forces = caller.force(whole(batch, *functor)).force;
  Measured worst;
  for (std::size_t l = 0; l < batch.valid; ++l) {
    const std::array<Vec3, 3> P = stress_of(forces, batch.rest, l);
    const std::array<Vec3, 3> A = mean_edges(nodes_of(batch.rest, l));
    double size = 0, difference = 0;
    for (int n = 0; n < 8; ++n) {
      const Vec3 expected = expected_force(P, A, batch.ids[l], n);
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
