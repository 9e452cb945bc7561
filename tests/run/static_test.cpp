// SPDX-License-Identifier: GPL-3.0-or-later
//
// Equilibria by Newton's method, compared with independent programs and closed forms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernel/base/error.hpp"
#include "kernel/dynamics/pieces.hpp"
#include "kernel/results/fields.hpp"
#include "tests/reference/beam.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/events.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test {
namespace {

Scene equilibrium(Scene scene, unsigned frames = 1, double end = 1) {
  scene.solver.integrator = "static";
  scene.solver.end = end;
  scene.solver.dt = end / frames;
  return scene;
}

struct Counted : Observer {
  void on_detail(const std::string& text) override {
    iterations += text.starts_with("Newton");
    details.push_back(text);
  }
  void on_message(const std::string& text) override { messages.push_back(text); }
  int iterations = 0;
  std::vector<std::string> messages, details;
};

class StaticSolve : public testing::TestWithParam<reference::StaticBeam> {};

// From rest, in one step, to the solution of the same discrete problem.
TEST_P(StaticSolve, AgreesWithTheIndependentSolution) {
  const reference::StaticBeam& expected = GetParam();
  const auto n = static_cast<Index>(expected.cells_y);
  const Scene scene = equilibrium(
      beam(host(), "tm-faure", static_cast<Index>(expected.cells_x), n, expected.gravity));
  TestSimulation simulation(scene);
  Counted observer;
  const RunSummary summary = simulation.run(observer);
  EXPECT_EQ(summary.steps, 1u);
  const Vec3 tip = simulation.mean_displacement(beam_tip(n));
  const double scale = std::abs(expected.tip_uy);
  EXPECT_NEAR(tip[1], expected.tip_uy, 1e-8 * scale);
  EXPECT_NEAR(tip[0], expected.tip_ux, 1e-8 * scale);
  EXPECT_NEAR(simulation.energies().elastic, expected.strain_energy, 1e-7 * expected.strain_energy);
  EXPECT_LE(observer.iterations, 15);
}

std::vector<reference::StaticBeam> small_beams() {
  std::vector<reference::StaticBeam> beams;
  for (const reference::StaticBeam& beam : reference::static_beams)
    if (std::string(beam.quadrature) == "gauss2" && beam.cells_y <= 10) beams.push_back(beam);
  return beams;
}
INSTANTIATE_TEST_SUITE_P(CaseA, StaticSolve, testing::ValuesIn(small_beams()),
                         [](const auto& test) {
                           std::string name = test.param.name;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

struct Tips {
  Vec3 relaxed, solved;
};

/// The displacement of the tip of a beam, two elements high, by a relaxation to this residual and
/// by Newton's method.
Tips tips_of(const Scene& scene, double tolerance, Counted& observer) {
  Scene slow = scene;
  slow.solver.until_rest = slow.solver.automatic_damping = true;
  slow.solver.tolerance = tolerance;
  TestSimulation relaxed(slow), solved(equilibrium(scene));
  relaxed.run();
  EXPECT_EQ(solved.run(observer).outcome, RunSummary::Outcome::finished);
  return {relaxed.mean_displacement(beam_tip(2)), solved.mean_displacement(beam_tip(2))};
}

TEST(Static, SpringsReachTheEquilibriumOfARelaxation) {
  Counted observer;
  const Tips tips = tips_of(beam(host(), "mss-baudet", 8, 2, 2.45), 1e-10, observer);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(tips.relaxed[c], tips.solved[c], 1e-7);
}

/// Both ends held, one drawn away by half the length: x = 1.5 X and free contraction.
Scene stretched(unsigned frames) {
  Scene scene = equilibrium(beam(host(), "tm-faure", 4, 2, 0), frames);
  scene.constraints[0].components = 1;
  Constraint pulled;
  pulled.where.what = Selection::InBox{{0.999, -1, -1}, {1.001, 1, 1}};
  pulled.components = 1;
  pulled.translation = {0.5, 0, 0};
  pulled.moves = true;
  pulled.ramp = {0, 1, false};
  scene.constraints.push_back(pulled);
  return scene;
}

// Uniaxial tension of St Venant-Kirchhoff: lateral stretch from S_yy = 0 (formulas: E_yy = -nu E_xx
// for the plane E, so l_y^2 = 1 - nu (l_x^2 - 1)), and the same in one step as in ten.
TEST(Static, PrescribedMotionGivesUniaxialTensionInAnyNumberOfSteps) {
  for (const unsigned frames : {1u, 10u}) {
    Scene scene = stretched(frames);
    for (int c = 1; c < 3; ++c) {  // symmetry planes
      Constraint plane = scene.constraints[0];
      const double y = c == 1 ? 1e-6 : 9, z = c == 2 ? 1e-6 : 9;
      plane.where.what = Selection::InBox{{-9, -y, -z}, {9, y, z}};
      plane.components = static_cast<std::uint8_t>(1 << c);
      scene.constraints.push_back(plane);
    }
    TestSimulation simulation(scene);
    simulation.run();
    const double lateral = std::sqrt(1 - 0.3 * (1.5 * 1.5 - 1));
    Attributes& attributes = simulation.attributes();
    for (Index v = 0; v < attributes.vertex_count(); ++v)
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(attributes.position().get(v, c),
                    (c == 0 ? 1.5 : lateral) * attributes.rest().get(v, c), 1e-8);
  }
}

/// A bar of springs with this viscosity, which is drawn over `end` seconds.
Scene viscous_bar(double viscosity, double end, bool follows_path) {
  Scene scene = stretched(2);
  scene.models =
      beam(host(), "mss-baudet", 4, 2, 0, {{"viscosity", viscosity}, {"nu", 0.25}}).models;
  scene.constraints[0].components = scene.constraints[1].components = 7;
  scene.constraints[1].translation = {0.04, 0, 0};  // no path leads far: springs soften
  scene.constraints[1].ramp.to = end;
  scene.solver.end = end;
  scene.solver.dt = end / 2;
  scene.solver.follow_path = follows_path;
  return scene;
}

Selection section_at(double x) {
  Selection section;
  section.what = Selection::InBox{{x - 1e-3, -1, -1}, {x + 1e-3, 1, 1}};
  section.path = "/section";
  return section;
}

double reaction_at_the_grip(Simulation& simulation) {
  const auto reaction = std::ranges::find(kernel_fields(), "reaction", &FieldChoice::name);
  simulation.built().dynamics().synchronise();
  double sum = 0;
  for (const Index v : simulation.built().selector().vertices(section_at(1)))
    sum += reaction->value(simulation.built(), {}, v, 0);
  return sum;
}

// Time is a parameter only: however fast it passes, no force feels how fast a grip moves.
TEST(Static, AnEquilibriumDoesNotDependOnTheSpeedOfPrescribedMotions) {
  for (const bool follows_path : {false, true}) {
    TestSimulation elastic(viscous_bar(0, 1, follows_path));
    elastic.run();
    const double reaction = reaction_at_the_grip(elastic);
    EXPECT_GT(reaction, 100);
    for (const double viscosity : {1.0, 10.0})
      for (const double end : {1.0 / 1024, 1.0, 1024.0}) {
        TestSimulation simulation(viscous_bar(viscosity, end, follows_path));
        simulation.run();
        EXPECT_NEAR(simulation.mean_displacement(section_at(0.5))[0], 0.02, 1e-7)
            << viscosity << ' ' << end;
        EXPECT_NEAR(reaction_at_the_grip(simulation), reaction, 1e-6 * reaction);
        EXPECT_EQ(simulation.energies().kinetic, 0);
      }
  }
}

// A straight column keeps its symmetry in every iteration, far above its Euler load.
TEST(Static, AStraightColumnAboveItsEulerLoadIsReportedAsUnstable) {
  for (const double part : {0.5, 3.0}) {
    Scene scene = equilibrium(beam(host(), "tm-faure", 8, 2, 0));
    const double second_moment = std::pow(0.25, 4) / 12;
    const double euler = std::pow(std::numbers::pi / 2, 2) * 400e3 * second_moment;
    scene.gravity = {-part * 3.18 * euler / (1000 * 0.0625), 0, 0};  // of the tip load: 7.84 / 2.47
    TestSimulation simulation(scene);
    const RunSummary summary = simulation.run();
    EXPECT_EQ(summary.outcome,
              part < 1 ? RunSummary::Outcome::finished : RunSummary::Outcome::unstable_equilibrium);
  }
}

// No residual is that small: the state is accepted, and the run says so.
TEST(Static, AToleranceBelowRoundingIsReported) {
  Scene scene = equilibrium(beam(host(), "tm-faure", 8, 2, 9.8));
  scene.solver.step_tolerance = 1e-17;
  TestSimulation simulation(scene);
  EXPECT_EQ(simulation.run().outcome, RunSummary::Outcome::finished);
  ASSERT_EQ(simulation.diagnostics.warnings().size(), 1u);
  EXPECT_THAT(simulation.diagnostics.warnings()[0],
              testing::HasSubstr("rounding kept the residual of 1 step"));
}

/// A bar whose end turns about its axis, by half a turn.
Scene turned_end(unsigned frames, double angle = std::numbers::pi) {
  Scene scene = equilibrium(beam(host(), "tm-faure", 8, 2, 0), frames);
  Constraint turned;
  turned.where.what = Selection::InBox{{0.999, -1, -1}, {1.001, 1, 1}};
  turned.axis = {1, 0, 0};
  turned.centre = {1, 0.125, 0.125};
  turned.angle = angle;
  turned.moves = true;
  turned.ramp = {0, 1, false};
  scene.constraints.push_back(turned);
  return scene;
}

// Half a turn of the end in one step would crush what is beside it; the bar follows as a whole.
TEST(Static, ALargeRotationOfTheEndIsFollowedInFewSteps) {
  TestSimulation simulation(turned_end(6));
  Counted observer;
  simulation.run(observer);
  EXPECT_EQ(observer.messages, std::vector<std::string>{});
  EXPECT_LE(observer.iterations, 6 * 10);
}

double energy_of_turned_end(unsigned frames, double angle) {
  TestSimulation simulation(turned_end(frames, angle));
  Counted observer;
  simulation.run(observer);
  return simulation.energies().elastic;
}

// The positions of the end are those at rest: only the path tells that the bar is twisted.
TEST(Static, AWholeTurnInOneStepTwistsTheBar) {
  const double turn = 2 * std::numbers::pi, expected = energy_of_turned_end(20, turn);
  EXPECT_GT(expected, 20 * energy_of_turned_end(1, turn / 5));
  EXPECT_NEAR(energy_of_turned_end(1, turn), expected, 1e-7 * expected);
}

/// A column of unit section that is pressed at one end and slides on three planes of symmetry: the
/// nominal stress of St Venant-Kirchhoff is E s (s^2 - 1) / 2 at a stretch s.
Scene pressed_column(double traction) {
  Scene scene = equilibrium(beam(host(), "tm-faure", 4, 1, 0));
  scene.constraints.clear();
  for (const char* side : {"x0", "y0", "z0"}) {
    Constraint plane;
    plane.where.what = Selection::Named{side};
    plane.components = static_cast<std::uint8_t>(1 << (side[0] - 'x'));
    scene.constraints.push_back(plane);
  }
  Load press;
  press.kind = Load::Kind::traction;
  press.value = {-traction, 0, 0};
  press.where.what = Selection::Named{"x1"};
  scene.loads.push_back(press);
  return scene;
}

TEST(Static, ALoadBeyondTheLimitOfTheLawIsFollowedUpToIt) {
  const double limit = 400e3 / std::sqrt(27.0), load = limit / 0.77;
  TestSimulation simulation(pressed_column(load));
  try {
    simulation.run();
    FAIL() << "there is no equilibrium";
  } catch (const NumericalError& error) {
    const std::string text = error.what();
    const std::size_t end = text.find("end at "), stretch = text.find("stretch is ");
    ASSERT_NE(end, std::string::npos) << text;
    ASSERT_NE(stretch, std::string::npos) << text;
    EXPECT_NEAR(std::stod(text.substr(end + 7)), 77 - 0.05, 0.05) << text;
    EXPECT_NEAR(std::stod(text.substr(stretch + 11)), 1 / std::sqrt(3.0), 0.03) << text;
    EXPECT_THAT(text, testing::HasSubstr("Reduce the loads"));
  }
}

// Half a turn at once is more than Newton's method can follow.
TEST(Static, ALargeRotationAtOnceIsFollowedInParts) {
  TestSimulation simulation(turned_end(1)), steps(turned_end(6));
  Counted observer;
  EXPECT_EQ(simulation.run(observer).steps, 1u);
  steps.run();
  EXPECT_THAT(observer.details,
              testing::Contains("a rotation by more than 45 degrees is followed in parts"));
  EXPECT_THAT(observer.details, testing::Contains(testing::HasSubstr("equilibrium at 100 %")));
  const double expected = steps.energies().elastic;
  EXPECT_NEAR(simulation.energies().elastic, expected, 1e-7 * expected);
}

// The block is pressed on all sides but the clamped one: the pressure has a symmetric tangent.
TEST(Static, NewtonConvergesFastUnderAPressureThatFollows) {
  Scene scene = equilibrium(beam(host(), "tm-faure", 8, 2, 2));
  for (const char* side : {"x1", "y0", "y1", "z0", "z1"}) {
    Load load;
    load.kind = Load::Kind::pressure;
    load.pressure = 20e3;
    load.where.what = Selection::Named{side};
    scene.loads.push_back(load);
  }
  TestSimulation simulation(scene);
  Counted observer;
  EXPECT_EQ(simulation.run(observer).outcome, RunSummary::Outcome::finished);
  EXPECT_LE(observer.iterations, 8);
}

// Up to free edges the tangent of the pressure is not symmetric.
TEST(Static, ACantileverUnderAPressureOnOneSideReachesTheEquilibriumOfARelaxation) {
  Scene scene = beam(host(), "tm-faure", 8, 2, 0);
  Load load;
  load.kind = Load::Kind::pressure;
  load.pressure = 3e3;
  load.where.what = Selection::Named{"y1"};
  scene.loads.push_back(load);
  Counted observer;
  const Tips tips = tips_of(scene, 1e-9, observer);
  EXPECT_LT(tips.relaxed[1], -0.3);
  EXPECT_LE(observer.iterations, 25);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(tips.relaxed[c], tips.solved[c], 1e-6);
}

// Forces across the displacement have no energy.
TEST(Static, ModelsWithoutAnEnergyAreSolvedWithTheirWholeTangent) {
  Scene scene = equilibrium(beam(host(), "tm-faure", 8, 2, 2));
  ModelUse swirl;
  swirl.name = "swirl";
  swirl.model = &host().model("swirl");
  swirl.parameters = parameters(*swirl.model, {{"k", 200}});
  scene.models.push_back(swirl);
  TestSimulation simulation(scene);
  Counted observer;
  EXPECT_EQ(simulation.run(observer).outcome, RunSummary::Outcome::finished);
  EXPECT_LE(observer.iterations, 8);
  EXPECT_GT(simulation.mean_displacement(beam_tip(2))[0], 0.004) << "it was too weak to matter";
}

/// The right half is cut off under its weight, half-way through a run of two steps.
Scene cut_in_two() {
  Scene scene = equilibrium(beam(host(), "tm-faure", 16, 3, 9.8), 2);
  Event cut = event_of(CutPlane{{0.5, 0, 0}, {1, 0, 0}}, 0.5);
  cut.rest_shape = true;
  scene.events.push_back(cut);
  return scene;
}

TEST(Static, APieceThatIsCutOffIsRefused) {
  TestSimulation simulation(cut_in_two());
  EXPECT_THAT([&] { simulation.run(); }, testing::ThrowsMessage<NumericalError>(testing::HasSubstr(
                                             "set /solver/static/free_pieces to \"hold\"")));
}

TEST(Static, InertiaReliefLetsAFreePieceRelaxWhereItIs) {
  Scene scene = cut_in_two();
  scene.solver.hold_free_pieces = true;
  TestSimulation simulation(scene);
  Counted observer;
  simulation.run_to(0.5, observer);
  Attributes& attributes = simulation.attributes();
  const std::vector<Index> pieces = pieces_of(simulation.complex(), attributes);
  std::vector<Index> free;
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    if (attributes.rest().get(pieces[v] == pieces[0] ? 0 : v, 0) > 0) free.push_back(v);
  ASSERT_EQ(free.size(), 9u * 16);
  const auto centre = [&] {
    Vec3 sum{};
    for (const Index v : free)
      for (int c = 0; c < 3; ++c)
        sum[static_cast<std::size_t>(c)] +=
            attributes.mass().get(v, 0) * attributes.position().get(v, c);
    return sum;
  };
  const auto length = [&](const Column& x, Index v) {
    return std::hypot(x.get(v, 0) - x.get(free[0], 0), x.get(v, 1) - x.get(free[0], 1),
                      x.get(v, 2) - x.get(free[0], 2));
  };
  const Vec3 before = centre();
  const RunSummary summary = simulation.run(observer);
  EXPECT_FALSE(summary.lowest_eigenvalue) << "nothing suggests that it is unstable";
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(centre()[c], before[c], 1e-9);
  for (const Index v : free)
    EXPECT_NEAR(length(attributes.position(), v), length(attributes.rest(), v), 1e-8);
  double reaction = 0;  // at the clamp
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    if (attributes.rest().get(v, 0) == 0)
      reaction -= attributes.force().get(v, 1) - 9.8 * attributes.mass().get(v, 0);
  EXPECT_NEAR(reaction, 9.8 * 1000 * 0.5 * 0.0625, 1e-4) << "the weight of the half that is held";
  ASSERT_EQ(observer.messages.size(), 2u);
  EXPECT_THAT(observer.messages[1], testing::AllOf(testing::HasSubstr("a piece of 72 elements"),
                                                   testing::HasSubstr("inertia relief holds it")));
}

TEST(Static, ABodyThatNothingHoldsIsRefused) {
  Scene scene = equilibrium(beam(host(), "tm-faure", 4, 2, 9.8));
  scene.constraints.clear();
  Diagnostics diagnostics;
  EXPECT_THAT([&] { Simulation(scene, host(), diagnostics); },
              testing::ThrowsMessage<InputError>(
                  testing::HasSubstr("is free to move and turn in every direction")));
}

}  // namespace
}  // namespace suture::test
