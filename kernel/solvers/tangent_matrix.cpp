// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/tangent_matrix.hpp"

#include <algorithm>

namespace suture {

TangentMatrix::TangentMatrix(Attributes& attributes,
                             const std::vector<std::unique_ptr<ForceTerm>>& terms)
    : attributes_(attributes), terms_(terms) {}

void TangentMatrix::set(const TangentTime& at, double mass, double velocity, double load) {
  at_ = at;
  mass_ = mass;
  velocity_ = velocity;
  load_ = load;
  const Column &masses = attributes_.mass(), &fixed = attributes_.fixed();
  free_.resize(std::size_t{attributes_.vertex_count()} * 3);
  for (Index v = 0; v < attributes_.vertex_count(); ++v) {
    const int held = masses.get(v, 0) > 0 ? static_cast<int>(fixed.get(v, 0)) : 7;
    for (std::size_t c = 0; c < 3; ++c) free_[std::size_t{v} * 3 + c] = (held >> c & 1) == 0;
  }
}

double TangentMatrix::mass_at(Index vertex) const {
  return mass_ * attributes_.mass().get(vertex, 0);
}

void TangentMatrix::restrict(std::span<double> x) const {
  for (std::size_t i = 0; i < x.size(); ++i)
    if (!free_[i]) x[i] = 0;
}

template <class Real>
void TangentMatrix::apply_mass(const Real* x, Real* y) const {
  for (Index v = 0; v < attributes_.vertex_count(); ++v) {
    const auto mass = static_cast<Real>(mass_ == 0 ? 0 : mass_at(v));
    for (std::size_t i = std::size_t{v} * 3; i < std::size_t{v} * 3 + 3; ++i) y[i] = mass * x[i];
  }
}

void TangentMatrix::apply(const double* x, double* y) const {
  apply_mass(x, y);
  for (std::size_t t = 0; t < terms_.size(); ++t)
    if (terms_[t]->has_tangent())
      terms_[t]->add_tangent(x, -factor(t), -factor(t) * velocity_, at_, y);
  restrict({y, free_.size()});
}

void TangentMatrix::apply(const float* x, float* y) const {
  apply_mass(x, y);
  for (std::size_t t = 0; t < terms_.size(); ++t) {
    ForceTerm& term = *terms_[t];
    if (term.is_stiff() && term.has_tangent() &&
        !term.add_tangent_in_single(x, -factor(t), -factor(t) * velocity_, at_, y))
      add_in_double(term, factor(t), x, y);
  }
  for (std::size_t i = 0; i < free_.size(); ++i)
    if (!free_[i]) y[i] = 0;
}

void TangentMatrix::add_in_double(ForceTerm& term, double factor, const float* x, float* y) const {
  const std::vector<double> wide(x, x + free_.size());
  std::vector<double> image(free_.size());
  term.add_tangent(wide.data(), -factor, -factor * velocity_, at_, image.data());
  for (std::size_t i = 0; i < image.size(); ++i) y[i] += static_cast<float>(image[i]);
}

void TangentMatrix::for_each_cell(const ForceTerm::VisitTangents& visit) const {
  for (std::size_t t = 0; t < terms_.size(); ++t)
    terms_[t]->for_each_tangent(factor(t), factor(t) * velocity_, at_, visit);
}

}  // namespace suture
