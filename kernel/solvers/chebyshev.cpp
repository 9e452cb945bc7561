// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/chebyshev.hpp"

#include <cmath>
#include <random>

namespace suture {

void Chebyshev::set(const DiagonalBlocks& inverse) {
  inverse_.resize(inverse.size() * 9 + 1);
  for (std::size_t v = 0; v < inverse.size(); ++v)
    Eigen::Map<Eigen::Matrix3f>(inverse_.data() + v * 9) = inverse[v].cast<float>();
  d_ = single_vector(inverse.size());
  q_ = single_vector(inverse.size());
}

void Chebyshev::start() {
  std::minstd_rand random(1);
  for (std::size_t i = 0; i + 1 < d_.size(); ++i)
    q_[i] = static_cast<float>(random()) / static_cast<float>(std::minstd_rand::max()) - 0.5f;
  SingleVector ignored(d_.size());
  advance(0, 1, q_, ignored);
}

double Chebyshev::normalise() {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < d_.size(); ++i) sum += double{d_[i]} * d_[i];
  const double size = std::sqrt(sum);
  const auto scale = static_cast<float>(size > 0 ? 1 / size : 0);
  for (float& value : d_) value *= scale;
  return size;
}

void Chebyshev::advance(float keep, float add, const SingleVector& r, SingleVector& x) const {
  const std::size_t size = d_.size() - 1;
  const float* b = inverse_.data();
  for (std::size_t i = 0; i < size; i += 3, b += 9)
    for (std::size_t c = 0; c < 3; ++c) {
      const float step = b[c] * r[i] + b[3 + c] * r[i + 1] + b[6 + c] * r[i + 2];
      d_[i + c] = keep * d_[i + c] + add * step;
      x[i + c] += d_[i + c];
    }
}

void Chebyshev::subtract_product(SingleVector& r) const {
  for (std::size_t i = 0; i < r.size(); ++i) r[i] -= q_[i];
}

}  // namespace suture
