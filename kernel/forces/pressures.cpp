// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/pressures.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <type_traits>
#include <utility>

#include "kernel/base/aligned.hpp"
#include "kernel/base/error.hpp"

namespace suture {
namespace {

using Arms = std::array<std::array<Vec3, 4>, 4>;

/// w_ab with df_a = p sum_b w_ab x du_b:
///   w_ab = integral of N_a (dx/dr dN_b/ds - dx/ds dN_b/dr) dr ds
Arms arms_of(const Quad& x) {
  Arms w{};
  for_each_point(x, [&](const QuadPoint& p) {
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b)
        for (std::size_t c = 0; c < 3; ++c)
          w[a][b][c] += p.n[a] / 4 * (p.x_r[c] * p.n_s[b] - p.x_s[c] * p.n_r[b]);
  });
  return w;
}

/// (w_ab + sign w_ba) / 2: the matrices [w_ab] x have blocks [-w_ba] x in their transpose, so -1
/// gives the symmetric part.
Vec3 part_of(const Arms& w, std::size_t a, std::size_t b, double sign) {
  Vec3 part;
  for (std::size_t c = 0; c < 3; ++c) part[c] = (w[a][b][c] + sign * w[b][a][c]) / 2;
  return part;
}

}  // namespace

void Pressures::add(const CellComplex& complex, std::span<const Dart> faces, double pressure,
                    const TimeRamp& ramp) {
  if (faces.empty()) throw InputError("a pressure acts on no face; select at least one");
  Load load{pressure, {faces.begin(), faces.end()}, {}, ramp, {}};
  for (const Dart face : faces) load.nodes.push_back(face_nodes(complex, face));
  loads_.push_back(std::move(load));
}

Quad Pressures::corners_of(const Corners& nodes) const {
  Quad x;
  for (std::size_t a = 0; a < 4; ++a) {
    const double* row = attributes_.position().rows() + std::size_t{nodes[a]} * 4;
    x[a] = {row[0], row[1], row[2]};
  }
  return x;
}

template <class Visit>
void Pressures::for_each_face(const Load& load, double time, Visit visit) const {
  const double p = load.pressure * load.ramp.value(time) / 4;
  for (std::size_t i = 0; i < load.nodes.size(); ++i) {
    Quad force{};
    for_each_point(corners_of(load.nodes[i]), [&](const QuadPoint& point) {
      const Vec3 inward = point.normal();
      for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t c = 0; c < 3; ++c) force[a][c] += p * point.n[a] * inward[c];
    });
    visit(i, force);
  }
}

/// on_face(load, face number, corner forces) for each face.
template <class OnFace>
void Pressures::add(double time, const LiveMask& live, double* rows, OnFace on_face) {
  for (Load& load : loads_)
    for_each_face(load, time, [&](std::size_t i, const Quad& force) {
      for (std::size_t a = 0; a < 4; ++a) add_row(rows, live, load.nodes[i][a], 1, force[a]);
      on_face(load, i, force);
    });
}

void Pressures::add_forces(double time, const LiveMask& live, double* rows) {
  add(time, live, rows, [](const Load&, std::size_t, const Quad&) {});
}

void Pressures::add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) {
  const bool first = !std::exchange(is_booked_, true);
  for (Load& load : loads_) load.booked.resize(load.nodes.size());
  add(step.time, live, rows, [&](Load& load, std::size_t i, const Quad& force) {
    Booked& last = load.booked[i];
    const Quad x = corners_of(load.nodes[i]);
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t c = 0; c < 3 && !first; ++c)
        work_ += (last.force[a][c] + force[a][c]) / 2 * (x[a][c] - last.position[a][c]);
    last = {x, force};
  });
}

void Pressures::add_forces_at(const VertexSelection& selection, std::span<const Index>, double time,
                              std::vector<Vec3>& forces) {
  for (Load load : loads_) {
    std::erase_if(load.nodes, [&](const Corners& nodes) {
      return std::ranges::none_of(nodes, [&](Index v) { return selection.contains(v); });
    });
    for_each_face(load, time, [&](std::size_t i, const Quad& force) {
      for (std::size_t a = 0; a < 4; ++a) {
        const Index slot = selection.slot(load.nodes[i][a]);
        for (std::size_t c = 0; c < 3 && slot != none; ++c) forces[slot][c] += force[a][c];
      }
    });
  }
}

template <class Visit>
void Pressures::for_each_arms(double time, Visit visit) const {
  for (const Load& load : loads_) {
    const double p = load.pressure * load.ramp.value(time);
    for (const Corners& nodes : load.nodes) visit(nodes, p, arms_of(corners_of(nodes)));
  }
}

template <class Real>
void Pressures::multiply(const Real* d, double factor, double sign, double time, Real* out) const {
  constexpr std::size_t row = std::is_same_v<Real, float> ? 4 : 3;  // numbers per vertex
  for_each_arms(time, [&](const Corners& nodes, double p, const Arms& w) {
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b) {
        const Real* u = d + nodes[b] * row;
        const Vec3 f = cross(part_of(w, a, b, sign), Vec3{u[0], u[1], u[2]});
        for (std::size_t c = 0; c < 3; ++c)
          out[nodes[a] * row + c] += static_cast<Real>(factor * p * f[c]);
      }
  });
}

void Pressures::add_tangent(const double* d, double dx, double, const TangentTime& at,
                            double* out) {
  multiply(d, dx, -1, at.time, out);
}

void Pressures::add_skew_tangent(const double* d, double dx, const TangentTime& at, double* out) {
  multiply(d, dx, 1, at.time, out);
}

bool Pressures::add_tangent_in_single(const float* d, double dx, double, const TangentTime& at,
                                      float* out) {
  multiply(d, dx, -1, at.time, out);
  return true;
}

void Pressures::for_each_tangent(double dx, double, const TangentTime& at,
                                 const VisitTangents& visit) {
  constexpr std::size_t width = 8, rows = 12;
  AlignedVector<double> values(rows * rows * width);
  std::array<Corners, width> vertices{};
  Index count = 0;
  const auto flush = [&] {
    if (count > 0) visit({count, 4, vertices[0].data(), values.data()});
    std::ranges::fill(values, 0.0);
    count = 0;
  };
  for_each_arms(at.time, [&](const Corners& nodes, double p, const Arms& w) {
    vertices[count] = nodes;
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b) {
        const Vec3 arm = part_of(w, a, b, -1);
        for (std::size_t c = 0; c < 3; ++c) {  // [w] x has -w_c at (c + 1, c + 2)
          const std::size_t up = (c + 1) % 3, down = (c + 2) % 3;
          values[((b * 3 + down) * rows + a * 3 + up) * width + count] = -dx * p * arm[c];
          values[((b * 3 + up) * rows + a * 3 + down) * width + count] = dx * p * arm[c];
        }
      }
    if (++count == width) flush();
  });
  flush();
}

/// What is left of the other part on the free components, for a vector without regularity.
bool Pressures::is_conservative(double time) {
  if (loads_.empty()) return true;
  const std::size_t size = std::size_t{attributes_.vertex_count()} * 3;
  std::vector<double> d(size), other(size), whole(size);
  std::minstd_rand random(1);
  for (double& x : d) x = random() % 2 == 0 ? 1 : -1;
  const auto restrict = [&](std::vector<double>& x) {
    for (std::size_t i = 0; i < size; ++i) {
      const auto v = static_cast<Index>(i / 3);
      if (static_cast<int>(attributes_.fixed().get(v, 0)) >> i % 3 & 1) x[i] = 0;
    }
  };
  restrict(d);
  multiply(d.data(), 1, 1, time, other.data());
  multiply(d.data(), 1, -1, time, whole.data());
  restrict(other);
  const auto largest = [](const std::vector<double>& x) {
    double most = 0;
    for (const double value : x) most = std::max(most, std::abs(value));
    return most;
  };
  return largest(other) <= 1e-9 * largest(whole);
}

void Pressures::forget_last() {
  is_booked_ = false;
  for (Load& load : loads_) load.booked.clear();
}

void Pressures::restart() {
  work_ = 0;
  forget_last();
}

void Pressures::follow(const CellComplex& complex, const TopologyChange& change) {
  const bool only_apart = change.faces_sewn == 0 && change.removed[3].empty();
  if (only_apart && change.splits[0].empty()) return;
  for (Load& load : loads_) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < load.faces.size(); ++i) {
      if (!is_open(complex, load.faces[i])) continue;
      load.faces[kept] = load.faces[i];
      if (is_booked_) load.booked[kept] = load.booked[i];
      ++kept;
    }
    load.faces.resize(kept);
    if (is_booked_) load.booked.resize(kept);
    load.nodes.clear();
    for (const Dart face : load.faces) load.nodes.push_back(face_nodes(complex, face));
  }
}

void Pressures::state(Archive& archive) {
  archive("work", work_);
  archive("is booked", is_booked_);
  std::span loads = loads_;
  archive.each("loads", loads, [](Archive& each, Load& load) {
    each.rows<double>("booked", load.booked);
    if (!each.has_cells()) return;
    each("faces", load.faces);
    each("nodes", load.nodes);
  });
}

double Pressures::last_change() const {
  double time = 0;
  for (const Load& load : loads_) time = std::max(time, load.ramp.to);
  return time;
}

}  // namespace suture
