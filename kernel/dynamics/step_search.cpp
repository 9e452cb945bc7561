// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/step_search.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "kernel/dynamics/stable_step.hpp"

namespace suture {
namespace {

using Vector = std::vector<float>;

constexpr double tolerance = 0.03;  // of the residual; half of it on the step
constexpr int most_iterations = 60;

double dot(const Vector& a, const Vector& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i]) * b[i];
  return sum;
}

double length(const Vector& a) { return std::sqrt(dot(a, a)); }

/// a = s a + t b
void combine(double s, Vector& a, double t, const Vector& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    a[i] = static_cast<float>(s * static_cast<double>(a[i]) + t * static_cast<double>(b[i]));
}

/// Fractional parts of multiples of the golden ratio: nothing that a mode is orthogonal to.
float spread(std::size_t i) {
  const double golden = 0.6180339887498949 * static_cast<double>(i + 1);
  return static_cast<float>(golden - std::floor(golden) - 0.5);
}

}  // namespace

struct StepSearch::Direction {
  Vector v, image;

  void scale(double s) {
    combine(s, v, 0, v);
    combine(s, image, 0, image);
  }
  void add(double t, const Direction& other) {
    combine(1, v, t, other.v);
    combine(1, image, t, other.image);
  }
};

/// Replaces x by the vector of largest Rayleigh quotient in the space of x, the residual
/// and the last direction, which becomes the difference to the old x.
void StepSearch::step_to_best(Direction& x, Direction& residual, Direction& last) {
  std::vector<Direction*> basis{&x, &residual};
  if (!last.v.empty()) {
    last.scale(1 / length(last.v));
    for (const Direction* other : {&x, &residual}) last.add(-dot(last.v, other->v), *other);
    // What little is left of a direction that the others span is rounding.
    if (length(last.v) > 0.01) basis.push_back(&last);
  }
  const auto size = static_cast<Eigen::Index>(basis.size());
  Eigen::MatrixXd gram(size, size), ritz(size, size);
  for (Eigen::Index i = 0; i < size; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) {
      gram(i, j) = gram(j, i) = dot(basis[i]->v, basis[j]->v);
      ritz(i, j) = ritz(j, i) = dot(basis[i]->v, basis[j]->image);
    }
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(ritz, gram);
  const Eigen::VectorXd best = solver.eigenvectors().col(size - 1);
  residual.scale(best[1]);
  if (size == 3) residual.add(best[2], last);
  std::swap(last, residual);
  x.scale(best[0]);
  x.add(1, last);
}

double StepSearch::largest(double time) {
  time_ = time;
  start();
  const auto [stiffness, stiffest] = largest_eigenvalue(1, 0);
  double dt = stable_step(stiffest, 0);
  // Damping shortens the step. At the mode that limits it, k and c give the step at
  // which this mode reaches 1; another mode may take over there, so repeat.
  for (int round = 0; forces_.reads_velocity() && round < 4; ++round) {
    if (!std::isfinite(dt)) dt = 1;
    const Eigenvalue both = largest_eigenvalue(dt * dt / 4, dt / 2);
    if (!(both.value > 0)) break;
    const double margin = both.upper / both.value;
    const double next = stable_step(margin * quotient(1, 0), margin * quotient(0, 1));
    const bool settled = std::abs(next - dt) < 0.01 * dt;
    dt = next;
    if (settled) break;
  }
  scale_ = Vector();  // gives its memory back, which = {} would not
  scaled_ = Vector();
  return dt;
}

/// Scales from masses and fixed components; a mode that is unknown, or that a cut gave
/// new vertices, is filled up.
void StepSearch::start() {
  const std::size_t vertices = attributes_.vertex_count();
  const double* mass = attributes_.mass().rows();
  const double* fixed = attributes_.fixed().rows();
  scale_.resize(3 * vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    const int bits = mass[v] > 0 ? static_cast<int>(fixed[v]) : 7;
    for (std::size_t c = 0; c < 3; ++c)
      scale_[3 * v + c] = bits >> c & 1 ? 0 : static_cast<float>(1 / std::sqrt(mass[v]));
  }
  const std::size_t known = std::min(mode_.size(), 3 * vertices);
  const float size = known > 0 ? 0.1F / std::sqrt(static_cast<float>(known)) : 1.0F;
  mode_.resize(3 * vertices);
  for (std::size_t i = known; i < mode_.size(); ++i) mode_[i] = size * spread(i);
  for (std::size_t i = 0; i < mode_.size(); ++i)
    if (scale_[i] == 0) mode_[i] = 0;
}

/// image = M^-1/2 (stiffness K + damping C) M^-1/2 x
void StepSearch::apply(const Vector& x, double stiffness, double damping, Vector& image) {
  scaled_.resize(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) scaled_[i] = scale_[i] * x[i];
  image.assign(x.size(), 0);
  forces_.add_tangent(scaled_.data(), stiffness, damping, time_, image.data());
  for (std::size_t i = 0; i < x.size(); ++i) image[i] *= -scale_[i];
}

double StepSearch::quotient(double stiffness, double damping) {
  Vector image;
  apply(mode_, stiffness, damping, image);
  return std::max(dot(mode_, image), 0.0);
}

StepSearch::Eigenvalue StepSearch::largest_eigenvalue(double stiffness, double damping) {
  Direction x{std::move(mode_), {}}, residual, last;
  Eigenvalue found{};
  for (int iteration = 0;; ++iteration) {
    x.scale(1 / length(x.v));
    if (iteration % 8 == 0) apply(x.v, stiffness, damping, x.image);  // sums lose digits
    found.value = dot(x.v, x.image);
    residual.v = x.image;
    combine(1, residual.v, -found.value, x.v);
    const double error = length(residual.v);
    found.upper = found.value + error;
    if (!(error > tolerance * std::abs(found.value)) || iteration == most_iterations) break;
    apply(residual.v, stiffness, damping, residual.image);
    residual.scale(1 / error);
    step_to_best(x, residual, last);
  }
  mode_ = std::move(x.v);
  return found;
}

}  // namespace suture
