// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/conjugate_gradients.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/solvers/single_vector.hpp"

namespace suture {
namespace {

using Vector = Eigen::Map<Eigen::VectorXd>;
using ConstVector = Eigen::Map<const Eigen::VectorXd>;

ConstVector view(std::span<const double> v) {
  return {v.data(), static_cast<Eigen::Index>(v.size())};
}
Vector view(std::span<double> v) { return {v.data(), static_cast<Eigen::Index>(v.size())}; }

}  // namespace

IterationLimit checked_limit(unsigned most, const std::function<void()>& check) {
  constexpr unsigned between_checks = 16;
  if (!check) return most;
  return {most, [check, made = 0U]() mutable {
            if (++made % between_checks == 0) check();
            return false;
          }};
}

double dot(std::span<const double> a, std::span<const double> b, const Workers* workers) {
  constexpr std::size_t part = 1024, parts_at_once = 16;
  std::vector<double> sums((a.size() + part - 1) / part);
  for_chunks(sums.size(), parts_at_once, workers,
             [&](std::size_t first, std::size_t end, std::size_t) {
               for (std::size_t i = first; i < end; ++i) {
                 const std::size_t count = std::min(part, a.size() - i * part);
                 sums[i] = view(a.subspan(i * part, count)).dot(view(b.subspan(i * part, count)));
               }
             });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

LinearSolve ConjugateGradients::solve(const TangentMatrix& a, const Preconditioner& preconditioner,
                                      std::span<const double> b, std::span<double> x,
                                      double tolerance, const IterationLimit& limit) {
  return solve([&](const double* d, double* out) { a.apply(d, out); },
               [&](const double* r, double* z) { preconditioner.apply(r, z); }, b, x, tolerance,
               limit, a.workers());
}

LinearSolve ConjugateGradients::solve(const Product& a, const Product& preconditioner,
                                      std::span<const double> b, std::span<double> x,
                                      double tolerance, const IterationLimit& limit,
                                      const Workers* workers) {
  const auto for_parts = [&](auto&& visit) {
    for_chunks(b.size(), vector_chunk, workers,
               [&](std::size_t first, std::size_t end, std::size_t) {
                 visit([=](std::span<double> v) { return view(v.subspan(first, end - first)); });
               });
  };
  for (auto* vector : {&r_, &z_, &d_, &q_}) vector->resize(b.size());
  std::ranges::copy(b, r_.begin());
  std::ranges::fill(x, 0.0);
  const double target = tolerance * std::sqrt(dot(b, b, workers));
  LinearSolve result;
  double rz = 0;
  for (;; ++result.iterations) {
    const double residual = std::sqrt(dot(r_, r_, workers));
    result.residual = target > 0 ? residual / target * tolerance : 0;
    if (!(residual > target)) return result;
    if (limit.ends(result.iterations)) {
      result.outcome = LinearSolve::Outcome::too_many;
      return result;
    }
    preconditioner(r_.data(), z_.data());
    const double last = std::exchange(rz, dot(r_, z_, workers));
    if (result.iterations == 0)
      d_ = z_;
    else
      for_parts([&](auto of) { of(d_) = of(z_) + rz / last * of(d_); });
    a(d_.data(), q_.data());
    const double curvature = dot(d_, q_, workers);
    if (!std::isfinite(curvature)) throw NumericalError("the tangent is not finite");
    if (!(curvature > 0)) {
      result.outcome = LinearSolve::Outcome::indefinite;
      if (result.iterations == 0) std::ranges::copy(d_, x.begin());
      return result;
    }
    for_parts([&](auto of) {
      of(x) += rz / curvature * of(d_);
      of(r_) -= rz / curvature * of(q_);
    });
  }
}

}  // namespace suture
