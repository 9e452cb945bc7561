// SPDX-License-Identifier: GPL-3.0-or-later
//
// Forces, energies, tangents and bounds of a model that contradict each other.
#include <algorithm>
#include <cmath>

#include "kernel/model_check/checks.hpp"
#include "kernel/solvers/symmetric_eigen.hpp"
#include "suture/single.h"

namespace suture::checks {
namespace {

constexpr std::size_t lane_count = SUTURE_LANES;
using Values = AlignedVector<double>;

/// The size of the cell in lane 0, in the state of the batch, m.
double size_of(const CellBatch& batch) {
  if (batch.functor->dimension == 0) return 0.05;
  double square = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double d =
        batch.position[CellBatch::place(1, c, 0)] - batch.position[CellBatch::place(0, c, 0)];
    square += d * d;
  }
  return std::sqrt(square);
}

/// Fourth-order central difference of f(h) at 0.
template <class F>
auto difference(double h, F f) {
  auto far = f(2 * h), near = f(h);
  const auto far_back = f(-2 * h), near_back = f(-h);
  for (std::size_t i = 0; i < near.size(); ++i)
    near[i] = (8 * (near[i] - near_back[i]) - (far[i] - far_back[i])) / (12 * h);
  return near;
}

/// The best of measure(step) with steps that grow shorter: a law may have kinks, such as fibres
/// that carry tension only, and differences across them are wrong. What is wrong stays wrong.
template <class Measure>
Measured without_kinks(Measure measure) {
  Measured best = measure(1e-4);
  for (const double step : {1e-5, 1e-6, 1e-7, 1e-8}) {
    if (best.figure < 1e-7) break;
    const Measured next = measure(step);
    if (next.figure < best.figure) best = next;
  }
  return best;
}

/// Gives the batch the states that it has once it was stretched by half, so that small motions
/// from here do not change those that follow the largest strain.
void keep_state_of_stretch(BatchCaller& caller, CellBatch& batch) {
  CellBatch stretched = batch;
  for (double& x : stretched.position) x *= 1.5;
  CellForces out;
  if (caller.try_force(stretched, out) != SUTURE_OK) return;
  for (std::size_t c = 0; c < out.trial.size(); ++c)
    if (!out.trial[c].empty()) batch.cell_columns[c] = std::move(out.trial[c]);
}

/// -dE/dx by differences.
Values minus_gradient(BatchCaller& caller, const CellBatch& batch, double step) {
  Values gradient(batch.vector_size());
  for (std::size_t n = 0; n < batch.nodes(); ++n)
    for (std::size_t c = 0; c < 3; ++c) {
      const auto slope = difference(step, [&](double h) {
        CellBatch moved = batch;
        for (std::size_t l = 0; l < lane_count; ++l) moved.position[CellBatch::place(n, c, l)] += h;
        return caller.energy(moved);
      });
      for (std::size_t l = 0; l < lane_count; ++l) gradient[CellBatch::place(n, c, l)] = -slope[l];
    }
  return gradient;
}

Values random_direction(std::mt19937_64& random, std::size_t size, double amount) {
  Values out(size);
  for (double& x : out) x = between(random, -amount, amount);
  return out;
}

/// df of the direction (dx, dv) by differences.
Values force_difference(BatchCaller& caller, const CellBatch& batch, const Values& dx,
                        const Values& dv, double step) {
  return difference(step, [&](double h) {
    CellBatch moved = batch;
    for (std::size_t i = 0; i < dx.size(); ++i) {
      moved.position[i] += h * dx[i];
      moved.velocity[i] += h * dv[i];
    }
    return caller.force(moved).force;
  });
}

/// How far df(dx, dv) is from the derivative of the force.
Measured tangent_error(BatchCaller& caller, const CellBatch& batch, const Values& dx,
                       const Values& dv, const char* what) {
  const Values found = caller.tangent(batch, dx, dv);
  const double force = largest(caller.force(batch).force);
  return without_kinks([&](double step) {
    const Values expected = force_difference(caller, batch, dx, dv, step);
    const double noise = 1e-14 / step * force;  // rounding of forces that hardly change
    return compare(batch, found, expected, std::max({largest(found), largest(expected), noise}),
                   what);
  });
}

using Matrix = Eigen::MatrixXd;

/// -df/dx or -df/dv of the cell in a lane, its symmetric part.
Matrix stiffness_of(BatchCaller& caller, const CellBatch& batch, std::size_t lane, bool damping) {
  const auto n = static_cast<Eigen::Index>(3 * batch.nodes());
  Matrix k(n, n);
  const Values zero(batch.vector_size());
  for (Eigen::Index j = 0; j < n; ++j) {
    Values unit = zero;
    for (std::size_t l = 0; l < lane_count; ++l)
      unit[static_cast<std::size_t>(j) * lane_count + l] = 1;
    const Values df =
        damping ? caller.tangent(batch, zero, unit) : caller.tangent(batch, unit, zero);
    for (Eigen::Index i = 0; i < n; ++i)
      k(i, j) = -df[static_cast<std::size_t>(i) * lane_count + lane];
  }
  return (k + k.transpose()) / 2;
}

/// The block-diagonal matrix of suture.stable-dt/1.
Matrix bound_of(const Values& bounds, std::size_t nodes, std::size_t lane) {
  constexpr int place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};  // XX YY ZZ XY YZ XZ
  const auto count = static_cast<Eigen::Index>(nodes);
  Matrix bound = Matrix::Zero(3 * count, 3 * count);
  for (Eigen::Index n = 0; n < count; ++n)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        bound(3 * n + i, 3 * n + j) =
            bounds[(static_cast<std::size_t>(n) * 6 + static_cast<std::size_t>(place[i][j])) *
                       lane_count +
                   lane];
  return bound;
}

/// By how much the matrix of a cell exceeds its bound, over its largest eigenvalue.
double excess(const Matrix& matrix, const Matrix& bound) {
  const double scale = symmetric_eigenvalues(matrix).cwiseAbs().maxCoeff();
  if (scale == 0) return 0;
  return -symmetric_eigenvalues(bound - matrix).minCoeff() / scale;
}

}  // namespace

// At constant state: the energy of a law that is damaged falls as the damage grows.
Result gradient(const BatchCase& of) {
  if (of.batch.functor->field != 0) return {};  // see coupling()
  if (extension_of<suture_energy_1>(*of.batch.functor, SUTURE_ENERGY_1) == nullptr) return {};
  BatchCaller caller(of.instance);
  CellBatch batch = of.batch;
  std::ranges::fill(batch.velocity, 0);
  batch.dt = 0;
  keep_state_of_stretch(caller, batch);
  const Values found = caller.force(batch).force;
  return without_kinks([&](double step) {
    const Values expected = minus_gradient(caller, batch, step * size_of(batch));
    return compare(batch, found, expected, std::max(largest(found), largest(expected)),
                   "the force");
  });
}

Result tangent(const BatchCase& of) {
  if (of.batch.functor->field != 0) return {};  // see rates()
  if (extension_of<suture_tangent_1>(*of.batch.functor, SUTURE_TANGENT_1) == nullptr) return {};
  BatchCaller caller(of.instance);
  std::mt19937_64 random(of.seed);
  const Values zero(of.batch.vector_size()),
      direction = random_direction(random, zero.size(), size_of(of.batch));
  const Measured of_x = tangent_error(caller, of.batch, direction, zero, "df/dx dx");
  const Measured of_v = tangent_error(caller, of.batch, zero, direction, "df/dv dv");
  return of_x.figure >= of_v.figure ? of_x : of_v;
}

Result single_tangent(const BatchCase& of) {
  const suture_functor& functor = *of.batch.functor;
  if (extension_of<suture_tangent_1>(functor, SUTURE_TANGENT_1) == nullptr ||
      extension_of<suture_tangent_single_1>(functor, SUTURE_TANGENT_SINGLE_1) == nullptr)
    return {};
  BatchCaller caller(of.instance);
  std::mt19937_64 random(of.seed);
  const Values dx = random_direction(random, of.batch.vector_size(), size_of(of.batch)),
               dv = random_direction(random, of.batch.vector_size(), size_of(of.batch));
  const Values found = caller.single_tangent(of.batch, dx, dv);
  const Values expected = caller.tangent(of.batch, dx, dv);
  return compare(of.batch, found, expected, std::max(largest(found), largest(expected)),
                 "the tangent in single precision");
}

// Without velocities: what they add to df/dx is not part of the bounds.
Result step_bounds(const BatchCase& of) {
  const suture_functor& functor = *of.batch.functor;
  const auto* table = extension_of<suture_stable_dt_1>(functor, SUTURE_STABLE_DT_1);
  if (table == nullptr || extension_of<suture_tangent_1>(functor, SUTURE_TANGENT_1) == nullptr)
    return {};
  BatchCaller caller(of.instance);
  CellBatch still = of.batch;
  std::ranges::fill(still.velocity, 0);
  Values bounds[2] = {Values(still.vector_size() * 2), Values(still.vector_size() * 2)};
  BatchView view(still);
  caller.call("bounds", still, view.batch(),
              [&](const suture_context* context, const suture_batch* batch) {
                return table->bounds(context, batch, bounds[0].data(), bounds[1].data());
              });
  Measured worst;
  for (std::size_t lane = 0; lane < of.batch.valid; ++lane)
    for (const bool damping : {false, true}) {
      const double over = excess(stiffness_of(caller, still, lane, damping),
                                 bound_of(bounds[damping], still.nodes(), lane));
      if (!(over <= worst.figure))
        worst = {over, std::string("the bound of the ") + (damping ? "damping" : "stiffness") +
                           " of cell " + std::to_string(of.batch.ids[lane]) +
                           " is too small by this part of the largest eigenvalue"};
    }
  return worst;
}

}  // namespace suture::checks
