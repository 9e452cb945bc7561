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

/// (w_ab + sign w_ba) / 2: the matrices [w_ab] x have blocks [-w_ba] x in their transpose, so -1
/// gives the symmetric part.
template <class Arms>
Vec3 part_of(const Arms& w, std::size_t a, std::size_t b, double sign) {
  Vec3 part;
  for (std::size_t c = 0; c < 3; ++c) part[c] = (w[a][b][c] + sign * w[b][a][c]) / 2;
  return part;
}

}  // namespace

template <class Face>
void PressuresOn<Face>::add(const CellComplex& complex, std::span<const typename Face::Given> faces,
                            double pressure, const TimeRamp& ramp, const LoadProfile& profile) {
  if (faces.empty()) throw InputError("a pressure acts on no face; select at least one");
  const RestPlaces rest = attributes_.rest_places(complex);
  Load load{pressure, Face::all(rest, faces, profile), {}, ramp, {}, {}, profile};
  for (const Face& face : load.faces) load.nodes.push_back(face.nodes(complex));
  if (may_be_divided()) load.given.assign(faces.begin(), faces.end());
  loads_.push_back(std::move(load));
}

template <class Face>
typename PressuresOn<Face>::Positions PressuresOn<Face>::positions_of(const Nodes& nodes) const {
  Positions x;
  for (std::size_t a = 0; a < Face::node_count; ++a) {
    const double* row = attributes_.position().rows() + std::size_t{nodes[a]} * 4;
    x[a] = {row[0], row[1], row[2]};
  }
  return x;
}

template <class Face>
template <class Wanted, class Visit>
void PressuresOn<Face>::for_each_face(double time, Wanted wanted, Visit visit) {
  for (Load& load : loads_) {
    const double p = load.pressure * load.ramp.value(time);
    for (std::size_t i = 0; i < load.faces.size(); ++i)
      if (wanted(load.nodes[i]))
        visit(load, i, load.faces[i].forces(positions_of(load.nodes[i]), p));
  }
}

template <class Face>
template <class Visit>
void PressuresOn<Face>::add(double time, const LiveMask& live, double* rows, Visit visit) {
  const auto all = [](const Nodes&) { return true; };
  for_each_face(time, all, [&](Load& load, std::size_t i, const Positions& force) {
    for (std::size_t a = 0; a < Face::node_count; ++a)
      add_row(rows, live, load.nodes[i][a], 1, force[a]);
    visit(load, i, force);
  });
}

template <class Face>
void PressuresOn<Face>::add_forces(double time, const LiveMask& live, double* rows) {
  add(time, live, rows, [](const Load&, std::size_t, const Positions&) {});
}

template <class Face>
void PressuresOn<Face>::add_forces_in_step(const StepTimes& step, const LiveMask& live,
                                           double* rows) {
  const bool first = !std::exchange(is_booked_, true);
  for (Load& load : loads_) load.booked.resize(load.nodes.size());
  add(step.time, live, rows, [&](Load& load, std::size_t i, const Positions& force) {
    Booked& last = load.booked[i];
    const Positions x = positions_of(load.nodes[i]);
    for (std::size_t a = 0; a < Face::node_count; ++a)
      for (std::size_t c = 0; c < 3 && !first; ++c)
        work_ += (last.force[a][c] + force[a][c]) / 2 * (x[a][c] - last.position[a][c]);
    last = {x, force};
  });
}

template <class Face>
void PressuresOn<Face>::add_forces_at(const VertexSelection& selection, std::span<const Index>,
                                      double time, std::vector<Vec3>& forces) {
  const auto is_selected = [&](const Nodes& nodes) {
    return std::ranges::any_of(nodes, [&](Index v) { return selection.contains(v); });
  };
  for_each_face(time, is_selected, [&](const Load& load, std::size_t i, const Positions& force) {
    for (std::size_t a = 0; a < Face::node_count; ++a) {
      const Index slot = selection.slot(load.nodes[i][a]);
      for (std::size_t c = 0; c < 3 && slot != none; ++c) forces[slot][c] += force[a][c];
    }
  });
}

template <class Face>
template <class Visit>
void PressuresOn<Face>::for_each_arms(double time, Visit visit) const {
  for (const Load& load : loads_) {
    const double p = load.pressure * load.ramp.value(time);
    for (std::size_t i = 0; i < load.faces.size(); ++i)
      visit(load.nodes[i], p, load.faces[i].arms(positions_of(load.nodes[i])));
  }
}

template <class Face>
template <class Real>
void PressuresOn<Face>::multiply(const Real* d, double factor, double sign, double time,
                                 Real* out) const {
  constexpr std::size_t row = std::is_same_v<Real, float> ? 4 : 3;  // numbers per vertex
  for_each_arms(time, [&](const Nodes& nodes, double p, const auto& w) {
    for (std::size_t a = 0; a < Face::node_count; ++a)
      for (std::size_t b = 0; b < Face::node_count; ++b) {
        const Real* u = d + nodes[b] * row;
        const Vec3 f = cross(part_of(w, a, b, sign), Vec3{u[0], u[1], u[2]});
        for (std::size_t c = 0; c < 3; ++c)
          out[nodes[a] * row + c] += static_cast<Real>(factor * p * f[c]);
      }
  });
}

template <class Face>
void PressuresOn<Face>::add_tangent(const double* d, double dx, double, const TangentTime& at,
                                    double* out) {
  multiply(d, dx, -1, at.time, out);
}

template <class Face>
void PressuresOn<Face>::add_skew_tangent(const double* d, double dx, const TangentTime& at,
                                         double* out) {
  multiply(d, dx, 1, at.time, out);
}

template <class Face>
bool PressuresOn<Face>::add_tangent_in_single(const float* d, double dx, double,
                                              const TangentTime& at, float* out) {
  multiply(d, dx, -1, at.time, out);
  return true;
}

template <class Face>
void PressuresOn<Face>::for_each_tangent(double dx, double, const TangentTime& at,
                                         const VisitTangents& visit) {
  constexpr std::size_t width = 8, rows = 3 * Face::node_count;
  AlignedVector<double> values(rows * rows * width);
  std::array<Nodes, width> vertices{};
  Index count = 0;
  const auto flush = [&] {
    if (count > 0) visit({count, Face::node_count, vertices[0].data(), values.data()});
    std::ranges::fill(values, 0.0);
    count = 0;
  };
  for_each_arms(at.time, [&](const Nodes& nodes, double p, const auto& w) {
    vertices[count] = nodes;
    for (std::size_t a = 0; a < Face::node_count; ++a)
      for (std::size_t b = 0; b < Face::node_count; ++b) {
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
template <class Face>
bool PressuresOn<Face>::is_conservative(double time) {
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

template <class Face>
void PressuresOn<Face>::mark_vertices(std::vector<bool>& marks) const {
  for (const Load& load : loads_)
    for (const Nodes& nodes : load.nodes)
      for (const Index v : nodes) marks[v] = true;
}

template <class Face>
void PressuresOn<Face>::forget_last() {
  is_booked_ = false;
  for (Load& load : loads_) load.booked.clear();
}

template <class Face>
void PressuresOn<Face>::restart() {
  work_ = 0;
  forget_last();
}

/// Copies carry what they have of the triangles.
template <class Face>
void PressuresOn<Face>::load_copies(Load& load, const CellComplex& complex,
                                    std::span<const Split> copies) const {
  if constexpr (Face::may_be_divided) {
    const auto given = triangles_of_copies(load.given, *attributes_.parts().copies(), copies);
    const std::vector<Face> added =
        Face::all(attributes_.rest_places(complex), given, load.profile);
    load.faces.insert(load.faces.end(), added.begin(), added.end());
    load.given.insert(load.given.end(), given.begin(), given.end());
    std::erase_if(load.given, [&](const SurfaceTriangle& triangle) {
      return !complex.exists(3, triangle.element);
    });
  }
}

template <class Face>
void PressuresOn<Face>::follow(const CellComplex& complex, const TopologyChange& change) {
  const bool only_apart = change.faces_sewn == 0 && change.removed[3].empty();
  if (only_apart && change.splits[0].empty()) return;
  if (!change.copies.empty()) forget_last();
  for (Load& load : loads_) {
    if (!change.copies.empty()) load_copies(load, complex, change.successors());
    std::size_t kept = 0;
    for (std::size_t i = 0; i < load.faces.size(); ++i) {
      if (!load.faces[i].exists(complex)) continue;
      load.faces[kept] = load.faces[i];
      if (is_booked_) load.booked[kept] = load.booked[i];
      ++kept;
    }
    load.faces.resize(kept);
    if (is_booked_) load.booked.resize(kept);
    load.nodes.clear();
    for (const Face& face : load.faces) load.nodes.push_back(face.nodes(complex));
  }
}

template <class Face>
void PressuresOn<Face>::state(Archive& archive) {
  archive("work", work_);
  archive("is booked", is_booked_);
  std::span loads = loads_;
  archive.each("loads", loads, [&](Archive& each, Load& load) {
    each.rows<double>("booked", load.booked);
    if (!each.has_cells()) return;
    Face::state(each, load.faces);
    each("nodes", load.nodes);
    if constexpr (Face::may_be_divided)
      if (may_be_divided()) state_of(each, load.given);
  });
}

template <class Face>
double PressuresOn<Face>::last_change() const {
  double time = 0;
  for (const Load& load : loads_) time = std::max(time, load.ramp.to);
  return time;
}

template class PressuresOn<PressedFace>;
template class PressuresOn<PressedPart>;

}  // namespace suture
