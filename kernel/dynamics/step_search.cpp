// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/step_search.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "kernel/forces/stable_step.hpp"

namespace suture {
namespace {

using Vector = std::vector<float>;

constexpr double tolerance = 0.03;  // of the eigenvalue; half of it on the step
constexpr double exact = 1e-3;      // a residual that single precision can still trust
constexpr int max_iterations = 80;
/// For modes around vertices that changed to come up. Of 6,600 searches after random
/// operations on small bodies 10 gave a step more than 3 % longer than one from random, 11 %
/// at most; 83 did without this.
constexpr int local_iterations = 8;

/// Iterations from a random vector of n components after which the quotient is within
/// `tolerance` of the largest eigenvalue but for one start in 10,000, whatever the other
/// eigenvalues (Kuczynski & Wozniakowski, SIAM J. Matrix Anal. 13 (1992) 1094, th. 4.1b):
///   P <= 1.648 sqrt(n) exp(-sqrt(tolerance) (2 k - 1))
/// A small residual alone only shows that some eigenvalue is near.
int iterations_from_random(std::size_t n) {
  const double factor = 1.648 * std::sqrt(static_cast<double>(n)) / 1e-4;
  return static_cast<int>(std::ceil((std::log(factor) / std::sqrt(tolerance) + 1) / 2));
}

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
  set_scales();
  if (std::ranges::none_of(scale_, [](float scale) { return scale > 0; }))
    return last_ = std::numeric_limits<double>::infinity();  // nothing is free
  const bool from_random = searches_++ % 16 == 0 || mode_.empty();
  const int least = from_random        ? iterations_from_random(scale_.size())
                    : changed_.empty() ? 0
                                       : local_iterations;
  if (from_random)
    start_at_random();
  else
    start_at_last();
  changed_.clear();
  if (!body_.models().reads_velocity()) {
    last_ = stable_step(largest_eigenvalue(1, 0, least).upper, 0);
  } else if (from_random) {
    const double undamped = stable_step(largest_eigenvalue(1, 0, 0).upper, 0);
    last_ = damped(undamped, 0);
    start_at_random();  // the mode of another dt is near to the wrong ones of this
    last_ = damped(last_, least);
  } else {
    last_ = damped(last_, least);
  }
  scale_ = Vector();  // gives its memory back, which = {} would not
  rows_ = image_rows_ = AlignedVector<float>();
  return last_;
}

/// Damping shortens the step. At the mode that limits it, k and c give the step at
/// which this mode reaches 1; another mode may take over there, so repeat.
double StepSearch::damped(double dt, int least) {
  for (int round = 0; round < 4; ++round) {
    if (!std::isfinite(dt)) dt = 1;
    const Eigenvalue both = largest_eigenvalue(dt * dt / 4, dt / 2, round == 0 ? least : 0);
    if (!(both.value > 0)) break;
    const double margin = both.upper / both.value;
    const double next = stable_step(margin * quotient(1, 0), margin * quotient(0, 1));
    const bool settled = std::abs(next - dt) < 0.01 * dt;
    dt = next;
    if (settled) break;
  }
  return dt;
}

/// 1/sqrt(m) from masses and fixed components.
void StepSearch::set_scales() {
  const std::size_t vertices = body_.attributes().vertex_count();
  const double* mass = body_.attributes().mass().rows();
  const double* fixed = body_.attributes().fixed().rows();
  scale_.resize(3 * vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    const int bits = mass[v] > 0 ? static_cast<int>(fixed[v]) : 7;
    for (std::size_t c = 0; c < 3; ++c)
      scale_[3 * v + c] = bits >> c & 1 ? 0 : static_cast<float>(1 / std::sqrt(mass[v]));
  }
}

/// Between -1/2 and 1/2; 0 where nothing moves.
float StepSearch::random_number(std::size_t i) {
  const double number = (random_() - 2147483647.5) / 4294967296.0;
  return scale_[i] == 0 ? 0.0F : static_cast<float>(number);
}

void StepSearch::start_at_random() {
  random_.seed();
  mode_.resize(scale_.size());
  for (std::size_t i = 0; i < mode_.size(); ++i) mode_[i] = random_number(i);
}

/// As large at the vertices that changed as the mode is in all.
void StepSearch::start_at_last() {
  mode_.resize(scale_.size());
  for (std::size_t i = 0; i < mode_.size(); ++i)
    if (scale_[i] == 0) mode_[i] = 0;
  const double size = length(mode_) / std::sqrt(static_cast<double>(changed_.size()) + 1) * 2;
  for (const Index v : changed_)
    for (std::size_t i = 3 * std::size_t{v}; i < 3 * std::size_t{v} + 3; ++i)
      mode_[i] += static_cast<float>(size * static_cast<double>(random_number(i)));
  if (!(length(mode_) > 0)) start_at_random();
}

void StepSearch::follow(const TopologyChange& change) {
  if (mode_.empty()) return;
  for (const Split& split : change.splits[0]) {
    mode_.resize(std::max(mode_.size(), 3 * (std::size_t{split.new_cell} + 1)));
    for (std::size_t c = 0; c < 3; ++c)
      mode_[3 * std::size_t{split.new_cell} + c] = mode_[3 * std::size_t{split.old_cell} + c];
  }
  changed_.insert(changed_.end(), change.stars[0].cells.begin(), change.stars[0].cells.end());
}

/// image = M^-1/2 (stiffness K + damping C) M^-1/2 x
void StepSearch::apply(const Vector& x, double stiffness, double damping, Vector& image) {
  rows_.assign(x.size() / 3 * 4, 0);
  image_rows_.assign(rows_.size(), 0);
  for (std::size_t i = 0; i < x.size(); ++i) rows_[i / 3 * 4 + i % 3] = scale_[i] * x[i];
  body_.models().add_tangent(rows_.data(), stiffness, damping, time_, image_rows_.data());
  image.resize(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) image[i] = image_rows_[i / 3 * 4 + i % 3];
  add_other_terms(stiffness, damping, image);
  for (std::size_t i = 0; i < x.size(); ++i) image[i] *= -scale_[i];
}

/// In double, as their interface has it.
void StepSearch::add_other_terms(double stiffness, double damping, Vector& image) {
  for (const auto& term : body_.loads()) {
    if (!term->is_stiff()) continue;
    direction_.resize(image.size());
    for (std::size_t i = 0; i < image.size(); ++i) direction_[i] = rows_[i / 3 * 4 + i % 3];
    image_.assign(image.size(), 0);
    term->add_tangent_for_step(direction_.data(), stiffness, damping, time_, image_.data());
    for (std::size_t i = 0; i < image.size(); ++i) image[i] += static_cast<float>(image_[i]);
  }
}

double StepSearch::quotient(double stiffness, double damping) {
  Vector image;
  apply(mode_, stiffness, damping, image);
  return std::max(dot(mode_, image), 0.0);
}

StepSearch::Eigenvalue StepSearch::largest_eigenvalue(double stiffness, double damping, int least) {
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
    const double wanted = iteration < least ? exact : tolerance;
    if (!(error > wanted * std::abs(found.value)) || iteration == max_iterations) break;
    combine(1 / error, residual.v, 0, residual.v);  // before: its image may be beyond a float
    apply(residual.v, stiffness, damping, residual.image);
    step_to_best(x, residual, last);
  }
  mode_ = std::move(x.v);
  return found;
}

void StepSearch::state(Archive& archive) {
  archive("searches", searches_);
  archive("last", last_);
  archive("mode", mode_);
  archive("changed", changed_);
  std::ostringstream text;
  text << random_;
  std::string engine = text.str();
  archive("random", engine);
  std::istringstream(engine) >> random_;
}

}  // namespace suture
