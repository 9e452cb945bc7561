// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/plausibility.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "kernel/attributes/shape.hpp"
#include "kernel/base/box.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/dynamics/moduli.hpp"

namespace suture {
namespace {

/// From aerogels to heavy metals, from the softest gels to diamond, from cells to buildings.
constexpr double densities[] = {1, 3e4}, speeds[] = {0.1, 2e4}, sizes[] = {1e-6, 100};
/// Beyond, a solid is pressed flat by its weight.
constexpr double bearable_strain = 0.5;

struct Figures {
  Vec3 size{};  ///< m
  double mass = 0, volume = 0;
  double speed = 0, strain = 0;  ///< m/s and 1; 0: not known

  double density() const { return mass / volume; }
};

/// 0 if the models do not provide it.
double speed_of_waves(Body& body, double mass) {
  if (!body.models().has_tangent()) return 0;
  try {
    return std::sqrt(std::max(sum_of_moduli(body, {{{1, 0, 0}, {}, {}}}, 0), 0.0) / mass);
  } catch (const NumericalError&) {
    return 0;  // the run reports what is wrong
  }
}

Figures figures_of(BuiltScene& built) {
  Body& body = built.body();
  Attributes& all = body.attributes();
  const CellComplex& complex = body.complex();
  const auto rest = [&](Index v) {
    return Vec3{all.rest().get(v, 0), all.rest().get(v, 1), all.rest().get(v, 2)};
  };
  Figures f;
  Box box = no_box;
  for (Index v = 0; v < all.vertex_count(); ++v) {
    if (!complex.exists(0, v)) continue;
    include(box, rest(v));
    f.mass += all.mass().get(v, 0);
  }
  for (Index e = 0; e < complex.element_count(); ++e) {
    HexahedronNodes nodes;
    for (std::size_t n = 0; n < hexahedron::vertices; ++n)
      nodes[n] = rest(complex.vertices_of(e)[n]);
    f.volume += all.parts().fraction(e) * std::abs(hexahedron_volume(nodes));
  }
  for (std::size_t a = 0; a < 3; ++a) f.size[a] = box.length(a);
  f.speed = speed_of_waves(body, f.mass);
  if (f.speed == 0) return f;
  const Vec3& g = built.scene().gravity;
  const double drop =
      std::abs(g[0]) * f.size[0] + std::abs(g[1]) * f.size[1] + std::abs(g[2]) * f.size[2];
  f.strain = drop / (f.speed * f.speed);
  return f;
}

std::string unusual(const Figures& f) {
  std::string list;
  const auto add = [&](bool is_usual, const char* what) {
    if (!is_usual) list += (list.empty() ? "" : ", ") + std::string(what);
  };
  const auto within = [](double x, const double(&range)[2]) {
    return x >= range[0] && x <= range[1];
  };
  add(within(std::hypot(f.size[0], f.size[1], f.size[2]), sizes), "size (1e-6 to 100 m)");
  add(within(f.density(), densities), "density (1 to 3e4 kg/m^3)");
  add(f.speed == 0 || within(f.speed, speeds), "wave speed (0.1 to 2e4 m/s)");
  add(f.strain <= bearable_strain, "weight (strains below 0.5)");
  return list;
}

}  // namespace

std::string describe_plausibility(BuiltScene& built) {
  const Figures f = figures_of(built);
  std::ostringstream text;
  text.precision(4);
  text << "body: " << f.size[0] << " x " << f.size[1] << " x " << f.size[2] << " m, " << f.mass
       << " kg, " << f.density() << " kg/m^3";
  if (f.speed > 0) text << ", waves of " << f.speed << " m/s";
  if (f.strain > 0) text << ", strained by " << f.strain << " under its weight";
  if (const std::string list = unusual(f); !list.empty())
    text << "; unusual for a solid: " << list << "; check the units";
  return text.str();
}

}  // namespace suture
