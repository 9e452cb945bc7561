// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/fields/exchange.hpp"

#include <array>

#include "kernel/base/aligned.hpp"

namespace suture {

const std::vector<double>& Exchange::rows(double time) {
  if (adds_no_rows() || (!rows_.empty() && time == rows_time_)) return rows_;
  rows_time_ = time;
  rows_.assign(std::size_t{attributes_.vertex_count()} * 4, 0);
  coefficients_.add_forces(time, attributes_.kernel(0).cells.live(), rows_.data());
  return rows_;
}

void Exchange::add_forces(double time, const LiveMask&, double* out) {
  const std::vector<double>& h = rows(time);
  const auto stride = static_cast<std::size_t>(values_.stride());
  for (std::size_t v = 0; v < h.size() / 4; ++v)
    for (std::size_t c = 0; c < 3; ++c)
      if (h[v * 4 + c] != 0) out[v * 4 + c] -= h[v * 4 + c] * values_.rows()[v * stride + c];
}

void Exchange::add_forces_at(const VertexSelection&, std::span<const Index> vertices, double time,
                             std::vector<Vec3>& forces) {
  std::vector<double> all(std::size_t{attributes_.vertex_count()} * 4);
  add_forces(time, attributes_.kernel(0).cells.live(), all.data());
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) forces[i][c] += all[std::size_t{vertices[i]} * 4 + c];
}

void Exchange::add_tangent(const double* d, double dx, double, const TangentTime& at, double* out) {
  const std::vector<double>& h = rows(at.time);
  for (std::size_t i = 0; i < h.size() / 4 * 3; ++i) out[i] -= dx * h[i / 3 * 4 + i % 3] * d[i];
}

bool Exchange::add_tangent_in_single(const float* d, double dx, double, const TangentTime& at,
                                     float* out) {
  const std::vector<double>& h = rows(at.time);
  for (std::size_t i = 0; i < h.size(); ++i) out[i] -= static_cast<float>(dx * h[i]) * d[i];
  return true;
}

void Exchange::for_each_tangent(double dx, double, const TangentTime& at,
                                const VisitTangents& visit) {
  const std::vector<double>& h = rows(at.time);
  AlignedVector<double> values(9 * 8);
  for (Index v = 0; v < h.size() / 4; ++v) {
    const double* of = &h[std::size_t{v} * 4];
    if (of[0] == 0 && of[1] == 0 && of[2] == 0) continue;
    for (std::size_t c = 0; c < 3; ++c) values[(c * 3 + c) * 8] = -dx * of[c];
    visit({1, 1, &v, values.data()});
  }
}

void Exchange::follow(const CellComplex& complex, const TopologyChange& change) {
  coefficients_.follow(complex, change);
  rows_.clear();
}

void Exchange::state(Archive& archive) {
  coefficients_.state(archive);
  rows_.clear();
}

}  // namespace suture
