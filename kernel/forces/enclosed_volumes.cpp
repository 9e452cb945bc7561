// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/enclosed_volumes.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <unordered_set>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/base/rows.hpp"

namespace suture {
namespace {

/// The closed surfaces of the boundary to which open faces belong: faces with a common edge belong
/// to the same.
std::vector<std::vector<PressedFace>> surfaces_with(const CellComplex& complex,
                                                    std::span<const Dart> faces) {
  std::vector<std::vector<PressedFace>> surfaces;
  std::unordered_set<Dart> seen;
  for (const Dart first : faces) {
    if (!is_open(complex, first) || !seen.insert(face_of(first)).second) continue;
    std::vector<PressedFace> surface{{face_of(first)}};
    for (std::size_t i = 0; i < surface.size(); ++i)
      for (Dart k = 0; k < hexahedron::darts_per_face; ++k) {
        const Dart next = face_of(across_edge(complex, surface[i].face + k));
        if (seen.insert(next).second) surface.push_back({next});
      }
    surfaces.push_back(std::move(surface));
  }
  return surfaces;
}

PressedFace::Positions positions_of(const std::array<Index, 4>& nodes, Column& positions) {
  PressedFace::Positions x;
  for (std::size_t a = 0; a < 4; ++a) x[a] = row(positions.rows(), nodes[a]);
  return x;
}

}  // namespace

void EnclosedVolumes::add(std::span<const Dart> faces, double stiffness, const TimeRamp& ramp,
                          const std::string& path) {
  std::size_t closed = 0, before = surfaces_.size();
  for (auto& found : surfaces_with(complex_, faces)) {
    closed += found.size();
    Surface surface = measured(loads_.size(), std::move(found));
    if (surface.rest != 0) surfaces_.push_back(std::move(surface));
  }
  if (closed != faces.size())
    throw InputError(path + ": the faces of a \"volume\" must enclose it, but only " +
                     std::to_string(faces.size()) + " of the " + std::to_string(closed) +
                     " faces of their closed surfaces are selected; select all nodes of these");
  if (surfaces_.size() == before)
    throw InputError(path + ": the faces are the lips of cracks, which enclose no volume; select " +
                     "all nodes around a body or a cavity");
  loads_.push_back({stiffness, ramp});
  make_pressures();
}

/// V0 is 0 for the lips of a crack inside, but for rounding.
EnclosedVolumes::Surface EnclosedVolumes::measured(std::size_t load,
                                                   std::vector<PressedFace> faces) const {
  Surface surface{load, std::move(faces)};
  for (const PressedFace& face : surface.faces) surface.nodes.push_back(face.nodes(complex_));
  Column& rest = attributes_.rest();
  const Vec3 origin = row(rest.rows(), surface.nodes.front().front());
  double size = 0;
  for (const auto& nodes : surface.nodes)
    for (const Vec3& x : positions_of(nodes, rest)) size = std::max(size, norm(minus(x, origin)));
  surface.rest = volume_of(surface, rest);
  if (std::abs(surface.rest) <= 1e-12 * size * size * size) surface.rest = 0;
  return surface;
}

void EnclosedVolumes::make_pressures() {
  pressures_ = std::make_unique<Pressures>(attributes_);
  std::vector<Dart> darts;
  for (const Surface& surface : surfaces_) {
    darts.clear();
    for (const PressedFace& face : surface.faces) darts.push_back(face.face);
    pressures_->add(complex_, darts, 0, {});
  }
}

/// V = -1/3 sum x . f, where f are the forces of an inward pressure of 1: f = -dV/dx, and V is of
/// third degree in x.
double EnclosedVolumes::volume_of(const Surface& surface, Column& positions) const {
  double sum = 0;
  const Vec3 origin = row(positions.rows(), surface.nodes.front().front());
  for (std::size_t i = 0; i < surface.faces.size(); ++i) {
    const PressedFace::Positions x = positions_of(surface.nodes[i], positions);
    const PressedFace::Positions f = surface.faces[i].forces(x, 1);
    for (std::size_t a = 0; a < 4; ++a) sum -= dot(minus(x[a], origin), f[a]) / 3;
  }
  return sum;
}

/// dp/dV = kappa / |V0|, Pa/m^3.
double EnclosedVolumes::stiffness_of(const Surface& surface, double time) const {
  const Load& load = loads_[surface.load];
  return load.stiffness * load.ramp.value(time) / std::abs(surface.rest);
}

EnclosedVolumes::Booked EnclosedVolumes::state_of(const Surface& surface, double time) const {
  const double volume = volume_of(surface, attributes_.position());
  return {volume, stiffness_of(surface, time) * (volume - surface.rest)};
}

void EnclosedVolumes::set_pressures(double time) {
  for (std::size_t i = 0; i < surfaces_.size(); ++i)
    pressures_->set(i, state_of(surfaces_[i], time).pressure);
}

void EnclosedVolumes::add_forces(double time, const LiveMask& live, double* rows) {
  set_pressures(time);
  pressures_->add_forces(time, live, rows);
}

void EnclosedVolumes::add_forces_in_step(const StepTimes& step, const LiveMask& live,
                                         double* rows) {
  add_forces(step.time, live, rows);
  const bool first = !std::exchange(is_booked_, true);
  for (Surface& surface : surfaces_) {
    const Booked now = state_of(surface, step.time), last = std::exchange(surface.booked, now);
    if (!first) work_ -= (last.pressure + now.pressure) / 2 * (now.volume - last.volume);
  }
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
        const auto& nodes = surface.nodes[i];
        const auto f = surface.faces[i].forces(positions_of(nodes, attributes_.position()), 1);
        for (std::size_t a = 0; a < 4; ++a) visit(nodes[a] * row, f[a]);
      }
    };
    double change = 0;
    for_each_node([&](std::size_t at, const Vec3& f) {
      for (std::size_t c = 0; c < 3; ++c) change += f[c] * d[at + c];
    });
    change *= -dx * stiffness_of(surface, time);
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
  const std::vector<Surface> before = std::exchange(surfaces_, {});
  for (std::size_t load = 0; load < loads_.size(); ++load)
    for (const bool is_cavity : {false, true}) {
      std::vector<Dart> faces;
      for (const Surface& surface : before)
        if (surface.load == load && surface.is_cavity() == is_cavity)
          for (const PressedFace& face : surface.faces) faces.push_back(face.face);
      for (auto& found : surfaces_with(complex, faces)) {
        Surface surface = measured(load, std::move(found));
        if (surface.rest != 0 && surface.is_cavity() == is_cavity)
          surfaces_.push_back(std::move(surface));
      }
    }
  make_pressures();
  forget_last();
}

void EnclosedVolumes::state(Archive& archive) {
  const auto is_on_boundary = [&](const PressedFace& face) {
    return element_of(face.face) < complex_.element_count() && face.exists(complex_);
  };
  archive("work", work_);
  archive("is booked", is_booked_);
  archive.each("surfaces", surfaces_, [&](Archive& each, Surface& surface) {
    if (each.has_cells()) {
      std::uint64_t load = surface.load;
      each("load", load);
      each.require(load < loads_.size(), "a volume belongs to no load of the scene");
      PressedFace::state(each, surface.faces);
      each.require(!surface.faces.empty() && std::ranges::all_of(surface.faces, is_on_boundary),
                   "a volume has faces that are not on the boundary");
      if (each.loads()) surface = measured(static_cast<std::size_t>(load), surface.faces);
    }
    each("volume", surface.booked.volume);
    each("pressure", surface.booked.pressure);
  });
  if (archive.has_cells() && archive.loads()) make_pressures();
}

double EnclosedVolumes::last_change() const {
  double time = 0;
  for (const Load& load : loads_) time = std::max(time, load.ramp.to);
  return time;
}

}  // namespace suture
