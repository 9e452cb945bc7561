// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/cut_faces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/base/bulk.hpp"
#include "kernel/base/error.hpp"

namespace suture {
namespace {

double product(const Vec3& a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// The sum of the magnitudes that product() adds up: its rounding is relative to that.
double magnitude_of_product(const Vec3& a, const double* b) {
  return std::abs(a[0] * b[0]) + std::abs(a[1] * b[1]) + std::abs(a[2] * b[2]);
}

/// The user's points of a face, sorted.
std::array<Index, 4> points_of(const CellComplex& complex, Dart face,
                               std::span<const Index> point_of_vertex) {
  std::array<Index, 4> points;
  for (Dart k = 0; k < 4; ++k) points[k] = point_of_vertex[complex.origin(face_of(face) + k)];
  std::ranges::sort(points);
  return points;
}

bool shared_a_face(const CellComplex& complex, Index a, Index b,
                   std::span<const Index> point_of_vertex) {
  for (const Dart f : sides_of(a))
    for (const Dart g : sides_of(b))
      if (points_of(complex, f, point_of_vertex) == points_of(complex, g, point_of_vertex))
        return true;
  return false;
}

}  // namespace

std::vector<Dart> faces_across_plane(const CellComplex& complex, const double* rows,
                                     const Vec3& point, const Vec3& normal, std::size_t stride,
                                     const ElementBlocks* blocks, const Box& within) {
  const double size = std::hypot(normal[0], normal[1], normal[2]);
  if (!std::isfinite(point[0] + point[1] + point[2]) || !std::isfinite(size) || size == 0)
    throw InputError("a plane needs a finite point and a finite normal that is not zero");
  const Vec3 n{normal[0] / size, normal[1] / size, normal[2] / size};
  const double offset = product(n, point.data());

  const SearchedElements near(blocks, complex.element_count(), [&](const Box& box) {
    const auto [low, high] = heights_of(box, point, n);
    return !(low > 0 || high < 0) && overlap(box, within);
  });
  BulkVector<double> heights(near.slot_count());
  double magnitude = 0;
  near.for_each([&](Index e) {
    if (!complex.exists(3, e)) return;
    double& height = heights[near.slot(e)] = 0;
    for (const Index v : complex.vertices_of(e)) {
      height += product(n, rows + stride * v) - offset;
      magnitude = std::max(magnitude, magnitude_of_product(n, rows + stride * v));
    }
  });
  const double rounding = 32 * std::numeric_limits<double>::epsilon() *
                          (magnitude + magnitude_of_product(n, point.data()));
  const auto is_above = [&](Index e) { return heights[near.slot(e)] >= -rounding; };
  std::vector<Dart> faces;
  near.for_each([&](Index e) {
    for (int f = 0; f < hexahedron::faces; ++f) {
      const Index other = complex.neighbour(e, f);
      if (other != none && e < other && near.contains(other) && is_above(e) != is_above(other))
        faces.push_back(face_dart(e, f));
    }
  });
  return faces;
}

Dart face_between(const CellComplex& complex, const std::string& path, const ElementPair& pair,
                  const std::function<Index(std::uint64_t)>& element_of,
                  std::span<const Index> point_of_vertex) {
  const std::string names =
      "elements " + std::to_string(pair[0]) + " and " + std::to_string(pair[1]);
  std::array<Index, 2> elements;
  for (int i = 0; i < 2; ++i) {
    elements[i] = element_of(pair[i]);
    if (elements[i] == none)
      throw InputError(path + ": the mesh has no element " + std::to_string(pair[i]));
  }
  if (elements[0] == elements[1])
    throw InputError(path + ": the pair contains element " + std::to_string(pair[0]) +
                     " twice; a face lies between two elements");
  if (!complex.exists(3, elements[0]) || !complex.exists(3, elements[1])) return none;
  for (int f = 0; f < hexahedron::faces; ++f)
    if (complex.neighbour(elements[0], f) == elements[1]) return face_dart(elements[0], f);
  if (point_of_vertex.empty())
    throw InputError(path + ": " + names + " have no common face (or it has already been cut)");
  if (shared_a_face(complex, elements[0], elements[1], point_of_vertex)) return none;
  throw InputError(path + ": " + names + " are not neighbours: they have no common face");
}

ListedFaces faces_between(const CellComplex& complex, const std::string& path,
                          std::span<const ElementPair> pairs,
                          const std::function<Index(std::uint64_t)>& element_of,
                          std::span<const Index> point_of_vertex) {
  ListedFaces result;
  std::string faults;
  for (std::size_t i = 0; i < pairs.size(); ++i) try {
      const Dart face = face_between(complex, path + "/" + std::to_string(i), pairs[i], element_of,
                                     point_of_vertex);
      const bool whole =
          complex.exists(3, element_of(pairs[i][0])) && complex.exists(3, element_of(pairs[i][1]));
      if (face != none)
        result.faces.push_back(face);
      else
        (whole ? result.already_cut : result.removed).push_back(pairs[i]);
    } catch (const InputError& error) {
      faults += (faults.empty() ? "" : "\n") + std::string(error.what());
    }
  if (!faults.empty()) throw InputError(faults);
  return result;
}

}  // namespace suture
