// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "kernel/plugin_host/plugin_host.hpp"
#include "kernel/run/simulation.hpp"

namespace suture::test {

PluginHost& plugins();

/// A scene from the members that are given, without output; `mesh`, `models` and `solver` among
/// them.
Scene field_scene(const std::string& members);
/// A bar of 1 m along x, of n x 1 x 1 elements, that conducts heat with k = 2 W/(m K) and c = 4
/// J/(m^3 K) and is held; `more`: more members of the scene, `solver` its solver.
Scene bar(int n, const std::string& solver, const std::string& more);

/// Runs to the end; the values of a field by vertex.
class FieldRun {
 public:
  explicit FieldRun(const Scene& scene) : simulation(scene, plugins(), diagnostics) {}
  FieldRun& run_to(double time);
  double value(Index vertex) const;
  std::vector<double> values() const;
  /// The mean over the vertices at this x at rest.
  double at(double x) const;
  /// max |u(x) - exact(x)| over the vertices.
  double error(const std::function<double(double)>& exact) const;
  FieldEquation& equation() { return simulation.built().body().fields().front(); }
  FieldBalance balance() { return equation().balance(); }
  FieldEnergy energy() { return equation().energy(simulation.time()); }

  Diagnostics diagnostics;
  mutable Simulation simulation;
  Observer observer;
};

}  // namespace suture::test
