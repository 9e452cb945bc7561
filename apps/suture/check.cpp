// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture/commands.hpp"
#include "kernel/run/inventory.hpp"
#include "kernel/run/plausibility.hpp"
#include "kernel/run/simulation.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture {

// Compiling the scene finds what its text cannot show: the mesh, the selections,
// rest shapes outside a model's range. Nothing is run and nothing is written.
int check(const CheckCommand& command, Console& console) {
  PluginHost host(&console.diagnostics(), trust_of(command));
  const Scene scene = read_scene(command.scene, command.sets, host, console.diagnostics());
  Simulation simulation(scene, host, console.diagnostics(), true, nullptr, command.check_plugins);
  if (command.check_plugins) simulation.try_plugins();
  if (!console.quiet()) {
    console.print(command.scene.string() + ": valid (" + count(scene.models.size(), "model") +
                  ", " + count(scene.constraints.size(), "constraint") + ", " +
                  count(scene.loads.size(), "load") + ", " + count(scene.events.size(), "event") +
                  "; hash " + scene.hash + ")");
    console.print(describe_plausibility(simulation.built()));
    for (const std::string& line : take_inventory(simulation.built())) console.print(line);
  }
  return 0;
}

}  // namespace suture
