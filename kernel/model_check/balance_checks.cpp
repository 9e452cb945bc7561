// SPDX-License-Identifier: GPL-3.0-or-later
//
// Newton's third law, and motions that no force may notice.
#include <algorithm>
#include <cmath>

#include "kernel/base/vec3.hpp"
#include "kernel/model_check/checks.hpp"

namespace suture::checks {
namespace {

using Values = AlignedVector<double>;

/// Functors on vertices act between the body and the world; so may loads on faces, which have no
/// energy. Rates of fields have no direction.
bool may_act_from_outside(const suture_functor& functor) {
  return functor.dimension == 0 || functor.field != 0 ||
         (functor.dimension == 2 &&
          extension_of<suture_energy_1>(functor, SUTURE_ENERGY_1) == nullptr);
}

Vec3 vector_at(const Values& values, std::size_t node, std::size_t lane) {
  return {values[CellBatch::place(node, 0, lane)], values[CellBatch::place(node, 1, lane)],
          values[CellBatch::place(node, 2, lane)]};
}

/// Sums over the nodes of a cell; `largest...` of the sizes of what is summed.
struct Sums {
  Vec3 force{}, torque{};
  double largest_force = 0, largest_torque = 0;
};

Sums sums_of(const CellBatch& batch, const Values& forces, std::size_t lane) {
  Sums sums;
  for (std::size_t n = 0; n < batch.nodes(); ++n) {
    const Vec3 f = vector_at(forces, n, lane);
    const Vec3 arm = minus(vector_at(batch.position, n, lane), vector_at(batch.position, 0, lane));
    const Vec3 torque = cross(arm, f);
    for (std::size_t c = 0; c < 3; ++c) {
      sums.force[c] += f[c];
      sums.torque[c] += torque[c];
    }
    sums.largest_force += norm(f);
    sums.largest_torque += norm(arm) * norm(f);
  }
  return sums;
}

Values rotated_all(const std::array<Vec3, 3>& rotation, const Values& values) {
  Values out(values.size());
  for (std::size_t n = 0; n < values.size() / (3 * SUTURE_LANES); ++n)
    for (std::size_t l = 0; l < SUTURE_LANES; ++l) {
      const Vec3 v = rotated(rotation, vector_at(values, n, l));
      for (std::size_t c = 0; c < 3; ++c) out[CellBatch::place(n, c, l)] = v[c];
    }
  return out;
}

}  // namespace

// The torques of a linear model vanish at rest, where nothing is left to sum.
Result balance(const BatchCase& of) {
  const CellBatch& batch = of.batch;
  const bool has_torque = !is_linear(of.instance.model());
  if (may_act_from_outside(*batch.functor)) return {};
  const Values forces = BatchCaller(of.instance).force(batch).force;
  Measured worst;
  for (std::size_t lane = 0; lane < batch.valid; ++lane) {
    const Sums sums = sums_of(batch, forces, lane);
    if (sums.largest_force == 0) continue;
    const std::string cell = " of cell " + std::to_string(batch.ids[lane]);
    const double force = norm(sums.force) / sums.largest_force,
                 torque = norm(sums.torque) / sums.largest_torque;
    if (!(force <= worst.figure)) worst = {force, "the total force" + cell + " is not zero"};
    if (has_torque && !(torque <= worst.figure))
      worst = {torque, "the total torque" + cell + " is not zero"};
  }
  return worst;
}

// By 3 m: what a scene places elsewhere is relative to the origin of its body.
Result translation(const BatchCase& of) {
  BatchCaller caller(of.instance);
  CellBatch moved = of.batch;
  for (std::size_t i = 0; i < moved.position.size(); ++i) {
    const double shift = i / SUTURE_LANES % 3 == 1 ? -3 : 2;
    moved.rest[i] += shift;
    moved.position[i] += shift;
  }
  const Values expected = caller.force(of.batch).force, found = caller.force(moved).force;
  return compare(of.batch, found, expected, largest(expected), "elsewhere, the force");
}

Result objectivity(const BatchCase& of) {
  if (may_act_from_outside(*of.batch.functor)) return {};
  std::mt19937_64 random(of.seed);
  const auto rotation = random_rotation(random);
  BatchCaller caller(of.instance);
  CellBatch turned = of.batch;
  turned.position = rotated_all(rotation, of.batch.position);
  turned.velocity = rotated_all(rotation, of.batch.velocity);
  const Values expected = rotated_all(rotation, caller.force(of.batch).force);
  const Values found = caller.force(turned).force;
  return compare(of.batch, found, expected, largest(expected), "after a rotation, the force");
}

}  // namespace suture::checks
