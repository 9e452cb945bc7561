// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/loads.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "kernel/attributes/shape.hpp"
#include "kernel/base/archive.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

using Quad = std::array<Vec3, 4>;

Vec3 row(const double* rows, Index vertex) {
  const double* p = rows + std::size_t{vertex} * 4;
  return {p[0], p[1], p[2]};
}

/// Vertices of the face of a dart, counter-clockwise seen from inside: the normal
/// dx/dr x dx/ds points inward.
std::array<Index, 4> face_nodes(const CellComplex& complex, Dart face) {
  const Hexahedron& x = complex.vertices_of(face / 24);
  const auto& local = suture_hexahedron_faces[face % 24 / 4];
  return {x[local[0]], x[local[1]], x[local[2]], x[local[3]]};
}

Quad rest_corners(const RestPlaces& rest, Dart face) {
  Quad x;
  for (std::size_t a = 0; a < 4; ++a) {
    const double* p = rest.corner(face / 24, suture_hexahedron_faces[face % 24 / 4][a]);
    x[a] = {p[0], p[1], p[2]};
  }
  return x;
}

/// The face is still there and on the boundary.
bool is_open(const CellComplex& complex, Dart face) {
  return complex.exists(3, face / 24) && complex.beta3(face) == none;
}

Quad corners_of(const double* rows, const std::array<Index, 4>& nodes) {
  return {row(rows, nodes[0]), row(rows, nodes[1]), row(rows, nodes[2]), row(rows, nodes[3])};
}

/// visit(shape functions N_0..N_3, dx/dr x dx/ds) at the 2 x 2 Gauss points of a
/// bilinear face on the unit square, nodes (0,0) (1,0) (1,1) (0,1); weights 1/4.
template <class Visit>
void for_each_point(const Quad& x, Visit visit) {
  const double low = 0.5 - 0.5 / std::sqrt(3.0), points[2] = {low, 1 - low};
  for (const double r : points)
    for (const double s : points) {
      const std::array<double, 4> n{(1 - r) * (1 - s), r * (1 - s), r * s, (1 - r) * s};
      Vec3 along_r, along_s;
      for (std::size_t c = 0; c < 3; ++c) {
        along_r[c] = (1 - s) * (x[1][c] - x[0][c]) + s * (x[2][c] - x[3][c]);
        along_s[c] = (1 - r) * (x[3][c] - x[0][c]) + r * (x[2][c] - x[1][c]);
      }
      visit(n, cross(along_r, along_s));
    }
}

/// Integral of N_a over the area, per corner. Four points: exact for
/// parallelograms, where the area element is constant.
std::array<double, 4> corner_areas(const Quad& x) {
  std::array<double, 4> areas{};
  for_each_point(x, [&](const std::array<double, 4>& n, const Vec3& normal) {
    const double area =
        std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]) / 4;
    for (std::size_t a = 0; a < 4; ++a) areas[a] += n[a] * area;
  });
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
      for (Dart f = 0; f < 6; ++f) {
        const Dart face = d / 24 * 24 + 4 * f;
        if (complex.beta3(face) == none) faces.push_back(face);
      }
  }
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
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

void Loads::add_at_vertex(DeadLoad& load, const RestPlaces& rest, Index vertex, const Vec3& force) {
  const CellComplex& complex = rest.complex();
  std::vector<Dart> star;
  complex.star(0, vertex, star);
  std::vector<double> volumes;
  double total = 0;
  for (const Dart d : star) {
    volumes.push_back(std::abs(hexahedron_volume(rest.of(d / 24))));
    total += volumes.back();
  }
  for (std::size_t i = 0; i < star.size(); ++i) {
    const Index element = star[i] / 24;
    const Hexahedron& nodes = complex.vertices_of(element);
    const auto corner = std::find(nodes.begin(), nodes.end(), vertex) - nodes.begin();
    const double share = volumes[i] / total;
    load.corners.push_back({element,
                            static_cast<std::uint32_t>(corner),
                            {force[0] * share, force[1] * share, force[2] * share}});
  }
}

void Loads::sum_corners(DeadLoad& load, const RestPlaces& rest) {
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

void Loads::add_force(const CellComplex& complex, Attributes& attributes,
                      std::span<const Index> vertices, const Vec3& total, const TimeRamp& ramp) {
  if (vertices.empty()) throw InputError("a force acts on no vertex: select at least one");
  const RestPlaces rest = attributes.rest_places(complex);
  std::vector<double> weights = areas_around(rest, vertices);
  if (weights.empty()) weights.assign(vertices.size(), 1);
  double sum = 0;
  for (const double w : weights) sum += w;
  DeadLoad load;
  load.ramp = ramp;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const double w = weights[i] / sum;
    add_at_vertex(load, rest, vertices[i], {total[0] * w, total[1] * w, total[2] * w});
  }
  sum_corners(load, rest);
  dead_.push_back(std::move(load));
}

void Loads::add_traction(const CellComplex& complex, Attributes& attributes,
                         std::span<const Dart> faces, const Vec3& traction, const TimeRamp& ramp) {
  if (faces.empty()) throw InputError("a traction acts on no face: select at least one");
  const RestPlaces rest = attributes.rest_places(complex);
  DeadLoad load;
  load.ramp = ramp;
  for (const Dart face : faces) {
    const auto areas = corner_areas(rest_corners(rest, face));
    const auto& local = suture_hexahedron_faces[face % 24 / 4];
    for (std::size_t a = 0; a < 4; ++a)
      load.corners.push_back(
          {face / 24,
           local[a],
           {traction[0] * areas[a], traction[1] * areas[a], traction[2] * areas[a]},
           face});
  }
  sum_corners(load, rest);
  dead_.push_back(std::move(load));
}

void Loads::add_pressure(const CellComplex& complex, std::span<const Dart> faces, double pressure,
                         const TimeRamp& ramp) {
  if (faces.empty()) throw InputError("a pressure acts on no face: select at least one");
  PressureLoad load{pressure, {faces.begin(), faces.end()}, {}, ramp};
  for (const Dart face : faces) load.nodes.push_back(face_nodes(complex, face));
  pressures_.push_back(std::move(load));
}

template <class Visit>
void Loads::for_each_face(const PressureLoad& load, const double* position, double time,
                          Visit visit) {
  const double p = load.pressure * load.ramp.value(time) / 4;
  for (std::size_t i = 0; i < load.nodes.size(); ++i) {
    std::array<Vec3, 4> force{};
    for_each_point(corners_of(position, load.nodes[i]),
                   [&](const std::array<double, 4>& n, const Vec3& inward) {
                     for (std::size_t a = 0; a < 4; ++a)
                       for (std::size_t c = 0; c < 3; ++c) force[a][c] += p * n[a] * inward[c];
                   });
    visit(i, force);
  }
}

namespace {

void add_row(double* rows, const LiveMask& live, Index vertex, double s, const Vec3& force) {
  for (std::size_t c = 0; c < 3 && live[vertex]; ++c)
    rows[std::size_t{vertex} * 4 + c] += s * force[c];
}

}  // namespace

template <class OnFace>
void Loads::add(double* rows, const double* position, double time, const LiveMask& live,
                OnFace on_face) const {
  for (const DeadLoad& load : dead_) {
    const double s = load.ramp.value(time);
    for (const Nodal& nodal : load.nodal) add_row(rows, live, nodal.vertex, s, nodal.force);
  }
  for (std::size_t l = 0; l < pressures_.size(); ++l)
    for_each_face(pressures_[l], position, time,
                  [&](std::size_t i, const std::array<Vec3, 4>& force) {
                    const std::array<Index, 4>& nodes = pressures_[l].nodes[i];
                    for (std::size_t a = 0; a < 4; ++a) add_row(rows, live, nodes[a], 1, force[a]);
                    on_face(l, i, force);
                  });
}

void Loads::add_to(double* rows, const double* position, double time, const LiveMask& live) const {
  add(rows, position, time, live, [](std::size_t, std::size_t, const std::array<Vec3, 4>&) {});
}

void Loads::add_at(const VertexSelection& selection, std::span<const Index> vertices,
                   const double* position, double time, std::vector<Vec3>& forces) const {
  for (const DeadLoad& load : dead_) {
    const double s = load.ramp.value(time);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const auto nodal = std::ranges::lower_bound(load.nodal, vertices[i], {}, &Nodal::vertex);
      if (nodal == load.nodal.end() || nodal->vertex != vertices[i]) continue;
      for (std::size_t c = 0; c < 3; ++c) forces[i][c] += s * nodal->force[c];
    }
  }
  for (PressureLoad load : pressures_) {
    std::erase_if(load.nodes, [&](const std::array<Index, 4>& nodes) {
      return std::ranges::none_of(nodes, [&](Index v) { return selection.contains(v); });
    });
    for_each_face(load, position, time, [&](std::size_t i, const std::array<Vec3, 4>& force) {
      for (std::size_t a = 0; a < 4; ++a) {
        const Index slot = selection.slot(load.nodes[i][a]);
        for (std::size_t c = 0; c < 3 && slot != none; ++c) forces[slot][c] += force[a][c];
      }
    });
  }
}

void Loads::add_and_book(double* rows, const double* position, double time, const LiveMask& live) {
  book_dead(position, time);
  const bool first = book_.of_pressure.size() != pressures_.size();
  book_.of_pressure.resize(pressures_.size());
  for (std::size_t l = 0; l < pressures_.size(); ++l)
    book_.of_pressure[l].resize(pressures_[l].nodes.size());
  add(rows, position, time, live,
      [&](std::size_t l, std::size_t i, const std::array<Vec3, 4>& force) {
        Book::Face& last = book_.of_pressure[l][i];
        const Quad x = corners_of(position, pressures_[l].nodes[i]);
        for (std::size_t a = 0; a < 4; ++a)
          for (std::size_t c = 0; c < 3 && !first; ++c)
            book_.pressure +=
                (last.force[a][c] + force[a][c]) / 2 * (x[a][c] - last.position[a][c]);
        last = {x, force};
      });
}

double Loads::value(const DeadLoad& load, const double* position) {
  double sum = 0;
  for (const Nodal& nodal : load.nodal) {
    const double* x = position + std::size_t{nodal.vertex} * 4;
    const Vec3& f = nodal.force;
    sum += f[0] * x[0] + f[1] * x[1] + f[2] * x[2] - nodal.at_rest;
  }
  return sum;
}

void Loads::book_dead(const double* position, double time) {
  const bool first = book_.of_dead.size() != dead_.size();
  book_.of_dead.resize(dead_.size());
  for (std::size_t l = 0; l < dead_.size(); ++l) {
    Book::Dead& last = book_.of_dead[l];
    const Book::Dead now{value(dead_[l], position), dead_[l].ramp.value(time)};
    if (!first) book_.dead += (last.ramp + now.ramp) / 2 * (now.value - last.value);
    last = now;
  }
}

double Loads::potential(const double* position, double time) const {
  double sum = 0;
  for (const DeadLoad& load : dead_) sum -= load.ramp.value(time) * value(load, position);
  return sum;
}

void Loads::update(const RestPlaces& rest) {
  const CellComplex& complex = rest.complex();
  for (DeadLoad& load : dead_) {
    std::erase_if(load.corners, [&](const Corner& corner) {
      return !complex.exists(3, corner.element) ||
             (corner.face != none && !is_open(complex, corner.face));
    });
    sum_corners(load, rest);
  }
  for (std::size_t l = 0; l < pressures_.size(); ++l) {
    PressureLoad& load = pressures_[l];
    std::vector<Book::Face>* booked =
        l < book_.of_pressure.size() ? &book_.of_pressure[l] : nullptr;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < load.faces.size(); ++i) {
      if (!is_open(complex, load.faces[i])) continue;
      load.faces[kept] = load.faces[i];
      if (booked) (*booked)[kept] = (*booked)[i];
      ++kept;
    }
    load.faces.resize(kept);
    if (booked) booked->resize(kept);
    load.nodes.clear();
    for (const Dart face : load.faces) load.nodes.push_back(face_nodes(complex, face));
  }
}

// ------------------------------------------------------------------ state --

void Loads::state(Archive& archive) {
  if (archive.has_cells()) {
    std::span dead = dead_;
    std::span pressures = pressures_;
    archive.each("dead", dead);
    archive.each("pressures", pressures);
  }
  archive("book", book_);
}

void Loads::DeadLoad::state(Archive& archive) {
  std::vector<std::array<Index, 3>> places;
  std::vector<Vec3> forces;
  std::vector<Index> vertices;
  std::vector<std::array<double, 4>> sums;
  for (const Corner& c : corners) {
    places.push_back({c.element, c.node, c.face});
    forces.push_back(c.force);
  }
  for (const Nodal& n : nodal) {
    vertices.push_back(n.vertex);
    sums.push_back({n.force[0], n.force[1], n.force[2], n.at_rest});
  }
  archive("corners", places);
  archive("forces", forces);
  archive("vertices", vertices);
  archive("sums", sums);
  archive.require(places.size() == forces.size() && vertices.size() == sums.size(),
                  "the arrays of a load have different lengths");
  if (!archive.loads()) return;
  corners.clear();
  nodal.clear();
  for (std::size_t i = 0; i < places.size(); ++i)
    corners.push_back({places[i][0], places[i][1], forces[i], places[i][2]});
  for (std::size_t i = 0; i < vertices.size(); ++i)
    nodal.push_back({vertices[i], {sums[i][0], sums[i][1], sums[i][2]}, sums[i][3]});
}

void Loads::PressureLoad::state(Archive& archive) {
  archive("faces", faces);
  archive("nodes", nodes);
  archive.require(faces.size() == nodes.size(), "the arrays of a load have different lengths");
}

void Loads::Book::state(Archive& archive) {
  archive("dead", dead);
  archive("pressure", pressure);
  archive.rows<double>("of_dead", of_dead);
  archive.each("of_pressure", of_pressure,
               [](Archive& a, std::vector<Face>& faces) { a.rows<double>("faces", faces); });
}

double Loads::settled_after() const {
  double time = 0;
  for (const DeadLoad& load : dead_) time = std::max(time, load.ramp.to);
  for (const PressureLoad& load : pressures_) time = std::max(time, load.ramp.to);
  return time;
}

}  // namespace suture
