// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/tangent_matrix.hpp"

#include <algorithm>

namespace suture {

TangentMatrix::TangentMatrix(Attributes& attributes,
                             const std::vector<std::unique_ptr<ForceTerm>>& terms)
    : attributes_(attributes), terms_(terms) {}

void TangentMatrix::set(double time, double mass, double velocity) {
  time_ = time;
  mass_ = mass;
  velocity_ = velocity;
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

void TangentMatrix::apply(const double* x, double* y) const {
  for (Index v = 0; v < attributes_.vertex_count(); ++v) {
    const double mass = mass_ == 0 ? 0 : mass_at(v);
    for (std::size_t i = std::size_t{v} * 3; i < std::size_t{v} * 3 + 3; ++i) y[i] = mass * x[i];
  }
  for (const auto& term : terms_)
    if (term->has_tangent()) term->add_tangent(x, -1, -velocity_, time_, y);
  restrict({y, free_.size()});
}

void TangentMatrix::for_each_cell(const ForceTerm::VisitTangents& visit) const {
  for (const auto& term : terms_) term->for_each_tangent(1, velocity_, time_, visit);
}

}  // namespace suture
