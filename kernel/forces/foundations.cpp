// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/foundations.hpp"

#include <algorithm>
#include <type_traits>

#include "kernel/base/aligned.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/forces/quad.hpp"

namespace suture {
namespace {

constexpr std::size_t entry_of[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};  // in XX YY ZZ XY YZ XZ

template <class Vector>
Vec3 product(const std::array<double, 6>& a, const Vector& u) {
  Vec3 f{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) f[i] += a[entry_of[i][j]] * u[j];
  return f;
}

}  // namespace

void Foundations::add(const CellComplex& complex, std::span<const Dart> faces,
                      const FoundationLaw& law) {
  const std::size_t first = patches_.size();
  add(complex, triangles_of_faces(faces), law);
  for (std::size_t i = first; i < patches_.size(); ++i) patches_[i].face = faces[(i - first) / 2];
}

void Foundations::add(const CellComplex& complex, std::span<const SurfaceTriangle> triangles,
                      const FoundationLaw& law) {
  if (triangles.empty()) throw InputError("a foundation acts on no face; select at least one");
  laws_.push_back(law);
  is_damped_ |= law.damping > 0;
  for (const SurfaceTriangle& triangle : triangles)
    patches_.push_back({triangle, static_cast<Index>(laws_.size() - 1)});
  build(complex);
}

void Foundations::add_supports(const Patch& patch, const RestPlaces& rest) {
  const Index element = patch.triangle.element;
  const HexahedronNodes nodes = rest.of(element);
  const Hexahedron& vertices = rest.complex().vertices_of(element);
  const FoundationLaw& law = laws_[patch.law];
  for (const TrianglePoint& point : quadrature_points(patch.triangle)) {
    const Vec3 normal = point.area(nodes);
    const double size = norm(normal);
    if (size == 0) continue;
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      const double area = point.n[a] * point.weight * size;
      if (area == 0) continue;
      Support support{vertices[a], nodes[a], {}, area * law.damping};
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = i; j < 3; ++j) {
          const double along = normal[i] * normal[j] / (size * size);
          support.stiffness[entry_of[i][j]] =
              area * (law.normal * along + law.tangential * ((i == j ? 1 : 0) - along));
        }
      supports_.push_back(support);
    }
  }
}

/// Sums the corners that share a vertex and its place at rest.
void Foundations::build(const CellComplex& complex) {
  const RestPlaces rest = attributes_.rest_places(complex);
  forget_last();
  supports_.clear();
  for (const Patch& patch : patches_) add_supports(patch, rest);
  std::ranges::stable_sort(supports_, [](const Support& a, const Support& b) {
    return a.vertex != b.vertex ? a.vertex < b.vertex : a.rest < b.rest;
  });
  std::size_t count = 0;
  for (const Support& next : supports_) {
    Support* last = count == 0 ? nullptr : &supports_[count - 1];
    if (last == nullptr || last->vertex != next.vertex || last->rest != next.rest) {
      supports_[count++] = next;
      continue;
    }
    for (std::size_t i = 0; i < 6; ++i) last->stiffness[i] += next.stiffness[i];
    last->damping += next.damping;
  }
  supports_.resize(count);
}

Vec3 Foundations::displacement(const Support& support) const {
  const double* x = attributes_.position().rows() + std::size_t{support.vertex} * 4;
  return {x[0] - support.rest[0], x[1] - support.rest[1], x[2] - support.rest[2]};
}

Vec3 Foundations::damping_force(const Support& support) const {
  const double* v = attributes_.velocity().rows() + std::size_t{support.vertex} * 4;
  return {-support.damping * v[0], -support.damping * v[1], -support.damping * v[2]};
}

/// f = - K_c (x - X_c) - C_c v
Vec3 Foundations::force(const Support& support) const {
  const Vec3 spring = product(support.stiffness, displacement(support));
  return minus(is_damped_ ? damping_force(support) : Vec3{}, spring);
}

void Foundations::add_forces(double, const LiveMask& live, double* rows) {
  for (const Support& support : supports_) add_row(rows, live, support.vertex, 1, force(support));
}

void Foundations::add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) {
  add_forces(step.time, live, rows);
  if (!is_damped_) return;
  const bool first = booked_.empty();
  booked_.resize(supports_.size());
  for (std::size_t i = 0; i < supports_.size(); ++i) {
    const Vec3 u = displacement(supports_[i]), f = damping_force(supports_[i]);
    if (!first) work_ += dot(plus(booked_[i].force, f), minus(u, booked_[i].position)) / 2;
    booked_[i] = {u, f};
  }
}

void Foundations::add_forces_at(const VertexSelection& selection, std::span<const Index> vertices,
                                double, std::vector<Vec3>& forces) {
  for (const Index v : vertices) {
    auto support = std::ranges::lower_bound(supports_, v, {}, &Support::vertex);
    for (; support != supports_.end() && support->vertex == v; ++support) {
      Vec3& sum = forces[selection.slot(v)];
      sum = plus(sum, force(*support));
    }
  }
}

void Foundations::mark_vertices(std::vector<bool>& marks) const {
  for (const Support& support : supports_) marks[support.vertex] = true;
}

template <class Real>
void Foundations::multiply(const Real* d, double dx, double dv, Real* out) const {
  constexpr std::size_t row = std::is_same_v<Real, float> ? 4 : 3;  // numbers per vertex
  for (const Support& support : supports_) {
    const std::size_t at = support.vertex * row;
    const Vec3 f = product(support.stiffness, d + at);
    for (std::size_t c = 0; c < 3; ++c)
      out[at + c] -= static_cast<Real>(dx * f[c] + dv * support.damping * d[at + c]);
  }
}

void Foundations::add_tangent(const double* d, double dx, double dv, const TangentTime&,
                              double* out) {
  multiply(d, dx, dv, out);
}

bool Foundations::add_tangent_in_single(const float* d, double dx, double dv, const TangentTime&,
                                        float* out) {
  multiply(d, dx, dv, out);
  return true;
}

void Foundations::for_each_tangent(double dx, double dv, const TangentTime&,
                                   const VisitTangents& visit) {
  constexpr std::size_t width = 8;
  AlignedVector<double> values(9 * width);
  std::array<Index, width> vertices{};
  for (std::size_t begin = 0; begin < supports_.size(); begin += width) {
    const std::size_t count = std::min(width, supports_.size() - begin);
    std::ranges::fill(values, 0.0);
    for (std::size_t lane = 0; lane < count; ++lane) {
      const Support& support = supports_[begin + lane];
      vertices[lane] = support.vertex;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          values[(j * 3 + i) * width + lane] =
              -dx * support.stiffness[entry_of[i][j]] - (i == j ? dv * support.damping : 0);
    }
    visit({static_cast<Index>(count), 1, vertices.data(), values.data()});
  }
}

/// The matrices are blocks of vertices, so the bound is exact.
void Foundations::add_bounds(double, const AddBounds& sums) {
  for (const Support& support : supports_) {
    const double c = support.damping, damping[6]{c, c, c, 0, 0, 0};
    sums(support.vertex, support.stiffness.data(), damping);
  }
}

double Foundations::energy(double) {
  double sum = 0;
  for (const Support& support : supports_) {
    const Vec3 u = displacement(support);
    sum += dot(u, product(support.stiffness, u)) / 2;
  }
  return sum;
}

void Foundations::restart() {
  work_ = 0;
  forget_last();
}

void Foundations::add_copies(std::span<const Split> copies) {
  for (Index law = 0; law < laws_.size(); ++law) {
    std::vector<SurfaceTriangle> triangles;
    for (const Patch& patch : patches_)
      if (patch.law == law) triangles.push_back(patch.triangle);
    for (const SurfaceTriangle& triangle :
         triangles_of_copies(triangles, *attributes_.parts().copies(), copies))
      patches_.push_back({triangle, law});
  }
}

void Foundations::follow(const CellComplex& complex, const TopologyChange& change) {
  const bool only_apart = change.faces_sewn == 0 && change.removed[3].empty();
  if (supports_.empty() || (only_apart && change.splits[0].empty())) return;
  if (!change.copies.empty()) add_copies(change.successors());
  std::erase_if(patches_, [&](const Patch& patch) {
    return !complex.exists(3, patch.triangle.element) ||
           (patch.face != none && !is_open(complex, patch.face));
  });
  build(complex);
}

void Foundations::state(Archive& archive) {
  archive("work", work_);
  archive.rows<double>("booked", booked_);
  if (!archive.has_cells()) return;
  archive.group("patches", [&] {
    std::vector<SurfaceTriangle> triangles;
    for (const Patch& patch : patches_) triangles.push_back(patch.triangle);
    state_of(archive, triangles);
    patches_.resize(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) patches_[i].triangle = triangles[i];
    archive.member("law", patches_, &Patch::law);
    archive.member("face", patches_, &Patch::face);
  });
  archive.group("supports", [&] {
    archive.member("vertex", supports_, &Support::vertex);
    archive.member("rest", supports_, &Support::rest);
    archive.member("stiffness", supports_, &Support::stiffness);
    archive.member("damping", supports_, &Support::damping);
  });
}

}  // namespace suture
