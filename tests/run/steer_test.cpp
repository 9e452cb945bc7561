// SPDX-License-Identifier: GPL-3.0-or-later
//
// Obstacles that a program steers while the run goes on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "kernel/base/error.hpp"
#include "kernel/output/checkpoint_file.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/contact_scenes.hpp"
#include "tests/run/events.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

using testing::HasSubstr;

/// A block that is held at the bottom, and a ball that touches it from above.
Scene probed_block(Index n = 4) {
  Scene scene = block_on_floor(n, {}, 0);
  Constraint& plate = scene.constraints.emplace_back();
  plate.where.what = Selection::Named{"z0"};
  Obstacle ball{"probe", "/contact/obstacles/0", Sphere{{0.21, 0.2, 0.3}, 0.1}};
  ball.friction = 0.3;
  ball.motion.centre = {0.21, 0.2, 0.3};
  scene.contact.obstacles = {ball};
  scene.solver.damping = 5;
  scene.solver.end = 0.12;
  scene.solver.threads = 1;
  return scene;
}

/// With a knife above the block whose blade is in its upper half.
Scene block_with_knife() {
  Scene scene = probed_block();
  Obstacle& knife = scene.contact.obstacles.emplace_back();
  knife = {"knife", "/contact/obstacles/1", Sphere{{-0.05, 0.12, 0.4}, 0.02}};
  scene.events = {event_of(
      CutBlade{{}, CutBlade::Carried{1, "knife", {{-0.05, 0.12, 0.12}, {-0.05, 0.12, 0.4}}}})};
  return scene;
}

struct SteeredRun {
  explicit SteeredRun(const Scene& scene) : simulation(scene, host(), diagnostics) {}
  void to(double time) { simulation.run_to(time, nobody); }
  RunSummary finish() { return simulation.run(nobody); }
  void steer(const PoseTarget& target, const char* name = "probe") {
    simulation.steer(name, target);
  }
  double force() const { return simulation.contact()->loads()[0].force[2]; }
  std::vector<double> state() {
    std::vector<double> all = position_rows(simulation);
    for (const ContactLaw::Load& load : simulation.contact()->loads())
      all.insert(all.end(), load.force.begin(), load.force.end());
    return all;
  }

  Diagnostics diagnostics;
  Simulation simulation;
  Observer nobody;
};

// Fastest at first: an automatic dt knows the whole of a path, and only the next target of a
// program.
const std::vector<RigidPath::Station> path_of_probe{
    {0, {}, 0}, {0.05, {0.02, 0, -0.02}, 1}, {0.1, {0.03, 0, -0.025}, 1.2}};

/// The same motion by the path of the scene and by two calls. `allowed` in m and N.
void expect_the_motion_of_a_path(Scene scene, double allowed = 1e-8) {
  SteeredRun steered(scene);
  scene.contact.obstacles[0].motion.stations = path_of_probe;
  SteeredRun path(scene);
  path.finish();
  steered.steer({0.05, path_of_probe[1].translation, Vec3{0, 0, 1}});
  steered.to(0.05);
  steered.steer({0.1, path_of_probe[2].translation, Vec3{0, 0, 1.2}});
  steered.finish();
  EXPECT_GT(path.force(), 10) << "it presses";
  EXPECT_EQ(steered.simulation.step(), path.simulation.step());
  const std::vector<double> one = path.state(), other = steered.state();
  ASSERT_EQ(one.size(), other.size());
  double difference = 0;
  for (std::size_t i = 0; i < one.size(); ++i)
    difference = std::max(difference, std::abs(one[i] - other[i]));
  EXPECT_LT(difference, allowed);
}

TEST(Steer, MovesAsAPathWithTheSameStations) {
  for (const bool is_auto : {true, false}) {
    Scene scene = probed_block();
    if (!is_auto) scene.solver.dt = 1e-3;
    expect_the_motion_of_a_path(scene);
    scene.contact.obstacles[0].coupling = Coupling{2, 2e4, 200, 0.01, 100, 1};
    expect_the_motion_of_a_path(scene);
  }
}

TEST(Steer, MovesAsAPathInImplicitStepsEquilibriaAndSprings) {
  Scene scene = probed_block(2);
  scene.contact.obstacles[0].friction = 0;
  scene.contact.penalty = true;
  expect_the_motion_of_a_path(scene);
  scene.contact.penalty = false;
  scene.solver.dt = 0.025;
  scene.solver.end = 0.1;
  scene.solver.step_tolerance = 1e-10;
  scene.solver.integrator = "static";
  expect_the_motion_of_a_path(scene);
  // Steps may end before the gap settles (multiplier_forces.hpp); forces differ by 3e-5 of them.
  scene.solver.integrator = "implicit-euler";
  expect_the_motion_of_a_path(scene, 1e-2);
}

TEST(Steer, ATargetWhereItIsChangesNoBit) {
  for (const bool is_compliant : {false, true}) {
    Scene scene = probed_block();
    scene.gravity = {0, 0, 30};  // towards the ball
    if (is_compliant) scene.contact.obstacles[0].coupling = Coupling{2, 2e4, 200, 0.01, 100, 1};
    SteeredRun left(scene), held(scene);
    left.finish();
    for (double time = 0; time < 0.1; time += 0.01) {
      held.to(time);
      held.steer({time + 0.013, Vec3{}, {}});
      held.steer({time + 0.02, {}, {}});
    }
    held.finish();
    EXPECT_GT(left.force(), 1);
    EXPECT_EQ(held.state(), left.state());
  }
}

TEST(Steer, ANewTargetReplacesTheRest) {
  Scene scene = probed_block();
  scene.solver.dt = 1e-3;
  SteeredRun run(scene);
  run.steer({0.1, Vec3{0, 0, 0.1}, Vec3{0, 0, std::numbers::pi / 2}});
  run.to(0.05);
  const auto expect = [&](const Vec3& translation, double angle) {
    const Pose pose = run.simulation.contact()->pose(0, run.simulation.time());
    EXPECT_LT(norm(minus(pose.translation, translation)), 1e-12);
    EXPECT_LT(norm(minus(rotation_vector(pose), Vec3{0, 0, angle})), 1e-12);
  };
  expect({0, 0, 0.05}, std::numbers::pi / 4);
  run.steer({0.07, Vec3{0.01, 0, 0.05}, {}});
  run.to(0.06);
  expect({0.005, 0, 0.05}, std::numbers::pi / 4);
  run.finish();
  expect({0.01, 0, 0.05}, std::numbers::pi / 4);
}

TEST(Steer, AnAutomaticDtFollowsAndHitsTheTarget) {
  SteeredRun run(probed_block());
  run.to(0.02);
  const double dt = run.simulation.next_dt(), now = run.simulation.time();
  const double edge = run.simulation.contact()->shortest_edge();
  run.steer({now + dt, Vec3{0, 0, edge}, {}});
  EXPECT_LE(run.simulation.next_dt(), 0.1 * dt * (1 + 1e-9)) << "a tenth of an edge per step";
  run.to(now + dt);
  EXPECT_NEAR(run.simulation.time(), now + dt, 1e-12);
  EXPECT_EQ(run.simulation.contact()->pose(0, run.simulation.time()).translation[2], edge);
  run.steer({now + 2.4 * dt, Vec3{}, {}});
  run.to(now + 2.4 * dt);
  EXPECT_NEAR(run.simulation.time(), now + 2.4 * dt, 1e-12);
}

TEST(Steer, ARunIsNotAtRestBeforeTheToolIs) {
  Scene scene = probed_block();
  scene.solver.end = {};
  scene.solver.until_rest = scene.solver.automatic_damping = true;
  SteeredRun held(scene), moved(scene);
  EXPECT_LT(held.finish().time, 1);
  moved.steer({2, Vec3{0, 0, 0.01}, {}});
  EXPECT_GE(moved.finish().time, 2);
}

// Also where every motion ends within a step, so that the tool stands whenever a step begins.
TEST(Steer, WakesWhatTheToolComesNear) {
  Scene scene = probed_block();
  scene.solver.sleep_acceleration = 0.1;
  scene.solver.sleep_velocity = 1e-3;
  scene.solver.end = 2;
  SteeredRun run(scene);
  run.to(1.5);
  ASSERT_TRUE(run.simulation.built().dynamics().motion().is_frozen()) << "it sleeps";
  for (int i = 1; i <= 5; ++i) {
    const double at = run.simulation.time() + run.simulation.next_dt();
    run.steer({at, Vec3{0, 0, -0.002 * i}, {}});
    run.to(at);
  }
  EXPECT_GT(run.force(), 1);
}

/// Rejects one step.
struct Rejecting : ForceTerm {
  const char* name() const override { return "rejecting"; }
  void add_forces(double, const LiveMask&, double*) override {
    if (std::exchange(rejects, false)) throw StepRejected("rejected", 0.5);
  }
  void add_forces_at(const VertexSelection&, std::span<const Index>, double,
                     std::vector<Vec3>&) override {}
  bool rejects = false;
};

TEST(Steer, NoRollbackCrossesIt) {
  Scene scene = probed_block(2);
  scene.solver.dt = 1e-3;
  for (const bool is_steered : {false, true}) {
    SteeredRun run(scene);
    auto& term = dynamic_cast<Rejecting&>(run.simulation.add_term(std::make_unique<Rejecting>()));
    run.to(0.07);
    if (is_steered) run.steer({0.1, Vec3{0, 0, 0.01}, {}});
    term.rejects = true;
    run.simulation.advance({{}, 1}, run.nobody);
    EXPECT_EQ(run.simulation.time() < 0.069, !is_steered);
  }
}

TEST(Steer, CarriesABladeAlong) {
  Scene scene = block_with_knife();
  SteeredRun steered(scene);
  scene.contact.obstacles[1].motion.stations = {{0, {}, 0}, {0.1, {0.5, 0, 0}, 0}};
  SteeredRun path(scene);
  steered.steer({0.05, Vec3{0.25, 0, 0}, {}}, "knife");
  steered.to(0.05);
  steered.steer({0.1, Vec3{0.5, 0, 0}, {}}, "knife");
  const auto cut = path.finish().faces_cut;
  EXPECT_GT(cut, 3u);
  EXPECT_EQ(steered.finish().faces_cut, cut);
}

TEST(Steer, IsResumedWithTheSameBits) {
  const TemporaryFolder folder;
  Scene scene = block_with_knife();
  scene.contact.obstacles[0].coupling = Coupling{2, 2e4, 200, 0.01, 100, 1};
  scene.checkpoint.enabled = true;
  scene.checkpoint.every = 0.045;
  scene.output.directory = folder.path() / "out";
  const auto go_on = [](SteeredRun& run) {
    run.to(0.06);
    run.steer({0.11, Vec3{0.02, 0, -0.01}, Vec3{0.3, 0.4, 0}});
    run.finish();
    return run.state();
  };
  SteeredRun whole(scene);
  whole.steer({0.03, Vec3{0, 0.01, -0.01}, Vec3{0.2, 0, 0}});
  whole.steer({0.1, Vec3{0.4, 0, 0}, {}}, "knife");
  whole.to(0.03);
  whole.steer({0.08, Vec3{0, -0.01, -0.02}, Vec3{0, 0.5, 1}});
  const std::vector<double> expected = go_on(whole);

  const std::filesystem::path file = folder.path() / "out" / checkpoint_name(1);
  const Checkpoint checkpoint = read_checkpoint(file);
  EXPECT_NEAR(checkpoint.header.time, 0.045, 0.01) << "in the middle of the second motion";
  scene.output.directory = folder.path() / "again";
  SteeredRun resumed(scene);
  resumed.simulation.resume(checkpoint, file);
  EXPECT_EQ(go_on(resumed), expected);
}

std::string refusal(SteeredRun& run, const PoseTarget& target, const char* name = "probe") {
  try {
    run.steer(target, name);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(Steer, RefusesWhatItCannotDoAndChangesNothing) {
  Scene scene = probed_block();
  scene.solver.dt = 1e-3;
  SteeredRun run(scene), twin(scene);
  for (SteeredRun* one : {&run, &twin}) {
    one->steer({0.1, Vec3{0, 0, -0.02}, {}});
    one->to(0.05);
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal(run, {0.1, {}, {}}, "prob"),
            "the scene has no obstacle 'prob' (did you mean 'probe'?)");
  EXPECT_THAT(refusal(run, {0.05, Vec3{0, 0, -0.01}, {}}),
              HasSubstr("the target of obstacle 'probe' must be later than now, t = 0.05 s"));
  EXPECT_THAT(refusal(run, {nan, {}, {}}), HasSubstr("a time that is not finite"));
  EXPECT_THAT(refusal(run, {0.1, Vec3{0, nan, 0}, {}}), HasSubstr("translation that is not"));
  EXPECT_THAT(refusal(run, {0.1, {}, Vec3{nan, 0, 0}}), HasSubstr("rotation that is not"));
  EXPECT_THAT(refusal(run, {0.051, Vec3{0, 0, -0.2}, {}}),
              HasSubstr("obstacle 'probe' moves by up to 0.19"));
  EXPECT_EQ(refusal(run, {0.0501, Vec3{0, 0, -0.0101}, {}}), "none") << "fast, but not far";
  run.steer({0.1, Vec3{0, 0, -0.02}, {}});
  twin.steer({0.1, Vec3{0, 0, -0.02}, {}});
  run.finish();
  twin.finish();
  EXPECT_EQ(run.state(), twin.state());

  scene.contact.obstacles.clear();
  SteeredRun without(scene);
  EXPECT_EQ(refusal(without, {0.1, {}, {}}), "the scene has no obstacle 'probe'");
}

}  // namespace
}  // namespace suture::test
