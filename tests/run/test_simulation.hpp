// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/run/simulation.hpp"
#include "tests/run/host.hpp"

namespace suture::test {

/// Constructed before the simulation that reports to it.
struct OwnDiagnostics {
  Diagnostics diagnostics;
};

/// A simulation with the plugins of host(), which nobody observes.
struct TestSimulation : OwnDiagnostics, Simulation {
  explicit TestSimulation(const Scene& scene, bool skip = true)
      : Simulation(scene, host(), diagnostics, skip) {}

  using Simulation::run, Simulation::run_to, Simulation::apply;
  RunSummary run() { return run(nobody); }
  void run_to(double time) { run_to(time, nobody); }
  EventOutcome apply(const Event& event) { return apply(event, nobody); }

  Observer nobody;
};

}  // namespace suture::test
