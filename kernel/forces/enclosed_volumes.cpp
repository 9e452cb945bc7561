// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/enclosed_volumes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <type_traits>
#include <utility>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

using Nodes = std::array<Index, 4>;

/// The boundary of a body, by closed surfaces: faces with a common edge belong to the same.
class ClosedSurfaces {
 public:
  explicit ClosedSurfaces(const CellComplex& complex) {
    for (Index e = 0; e < complex.element_count(); ++e)
      for (int f = 0; f < 6 && complex.exists(3, e); ++f)
        if (const Dart face = 24 * e + 4 * static_cast<Dart>(f); is_open(complex, face))
          faces_.push_back(face);
    owner_.resize(faces_.size());
    std::iota(owner_.begin(), owner_.end(), 0u);
    struct Edge {
      Index low, high, face;
      auto operator<=>(const Edge&) const = default;
    };
    std::vector<Edge> edges;
    for (Index i = 0; i < faces_.size(); ++i) {
      const Nodes nodes = face_nodes(complex, faces_[i]);
      for (std::size_t a = 0; a < 4; ++a)
        edges.push_back(
            {std::min(nodes[a], nodes[(a + 1) % 4]), std::max(nodes[a], nodes[(a + 1) % 4]), i});
    }
    std::ranges::sort(edges);
    for (std::size_t i = 1; i < edges.size(); ++i)
      if (edges[i].low == edges[i - 1].low && edges[i].high == edges[i - 1].high)
        owner_[find(edges[i].face)] = find(edges[i - 1].face);
  }

  /// The surfaces with some of these faces, by their first face.
  std::vector<std::vector<PressedFace>> with(std::span<const Dart> some) {
    std::vector<std::vector<PressedFace>> of(faces_.size());
    for (const Dart face : some) {
      const auto at = std::ranges::lower_bound(faces_, face_of(face));
      if (at != faces_.end() && *at == face_of(face))
        of[find(static_cast<Index>(at - faces_.begin()))].resize(1);
    }
    for (Index i = 0; i < faces_.size(); ++i)
      if (auto& surface = of[find(i)]; !surface.empty()) surface.push_back({faces_[i]});
    std::erase_if(of, [](const auto& surface) { return surface.empty(); });
    for (auto& surface : of) surface.erase(surface.begin());  // the mark
    return of;
  }

 private:
  Index find(Index i) {
    while (owner_[i] != i) i = owner_[i] = owner_[owner_[i]];
    return i;
  }
  std::vector<Dart> faces_;  ///< ascending
  std::vector<Index> owner_;
};

PressedFace::Positions positions_of(const Nodes& nodes, Column& positions) {
  PressedFace::Positions x;
  for (std::size_t a = 0; a < 4; ++a) {
    const double* const row = positions.rows() + std::size_t{nodes[a]} * 4;
    x[a] = {row[0], row[1], row[2]};
  }
  return x;
}

std::vector<Dart> darts_of(const std::vector<PressedFace>& faces) {
  std::vector<Dart> darts;
  for (const PressedFace& face : faces) darts.push_back(face.face);
  return darts;
}

}  // namespace

void EnclosedVolumes::add(std::span<const Dart> faces, double stiffness, const TimeRamp& ramp) {
  std::size_t closed = 0;
  for (auto& surface : ClosedSurfaces(complex_).with(faces)) {
    closed += surface.size();
    surfaces_.push_back({loads_.size(), std::move(surface)});
  }
  if (faces.empty() || closed != faces.size())
    throw InputError("the faces of a \"volume\" must enclose it: " + std::to_string(faces.size()) +
                     " are selected, and the closed surfaces to which they belong have " +
                     std::to_string(closed) + "; select all nodes of these surfaces");
  loads_.push_back({stiffness, ramp});
  build();
}

/// Finds nodes and volumes at rest, and makes a pressure for each surface.
void EnclosedVolumes::build() {
  pressures_ = std::make_unique<Pressures>(attributes_);
  for (Surface& surface : surfaces_) {
    surface.nodes.clear();
    for (const PressedFace& face : surface.faces) surface.nodes.push_back(face.nodes(complex_));
    surface.rest = volume_of(surface, attributes_.rest());
    pressures_->add(complex_, darts_of(surface.faces), 0, {});
  }
}

/// V = -1/3 sum x . f, where f are the forces of an inward pressure of 1: f = -dV/dx, and V is of
/// third degree in x.
double EnclosedVolumes::volume_of(const Surface& surface, Column& positions) const {
  double sum = 0;
  const Vec3 origin = positions_of(surface.nodes.front(), positions)[0];
  for (std::size_t i = 0; i < surface.faces.size(); ++i) {
    const PressedFace::Positions x = positions_of(surface.nodes[i], positions);
    const PressedFace::Positions f = surface.faces[i].forces(x, 1);
    for (std::size_t a = 0; a < 4; ++a) sum -= dot(minus(x[a], origin), f[a]) / 3;
  }
  return sum;
}

double EnclosedVolumes::stiffness_of(const Surface& surface, double time) const {
  const Load& load = loads_[surface.load];
  return load.stiffness * load.ramp.value(time);
}

void EnclosedVolumes::set_pressures(double time) {
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const Surface& surface = surfaces_[i];
    const double more = volume_of(surface, attributes_.position()) - surface.rest;
    pressures_->set(i, stiffness_of(surface, time) * more / std::abs(surface.rest));
  }
}

double EnclosedVolumes::energy(double time) const {
  double sum = 0;
  for (const Surface& surface : surfaces_) {
    const double more = volume_of(surface, attributes_.position()) - surface.rest;
    sum += stiffness_of(surface, time) / std::abs(surface.rest) / 2 * more * more;
  }
  return sum;
}

void EnclosedVolumes::add_forces(double time, const LiveMask& live, double* rows) {
  set_pressures(time);
  pressures_->add_forces(time, live, rows);
}

void EnclosedVolumes::add_forces_in_step(const StepTimes& step, const LiveMask& live,
                                         double* rows) {
  add_forces(step.time, live, rows);
  const double energy = this->energy(step.time);
  if (std::exchange(is_booked_, true)) work_ += last_energy_ - energy;
  last_energy_ = energy;
}

void EnclosedVolumes::add_forces_at(const VertexSelection& selection,
                                    std::span<const Index> vertices, double time,
                                    std::vector<Vec3>& forces) {
  set_pressures(time);
  pressures_->add_forces_at(selection, vertices, time, forces);
}

/// What the change of the pressure adds:
///   df = f dp,   dp = -kappa / |V0| f . d      f: the forces of a pressure of 1
template <class Real>
void EnclosedVolumes::add_common(const Real* d, double dx, double time, Real* out) const {
  constexpr std::size_t row = std::is_same_v<Real, float> ? 4 : 3;  // numbers per vertex
  for (const Surface& surface : surfaces_) {
    const auto for_each_node = [&](const auto& visit) {
      for (std::size_t i = 0; i < surface.faces.size(); ++i) {
        const Nodes& nodes = surface.nodes[i];
        const auto f = surface.faces[i].forces(positions_of(nodes, attributes_.position()), 1);
        for (std::size_t a = 0; a < 4; ++a) visit(nodes[a] * row, f[a]);
      }
    };
    double change = 0;
    for_each_node([&](std::size_t at, const Vec3& f) {
      for (std::size_t c = 0; c < 3; ++c) change += f[c] * d[at + c];
    });
    change *= -dx * stiffness_of(surface, time) / std::abs(surface.rest);
    for_each_node([&](std::size_t at, const Vec3& f) {
      for (std::size_t c = 0; c < 3; ++c) out[at + c] += static_cast<Real>(change * f[c]);
    });
  }
}

void EnclosedVolumes::add_tangent(const double* d, double dx, double dv, const TangentTime& at,
                                  double* out) {
  set_pressures(at.time);
  pressures_->add_tangent(d, dx, dv, at, out);
  add_common(d, dx, at.time, out);
}

bool EnclosedVolumes::add_tangent_in_single(const float* d, double dx, double dv,
                                            const TangentTime& at, float* out) {
  set_pressures(at.time);
  pressures_->add_tangent_in_single(d, dx, dv, at, out);
  add_common(d, dx, at.time, out);
  return true;
}

void EnclosedVolumes::for_each_tangent(double dx, double dv, const TangentTime& at,
                                       const VisitTangents& visit) {
  set_pressures(at.time);
  pressures_->for_each_tangent(dx, dv, at, visit);
}

void EnclosedVolumes::restart() {
  work_ = 0;
  forget_last();
}

/// A cavity that is open to the outside belongs to a surface around elements: its volume is gone.
void EnclosedVolumes::follow(const CellComplex& complex, const TopologyChange& change) {
  const bool only_apart = change.faces_sewn == 0 && change.removed[3].empty();
  if (surfaces_.empty() || (only_apart && change.splits[0].empty())) return;
  ClosedSurfaces closed(complex);
  std::vector<Surface> next;
  for (std::size_t load = 0; load < loads_.size(); ++load)
    for (const bool is_cavity : {false, true}) {
      std::vector<Dart> faces;
      for (const Surface& surface : surfaces_)
        if (surface.load == load && (surface.rest < 0) == is_cavity)
          for (const Dart face : darts_of(surface.faces)) faces.push_back(face);
      for (auto& surface : closed.with(faces)) {
        next.push_back({load, std::move(surface)});
        for (const PressedFace& face : next.back().faces)
          next.back().nodes.push_back(face.nodes(complex));
        if ((volume_of(next.back(), attributes_.rest()) < 0) != is_cavity) next.pop_back();
      }
    }
  surfaces_ = std::move(next);
  build();
  forget_last();
}

void EnclosedVolumes::state(Archive& archive) {
  archive("work", work_);
  archive("energy", last_energy_);
  archive("is booked", is_booked_);
  if (!archive.has_cells()) return;
  std::uint64_t count = surfaces_.size();
  archive("surfaces", count);
  if (archive.loads()) surfaces_.resize(static_cast<std::size_t>(count));
  for (Surface& surface : surfaces_) {
    std::uint64_t load = surface.load;
    archive("load", load);
    archive.require(load < loads_.size(), "a volume belongs to no load of the scene");
    surface.load = static_cast<std::size_t>(load);
    PressedFace::state(archive, surface.faces);
  }
  if (archive.loads()) build();
}

double EnclosedVolumes::last_change() const {
  double time = 0;
  for (const Load& load : loads_) time = std::max(time, load.ramp.to);
  return time;
}

}  // namespace suture
