// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/conjugate_gradients.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "kernel/base/error.hpp"

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

double dot(std::span<const double> a, std::span<const double> b) {
  constexpr std::size_t part = 1024;
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); i += part) {
    const std::size_t count = std::min(part, a.size() - i);
    sum += view(a.subspan(i, count)).dot(view(b.subspan(i, count)));
  }
  return sum;
}

LinearSolve ConjugateGradients::solve(const TangentMatrix& a, const Preconditioner& preconditioner,
                                      std::span<const double> b, std::span<double> x,
                                      double tolerance, const IterationLimit& limit) {
  return solve([&](const double* d, double* out) { a.apply(d, out); },
               [&](const double* r, double* z) { preconditioner.apply(r, z); }, b, x, tolerance,
               limit);
}

LinearSolve ConjugateGradients::solve(const Product& a, const Product& preconditioner,
                                      std::span<const double> b, std::span<double> x,
                                      double tolerance, const IterationLimit& limit) {
  for (auto* vector : {&r_, &z_, &d_, &q_}) vector->resize(b.size());
  std::ranges::copy(b, r_.begin());
  std::ranges::fill(x, 0.0);
  const double target = tolerance * std::sqrt(dot(b, b));
  LinearSolve result;
  double rz = 0;
  for (;; ++result.iterations) {
    const double residual = std::sqrt(dot(r_, r_));
    result.residual = target > 0 ? residual / target * tolerance : 0;
    if (!(residual > target)) return result;
    if (limit.ends(result.iterations)) {
      result.outcome = LinearSolve::Outcome::too_many;
      return result;
    }
    preconditioner(r_.data(), z_.data());
    const double last = std::exchange(rz, dot(r_, z_));
    if (result.iterations == 0)
      d_ = z_;
    else
      view(std::span(d_)) = view(std::span(z_)) + rz / last * view(std::span(d_));
    a(d_.data(), q_.data());
    const double curvature = dot(d_, q_);
    if (!std::isfinite(curvature)) throw NumericalError("the tangent is not finite");
    if (!(curvature > 0)) {
      result.outcome = LinearSolve::Outcome::indefinite;
      if (result.iterations == 0) std::ranges::copy(d_, x.begin());
      return result;
    }
    view(x) += rz / curvature * view(std::span(d_));
    view(std::span(r_)) -= rz / curvature * view(std::span(q_));
  }
}

}  // namespace suture
