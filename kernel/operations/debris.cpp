// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/debris.hpp"

#include <algorithm>
#include <limits>
#include <sstream>
#include <unordered_set>

#include "kernel/base/message_text.hpp"
#include "kernel/base/sort_unique.hpp"

namespace suture {
namespace {

RestPlaces rest_of(BuiltScene& built) {
  return built.body().attributes().rest_places(built.body().complex());
}

/// Visits elements from one to the next until the volume is reached, so a large island costs as
/// little as a small one.
double volume_below(const CellComplex& complex, const RestPlaces& rest, Index first, double limit,
                    std::vector<Index>& elements) {
  elements.assign(1, first);
  std::unordered_set<Index> visited{first};
  double volume = 0;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    volume += rest.volume(elements[i]);
    if (!(volume < limit)) return std::numeric_limits<double>::infinity();
    for (int f = 0; f < hexahedron::faces; ++f) {
      const Index next = complex.neighbour(elements[i], f);
      if (next != none && visited.insert(next).second) elements.push_back(next);
    }
  }
  return volume;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

Debris::Debris(const Scene& scene, BuiltScene& built)
    : built_(built), removes_(scene.debris.removes) {
  if (!removes_ && !scene.divides_elements()) return;
  const CellComplex& complex = built.body().complex();
  const RestPlaces rest = rest_of(built);
  std::vector<double> cubes;
  cubes.reserve(complex.element_count());
  for (Index e = 0; e < complex.element_count(); ++e) {
    cubes.push_back(hexahedron_volume(rest.of(e)));
    volume_at_start_ += rest.parts().fraction(e) * cubes.back();
  }
  typical_volume_ = median(std::move(cubes));
  if (!removes_) return;
  limit_ = scene.debris.volume.value_or(scene.debris.fraction * typical_volume_);
  const Islands& islands = built.body().islands();
  std::vector<Index> elements;
  for (Index i = 0; i < islands.count(); ++i)
    if (volume_below(i, limit_, elements) < limit_) given_.push_back(i);
}

double Debris::volume_below(Index island, double limit, std::vector<Index>& elements) const {
  return suture::volume_below(built_.body().complex(), rest_of(built_),
                              built_.body().islands().representative(island), limit, elements);
}

std::vector<Index> Debris::find() const {
  std::vector<Index> debris, elements;
  if (!removes_) return debris;
  const Islands& islands = built_.body().islands();
  for (Index i = 0; i < islands.count(); ++i) {
    if (islands.size(i) == 0 || std::ranges::binary_search(given_, i)) continue;
    if (volume_below(i, limit_, elements) < limit_)
      debris.insert(debris.end(), elements.begin(), elements.end());
  }
  std::ranges::sort(debris);
  return debris;
}

RemovedMatter Debris::matter(std::span<const Index> elements) const {
  Body& body = built_.body();
  const RestPlaces rest = rest_of(built_);
  RemovedMatter matter;
  std::vector<Index> vertices, islands;
  for (const Index e : elements) {
    matter.volume += rest.volume(e);
    islands.push_back(body.islands().of(e));
    const Hexahedron& nodes = body.complex().vertices_of(e);
    vertices.insert(vertices.end(), nodes.begin(), nodes.end());
  }
  sort_unique(vertices);
  sort_unique(islands);
  matter.elements = static_cast<Index>(elements.size());
  matter.pieces = static_cast<Index>(islands.size());
  const double *mass = body.attributes().mass().rows(),
               *velocity = body.attributes().velocity().rows();
  for (const Index v : vertices) {
    const double* const row = velocity + std::size_t{v} * 4;
    const Vec3 u{row[0], row[1], row[2]};
    matter.mass += mass[v];
    matter.momentum = plus(matter.momentum, scaled(mass[v], u));
    matter.energy += mass[v] * dot(u, u) / 2;
  }
  matter.energy += body.models().energy_around(elements, built_.dynamics().time());
  return matter;
}

std::vector<Index> elements_of_small_islands(BuiltScene& built, double volume) {
  const CellComplex& complex = built.body().complex();
  const Islands& islands = built.body().islands();
  const RestPlaces rest = rest_of(built);
  std::vector<Index> all, elements;
  for (Index i = 0; i < islands.count(); ++i)
    if (islands.size(i) > 0 &&
        volume_below(complex, rest, islands.representative(i), volume, elements) < volume)
      all.insert(all.end(), elements.begin(), elements.end());
  std::ranges::sort(all);
  return all;
}

std::string volume_text(double volume) {
  std::ostringstream text;
  text.precision(3);
  text << 1e6 * volume << " ml";
  return text.str();
}

std::string describe(const RemovedMatter& removed, double of_volume) {
  std::ostringstream text;
  text.precision(3);
  text << (removed.pieces > 0 ? count_text(removed.pieces, "piece")
                              : count_text(removed.elements, "part"))
       << ", " << volume_text(removed.volume) << " of " << volume_text(of_volume) << ", "
       << removed.mass << " kg, momentum " << norm(removed.momentum) << " N s, energy "
       << removed.energy << " J";
  return text.str();
}

}  // namespace suture
