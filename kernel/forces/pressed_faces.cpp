// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/pressed_faces.hpp"

#include <map>

namespace suture {

// -------------------------------------------------------------------- faces --

std::vector<PressedFace> PressedFace::all(const RestPlaces& rest, std::span<const Dart> faces,
                                          const LoadProfile& profile) {
  std::vector<PressedFace> all;
  for (const Dart face : faces) {
    const auto& corners = suture_hexahedron_faces[local_face(face)];
    const HexahedronNodes nodes = rest.of(element_of(face));
    all.push_back({face});
    for (std::size_t a = 0; a < node_count; ++a) all.back().factors[a] = profile(nodes[corners[a]]);
  }
  return all;
}

/// sum N_a factor_a / 4
static double weight_of(const PressedFace& face, const QuadPoint& point) {
  double factor = 0;
  for (std::size_t a = 0; a < face.factors.size(); ++a) factor += point.n[a] * face.factors[a];
  return factor / 4;
}

PressedFace::Positions PressedFace::forces(const Positions& x, double pressure) const {
  Positions forces{};
  for_each_point(x, [&](const QuadPoint& point) {
    const double p = pressure * weight_of(*this, point);
    const Vec3 inward = point.normal();
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t c = 0; c < 3; ++c) forces[a][c] += p * point.n[a] * inward[c];
  });
  return forces;
}

PressedFace::Arms PressedFace::arms(const Positions& x) const {
  Arms w{};
  for_each_point(x, [&](const QuadPoint& p) {
    const double weight = weight_of(*this, p);
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b)
        for (std::size_t c = 0; c < 3; ++c)
          w[a][b][c] += weight * p.n[a] * (p.x_r[c] * p.n_s[b] - p.x_s[c] * p.n_r[b]);
  });
  return w;
}

void PressedFace::state(Archive& archive, std::vector<PressedFace>& faces) {
  archive.member("faces", faces, &PressedFace::face);
  archive.member("factors", faces, &PressedFace::factors);
}

// -------------------------------------------------------------------- parts --

namespace {

/// visit(pair, b, c) for 1 <= b < c <= 7. The derivatives of shape functions add up to zero, so
/// that positions relative to node 0 suffice.
template <class Visit>
void for_each_pair(Visit visit) {
  std::size_t pair = 0;
  for (std::size_t b = 1; b < PressedPart::node_count; ++b)
    for (std::size_t c = b + 1; c < PressedPart::node_count; ++c) visit(pair++, b, c);
}

/// A normal that points inward takes r and s the other way round.
void add_products(PressedPart& part, const SurfaceTriangle& triangle, const RestPlaces& rest,
                  const LoadProfile& profile) {
  const auto factor = [&](const TrianglePoint& point) {
    if (profile.points.empty()) return 1.0;
    return profile(point.place(rest.of(triangle.element)));
  };
  for (const TrianglePoint& point : quadrature_points(triangle)) {
    const double weight = point.weight * factor(point);
    for_each_pair([&](std::size_t pair, std::size_t b, std::size_t c) {
      const double product = weight * (point.n_s[b] * point.n_r[c] - point.n_r[b] * point.n_s[c]);
      for (std::size_t a = 0; a < PressedPart::node_count; ++a)
        part.products[a][pair] += point.n[a] * product;
    });
  }
}

PressedPart::Positions relative(const PressedPart::Positions& x) {
  PressedPart::Positions y;
  for (std::size_t a = 0; a < PressedPart::node_count; ++a) y[a] = minus(x[a], x[0]);
  return y;
}

}  // namespace

std::vector<PressedPart> PressedPart::all(const RestPlaces& rest,
                                          std::span<const SurfaceTriangle> triangles,
                                          const LoadProfile& profile) {
  std::map<Index, PressedPart> parts;
  for (const SurfaceTriangle& triangle : triangles) {
    PressedPart& part = parts[triangle.element];
    part.element = triangle.element;
    add_products(part, triangle, rest, profile);
  }
  std::vector<PressedPart> all;
  for (const auto& [element, part] : parts) all.push_back(part);
  return all;
}

PressedPart::Positions PressedPart::forces(const Positions& x, double pressure) const {
  const Positions y = relative(x);
  Positions forces{};
  for_each_pair([&](std::size_t pair, std::size_t b, std::size_t c) {
    const Vec3 area = scaled(pressure, cross(y[b], y[c]));
    for (std::size_t a = 0; a < PressedPart::node_count; ++a)
      for (std::size_t i = 0; i < 3; ++i) forces[a][i] += products[a][pair] * area[i];
  });
  return forces;
}

/// w_ab = sum_c y_c (products of c and b), w_a0 = - sum of the others.
PressedPart::Arms PressedPart::arms(const Positions& x) const {
  const Positions y = relative(x);
  Arms w{};
  for (std::size_t a = 0; a < PressedPart::node_count; ++a)
    for_each_pair([&](std::size_t pair, std::size_t b, std::size_t c) {
      const double product = products[a][pair];
      for (std::size_t i = 0; i < 3; ++i) {
        const double of_b = -product * y[c][i], of_c = product * y[b][i];
        w[a][b][i] += of_b;
        w[a][c][i] += of_c;
        w[a][0][i] -= of_b + of_c;
      }
    });
  return w;
}

void PressedPart::state(Archive& archive, std::vector<PressedPart>& parts) {
  archive.member("elements", parts, &PressedPart::element);
  archive.member("products", parts, &PressedPart::products);
}

}  // namespace suture
