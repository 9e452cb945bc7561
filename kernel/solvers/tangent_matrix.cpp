// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/tangent_matrix.hpp"

#include <algorithm>
#include <type_traits>

#include "kernel/attributes/held.hpp"
#include "kernel/solvers/conjugate_gradients.hpp"
#include "kernel/solvers/single_vector.hpp"

namespace suture {

TangentMatrix::TangentMatrix(Attributes& attributes,
                             const std::vector<std::unique_ptr<ForceTerm>>& terms,
                             const Workers& workers)
    : attributes_(attributes), terms_(terms), workers_(workers) {}

void TangentMatrix::set(const TangentTime& at, double mass, double velocity,
                        std::span<const LoadTime> loads) {
  at_ = at;
  velocity_ = velocity;
  loads_.assign(loads.begin(), loads.end());
  if (loads.empty()) loads_ = {{at.time, 1}};
  stiffen({}, 0);
  const Column& masses = attributes_.mass();
  const Index vertices = attributes_.vertex_count();
  free_.assign(std::size_t{vertices} * 3, 1);
  held_.clear();
  masses_.resize(mass != 0 ? vertices : 0);
  for (Index v = 0; v < vertices; ++v) {
    if (mass != 0) masses_[v] = mass * masses.get(v, 0);
    const unsigned held = held_components(attributes_, v);
    for (Index c = 0; held != 0 && c < 3; ++c)
      if (is_held(held, c)) held_.push_back(v * 3 + c);
  }
  for (const std::size_t i : supports_) held_.push_back(static_cast<Index>(i));
  for (const Index i : held_) free_[i] = 0;
}

void TangentMatrix::set(const TangentTime& at, double velocity, std::vector<std::uint8_t> free,
                        std::vector<double> masses) {
  at_ = at;
  velocity_ = velocity;
  loads_ = {{at.time, 1}};
  stiffen({}, 0);
  free_ = std::move(free);
  masses_ = std::move(masses);
  held_.clear();
  for (std::size_t i = 0; i < free_.size(); ++i)
    if (!free_[i]) held_.push_back(static_cast<Index>(i));
}

void TangentMatrix::stiffen(std::span<const double> direction, double stiffness) {
  direction_ = direction;
  stiffness_ = stiffness;
}

void TangentMatrix::restrict(std::span<double> x) const {
  for (const Index i : held_) x[i] = 0;
}

/// visit(term, factor, time): the models and constraints, and every load at each of its times.
template <class Capability, class Visit>
void TangentMatrix::for_each_term(Visit visit) const {
  for_each_with<Capability>(terms_, [&](Capability& term) {
    const auto* base = dynamic_cast<ForceTerm*>(&term);
    if (base == terms_[0].get() || dynamic_cast<ConstraintTerm*>(&term)) {
      visit(term, 1.0, at_);
      return;
    }
    for (const LoadTime& load : loads_) visit(term, load.factor, TangentTime{load.time, at_.dt});
  });
}

/// y = M x for the mass term, in the rows of Real.
template <class Real>
void TangentMatrix::multiply_by_mass(const Real* x, Real* y) const {
  constexpr std::size_t width = std::is_same_v<Real, float> ? 4 : 3;
  for_vector_chunks(free_.size() / 3, &workers_, [&](std::size_t first, std::size_t rows) {
    if (masses_.empty()) {
      std::fill_n(y + first * width, rows * width, Real{0});
      return;
    }
    for (std::size_t v = first; v < first + rows; ++v) {
      const auto mass = static_cast<Real>(masses_[v]);
      for (std::size_t i = v * width; i < (v + 1) * width; ++i) y[i] = mass * x[i];
    }
  });
}

void TangentMatrix::apply(const double* x, double* y) const {
  multiply_by_mass(x, y);
  for_each_term<TangentTerm>([&](TangentTerm& term, double factor, const TangentTime& at) {
    if (term.has_tangent()) term.add_tangent(x, -factor, -factor * velocity_, at, y);
  });
  if (!direction_.empty()) {
    const double force = stiffness_ * dot(direction_, {x, direction_.size()});
    for (std::size_t i = 0; i < direction_.size(); ++i) y[i] += force * direction_[i];
  }
  restrict({y, free_.size()});
}

void TangentMatrix::apply_whole(const double* x, double* y) const {
  apply(x, y);
  for_each_term<TangentTerm>([&](TangentTerm& term, double factor, const TangentTime& at) {
    term.add_skew_tangent(x, -factor * skew_, at, y);
  });
  restrict({y, free_.size()});
}

void TangentMatrix::apply(const float* x, float* y) const {
  multiply_by_mass(x, y);
  for_each_term<TangentTerm>([&](TangentTerm& term, double factor, const TangentTime& at) {
    if (term.is_stiff() && term.has_tangent() &&
        !term.add_tangent_in_single(x, -factor, -factor * velocity_, at, y))
      add_in_double(term, factor, at, x, y);
  });
  for (const Index i : held_) y[i / 3 * 4 + i % 3] = 0;
}

void TangentMatrix::add_in_double(TangentTerm& term, double factor, const TangentTime& at,
                                  const float* x, float* y) const {
  std::vector<double> wide(free_.size()), image(free_.size());
  for (std::size_t i = 0; i < wide.size(); ++i) wide[i] = x[i / 3 * 4 + i % 3];
  term.add_tangent(wide.data(), -factor, -factor * velocity_, at, image.data());
  for (std::size_t i = 0; i < image.size(); ++i)
    y[i / 3 * 4 + i % 3] += static_cast<float>(image[i]);
}

void TangentMatrix::for_each_cell(const CellTangentTerm::VisitTangents& visit) const {
  for_each_term<CellTangentTerm>([&](CellTangentTerm& term, double factor, const TangentTime& at) {
    term.for_each_tangent(factor, factor * velocity_, at, visit);
  });
}

void TangentMatrix::for_each_cell(TangentPieces& pieces) const {
  for_each_term<CellTangentTerm>([&](CellTangentTerm& term, double factor, const TangentTime& at) {
    term.for_each_piece(factor, factor * velocity_, at, pieces);
  });
}

void TangentMatrix::for_some_cells(const CellTangentTerm::SelectCell& select,
                                   const CellTangentTerm::VisitTangents& visit) const {
  for_each_term<CellTangentTerm>([&](CellTangentTerm& term, double factor, const TangentTime& at) {
    term.for_some_tangents(factor, factor * velocity_, at, select, visit);
  });
}

}  // namespace suture
