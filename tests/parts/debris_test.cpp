// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pieces that are too small to be computed: which they are, and what is booked when they go.
#include "kernel/operations/debris.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "kernel/base/vec3.hpp"
#include "kernel/plugin_host/plugin_host.hpp"
#include "tests/parts/blade_event.hpp"
#include "tests/run/open_scene.hpp"

namespace suture::debris_test {
namespace {

using testing::HasSubstr;

/// A bar of 8 x 2 x 2 elements of 1 m, of which a plane cuts a corner of the volume legs^3 / 6.
Scene bar(double legs) {
  static PluginHost plugins;
  Scene scene;
  scene.mesh.box = BoxOptions{{0, 0, 0}, {8, 2, 2}, {8, 2, 2}};
  ModelUse use;
  use.name = "tm-faure";
  use.model = &plugins.model("tm-faure");
  for (std::uint32_t p = 0; p < use.model->parameter_count; ++p)
    use.parameters.push_back(use.model->parameters[p].default_value);
  use.parameters[0] = 1e5;   // E
  use.parameters[1] = 0.3;   // nu
  use.parameters[2] = 1000;  // rho
  scene.models.push_back(use);
  scene.debris.removes = true;
  scene.events = {test::divide({8 - legs, 2, 2}, {1, 1, 1})};
  return scene;
}

Scene at_rest(Scene scene) {
  scene.events[0].rest_shape = true;
  return scene;
}

struct Cut : test::OpenScene {
  explicit Cut(const Scene& of) : OpenScene(at_rest(of)) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    Attributes& a = built.body().attributes();
    for (Index v = 0; v < a.vertex_count(); ++v)
      for (int c = 0; c < 3; ++c) {
        a.velocity().set(v, c, any(random));
        a.position().set(v, c, a.rest().get(v, c) + 0.01 * any(random));
      }
    built.dynamics().start();
    built.dynamics().check_balance();
  }
  std::pair<double, Vec3> mass_and_momentum() {
    Attributes& a = built.body().attributes();
    std::pair<double, Vec3> sum{};
    for (Index v = 0; v < a.vertex_count(); ++v) {
      if (!built.body().complex().exists(0, v)) continue;
      const double m = a.mass().get(v, 0);
      sum.first += m;
      for (int c = 0; c < 3; ++c)
        sum.second[static_cast<std::size_t>(c)] += m * a.velocity().get(v, c);
    }
    return sum;
  }
  double volume() {
    const CellComplex& complex = built.body().complex();
    const RestPlaces rest = built.body().attributes().rest_places(complex);
    double sum = 0;
    for (Index e = 0; e < complex.element_count(); ++e)
      if (complex.exists(3, e)) sum += rest.volume(e);
    return sum;
  }
};

TEST(Debris, ACornerThatIsTooSmallGoesAndIsBooked) {
  Cut cut(bar(0.8));
  const auto [mass, momentum] = cut.mass_and_momentum();
  const double energy =
      energies(cut.built.dynamics()).kinetic + energies(cut.built.dynamics()).elastic;
  const EventOutcome outcome = cut.events.fire(0, 0);
  const RemovedMatter& debris = outcome.debris;
  EXPECT_EQ(debris.pieces, 1u);
  EXPECT_EQ(outcome.elements_removed, 1u);
  EXPECT_EQ(outcome.removed.size(), 1u);
  EXPECT_THAT(outcome.text(), HasSubstr("removed 1 element (debris: 1 piece, 8.53e+04 ml)"));
  EXPECT_EQ(cut.built.body().islands().existing(), 1u);
  const double legs = 0.8;
  EXPECT_NEAR(debris.volume, legs * legs * legs / 6, 1e-12);
  const auto [mass_left, momentum_left] = cut.mass_and_momentum();
  EXPECT_NEAR(cut.volume() + debris.volume, 32, 1e-11);
  EXPECT_NEAR(mass_left + debris.mass, mass, 1e-12 * mass);
  const double density = cut.built.scene().models[0].parameters[2];
  EXPECT_NEAR(debris.mass, density * debris.volume, 1e-9 * mass);
  EXPECT_NEAR(norm(minus(plus(momentum_left, debris.momentum), momentum)), 0, 1e-12 * mass);
  // The cut itself changes no kinetic energy; the law is integrated again over the parts.
  const double left =
      energies(cut.built.dynamics()).kinetic + energies(cut.built.dynamics()).elastic;
  const EnergyBalance balance = cut.built.dynamics().check_balance();
  EXPECT_NEAR(balance.events, left - energy, 1e-10 * energy);
  EXPECT_NEAR(balance.balance, 0, 1e-10 * energy);
  EXPECT_GT(debris.energy, 0);
  EXPECT_EQ(cut.events.removed_debris().mass, debris.mass);
}

TEST(Debris, WhatRemainsMovesAsBefore) {
  Scene kept = bar(0.8);
  kept.debris.removes = false;
  Cut with(bar(0.8)), without(kept);
  with.events.fire(0, 0);
  without.events.fire(0, 0);
  EXPECT_EQ(without.built.body().islands().existing(), 2u);
  Attributes &a = with.built.body().attributes(), &b = without.built.body().attributes();
  Index compared = 0;
  for (Index v = 0; v < a.vertex_count(); ++v) {
    if (!with.built.body().complex().exists(0, v)) continue;
    ++compared;
    EXPECT_EQ(a.mass().get(v, 0), b.mass().get(v, 0));
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(a.velocity().get(v, c), b.velocity().get(v, c));
      EXPECT_EQ(a.position().get(v, c), b.position().get(v, c));
    }
  }
  EXPECT_GT(compared, 80u);
}

TEST(Debris, TheLimitIsAPartOfATypicalElementOrAVolume) {
  const double volume = 0.8 * 0.8 * 0.8 / 6;
  for (const double factor : {0.99, 1.01}) {
    Scene scene = bar(0.8);
    scene.debris.fraction = factor * volume;
    Cut by_fraction(scene);
    EXPECT_EQ(by_fraction.events.fire(0, 0).debris.pieces, factor > 1 ? 1u : 0u);
    scene.debris.fraction = 1;
    scene.debris.volume = factor * volume;
    Cut by_volume(scene);
    EXPECT_EQ(by_volume.events.fire(0, 0).debris.pieces, factor > 1 ? 1u : 0u);
  }
}

TEST(Debris, ManySmallPartsOfOnePieceCountTogether) {
  // A slice of 0.05 of each of four elements.
  Scene scene = bar(0.8);
  scene.events = {test::divide({7.95, 1, 1}, {1, 0, 0})};
  Cut slice(scene);
  EXPECT_EQ(slice.events.fire(0, 0).debris.pieces, 0u);
  scene.debris.fraction = 0.21;
  Cut again(scene);
  const EventOutcome outcome = again.events.fire(0, 0);
  EXPECT_EQ(outcome.debris.pieces, 1u);
  EXPECT_EQ(outcome.debris.elements, 4u);
  EXPECT_NEAR(outcome.debris.volume, 0.2, 1e-12);
}

TEST(Debris, TheBodyIsNone) {
  Scene scene = bar(0.8);
  scene.debris.fraction = 1000;
  Cut cut(scene);
  EXPECT_EQ(cut.events.fire(0, 0).debris.pieces, 1u);
  EXPECT_EQ(cut.built.body().islands().existing(), 1u);
}

TEST(Debris, PiecesOfTheMeshAreNone) {
  // Two rows of cubes apart, and a cube on its own.
  Scene scene = bar(0.8);
  scene.mesh.box.reset();
  scene.mesh.voxels = VoxelOptions{.size = 1, .rows = {"###.#"}};
  scene.debris.fraction = 1.5;
  scene.events = {test::divide({0.5, 0, 0}, {1, 0, 0})};
  Cut cut(scene);
  const EventOutcome outcome = cut.events.fire(0, 0);
  EXPECT_EQ(outcome.debris.pieces, 1u) << "half of the first cube, not the last one";
  EXPECT_NEAR(outcome.debris.volume, 0.5, 1e-12);
}

}  // namespace
}  // namespace suture::debris_test
