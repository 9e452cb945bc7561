// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/pressures.hpp"

#include <algorithm>
#include <utility>

#include "kernel/base/error.hpp"

namespace suture {

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
    for_each_point(corners_of(load.nodes[i]),
                   [&](const std::array<double, 4>& n, const Vec3& inward) {
                     for (std::size_t a = 0; a < 4; ++a)
                       for (std::size_t c = 0; c < 3; ++c) force[a][c] += p * n[a] * inward[c];
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
