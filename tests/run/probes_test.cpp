// SPDX-License-Identifier: GPL-3.0-or-later
//
// The values of probes, the nodes and elements that they cover, and their cost.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernel/base/error.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/csv_table.hpp"
#include "tests/run/events.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

Selection selection(decltype(Selection::what) what) {
  Selection result;
  result.what = std::move(what);
  result.path = "/output/probes/at/0/where";
  return result;
}

Selection named(const char* set) { return selection(Selection::Named{set}); }

/// Runs of a clamped beam of 8 x 2 x 2 elements that falls for 200 steps, with probes.
class Probes : public testing::Test {
 protected:
  Probes() {
    scene_.solver.dt = 1e-4;
    scene_.solver.end = 200e-4;
    scene_.output.enabled = true;
    scene_.output.directory = folder_ / "out";
    scene_.output.fields = {};
    scene_.output.probes_every = 50;
  }
  Probe& add(const std::string& name, Selection where, std::vector<std::string> fields = {}) {
    Probe probe;
    probe.name = name;
    probe.where = std::move(where);
    probe.fields = std::move(fields);
    probe.path = "/output/probes/at/" + std::to_string(scene_.output.probes.size());
    return scene_.output.probes.emplace_back(probe);
  }
  CsvTable run() {
    simulation_ = std::make_unique<Simulation>(scene_, host(), diagnostics_);
    Observer nobody;
    simulation_->run(nobody);
    return CsvTable(folder_ / "out/probes.csv");
  }
  const Decision& decision(const std::string& subject) const {
    return *std::ranges::find(simulation_->decisions(), subject, &Decision::subject);
  }

  TemporaryFolder folder_;
  Diagnostics diagnostics_;
  Scene scene_ = beam(host(), "tm-faure", 8, 2, 9.8);
  std::unique_ptr<Simulation> simulation_;
};

TEST_F(Probes, WithoutFieldsShowPositionDisplacementAndForce) {
  add("tip", named("x1"));
  const CsvTable table = run();
  const std::vector<std::string> expected{"step",
                                          "time [s]",
                                          "tip position x [m]",
                                          "tip position y [m]",
                                          "tip position z [m]",
                                          "tip displacement x [m]",
                                          "tip displacement y [m]",
                                          "tip displacement z [m]",
                                          "tip force x [N]",
                                          "tip force y [N]",
                                          "tip force z [N]"};
  EXPECT_EQ(table.columns, expected);
  EXPECT_EQ(table.rows.size(), 5u);
  const double uy = simulation_->mean_displacement(named("x1"))[1];
  EXPECT_LT(uy, -1e-6);
  EXPECT_NEAR(table.last("tip displacement y [m]"), uy, 1e-12 * std::abs(uy));
  EXPECT_NEAR(table.last("tip position x [m]"), 1, 1e-3);
}

TEST_F(Probes, ShowTheFieldsThatTheyName) {
  add("root", named("x0"), {"reaction", "mass"});
  add("body", selection(Selection::All{}), {"stress", "von_mises", "element_id"});
  const CsvTable table = run();
  const std::vector<std::string> expected{
      "step",
      "time [s]",
      "root reaction x [N]",
      "root reaction y [N]",
      "root reaction z [N]",
      "root mass [kg]",
      "body stress xx [Pa]",
      "body stress yy [Pa]",
      "body stress zz [Pa]",
      "body stress xy [Pa]",
      "body stress yz [Pa]",
      "body stress xz [Pa]",
      "body von_mises [Pa]",
      "body element_id",
  };
  EXPECT_EQ(table.columns, expected);
  EXPECT_DOUBLE_EQ(table.last("body element_id"), 15.5) << "the mean of 0 to 31";
}

TEST_F(Probes, AtRestTheReactionCarriesTheWeight) {
  scene_.solver.dt.reset();
  scene_.solver.end.reset();
  scene_.solver.until_rest = scene_.solver.automatic_damping = true;
  scene_.output.probes_every = 1;
  add("root", named("x0"), {"reaction", "force"});
  add("body", selection(Selection::All{}), {"force", "mass"}).of = Probe::Of::sum;
  const CsvTable table = run();
  const double weight = 9.8 * 1000 * 0.0625;
  EXPECT_NEAR(table.last("root reaction y [N]"), weight, 1e-4 * weight);
  EXPECT_EQ(table.last("root force y [N]"), -table.last("root reaction y [N]"));
  EXPECT_NEAR(table.last("body force y [N]"), -weight, 1e-9 * weight) << "inner forces have no sum";
  EXPECT_NEAR(table.last("body mass [kg]"), 62.5, 1e-9);
}

/// Equilibrium in one step.
void make_static(Scene& scene) {
  scene.solver.integrator = "static";
  scene.solver.dt = scene.solver.end = 1;
  scene.output.probes_every = 1;
}

// Reactions and external forces sum to zero, and so do their moments about the origin of the
// scene, which is far from the body: m g acts at the centre of mass of the bent beam.
TEST_F(Probes, AtAStaticEquilibriumReactionsBalanceTheLoads) {
  make_static(scene_);
  scene_.mesh.box->origin = {1000, 0, 0};
  Load load;
  load.kind = Load::Kind::force;
  load.value = {0, 0, 30};
  load.where = named("x1");
  scene_.loads.push_back(load);
  add("root", named("x0"), {"reaction", "reaction_moment"});
  add("body", selection(Selection::All{}), {"reaction"});
  add("balance", named("x1"), {"force"});
  const CsvTable table = run();
  const double weight = 9.8 * 1000 * 0.0625;
  EXPECT_NEAR(table.last("root reaction x [N]"), 0, 1e-5);
  EXPECT_NEAR(table.last("root reaction y [N]"), weight, 1e-5);
  EXPECT_NEAR(table.last("root reaction z [N]"), -30, 1e-5);
  EXPECT_EQ(table.last("body reaction y [N]"), table.last("root reaction y [N]"));
  EXPECT_NEAR(table.last("balance force y [N]"), 0, 1e-5);
  Attributes& a = simulation_->attributes();
  double first_moment = 0;
  for (Index v = 0; v < a.vertex_count(); ++v)
    first_moment += a.mass().get(v, 0) * (a.position().get(v, 0) + simulation_->origin()[0]);
  EXPECT_NEAR(table.last("root reaction_moment z [N m]"), 9.8 * first_moment, 1e-2);
}

// A bar with nu = 0 that hangs under its weight: the stress of elements is exact at their centres,
// rho g (L - x), and the stress of nodes at the nodes, also at the clamp and at the free end.
TEST_F(Probes, ShowTheStressAtTheClampOfAHangingBar) {
  scene_ = [&] {
    Scene hanging = beam(host(), "tm-faure", 8, 2, 0, {{"E", 4e9}, {"nu", 0}});
    hanging.gravity = {9.8, 0, 0};
    hanging.output = scene_.output;
    return hanging;
  }();
  make_static(scene_);
  add("clamp", named("x0"), {"nodal_stress", "nodal_von_mises"});
  add("end", named("x1"), {"nodal_stress"});
  add("first", selection(Selection::InBox{{0, 0, 0}, {0.1, 1, 1}}),
      {"stress", "principal_stress", "principal_strain"});
  const CsvTable table = run();
  const double stress = 9800;
  EXPECT_NEAR(table.last("first stress xx [Pa]"), stress * 15 / 16, 1e-5 * stress);
  EXPECT_NEAR(table.last("first principal_stress 1 [Pa]"), stress * 15 / 16, 1e-5 * stress);
  EXPECT_NEAR(table.last("first principal_strain 1"), stress * 15 / 16 / 4e9, 1e-11);
  EXPECT_NEAR(table.last("clamp nodal_stress xx [Pa]"), stress, 1e-5 * stress);
  EXPECT_NEAR(table.last("clamp nodal_von_mises [Pa]"), stress, 1e-5 * stress);
  EXPECT_NEAR(table.last("end nodal_stress xx [Pa]"), 0, 1e-5 * stress);
}

TEST_F(Probes, TakeMeanSumLeastOrLargest) {
  const std::pair<const char*, Probe::Of> ways[] = {{"mean", Probe::Of::mean},
                                                    {"sum", Probe::Of::sum},
                                                    {"min", Probe::Of::min},
                                                    {"max", Probe::Of::max}};
  for (const auto& [name, of] : ways)
    add(name, selection(Selection::All{}), {"displacement"}).of = of;
  const CsvTable table = run();
  const auto value = [&](const std::string& name) {
    return table.last(name + " displacement z [m]");
  };
  EXPECT_NEAR(value("sum"), 81 * value("mean"), 1e-9 * value("max"));
  EXPECT_LT(value("min"), -1e-9);
  EXPECT_NEAR(value("max"), -value("min"), 1e-6 * value("max")) << "the beam is symmetric in z";
  double largest = -1;
  Attributes& a = simulation_->attributes();
  for (Index v = 0; v < a.vertex_count(); ++v)
    largest = std::max(largest, a.position().get(v, 2) - a.rest().get(v, 2));
  EXPECT_EQ(value("max"), largest);
}

TEST_F(Probes, AtAPointShowTheElementsAroundItsNode) {
  // The node at the middle of the end face has four elements, the corner has one.
  Probe middle, corner;
  for (auto [probe, name, place] : {std::tuple(&middle, "middle", Vec3{1.1, 0.125, 0.125}),
                                    std::tuple(&corner, "corner", Vec3{1.1, 0, 0})}) {
    *probe = {name, selection(Selection::Nearest{place}), {"element_id"}, Probe::Of::sum, "", true};
    scene_.output.probes.push_back(*probe);
  }
  add("element", selection(Selection::Nearest{{1.1, 0, 0}}), {"element_id"});
  const CsvTable table = run();
  EXPECT_EQ(table.last("middle element_id"), 7 + 15 + 23 + 31);
  EXPECT_EQ(table.last("corner element_id"), 7);
  EXPECT_EQ(table.last("element element_id"), 7);
}

TEST_F(Probes, ShowNaNWhereEverythingWasRemoved) {
  scene_.events.push_back(event_of(Pierce{selection(Selection::Ids{{7}}), {}, 0}, 100e-4));
  add("gone", selection(Selection::Ids{{7}}), {"von_mises"});
  add("left", selection(Selection::Ids{{6, 7}}), {"von_mises", "element_id"});
  const CsvTable table = run();
  const auto gone = table.column("gone von_mises [Pa]");
  EXPECT_FALSE(std::isnan(gone[1]));
  EXPECT_TRUE(std::isnan(gone[2]) && std::isnan(gone[4])) << "from the step of the event on";
  EXPECT_FALSE(std::isnan(table.last("left von_mises [Pa]")));
  EXPECT_EQ(table.last("left element_id"), 6);
}

// Elements of a model without the field count for nothing.
TEST_F(Probes, TakeAFieldFromTheElementsThatHaveIt) {
  ModelUse springs;
  springs.name = "springs";
  springs.model = &host().model("mss-baudet");
  springs.parameters = parameters(*springs.model, {{"E", 400e3}, {"nu", 0.3}, {"rho", 1000}});
  springs.region = selection(Selection::HalfSpace{{0.5, 0, 0}, {1, 0, 0}});
  scene_.models[0].region = selection(Selection::HalfSpace{{0.5, 0, 0}, {-1, 0, 0}});
  scene_.models.push_back(springs);
  add("body", selection(Selection::All{}), {"von_mises"});
  add("solid", scene_.models[0].region, {"von_mises"});
  add("springs", springs.region, {"von_mises"});
  const CsvTable table = run();
  EXPECT_GT(table.last("body von_mises [Pa]"), 0);
  EXPECT_EQ(table.last("body von_mises [Pa]"), table.last("solid von_mises [Pa]"));
  EXPECT_TRUE(std::isnan(table.last("springs von_mises [Pa]")));
}

// Looking changes no bit, and what nobody looks at is not computed.
TEST_F(Probes, LookingChangesNoBit) {
  std::vector<double> places;
  for (const auto& fields : {std::vector<std::string>{"position"}, {"reaction", "von_mises"}}) {
    for (const auto integrator : {"symplectic-euler", "velocity-verlet"}) {
      scene_.solver.integrator = integrator;
      scene_.output.probes.clear();
      add("all", selection(Selection::All{}), fields);
      run();
      const Column& x = simulation_->attributes().position();
      places.insert(places.end(), x.rows(), x.rows() + std::size_t{4} * x.size());
    }
  }
  const std::size_t half = places.size() / 2;
  EXPECT_TRUE(std::equal(places.begin(), places.begin() + half, places.begin() + half));
}

TEST_F(Probes, KeepStillCellsOnlyIfTheyShowForcesOrStress) {
  scene_.mesh.box->cells = {16, 4, 4};
  scene_.constraints[0].where.what = Selection::InBox{{-1, -1, -1}, {0.5, 1, 1}};
  const auto skipped = [&](const char* field) {
    scene_.output.probes.clear();
    add("root", named("x0"), {field});
    scene_.output.probes[0].where = selection(Selection::All{});
    run();
    return decision("cells between fixed vertices").skipped;
  };
  for (const char* field : {"position", "displacement", "velocity", "mass", "element_id"})
    EXPECT_TRUE(skipped(field)) << field;
  for (const char* field : {"force", "reaction", "von_mises", "nodal_stress", "stress"})
    EXPECT_FALSE(skipped(field)) << field;
  EXPECT_NE(decision("probes.csv").reason.find("stress"), std::string::npos);
}

TEST_F(Probes, RefuseFieldsThatNoModelGives) {
  add("tip", named("x1"), {"von_mises"});
  scene_.models[0].model = &host().model("mss-baudet");
  scene_.models[0].parameters =
      parameters(*scene_.models[0].model, {{"E", 400e3}, {"nu", 0.3}, {"rho", 1000}});
  try {
    run();
    ADD_FAILURE();
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_EQ(
        text.find(
            "/output/probes/at/0/fields: no model of this scene provides the field 'von_mises'"),
        0u)
        << text;
    EXPECT_NE(text.find("available: position, displacement, "), std::string::npos) << text;
  }
}

TEST_F(Probes, OfElementsNeedASelectionOfElements) {
  add("tip", named("x1"), {"von_mises"});
  EXPECT_THROW(run(), InputError);
  scene_.output.probes[0].fields = {"displacement"};
  EXPECT_NO_THROW(run());
}

}  // namespace
}  // namespace suture::test
