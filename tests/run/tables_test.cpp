// SPDX-License-Identifier: GPL-3.0-or-later
//
// The steps that have a row in energies.csv and probes.csv.
#include <gtest/gtest.h>

#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/csv_table.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test {
namespace {

/// Asks to stop once `steps` steps were made (and it was asked so often).
struct Impatient : Observer {
  explicit Impatient(int steps) : left(steps) {}
  bool stop_requested() override { return left-- == 0; }
  int left;
};

/// A small beam with a row of both tables every 4 steps.
class Tables : public testing::Test {
 protected:
  Tables() {
    scene_.solver.dt = 1e-4;
    scene_.solver.end = 10e-4;
    scene_.output.enabled = true;
    scene_.output.directory = folder_ / "out";
    scene_.output.energies_every = scene_.output.probes_every = 4;
    scene_.output.probes.push_back({"tip", beam_tip(2)});
  }
  /// The steps of both tables, which agree, after a run.
  std::vector<double> steps(Observer&& observer = Observer()) {
    Diagnostics diagnostics;
    simulation_ = std::make_unique<Simulation>(scene_, host(), diagnostics);
    summary_ = simulation_->run(observer);
    const std::vector<double> probes = CsvTable(folder_ / "out/probes.csv").column("step");
    EXPECT_EQ(CsvTable(folder_ / "out/energies.csv").column("step"), probes);
    return probes;
  }

  TemporaryFolder folder_;
  Scene scene_ = beam(host(), "tm-faure", 4, 2, 9.8);
  std::unique_ptr<Simulation> simulation_;
  RunSummary summary_;
};

using Steps = std::vector<double>;

TEST_F(Tables, EndWithTheLastState) {
  EXPECT_EQ(steps(), (Steps{0, 4, 8, 10}));
  const CsvTable probes(folder_ / "out/probes.csv"), energies(folder_ / "out/energies.csv");
  EXPECT_EQ(probes.last("time [s]"), 10e-4);
  EXPECT_EQ(energies.last("kinetic [J]"), simulation_->energies().kinetic);
  EXPECT_DOUBLE_EQ(probes.last("tip displacement y [m]"),
                   simulation_->mean_displacement(beam_tip(2))[1]);
}

TEST_F(Tables, HaveNoRowTwice) {
  scene_.solver.end = 8e-4;
  EXPECT_EQ(steps(), (Steps{0, 4, 8}));
  scene_.output.energies_every = scene_.output.probes_every = 100;
  EXPECT_EQ(steps(), (Steps{0, 8}));
}

TEST_F(Tables, EndWhereARunWasInterrupted) {
  EXPECT_EQ(steps(Impatient(6)), (Steps{0, 4, 6}));
  EXPECT_EQ(summary_.outcome, RunSummary::Outcome::interrupted);
  EXPECT_EQ(steps(Impatient(0)), Steps{0});
}

TEST_F(Tables, EndAtRest) {
  scene_.solver.dt.reset();
  scene_.solver.end.reset();
  scene_.solver.until_rest = scene_.solver.automatic_damping = true;
  scene_.output.energies_every = scene_.output.probes_every = 1000;
  const Steps rows = steps();
  EXPECT_EQ(summary_.outcome, RunSummary::Outcome::at_rest);
  EXPECT_EQ(rows.back(), static_cast<double>(summary_.steps));
  EXPECT_DOUBLE_EQ(CsvTable(folder_ / "out/probes.csv").last("tip displacement y [m]"),
                   simulation_->mean_displacement(beam_tip(2))[1]);
}

// Stops in between add no rows.
TEST_F(Tables, GoOnAfterALookInBetween) {
  TestSimulation simulation(scene_);
  for (const double time : {2e-4, 4e-4, 5e-4, 10e-4}) simulation.run_to(time);
  simulation.run();
  EXPECT_EQ(CsvTable(folder_ / "out/probes.csv").column("step"), (Steps{0, 4, 8, 10}));
}

}  // namespace
}  // namespace suture::test
