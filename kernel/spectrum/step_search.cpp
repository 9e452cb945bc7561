// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/spectrum/step_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>

#include "kernel/forces/stable_step.hpp"
#include "kernel/solvers/symmetric_eigen.hpp"

namespace suture {
namespace {

using Vector = std::vector<float>;

constexpr double tolerance = 0.03;  // of the eigenvalue; half of it on the step
constexpr double exact = 1e-3;      // a residual that single precision can still trust
constexpr int max_search_iterations = 80;
/// For modes around vertices that changed to come up. Of 6,600 searches after random
/// operations on small bodies 10 gave a step more than 3 % longer than one from random, 11 %
/// at most; 83 did without this.
constexpr int local_iterations = 8;
constexpr int max_rounds = 4;  // with damping

/// Iterations from a random vector of n components after which the quotient is within
/// `tolerance` of the largest eigenvalue but for one start in 10,000, whatever the other
/// eigenvalues (Kuczynski & Wozniakowski, SIAM J. Matrix Anal. 13 (1992) 1094, th. 4.1b):
///   P <= 1.648 sqrt(n) exp(-sqrt(tolerance) (2 k - 1))
/// A small residual alone only shows that some eigenvalue is near.
int iterations_from_random(std::size_t n) {
  const double factor = 1.648 * std::sqrt(static_cast<double>(n)) / 1e-4;
  return static_cast<int>(std::ceil((std::log(factor) / std::sqrt(tolerance) + 1) / 2));
}

/// In eight sums: one alone waits for each addition, and took longer than a derivative.
double inner_product(const Vector& a, const Vector& b) {
  std::array<double, 8> sums{};
  std::size_t i = 0;
  for (; i + 8 <= a.size(); i += 8)
    for (std::size_t k = 0; k < 8; ++k) sums[k] += static_cast<double>(a[i + k]) * b[i + k];
  for (; i < a.size(); ++i) sums[0] += static_cast<double>(a[i]) * b[i];
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

double length(const Vector& a) { return std::sqrt(inner_product(a, a)); }

/// a = s a + t b
void combine(double s, Vector& a, double t, const Vector& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    a[i] = static_cast<float>(s * static_cast<double>(a[i]) + t * static_cast<double>(b[i]));
}

}  // namespace

void StepSearch::Direction::scale(double s) {
  combine(s, v, 0, v);
  combine(s, image, 0, image);
}

void StepSearch::Direction::add(double t, const Direction& other) {
  combine(1, v, t, other.v);
  combine(1, image, t, other.image);
}

/// The new vertex moves as the one that it separated from.
void StepSearch::Direction::follow(const Split& split) {
  for (Vector* values : {&v, &image}) {
    if (values->empty()) continue;
    values->resize(std::max(values->size(), 3 * (std::size_t{split.new_cell} + 1)));
    for (std::size_t c = 0; c < 3; ++c)
      (*values)[3 * std::size_t{split.new_cell} + c] =
          (*values)[3 * std::size_t{split.old_cell} + c];
  }
}

// ------------------------------------------------------------------ the search --

double StepSearch::largest(double time) {
  begin();
  time_ = time;
  set_scales();
  while (!iterate()) continue;
  return result_;
}

void StepSearch::begin() {
  stage_ = Stage::begun;
  difference_ = {};
}

bool StepSearch::advance(double time) {
  time_ = time;
  set_scales();
  ++image_age_;
  return iterate();
}

/// True if the search is over. One directional derivative, or those that take_eigenvalue() needs.
bool StepSearch::iterate() {
  if (std::ranges::none_of(scale_, [](float scale) { return scale > 0; }))
    return finish(std::numeric_limits<double>::infinity());  // nothing is free
  if (stage_ == Stage::begun) start();
  mode_.scale(1 / length(mode_.v));
  if (mode_.image.empty()) {
    apply(mode_.v, stiffness_, damping_, mode_.image);
    image_age_ = 0;
    return false;
  }
  find_residual();
  const bool is_enough = is_good_enough();
  if (is_enough && image_age_ <= 1) return take_eigenvalue();
  if (!is_enough) step_to_best();
  if (is_enough || ++iteration_ % 8 == 0) mode_.image.clear();  // sums lose digits
  return false;
}

void StepSearch::start() {
  const bool from_random = searches_++ % 16 == 0 || mode_.v.empty();
  least_of_search_ = from_random        ? iterations_from_random(scale_.size())
                     : changed_.empty() ? 0
                                        : local_iterations;
  if (from_random)
    start_at_random();
  else
    start_at_last();
  changed_.clear();
  const bool damped = body_.models().reads_velocity();
  stage_ = !damped || from_random ? Stage::undamped : Stage::damped;
  round_ = 0;
  if (stage_ == Stage::undamped)
    begin_eigenvalue(1, 0, damped ? 0 : least_of_search_);
  else
    begin_damped(result_, least_of_search_);
}

void StepSearch::begin_eigenvalue(double stiffness, double damping, int least) {
  stiffness_ = stiffness;
  damping_ = damping;
  least_ = least;
  iteration_ = 0;
  mode_.image.clear();
  difference_ = {};
}

void StepSearch::begin_damped(double dt, int least) {
  dt_ = std::isfinite(dt) ? dt : 1;
  begin_eigenvalue(dt_ * dt_ / 4, dt_ / 2, least);
}

/// Damping shortens the step. At the mode that limits it, k and c give the step at which this mode
/// reaches 1; another mode may take over there, so repeat. True if the search is over.
bool StepSearch::take_eigenvalue() {
  if (stage_ == Stage::undamped) {
    const double dt = stable_step(found_.upper, 0);
    if (!body_.models().reads_velocity()) return finish(dt);
    stage_ = Stage::approach;
    begin_damped(dt, 0);
    return false;
  }
  const double before = dt_;
  bool settled = !(found_.value > 0);
  if (!settled) {
    const double margin = found_.upper / found_.value;
    dt_ = stable_step(margin * quotient(1, 0), margin * quotient(0, 1));
    settled = std::abs(dt_ - before) < 0.01 * before;
  }
  if (!settled && ++round_ < max_rounds) {
    begin_damped(dt_, 0);
    return false;
  }
  if (stage_ == Stage::damped) return finish(dt_);
  stage_ = Stage::damped;
  round_ = 0;
  start_at_random();  // the mode of another dt is near to the wrong ones of this
  begin_damped(dt_, least_of_search_);
  return false;
}

bool StepSearch::finish(double dt) {
  result_ = dt;
  stage_ = Stage::begun;
  // Gives the memory back, which = {} would not.
  for (Vector* values :
       {&mode_.image, &residual_.v, &residual_.image, &difference_.v, &difference_.image, &scale_})
    *values = Vector();
  rows_ = image_rows_ = AlignedVector<float>();
  return true;
}

// --------------------------------------------------------------- one iteration --

/// The residual of the mode, and its Rayleigh quotient.
void StepSearch::find_residual() {
  found_.value = inner_product(mode_.v, mode_.image);
  residual_.v = mode_.image;
  combine(1, residual_.v, -found_.value, mode_.v);
  found_.upper = found_.value + length(residual_.v);
}

bool StepSearch::is_good_enough() const {
  const double wanted = iteration_ < least_ ? exact : tolerance;
  const double error = found_.upper - found_.value;
  return !(error > wanted * std::abs(found_.value)) || iteration_ >= max_search_iterations;
}

/// Replaces the mode by the vector of largest Rayleigh quotient in the space of the mode, its
/// residual and the last difference, which becomes the difference to the old mode.
void StepSearch::step_to_best() {
  // Before it is multiplied: its image may be beyond a float.
  combine(1 / length(residual_.v), residual_.v, 0, residual_.v);
  apply(residual_.v, stiffness_, damping_, residual_.image);
  std::vector<Direction*> basis{&mode_, &residual_};
  if (!difference_.v.empty()) {
    difference_.scale(1 / length(difference_.v));
    for (const Direction* other : {&mode_, &residual_})
      difference_.add(-inner_product(difference_.v, other->v), *other);
    // What little is left of a direction that the others span is rounding.
    if (length(difference_.v) > 0.01) basis.push_back(&difference_);
  }
  const auto size = static_cast<Eigen::Index>(basis.size());
  Eigen::MatrixXd gram(size, size), ritz(size, size);
  for (Eigen::Index i = 0; i < size; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) {
      gram(i, j) = gram(j, i) = inner_product(basis[i]->v, basis[j]->v);
      ritz(i, j) = ritz(j, i) = inner_product(basis[i]->v, basis[j]->image);
    }
  const Eigen::VectorXd best = symmetric_eigen(ritz, gram).vectors.col(size - 1);
  residual_.scale(best[1]);
  if (size == 3) residual_.add(best[2], difference_);
  std::swap(difference_, residual_);
  mode_.scale(best[0]);
  mode_.add(1, difference_);
}

/// 1/sqrt(m) from masses and fixed components. Nothing moves where it is 0.
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
  for (Vector* values : {&mode_.v, &mode_.image, &difference_.v, &difference_.image}) {
    if (values->empty()) continue;
    values->resize(scale_.size());
    for (std::size_t i = 0; i < values->size(); ++i)
      if (scale_[i] == 0) (*values)[i] = 0;
  }
}

/// Between -1/2 and 1/2; 0 where nothing moves.
float StepSearch::random_number(std::size_t i) {
  const double number = (random_() - 2147483647.5) / 4294967296.0;
  return scale_[i] == 0 ? 0.0F : static_cast<float>(number);
}

void StepSearch::start_at_random() {
  random_.seed();
  mode_.v.resize(scale_.size());
  for (std::size_t i = 0; i < mode_.v.size(); ++i) mode_.v[i] = random_number(i);
}

/// As large at the vertices that changed as the mode is in all.
void StepSearch::start_at_last() {
  const double size = length(mode_.v) / std::sqrt(static_cast<double>(changed_.size()) + 1) * 2;
  for (const Index v : changed_)
    for (std::size_t i = 3 * std::size_t{v}; i < 3 * std::size_t{v} + 3; ++i)
      mode_.v[i] += static_cast<float>(size * static_cast<double>(random_number(i)));
  if (!(length(mode_.v) > 0)) start_at_random();
}

void StepSearch::follow(const TopologyChange& change) {
  if (mode_.v.empty()) return;
  for (const Split& split : change.splits[0]) {
    mode_.follow(split);
    difference_.follow(split);
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
  for_each_with<TangentTerm>(body_.loads(), [&](TangentTerm& term) {
    if (!term.is_stiff()) return;
    direction_.resize(image.size());
    for (std::size_t i = 0; i < image.size(); ++i) direction_[i] = rows_[i / 3 * 4 + i % 3];
    image_.assign(image.size(), 0);
    term.add_tangent_for_step(direction_.data(), stiffness, damping, time_, image_.data());
    for (std::size_t i = 0; i < image.size(); ++i) image[i] += static_cast<float>(image_[i]);
  });
}

double StepSearch::quotient(double stiffness, double damping) {
  Vector image;
  apply(mode_.v, stiffness, damping, image);
  return std::max(inner_product(mode_.v, image), 0.0);
}

void StepSearch::state(Archive& archive) {
  archive("searches", searches_);
  archive("last", result_);
  archive("mode", mode_.v);
  archive("changed", changed_);
  archive("stage", stage_);
  archive("stiffness", stiffness_);
  archive("damping", damping_);
  archive("least", least_);
  archive("least of search", least_of_search_);
  archive("iteration", iteration_);
  archive("round", round_);
  archive("dt", dt_);
  archive("image", mode_.image);
  archive("image age", image_age_);
  archive("difference", difference_.v);
  archive("image of difference", difference_.image);
  std::ostringstream text;
  text << random_;
  std::string engine = text.str();
  archive("random", engine);
  std::istringstream(engine) >> random_;
}

}  // namespace suture
