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
double sum_of_products(std::span<const float> a, std::span<const float> b) {
  std::array<double, 8> sums{};
  std::size_t i = 0;
  for (; i + 8 <= a.size(); i += 8)
    for (std::size_t k = 0; k < 8; ++k) sums[k] += static_cast<double>(a[i + k]) * b[i + k];
  for (; i < a.size(); ++i) sums[0] += static_cast<double>(a[i]) * b[i];
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

}  // namespace

// ------------------------------------------------------------------ vectors --

bool StepSearch::may_divide() const {
  bool is_stiff = false;
  for_each_with<TangentTerm>(body_.loads(),
                             [&](const TangentTerm& term) { is_stiff |= term.is_stiff(); });
  return body_.models().may_divide() && !is_stiff;
}

void StepSearch::take_share() {
  is_divided_ = may_divide();
  if (!is_divided_) {
    complete();
    ranges_.assign(1, {0, body_.attributes().vertex_count()});
    return;
  }
  BodyShare& share = *body_.share();
  if (!body_.models().knows_share()) body_.models().find_share();
  ranges_.assign(share.own().begin(), share.own().end());
  ranges_.push_back({share.common_begin(), body_.attributes().vertex_count()});
  if (has_all_rows_)
    for (Vector* values : {&mode_.v, &mode_.image, &difference_.v, &difference_.image}) {
      if (values->empty()) continue;
      values->resize(3 * std::size_t{body_.attributes().vertex_count()});
      share.release({values->data(), 3});
    }
  has_all_rows_ = false;
}

void StepSearch::complete() {
  if (!has_all_rows_)
    for (Vector* values : {&mode_.v, &mode_.image, &difference_.v, &difference_.image})
      if (!values->empty()) body_.share()->complete({values->data(), 3});
  has_all_rows_ = true;
}

template <class Visit>
void StepSearch::for_each_number(Visit visit) const {
  for (const auto& [begin, end] : ranges_)
    for (std::size_t i = 3 * std::size_t{begin}; i < 3 * std::size_t{end}; ++i) visit(i);
}

/// a = s a + t b
void StepSearch::combine(double s, Vector& a, double t, const Vector& b) const {
  float* const to = a.data();
  const float* const other = b.data();
  for_each_number([=](std::size_t i) {
    to[i] = static_cast<float>(s * static_cast<double>(to[i]) + t * static_cast<double>(other[i]));
  });
}

void StepSearch::scale(Direction& direction, double s) const {
  combine(s, direction.v, 0, direction.v);
  if (!direction.image.empty()) combine(s, direction.image, 0, direction.image);
}

void StepSearch::add(Direction& direction, double t, const Direction& other) const {
  combine(1, direction.v, t, other.v);
  combine(1, direction.image, t, other.image);
}

/// Summed by blocks of vertices, in their order. One exchange.
std::vector<double> StepSearch::inner_products(std::span<const Factors> factors) {
  constexpr Index block = BodyShare::block;
  const std::size_t vertices = scale_.size() / 3, width = factors.size();
  std::vector<double> sums((vertices + block - 1) / block * width);
  for (const auto& [begin, end] : ranges_)
    for (Index first = begin; first < end; first += block) {
      const std::size_t at = 3 * std::size_t{first}, size = 3 * std::min(block, end - first);
      for (std::size_t i = 0; i < width; ++i)
        sums[first / block * width + i] = sum_of_products({factors[i].one.data() + at, size},
                                                          {factors[i].other.data() + at, size});
    }
  if (is_divided_) body_.share()->join_blocks(sums, width, true);
  std::vector<double> totals(width);
  for (std::size_t i = 0; i < sums.size(); ++i) totals[i % width] += sums[i];
  return totals;
}

double StepSearch::inner_product(const Vector& a, const Vector& b) {
  const Factors factors{a, b};
  return inner_products({&factors, 1})[0];
}

double StepSearch::length(const Vector& a) { return std::sqrt(inner_product(a, a)); }

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
  if (!is_free()) return finish(std::numeric_limits<double>::infinity());  // nothing is free
  if (stage_ == Stage::begun) start();
  scale(mode_, 1 / length(mode_.v));
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
  for (Vector* values : {&mode_.image, &residual_.v, &residual_.image, &difference_.v,
                         &difference_.image, &scale_, &rows_, &image_rows_})
    *values = Vector();
  return true;
}

// --------------------------------------------------------------- one iteration --

/// The residual of the mode, and its Rayleigh quotient.
void StepSearch::find_residual() {
  found_.value = inner_product(mode_.v, mode_.image);
  residual_.v.resize(mode_.image.size());
  for_each_number([&](std::size_t i) { residual_.v[i] = mode_.image[i]; });
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
    scale(difference_, 1 / length(difference_.v));
    for (const Direction* other : {&mode_, &residual_})
      add(difference_, -inner_product(difference_.v, other->v), *other);
    // What little is left of a direction that the others span is rounding.
    if (length(difference_.v) > 0.01) basis.push_back(&difference_);
  }
  const auto size = static_cast<Eigen::Index>(basis.size());
  std::vector<Factors> factors;
  for (std::size_t i = 0; i < basis.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      factors.push_back({basis[i]->v, basis[j]->v});
      factors.push_back({basis[i]->v, basis[j]->image});
    }
  const std::vector<double> products = inner_products(factors);
  Eigen::MatrixXd gram(size, size), ritz(size, size);
  auto next = products.begin();
  for (Eigen::Index i = 0; i < size; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) {
      gram(i, j) = gram(j, i) = *next++;
      ritz(i, j) = ritz(j, i) = *next++;
    }
  const Eigen::VectorXd best = symmetric_eigen(ritz, gram).vectors.col(size - 1);
  scale(residual_, best[1]);
  if (size == 3) add(residual_, best[2], difference_);
  std::swap(difference_, residual_);
  scale(mode_, best[0]);
  add(mode_, 1, difference_);
}

namespace {

/// 1/sqrt(m) of a component of a vertex, 0 where nothing moves.
float scale_of(std::size_t v, std::size_t c, const double* mass, const double* fixed) {
  const int bits = mass[v] > 0 ? static_cast<int>(fixed[v]) : 7;
  return bits >> c & 1 ? 0 : static_cast<float>(1 / std::sqrt(mass[v]));
}

}  // namespace

void StepSearch::set_scales() {
  take_share();
  const double* mass = body_.attributes().mass().rows();
  const double* fixed = body_.attributes().fixed().rows();
  scale_.resize(3 * std::size_t{body_.attributes().vertex_count()});
  for_each_number([&](std::size_t i) { scale_[i] = scale_of(i / 3, i % 3, mass, fixed); });
  for (Vector* values : {&mode_.v, &mode_.image, &difference_.v, &difference_.image}) {
    if (values->empty()) continue;
    values->resize(scale_.size());
    for_each_number([&](std::size_t i) {
      if (scale_[i] == 0) (*values)[i] = 0;
    });
  }
}

/// Whether anything moves, here or on another process.
bool StepSearch::is_free() const {
  const double* mass = body_.attributes().mass().rows();
  const double* fixed = body_.attributes().fixed().rows();
  for (std::size_t i = 0; i < scale_.size(); ++i)
    if (scale_of(i / 3, i % 3, mass, fixed) > 0) return true;
  return false;
}

/// Between -1/2 and 1/2.
float StepSearch::random_number() {
  return static_cast<float>((random_() - 2147483647.5) / 4294967296.0);
}

/// Every process draws the numbers of all.
void StepSearch::start_at_random() {
  random_.seed();
  mode_.v.resize(scale_.size());
  std::size_t next = 0;
  const auto skip_to = [&](std::size_t i) { random_.discard(i - std::exchange(next, i)); };
  for_each_number([&](std::size_t i) {
    skip_to(i);
    const float number = random_number();
    ++next;
    mode_.v[i] = scale_[i] == 0 ? 0 : number;
  });
  skip_to(scale_.size());
}

/// As large at the vertices that changed as the mode is in all.
void StepSearch::start_at_last() {
  const double size = length(mode_.v) / std::sqrt(static_cast<double>(changed_.size()) + 1) * 2;
  for (const Index v : changed_) {
    const bool is_mine = std::ranges::any_of(
        ranges_, [v](const loops::Rows& range) { return range.begin <= v && v < range.end; });
    for (std::size_t i = 3 * std::size_t{v}; i < 3 * std::size_t{v} + 3; ++i) {
      const float number = random_number();
      if (is_mine && scale_[i] != 0)
        mode_.v[i] += static_cast<float>(size * static_cast<double>(number));
    }
  }
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
  rows_.resize(x.size() / 3 * 4);
  image_rows_.resize(rows_.size());
  const auto row_of = [](std::size_t i) { return i / 3 * 4 + i % 3; };
  for_each_number([&](std::size_t i) {
    rows_[row_of(i)] = scale_[i] * x[i];
    image_rows_[row_of(i)] = 0;
  });
  if (is_divided_) {
    BodyShare& share = *body_.share();
    share.join_borders({rows_.data(), 4});
    for (const Index v : share.borders()) std::fill_n(&image_rows_[std::size_t{v} * 4], 4, 0.0F);
    body_.models().add_own_tangent(rows_.data(), stiffness, damping, time_, image_rows_.data());
  } else {
    body_.models().add_tangent(rows_.data(), stiffness, damping, time_, image_rows_.data());
  }
  image.resize(x.size());
  for_each_number([&](std::size_t i) { image[i] = image_rows_[row_of(i)]; });
  add_other_terms(stiffness, damping, image);
  for_each_number([&](std::size_t i) { image[i] *= -scale_[i]; });
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
  if (archive.loads())
    has_all_rows_ = true;
  else
    complete();
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
