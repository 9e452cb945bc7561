// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/surface_blade.hpp"

#include <cmath>

#include "kernel/base/bulk.hpp"
#include "kernel/base/error.hpp"
#include "kernel/geometry/geometry_module.hpp"

namespace suture {
namespace {

void check(const TriangleSurface& surface) {
  const std::string& name = surface.source;
  if (surface.triangles.empty()) throw InputError(name + ": the blade has no triangles");
  for (std::size_t i = 0; i < surface.points.size(); ++i)
    for (const double x : surface.points[i])
      if (!std::isfinite(x))
        throw InputError(name + ": point " + std::to_string(i) + " of the blade is not finite");
  for (std::size_t i = 0; i < surface.triangles.size(); ++i)
    for (const Index corner : surface.triangles[i])
      if (corner >= surface.points.size())
        throw InputError(name + ": triangle " + std::to_string(i) + " of the blade uses point " +
                         std::to_string(corner) + "; there are " +
                         std::to_string(surface.points.size()));
}

/// Corners at two places only, or three on a line to the last bit. A thinner test than the exact
/// one: what it leaves without area crosses nothing.
bool has_no_area(const TriangleSurface& s, const Triangle& t) {
  const Vec3 &a = s.points[t[0]], &b = s.points[t[1]], &c = s.points[t[2]];
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    sum += std::abs((b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]));
  }
  return sum == 0;
}

TriangleSurface checked(TriangleSurface surface, Diagnostics& diagnostics) {
  if (surface.source.empty()) surface.source = "blade";
  check(surface);
  const std::size_t dropped =
      std::erase_if(surface.triangles, [&](const Triangle& t) { return has_no_area(surface, t); });
  if (surface.triangles.empty())
    throw InputError(surface.source + ": all triangles of the blade are degenerate");
  if (dropped != 0)
    diagnostics.warn(surface.source + ": " + std::to_string(dropped) +
                     (dropped == 1 ? " triangle" : " triangles") +
                     " without area dropped (they cut nothing)");
  return surface;
}

bool overlap(const Box& box, const Row4& a, const Row4& b) {
  for (int i = 0; i < 3; ++i)
    if (std::max(a[i], b[i]) < box.low[i] || std::min(a[i], b[i]) > box.high[i]) return false;
  return true;
}

}  // namespace

SurfaceBlade::SurfaceBlade(TriangleSurface surface, Diagnostics& diagnostics)
    : surface_(checked(std::move(surface), diagnostics)),
      box_(box_of(surface_.points)),
      grid_(surface_, box_),
      tree_(geometry_module().tree(surface_)) {}
SurfaceBlade::~SurfaceBlade() = default;
SurfaceBlade::SurfaceBlade(SurfaceBlade&&) noexcept = default;
SurfaceBlade& SurfaceBlade::operator=(SurfaceBlade&&) noexcept = default;

std::vector<Dart> SurfaceBlade::faces_cut(const CellComplex& complex, const Places& places,
                                          const Workers* workers,
                                          const ElementBlocks* blocks) const {
  const SearchedElements searched(blocks, complex.element_count(),
                                  [&](const Box& box) { return overlap(box, box_); });
  const std::span<const ElementRange> ranges = searched.ranges();
  BulkVector<Row4> centroids(searched.slot_count());
  for_each_of(ranges.size(), workers, [&](std::size_t number) {
    for (Index e = ranges[number].begin; e < ranges[number].end; ++e)
      if (complex.exists(3, e))
        centroids[searched.slot(e)] = centroid_of(complex.vertices_of(e), places);
  });
  std::vector<std::vector<Dart>> cut(ranges.size());
  for_each_of(ranges.size(), workers, [&](std::size_t number) {
    std::vector<Dart> near;
    std::vector<Segment> links;
    for (Index e = ranges[number].begin; e < ranges[number].end; ++e)
      for (int f = 0; f < hexahedron::faces; ++f) {
        const Index n = complex.neighbour(e, f);
        if (n == none || n < e || !searched.contains(n)) continue;
        const Row4 &one = centroids[searched.slot(e)], &other = centroids[searched.slot(n)];
        if (!overlap(box_, one, other)) continue;
        const Segment link{xyz(one), xyz(other)};
        if (!grid_.may_meet(link.a, link.b)) continue;
        near.push_back(face_dart(e, f));
        links.push_back(link);
      }
    if (links.empty()) return;
    std::vector<std::uint8_t> crossed(links.size());
    tree_->crossings(links, crossed.data());
    for (std::size_t i = 0; i < near.size(); ++i)
      if (crossed[i]) cut[number].push_back(near[i]);
  });
  std::vector<Dart> faces;
  for (const auto& part : cut) faces.insert(faces.end(), part.begin(), part.end());
  return faces;
}

}  // namespace suture
