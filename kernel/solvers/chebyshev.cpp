// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/chebyshev.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

namespace suture {
namespace {

double product(const SingleVector& a, const SingleVector& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += double{a[i]} * double{b[i]};
  return sum;
}

void add(double factor, const SingleVector& from, SingleVector& to) {
  const auto f = static_cast<float>(factor);
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += f * from[i];
}

/// The same random numbers in every call: short waves have the largest eigenvalues.
SingleVector random_vector(std::size_t size) {
  std::minstd_rand random(1);
  SingleVector result(size);
  for (float& value : result)
    value = static_cast<float>(random()) / static_cast<float>(std::minstd_rand::max()) - 0.5f;
  return result;
}

/// The matrix D^-1 A in the basis of Lanczos' method, from the coefficients of conjugate gradients.
class Tridiagonal {
 public:
  void add(double step, double keep) {
    diagonal_.push_back(1 / step + (diagonal_.empty() ? 0 : keep / last_));
    if (diagonal_.size() > 1) below_.push_back(std::sqrt(keep) / last_);
    last_ = step;
  }
  double largest() const {
    if (diagonal_.empty()) return 0;
    const auto size = static_cast<Eigen::Index>(diagonal_.size());
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    solver.computeFromTridiagonal(Eigen::Map<const Eigen::VectorXd>(diagonal_.data(), size),
                                  Eigen::Map<const Eigen::VectorXd>(below_.data(), size - 1),
                                  Eigen::EigenvaluesOnly);
    return solver.eigenvalues()[size - 1];
  }

 private:
  std::vector<double> diagonal_, below_;
  double last_ = 1;
};

/// How much of each term is added to x, for polynomials of 1 to 4 terms: the best ones for a
/// V-cycle (Phillips and Fischer, arXiv:2210.03179, table 1).
constexpr unsigned max_steps = 4;
constexpr double parts[max_steps][max_steps] = {
    {1.125},
    {1.02387287570313, 1.26408905371085},
    {1.00842544782028, 1.08867839208730, 1.33753125909618},
    {1.00391310427285, 1.04035811188593, 1.14863498546254, 1.38268869241000}};

}  // namespace

void Chebyshev::set(const DiagonalBlocks& inverse, const SingleProduct& multiply) {
  // The estimate is a lower bound.
  constexpr double safety = 1.1;
  inverse_.resize(inverse.size() * 9);
  for (std::size_t v = 0; v < inverse.size(); ++v)
    Eigen::Map<Eigen::Matrix3f>(inverse_.data() + v * 9) = inverse[v].cast<float>();
  d_ = single_vector(inverse.size());
  q_ = single_vector(inverse.size());
  s_ = single_vector(inverse.size());
  largest_ = static_cast<float>(safety * estimate(multiply));
}

/// As good as 20 steps of power iteration.
double Chebyshev::estimate(const SingleProduct& multiply) const {
  constexpr unsigned steps = 10;
  SingleVector r = random_vector(d_.size()), z(d_.size());
  Tridiagonal lanczos;
  double rz = 0;
  for (unsigned i = 0; i < steps; ++i) {
    precondition(r, z);
    const double last = std::exchange(rz, product(r, z));
    const double keep = i == 0 ? 0 : rz / last;
    if (!(rz > 0)) break;
    for (std::size_t k = 0; k < d_.size(); ++k) d_[k] = z[k] + static_cast<float>(keep) * d_[k];
    multiply(d_.data(), q_.data());
    const double step = rz / product(d_, q_);
    if (!std::isfinite(step)) break;
    lanczos.add(step, keep);
    add(-step, q_, r);
  }
  return lanczos.largest();
}

void Chebyshev::precondition(const SingleVector& r, SingleVector& z) const {
  const float* b = inverse_.data();
  for (std::size_t i = 0; i + 3 < r.size(); i += 3, b += 9)
    for (std::size_t c = 0; c < 3; ++c)
      z[i + c] = b[c] * r[i] + b[3 + c] * r[i + 1] + b[6 + c] * r[i + 2];
}

void Chebyshev::advance(float keep, float add, const SingleVector& r) const {
  const float* b = inverse_.data();
  for (std::size_t i = 0; i + 3 < r.size(); i += 3, b += 9)
    for (std::size_t c = 0; c < 3; ++c)
      d_[i + c] =
          keep * d_[i + c] + add * (b[c] * r[i] + b[3 + c] * r[i + 1] + b[6 + c] * r[i + 2]);
}

void Chebyshev::smooth(const SingleProduct& multiply, unsigned steps, SingleVector& x,
                       SingleVector& r, bool finish) const {
  if (!(largest_ > 0)) return;
  if (finish) s_ = r;
  SingleVector& plain = finish ? s_ : r;
  for (unsigned i = 0; i < steps; ++i) {
    const auto odd = static_cast<float>(2 * i + 3);
    const double part = steps <= max_steps ? parts[steps - 1][i] : 1;
    advance(i == 0 ? 0.0f : static_cast<float>(2 * i - 1) / odd,
            static_cast<float>(8 * i + 4) / (odd * largest_), plain);
    add(part, d_, x);
    if (i + 1 == steps && !finish) return;
    multiply(d_.data(), q_.data());
    if (finish) add(-part, q_, r);
    if (i + 1 < steps) add(-1, q_, plain);
  }
}

void Chebyshev::correct(const SingleProduct& multiply, const SingleVector& correction,
                        SingleVector& x, SingleVector& r) const {
  multiply(correction.data(), q_.data());
  add(1, correction, x);
  add(-1, q_, r);
}

}  // namespace suture
