// SPDX-License-Identifier: GPL-3.0-or-later
//
// A body compared with another one that should have the same forces.
#include <algorithm>
#include <cmath>
#include <optional>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/model_check/checks.hpp"

namespace suture::checks {
namespace {

using NodalValues = std::vector<double>;

constexpr std::array<Vec3, 3> quarter_turn{{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}};  // x -> y -> z

NodalValues rotated_all(const std::array<Vec3, 3>& rotation, NodalValues values) {
  for (std::size_t i = 0; i < values.size(); i += 3) {
    const Vec3 v = rotated(rotation, {values[i], values[i + 1], values[i + 2]});
    std::ranges::copy(v, values.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return values;
}

bool has_loads(SampleBody& sample) {
  return std::ranges::any_of(sample.functors(), [](const suture_functor* f) {
    return f->dimension == 2 && extension_of<suture_energy_1>(*f, SUTURE_ENERGY_1) == nullptr;
  });
}
bool has_vertex_functors(SampleBody& sample) {
  return std::ranges::any_of(sample.functors(),
                             [](const suture_functor* f) { return f->dimension == 0; });
}

Measured differ(const NodalValues& found, const NodalValues& expected, const char* text) {
  return {relative_difference(found, expected), text};
}

}  // namespace

// Rest shape, state and directions together: no axis of space is different, unless the world has
// one, such as the normal of a floor.
Result orientation(const BodyCase& of) {
  if (has_loads(of.sample) || has_vertex_functors(of.sample)) return {};
  std::mt19937_64 random(of.sample.options().seed);
  Measured worst;
  for (const auto& rotation : {quarter_turn, random_rotation(random)}) {
    SampleOptions turned = of.sample.options();
    turned.rotation = rotation;
    SampleBody other(of.sample.model(), turned);
    const Measured found =
        differ(other.forces(), rotated_all(rotation, of.sample.forces()),
               rotation == quarter_turn ? "in a body that is turned by 90 degrees with its rest "
                                          "shape, the forces are not turned"
                                        : "in a body that is turned at random with its rest shape, "
                                          "the forces are not turned");
    if (!(found.figure <= worst.figure)) worst = found;
  }
  return worst;
}

// A tiny change of the rest shape passes elements on to the functor of general hexahedra.
Result shapes(const BodyCase& of) {
  const SampleOptions& options = of.sample.options();
  if (is_of_general_hexahedra(options.shape)) return {};
  SampleOptions irregular = options;
  irregular.irregular = 1e-9;
  std::optional<SampleBody> other;
  try {
    other.emplace(of.sample.model(), irregular);
  } catch (const InputError&) {  // it has no functor on parts of general hexahedra
    return {};
  }
  return differ(other->forces(), of.sample.forces(),
                "the functors of general and of regular hexahedra disagree on the forces of almost "
                "regular ones");
}

// Without velocities: a damping that follows the root of stiffness and mass is not a sum.
Result regions(const BodyCase& of) {
  if (has_vertex_functors(of.sample)) return {};
  SampleOptions halves = of.sample.options();
  halves.halves = true;
  SampleBody other(of.sample.model(), halves);
  other.stop();
  of.sample.stop();
  const Measured forces = differ(other.forces(), of.sample.forces(),
                                 "two equal models on the halves of a body give other forces than "
                                 "one model on the whole");
  const Measured masses = differ(
      other.at_vertices(other.body().attributes().mass(), 1),
      of.sample.at_vertices(of.sample.body().attributes().mass(), 1),
      "two equal models on the halves of a body give other masses than one model on the whole");
  return forces.figure >= masses.figure ? forces : masses;
}

// A model may be used several times in a scene.
Result instances(const BodyCase& of) {
  const suture_model& model = of.sample.model();
  SampleOptions options = of.sample.options();
  const NodalValues before = of.sample.forces();
  for (std::size_t p = 0; p < model.parameter_count; ++p) {
    const suture_parameter& parameter = model.parameters[p];
    double& value = options.set.values[p];
    if (parameter.type == SUTURE_NUMBER && value * 1.25 < parameter.maximum) value *= 1.25;
  }
  SampleBody other(model, options);
  other.forces();
  return differ(of.sample.forces(), before,
                "another instance of the model, with other parameters, changes the forces; keep "
                "what prepare() derives in the memory of the instance");
}

Result builds(const BodyCase& of) {
  if (of.builds.size() < 2) return {};
  Measured worst;
  for (const suture_model* build : of.builds) {
    SampleBody other(*build, of.sample.options());
    const Measured found = differ(other.forces(), of.sample.forces(),
                                  "two builds of the plugin give different forces");
    if (!(found.figure <= worst.figure)) worst = found;
  }
  return worst;
}

}  // namespace suture::checks
