// SPDX-License-Identifier: GPL-3.0-or-later
//
// Derivatives of runs, beside differences of whole runs: all models of the folder of plugins, all
// schemes, bodies that were cut. tests/python/run_gradients_test.py has all that is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <set>
#include <span>

#include "kernel/gradients/followed_slopes.hpp"
#include "kernel/gradients/kept_steps.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/sag.hpp"

namespace suture::test::run_gradients_test {
namespace {

using Values = std::map<std::string, double>;

/// Soft materials by model. A model that is not listed has E, nu and rho.
const std::map<std::string, Values> materials{
    {"mooney-rivlin", {{"C10", 1e4}, {"C01", 5e3}, {"K", 1e5}, {"rho", 1000}}},
    {"fibres", {{"mu", 4e4}, {"lambda", 6e4}, {"k1", 1e5}, {"k2", 20}, {"rho", 1000}}},
    {"damage", {{"mu", 4e4}, {"lambda", 6e4}, {"rho", 1000}, {"e0", 0.02}, {"e1", 0.3}}},
    {"damage-springs", {{"E", 1e5}, {"rho", 1000}, {"e0", 0.02}, {"e1", 0.3}}},
    {"mss-baudet", {{"E", 1e5}, {"nu", 0.25}, {"rho", 1000}}},
    {"visco", {{"K", 2e4}, {"n", 0.12}, {"lambda", 1e5}, {"rho", 1000}, {"tau", 0.02}}}};

Values material(const std::string& model) {
  const auto found = materials.find(model);
  return found != materials.end() ? found->second : Values{{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}};
}

struct Case {
  std::string model, integrator;
  unsigned steps = 100;
  std::array<Index, 3> cells{4, 2, 2};
};

std::string name_of(const Case& run) {
  std::string name = run.model + "_" + run.integrator;
  std::ranges::replace(name, '-', '_');
  return name;
}
void PrintTo(const Case& run, std::ostream* out) { *out << name_of(run); }

/// A beam of 4 x 2 x 2 elements, cut along half of its length, that moves under its weight; or that
/// is loaded and unloaded from equilibrium to equilibrium.
class Running : private Observer {
 public:
  /// `follow`: a parameter whose derivatives are followed.
  Running(const Case& run, const Values& values, StepReplay::Limit limit = {},
          const std::string& follow = {})
      : simulation_(scene(run, values), tree_plugins(), known_) {
    Event event;
    event.what = CutPlane{{0.5, 0.25, 0.25}, {0, 1, 0}, 0.45};
    simulation_.apply(event, *this);
    kept_ = std::make_unique<KeptSteps>(simulation_.built().dynamics(), limit);
    if (!follow.empty()) {
      followed_ = std::make_unique<FollowedSlopes>(simulation_.built().dynamics(),
                                                   std::vector{direction_of(follow)}, 1e-11);
    }
    simulation_.run(*this);
  }

  /// J = sum of u_y^2 over all vertices and moments.
  double objective() const { return objective_; }
  double followed() const { return followed_slope_; }  ///< dJ/dp
  RunAdjoint adjoint(const std::vector<std::string>& parameters, double tolerance = 1e-11) {
    WantedSlopes wanted;
    for (const std::string& name : parameters)
      wanted.parameters.push_back({attributes().instances()[0].get(), name});
    wanted.moments = true;
    return kept_->adjoint([this](std::size_t) { return slopes(); }, tolerance, wanted);
  }
  KeptSteps& kept() { return *kept_; }
  Attributes& attributes() { return simulation_.attributes(); }

 private:
  static Scene scene(const Case& run, const Values& values) {
    Scene scene;
    scene.mesh.box = BoxOptions{{0, 0, 0}, {1, 0.5, 0.5}, run.cells, {1, 1, 1}};
    ModelUse use;
    use.name = run.model;
    use.model = &tree_plugins().model(run.model);
    use.parameters = parameters(*use.model, values);
    scene.models.push_back(use);
    const bool is_static = run.integrator == "static";
    const double weight = is_static ? 0.4 : 1;  // less than what breaks springs
    scene.gravity = {weight * 0.1, -weight, weight * 0.3};
    scene.gravity_ramp = {0, is_static ? 1.0 : 0.0};
    Constraint clamp;
    clamp.where.what = Selection::Named{"x0"};
    scene.constraints.push_back(clamp);
    scene.output.enabled = false;
    scene.solver.integrator = run.integrator;
    const bool is_explicit =
        run.integrator == "symplectic-euler" || run.integrator == "velocity-verlet";
    scene.solver.dt = is_static ? 0.1 : is_explicit ? 1e-3 : 0.01;
    scene.solver.end = *scene.solver.dt * run.steps;
    scene.solver.damping = 0.5;
    scene.solver.step_tolerance = 1e-12;
    return scene;
  }
  bool stop_requested() override {
    if (!kept_ || kept_->count() == simulation_.step()) return false;
    kept_->keep();
    objective_ += sag_of(attributes());
    if (!followed_) return false;
    followed_->follow();
    for (Index v = 0; v < attributes().vertex_count(); ++v)
      followed_slope_ +=
          2 * sag_at(attributes(), v) * followed_->of(0).state.position[std::size_t{v} * 3 + 1];
    return false;
  }
  /// All values of a parameter together.
  ParameterDirection direction_of(const std::string& parameter) {
    Instance& instance = *attributes().instances()[0];
    const ParameterSlopes slopes(simulation_.built().body(), {}, instance, parameter);
    return {&instance, parameter, std::vector<double>(slopes.size(), 1)};
  }
  ObjectiveSlopes slopes() { return sag_slopes(attributes()); }

  Diagnostics known_;
  Simulation simulation_;
  std::unique_ptr<KeptSteps> kept_;
  std::unique_ptr<FollowedSlopes> followed_;
  double objective_ = 0, followed_slope_ = 0;
};

class RunGradientsOf : public testing::TestWithParam<Case> {};

/// Of all parameters, within 1e-5.
void expect_differences_of_runs(const Case& test) {
  constexpr double h = 1e-4;
  const Values values = material(test.model);
  std::vector<std::string> names;
  for (const auto& [name, value] : values) names.push_back(name);
  Running run(test, values);
  ASSERT_EQ(run.kept().count(), std::size_t{test.steps});
  const RunAdjoint adjoint = run.adjoint(names);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::vector<double>& each = adjoint.parameters[i];
    const double found = std::accumulate(each.begin(), each.end(), 0.0) * values.at(names[i]);
    std::vector<double> at;
    for (const double part : {-2, -1, 1, 2}) {
      Values changed = values;
      changed[names[i]] *= 1 + part * h;
      at.push_back(Running(test, changed).objective());
    }
    const double expected = (8 * (at[2] - at[1]) - (at[3] - at[0])) / (12 * h);
    // Differences of runs have the rounding of the runs.
    EXPECT_NEAR(found, expected, 1e-5 * std::abs(expected) + 1e-10 / h * run.objective())
        << names[i];
  }
}

TEST_P(RunGradientsOf, AgreeWithDifferencesOfRuns) { expect_differences_of_runs(GetParam()); }

/// Models see batches of eight elements; the last one is full by chance only. Longer beams of one
/// row break under their weight.
TEST(RunGradients, AgreeForAnyNumberOfElements) {
  for (const std::array<Index, 3>& cells : {std::array<Index, 3>{1, 1, 1},
                                            {2, 1, 1},
                                            {3, 1, 1},
                                            {4, 1, 1},
                                            {5, 1, 1},
                                            {3, 2, 1},
                                            {4, 2, 1},
                                            {5, 2, 1},
                                            {3, 2, 2}})
    for (const char* model : {"visco", "damage", "damage-springs"})
      for (const char* integrator : {"implicit-euler", "symplectic-euler"}) {
        SCOPED_TRACE(std::string(model) + ' ' + integrator + ' ' +
                     std::to_string(cells[0] * cells[1] * cells[2]));
        expect_differences_of_runs({model, integrator, 12, cells});
      }
}

/// Limits on memory change no bit.
TEST_P(RunGradientsOf, AreTheSameWithFewKeptStates) {
  const Values values = material(GetParam().model);
  Running all(GetParam(), values), few(GetParam(), values, {5});
  const RunAdjoint a = all.adjoint({"rho"}), b = few.adjoint({"rho"});
  EXPECT_EQ(all.kept().repeated(), 0u);
  EXPECT_GT(few.kept().repeated(), std::size_t{GetParam().steps} / 2);
  EXPECT_LT(few.kept().repeated(), std::size_t{GetParam().steps} * 6);
  EXPECT_EQ(a.parameters, b.parameters);
  EXPECT_EQ(a.loads, b.loads);
  EXPECT_EQ(a.motions, b.motions);
  EXPECT_EQ(a.start.position, b.start.position);
  EXPECT_EQ(a.start.velocity, b.start.velocity);
  const auto same = [&](Column& x, Column& y) {
    return std::equal(x.rows(), x.rows() + std::size_t{x.size()} * 4, y.rows());
  };
  EXPECT_TRUE(same(few.attributes().position(), all.attributes().position()));
  EXPECT_TRUE(same(few.attributes().velocity(), all.attributes().velocity()));
}

/// Forward and backward lead to the same.
TEST(RunGradients, FollowedOnesAreThoseOfTheAdjoint) {
  for (const char* model : {"mss-golec", "damage-springs", "visco"})
    for (const char* integrator : {"implicit-euler", "static"})
      for (const char* parameter : {"rho", std::string(model) == "visco" ? "n" : "E"}) {
        const Case run{model, integrator, 12};
        Running beam(run, material(model), {}, parameter);
        const std::vector<double> each = beam.adjoint({parameter}).parameters[0];
        const double expected = std::accumulate(each.begin(), each.end(), 0.0);
        EXPECT_NEAR(beam.followed(), expected, 1e-7 * std::abs(expected))
            << name_of(run) << parameter;
        EXPECT_NE(expected, 0);
      }
}

/// Others, such as `volume`, go beside a model that does.
bool has_mass(const suture_model& model) {
  return std::ranges::any_of(
      std::span(model.parameters, model.parameter_count),
      [](const suture_parameter& p) { return std::string_view(p.name) == "rho"; });
}

bool has_field(const suture_model& model) {
  return std::ranges::any_of(
      std::span(model.attributes, model.attribute_count),
      [](const suture_attribute& a) { return (a.flags & SUTURE_FIELD) != 0; });
}

/// All models with a mass and without fields that are installed, by implicit Euler; all schemes
/// with one and without a memory.
std::vector<Case> cases() {
  std::vector<Case> cases;
  std::set<std::string> models;
  for (const PluginHost::Listing& plugin : tree_plugins().list())
    models.insert(plugin.models.begin(), plugin.models.end());
  for (const std::string& name : models) {
    const suture_model& model = tree_plugins().model(name);
    if (has_mass(model) && !has_field(model)) cases.push_back({name, "implicit-euler"});
  }
  for (const char* integrator : {"newmark", "symplectic-euler", "velocity-verlet", "static"})
    for (const char* model : {"mss-golec", "damage-springs", "visco"})
      cases.push_back({model, integrator, 12});
  return cases;
}
INSTANTIATE_TEST_SUITE_P(Models, RunGradientsOf, testing::ValuesIn(cases()),
                         [](const auto& test) { return name_of(test.param); });

}  // namespace
}  // namespace suture::test::run_gradients_test
