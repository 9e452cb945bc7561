// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/dead_loads.hpp"

#include <algorithm>
#include <map>

#include "kernel/attributes/shape.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/forces/quad.hpp"

namespace suture {
namespace {

Quad rest_corners(const RestPlaces& rest, Dart face) {
  Quad x;
  for (std::size_t a = 0; a < 4; ++a) {
    const double* p = rest.corner(element_of(face), suture_hexahedron_faces[local_face(face)][a]);
    x[a] = {p[0], p[1], p[2]};
  }
  return x;
}

/// Integral of N_a times the profile over the area, per corner. Four points: exact for
/// parallelograms, where the area element is constant, and a linear profile.
std::array<double, 4> corner_areas(const Quad& x, const LoadProfile& profile = {}) {
  std::array<double, 4> areas{};
  for_each_point(x, [&](const QuadPoint& point) {
    const Vec3 normal = point.normal();
    const double area =
        std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]) / 4 *
        profile(point.place(x));
    for (std::size_t a = 0; a < 4; ++a) areas[a] += point.n[a] * area;
  });
  return areas;
}

/// Integral of N_a times the profile over the area of a triangle at rest, per node of its element.
std::array<double, hexahedron::vertices> node_areas(const RestPlaces& rest,
                                                    const SurfaceTriangle& triangle,
                                                    const LoadProfile& profile) {
  std::array<double, hexahedron::vertices> areas{};
  const HexahedronNodes nodes = rest.of(triangle.element);
  for (const TrianglePoint& point : quadrature_points(triangle)) {
    const double area = point.weight * norm(point.area(nodes)) * profile(point.place(nodes));
    for (std::size_t a = 0; a < hexahedron::vertices; ++a) areas[a] += point.n[a] * area;
  }
  return areas;
}

/// Boundary area around each vertex of a set, from faces that lie in it wholly;
/// empty if a vertex has none.
std::vector<double> areas_around(const RestPlaces& rest, std::span<const Index> vertices) {
  const CellComplex& complex = rest.complex();
  std::map<Index, double> area;
  for (const Index v : vertices) area[v] = 0;
  std::vector<Dart> faces, star;
  for (const Index v : vertices) {
    complex.star(0, v, star);
    for (const Dart d : star)
      for (int f = 0; f < hexahedron::faces; ++f) {
        const Dart face = face_dart(element_of(d), f);
        if (complex.beta3(face) == none) faces.push_back(face);
      }
  }
  sort_unique(faces);
  for (const Dart face : faces) {
    const auto nodes = face_nodes(complex, face);
    if (!std::all_of(nodes.begin(), nodes.end(), [&](Index n) { return area.contains(n); }))
      continue;
    const auto parts = corner_areas(rest_corners(rest, face));
    for (std::size_t a = 0; a < 4; ++a) area[nodes[a]] += parts[a];
  }
  std::vector<double> areas;
  for (const Index v : vertices) areas.push_back(area[v]);
  if (std::find(areas.begin(), areas.end(), 0.0) != areas.end()) areas.clear();
  return areas;
}

}  // namespace

void DeadLoads::add_at_vertex(Load& load, const RestPlaces& rest, Index vertex,
                              const Vec3& force) const {
  const CellComplex& complex = rest.complex();
  std::vector<Dart> star;
  complex.star(0, vertex, star);
  std::vector<double> volumes;
  double total = 0;
  for (const Dart d : star) {
    volumes.push_back(std::abs(rest.volume(element_of(d))));
    total += volumes.back();
  }
  for (std::size_t i = 0; i < star.size(); ++i) {
    const Index element = element_of(star[i]);
    const Hexahedron& nodes = complex.vertices_of(element);
    const auto corner = std::find(nodes.begin(), nodes.end(), vertex) - nodes.begin();
    const double share = volumes[i] / total;
    load.corners.push_back({element,
                            static_cast<std::uint32_t>(corner),
                            {force[0] * share, force[1] * share, force[2] * share}});
  }
}

void DeadLoads::sum_corners(Load& load, const RestPlaces& rest) {
  load.nodal.clear();
  if (load.corners.empty()) return;
  for (const Corner& corner : load.corners) {
    const double* x = rest.corner(corner.element, corner.node);
    const Vec3& f = corner.force;
    load.nodal.push_back({rest.complex().vertices_of(corner.element)[corner.node], f,
                          f[0] * x[0] + f[1] * x[1] + f[2] * x[2]});
  }
  std::stable_sort(load.nodal.begin(), load.nodal.end(),
                   [](const Nodal& a, const Nodal& b) { return a.vertex < b.vertex; });
  std::size_t last = 0;
  for (std::size_t i = 1; i < load.nodal.size(); ++i) {
    if (load.nodal[i].vertex != load.nodal[last].vertex) {
      load.nodal[++last] = load.nodal[i];
      continue;
    }
    for (std::size_t c = 0; c < 3; ++c) load.nodal[last].force[c] += load.nodal[i].force[c];
    load.nodal[last].at_rest += load.nodal[i].at_rest;
  }
  load.nodal.resize(last + 1);
}

void DeadLoads::add_force(const CellComplex& complex, std::span<const Index> vertices,
                          const Vec3& total, const TimeRamp& ramp) {
  if (vertices.empty()) throw InputError("a force acts on no node; select at least one");
  const RestPlaces rest = attributes_.rest_places(complex);
  std::vector<double> weights = areas_around(rest, vertices);
  if (weights.empty()) weights.assign(vertices.size(), 1);
  double sum = 0;
  for (const double w : weights) sum += w;
  Load load;
  load.ramp = ramp;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const double w = weights[i] / sum;
    add_at_vertex(load, rest, vertices[i], {total[0] * w, total[1] * w, total[2] * w});
  }
  sum_corners(load, rest);
  loads_.push_back(std::move(load));
}

void DeadLoads::add_traction(const CellComplex& complex, std::span<const Dart> faces,
                             const Vec3& traction, const TimeRamp& ramp,
                             const LoadProfile& profile) {
  if (faces.empty()) throw InputError("a traction acts on no face; select at least one");
  const RestPlaces rest = attributes_.rest_places(complex);
  Load load;
  load.ramp = ramp;
  for (const Dart face : faces) {
    const auto areas = corner_areas(rest_corners(rest, face), profile);
    const auto& local = suture_hexahedron_faces[local_face(face)];
    for (std::size_t a = 0; a < 4; ++a)
      load.corners.push_back(
          {element_of(face),
           local[a],
           {traction[0] * areas[a], traction[1] * areas[a], traction[2] * areas[a]},
           face});
  }
  sum_corners(load, rest);
  loads_.push_back(std::move(load));
}

void DeadLoads::add_surface_traction(const CellComplex& complex,
                                     std::span<const SurfaceTriangle> triangles,
                                     const Vec3& traction, const TimeRamp& ramp,
                                     const LoadProfile& profile) {
  if (triangles.empty()) throw InputError("a traction acts on no triangle; select at least one");
  const RestPlaces rest = attributes_.rest_places(complex);
  Load load;
  load.ramp = ramp;
  load.traction = traction;
  load.profile = profile;
  add_corners(load, triangles, rest);
  sum_corners(load, rest);
  loads_.push_back(std::move(load));
}

void DeadLoads::add_corners(Load& load, std::span<const SurfaceTriangle> triangles,
                            const RestPlaces& rest) const {
  for (const SurfaceTriangle& triangle : triangles) {
    const auto areas = node_areas(rest, triangle, load.profile);
    for (std::uint32_t a = 0; a < hexahedron::vertices; ++a)
      if (areas[a] != 0)
        load.corners.push_back({triangle.element, a, scaled(areas[a], load.traction)});
  }
  if (attributes_.parts().may_grow())
    load.triangles.insert(load.triangles.end(), triangles.begin(), triangles.end());
}

void DeadLoads::add_forces(double time, const LiveMask& live, double* rows) {
  for (const Load& load : loads_) {
    const double s = load.ramp.value(time);
    for (const Nodal& nodal : load.nodal) add_row(rows, live, nodal.vertex, s, nodal.force);
  }
}

void DeadLoads::add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) {
  const bool first = booked_.size() != loads_.size();
  booked_.resize(loads_.size());
  for (std::size_t l = 0; l < loads_.size(); ++l) {
    Booked& last = booked_[l];
    const Booked now{value(loads_[l]), loads_[l].ramp.value(step.time)};
    if (!first) work_ += (last.ramp + now.ramp) / 2 * (now.value - last.value);
    last = now;
  }
  add_forces(step.time, live, rows);
}

void DeadLoads::add_forces_at(const VertexSelection&, std::span<const Index> vertices, double time,
                              std::vector<Vec3>& forces) {
  for (const Load& load : loads_) {
    const double s = load.ramp.value(time);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const auto nodal = std::ranges::lower_bound(load.nodal, vertices[i], {}, &Nodal::vertex);
      if (nodal == load.nodal.end() || nodal->vertex != vertices[i]) continue;
      for (std::size_t c = 0; c < 3; ++c) forces[i][c] += s * nodal->force[c];
    }
  }
}

void DeadLoads::mark_vertices(std::vector<bool>& marks) const {
  for (const Load& load : loads_)
    for (const Nodal& nodal : load.nodal) marks[nodal.vertex] = true;
}

/// sum f . (x - X)
double DeadLoads::value(const Load& load) const {
  double sum = 0;
  for (const Nodal& nodal : load.nodal) {
    const double* x = attributes_.position().rows() + std::size_t{nodal.vertex} * 4;
    const Vec3& f = nodal.force;
    sum += f[0] * x[0] + f[1] * x[1] + f[2] * x[2] - nodal.at_rest;
  }
  return sum;
}

double DeadLoads::potential(double time) {
  double sum = 0;
  for (const Load& load : loads_) sum -= load.ramp.value(time) * value(load);
  return sum;
}

void DeadLoads::restart() {
  work_ = 0;
  forget_last();
}

/// Each copy takes what it has of the triangles, or, of a force on nodes, the share of its part.
void DeadLoads::load_copies(Load& load, std::span<const Split> copies,
                            const RestPlaces& rest) const {
  const ElementParts& parts = attributes_.parts();
  if (!load.triangles.empty())
    return add_corners(load, triangles_of_copies(load.triangles, *parts.copies(), copies), rest);
  const std::size_t before = load.corners.size();
  for (std::size_t i = 0; i < before; ++i) {
    const Corner corner = load.corners[i];
    auto next = std::ranges::lower_bound(copies, corner.element, {}, &Split::old_cell);
    for (; next != copies.end() && next->old_cell == corner.element; ++next) {
      const auto& [origin, copy] = *next;
      Corner part = corner;
      part.element = copy;
      // A copy that absorbs others takes what all of them have.
      const double share = std::min(1.0, parts.fraction(copy) / parts.fraction(origin));
      for (double& f : part.force) f *= share;
      load.corners.push_back(part);
    }
  }
}

void DeadLoads::follow(const CellComplex& complex, const TopologyChange& change) {
  const bool only_apart = change.faces_sewn == 0 && change.removed[3].empty();
  if (only_apart && change.splits[0].empty()) return;
  const RestPlaces rest = attributes_.rest_places(complex);
  for (Load& load : loads_) {
    if (!change.copies.empty()) load_copies(load, change.successors(), rest);
    std::erase_if(load.corners, [&](const Corner& corner) {
      return !complex.exists(3, corner.element) ||
             (corner.face != none && !is_open(complex, corner.face));
    });
    std::erase_if(load.triangles, [&](const SurfaceTriangle& triangle) {
      return !complex.exists(3, triangle.element);
    });
    sum_corners(load, rest);
  }
}

void DeadLoads::state(Archive& archive) {
  archive("work", work_);
  archive.rows<double>("booked", booked_);
  if (!archive.has_cells()) return;
  std::span loads = loads_;
  archive.each("loads", loads, [&](Archive& each, Load& load) {
    each.group("corners", [&] {
      each.member("element", load.corners, &Corner::element);
      each.member("node", load.corners, &Corner::node);
      each.member("force", load.corners, &Corner::force);
      each.member("face", load.corners, &Corner::face);
    });
    if (attributes_.parts().may_grow()) state_of(each, load.triangles);
    each.group("nodal", [&] {
      each.member("vertex", load.nodal, &Nodal::vertex);
      each.member("force", load.nodal, &Nodal::force);
      each.member("at rest", load.nodal, &Nodal::at_rest);
    });
  });
}

double DeadLoads::last_change() const {
  double time = 0;
  for (const Load& load : loads_) time = std::max(time, load.ramp.to);
  return time;
}

}  // namespace suture
