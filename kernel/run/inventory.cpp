// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/inventory.hpp"

#include <cmath>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/base/escape.hpp"
#include "kernel/base/message_text.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/build/model_regions.hpp"

namespace suture {
namespace {

std::string text_of(double value, const char* unit) {
  std::ostringstream text;
  text.precision(4);
  text << value << ' ' << unit;
  return text.str();
}

/// Components that are rounding are 0.
std::string text_of(Vec3 v) {
  for (const double least = 1e-12 * norm(v); double& component : v)
    if (std::abs(component) <= least) component = 0;
  std::ostringstream text;
  text.precision(4);
  text << '[' << v[0] << ", " << v[1] << ", " << v[2] << "] N";
  return text.str();
}

/// The sums of the area vectors, outward, and of their magnitudes, both times the profile of a
/// load, and the whole area, m^2.
struct Area {
  Vec3 vector{};
  double weighted = 0, size = 0;
};

Area area_of(const std::vector<SurfaceTriangle>& triangles, const RestPlaces& rest,
             const LoadProfile& profile = {}) {
  Area area;
  for (const SurfaceTriangle& triangle : triangles) {
    const HexahedronNodes nodes = rest.of(triangle.element);
    for (const TrianglePoint& point : quadrature_points(triangle)) {
      const Vec3 part = scaled(point.weight, point.area(nodes));
      const double factor = profile(point.place(nodes));
      area.vector = plus(area.vector, scaled(factor, part));
      area.weighted += factor * norm(part);
      area.size += norm(part);
    }
  }
  return area;
}

class Inventory {
 public:
  explicit Inventory(BuiltScene& built)
      : scene_(built.scene()),
        selector_(built.selector()),
        rest_(built.body().attributes().rest_places(built.body().complex())),
        rest_rows_(built.body().attributes().rest().rows()) {}

  /// A set that uses a set of nodes contains no elements.
  std::string line_of(const NamedSelection& set) const {
    std::string line = "set " + quote(set.name) + ": " +
                       count_text(selector_.vertices_now(set.where, rest_rows_).size(), "node");
    try {
      line += ", " + contents(selector_.elements_now(set.where, rest_rows_));
    } catch (const InputError&) {
    }
    return line;
  }
  std::string line_of(const ModelUse& use, const std::vector<Index>& region) const {
    std::vector<Index> all = region;
    for (Index e = 0; region.empty() && e < selector_.element_count(); ++e) all.push_back(e);
    return "model " + quote(use.name) + ": " + contents(all);
  }
  std::string line_of(const Load& load) const {
    switch (load.kind) {
      case Load::Kind::force:
        return text_of(load.value) + " on " +
               count_text(selector_.vertices(load.where).size(), "node");
      case Load::Kind::volume:
        return text_of(load.pressure, "Pa per relative change of the volume");
      case Load::Kind::traction: {
        const Area area = area_of(selector_.surface_triangles(load.where), rest_, load.profile);
        return text_of(norm(load.value), "Pa on ") + text_of(area.size, "m^2, ") +
               text_of(scaled(area.weighted, load.value)) + " in total";
      }
      default: {
        const Area area = area_of(selector_.surface_triangles(load.where), rest_, load.profile);
        return text_of(load.pressure, "Pa on ") + text_of(area.size, "m^2, ") +
               text_of(scaled(-load.pressure, area.vector)) + " in total";
      }
    }
  }
  std::string line_of(const Foundation& foundation) const {
    const Area area = area_of(selector_.surface_triangles(foundation.where), rest_);
    return text_of(area.size, "m^2, ") + text_of(area.size * foundation.normal, "N/m normal, ") +
           text_of(area.size * foundation.tangential, "N/m tangential");
  }
  std::vector<std::string> lines() const {
    std::vector<std::string> lines;
    for (const NamedSelection& set : scene_.sets) lines.push_back(line_of(set));
    if (scene_.models.size() > 1) {
      const auto regions = model_regions(scene_, selector_, rest_);
      for (std::size_t m = 0; m < regions.size(); ++m)
        if (!scene_.models[m].between) lines.push_back(line_of(scene_.models[m], regions[m]));
    }
    for (std::size_t i = 0; i < scene_.foundations.size(); ++i)
      lines.push_back("foundation " + std::to_string(i) + ": " + line_of(scene_.foundations[i]));
    for (std::size_t i = 0; i < scene_.loads.size(); ++i)
      lines.push_back("load " + std::to_string(i) + ": " + line_of(scene_.loads[i]));
    return lines;
  }

 private:
  std::string contents(const std::vector<Index>& elements) const {
    double volume = 0;
    for (const Index e : elements) volume += rest_.volume(e);
    return count_text(elements.size(), "element") + ", " + text_of(volume, "m^3");
  }

  const Scene& scene_;
  const Selector& selector_;
  RestPlaces rest_;
  const double* rest_rows_;
};

}  // namespace

std::vector<std::string> take_inventory(BuiltScene& built) { return Inventory(built).lines(); }

}  // namespace suture
