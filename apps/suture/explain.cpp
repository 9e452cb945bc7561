// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/suture/commands.hpp"
#include "kernel/run/inventory.hpp"
#include "kernel/run/plausibility.hpp"
#include "kernel/run/simulation.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture {
namespace {

std::string seconds(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g s", value);
  return text;
}

std::string stability(double stable_dt) {
  if (std::isinf(stable_dt)) return "any step is stable";
  return "stable below " + seconds(stable_dt);
}

/// Decisions of one kind, one after the other for one reason, on one line.
void print_decisions(const std::vector<Decision>& decisions, bool skipped, Console& console) {
  const Decision* last = nullptr;
  std::string subjects;
  const auto flush = [&] {
    if (last) console.print("  " + subjects + ": " + last->reason);
  };
  for (const Decision& decision : decisions) {
    if (decision.skipped != skipped) continue;
    const auto name = decision.subject.rfind('/');  // "column tissue/mass"
    const bool joins = last && last->reason == decision.reason && name != std::string::npos &&
                       decision.subject.compare(0, name + 1, last->subject, 0, name + 1) == 0;
    if (joins) {
      subjects += ", " + decision.subject.substr(name + 1);
      continue;
    }
    flush();
    last = &decision;
    subjects = decision.subject;
  }
  flush();
}

struct Explained {
  std::string plausibility;
  std::vector<std::string> inventory;
  Estimate cost;
};

void print_text(const Scene& scene, const Simulation& simulation, const Explained& what,
                Console& console) {
  const Estimate& cost = what.cost;
  console.print(scene.file.filename().string() + (scene.title.empty() ? "" : ": " + scene.title) +
                " (hash " + scene.hash + ")");
  console.print(what.plausibility);
  for (const std::string& line : what.inventory) console.print(line);
  for (const bool skipped : {false, true}) {
    console.print(skipped ? "\nskipped" : "\ndone");
    print_decisions(simulation.decisions(), skipped, console);
  }
  console.print("\ncost");
  const char* mean = cost.dt_follows_error ? "about " : "";
  console.print("  step: dt " + (mean + seconds(cost.dt)) + ", " + stability(cost.stable_dt) +
                ", takes " + duration(cost.seconds_per_step));
  console.print(cost.steps == 0 ? "  steps: until rest, number not known in advance"
                                : "  steps: " + std::to_string(cost.steps) +
                                      ", frames: " + std::to_string(cost.frames));
  if (cost.steps > 0) console.print("  time: about " + duration(cost.seconds));
  console.print("  memory: about " + memory(cost.bytes));
}

void print_json(const Scene& scene, const Simulation& simulation, const Explained& what,
                Console& console) {
  const Estimate& cost = what.cost;
  nlohmann::ordered_json decisions = nlohmann::ordered_json::array();
  for (const Decision& decision : simulation.decisions()) {
    decisions.push_back({{"subject", decision.subject},
                         {"skipped", decision.skipped},
                         {"reason", decision.reason}});
  }
  nlohmann::ordered_json report = {{"scene", scene.file.string()},
                                   {"hash", scene.hash},
                                   {"plausibility", what.plausibility},
                                   {"inventory", what.inventory},
                                   {"decisions", decisions},
                                   {"steps", nullptr},
                                   {"frames", cost.frames},
                                   {"dt_s", cost.dt},
                                   {"stable_dt_s", cost.stable_dt},
                                   {"seconds_per_step", cost.seconds_per_step},
                                   {"seconds", nullptr},
                                   {"bytes", cost.bytes}};
  if (cost.steps > 0) {  // else it ends at rest, nobody knows when
    report["steps"] = cost.steps;
    report["seconds"] = cost.seconds;
  }
  console.print(report.dump(2));
}

}  // namespace

int explain(const ExplainCommand& command, Console& console) {
  PluginHost host(&console.diagnostics(), trust_of(command));
  const Scene scene = read_scene(command.scene, command.sets, host, console.diagnostics());
  Simulation simulation(scene, host, console.diagnostics(), command.skip);
  BuiltScene& built = simulation.built();
  const Explained what{describe_plausibility(built), take_inventory(built), simulation.estimate()};
  (command.json ? print_json : print_text)(scene, simulation, what, console);
  return 0;
}

}  // namespace suture
