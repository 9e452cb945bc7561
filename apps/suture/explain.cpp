// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>

#include "apps/suture/commands.hpp"
#include "kernel/run/simulation.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture {
namespace {

std::string seconds(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g s", value);
  return text;
}

void print_text(const Scene& scene, const Simulation& simulation, const Estimate& cost,
                Console& console) {
  console.print(scene.file.filename().string() + (scene.title.empty() ? "" : ": " + scene.title) +
                " (hash " + scene.hash + ")");
  for (const bool skipped : {false, true}) {
    console.print(skipped ? "\nskipped" : "\ndone");
    for (const Decision& decision : simulation.decisions()) {
      if (decision.skipped == skipped) {
        console.print("  " + decision.subject + ": " + decision.reason);
      }
    }
  }
  console.print("\ncost");
  console.print("  step: dt " + seconds(cost.dt) + ", stable below " + seconds(cost.stable_dt) +
                ", takes " + duration(cost.seconds_per_step));
  console.print(cost.steps == 0 ? "  steps: until rest, not known beforehand"
                                : "  steps: " + std::to_string(cost.steps) +
                                      ", frames: " + std::to_string(cost.frames));
  if (cost.steps > 0) console.print("  time: about " + duration(cost.seconds));
  console.print("  memory: about " + memory(cost.bytes));
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    char escape[8];
    std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned char>(c));
    if (c == '"' || c == '\\') {
      out += std::string("\\") + c;
    } else {
      out += static_cast<unsigned char>(c) < 0x20 ? escape : std::string(1, c);
    }
  }
  return out + "\"";
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

void print_json(const Scene& scene, const Simulation& simulation, const Estimate& cost,
                Console& console) {
  std::string decisions;
  for (const Decision& decision : simulation.decisions()) {
    decisions += decisions.empty() ? "\n" : ",\n";
    decisions += "    {\"subject\": " + quoted(decision.subject) +
                 ", \"skipped\": " + (decision.skipped ? "true" : "false") +
                 ", \"reason\": " + quoted(decision.reason) + "}";
  }
  console.print("{\n  \"scene\": " + quoted(scene.file.string()) + ",\n  \"hash\": " +
                quoted(scene.hash) + ",\n  \"decisions\": [" + decisions + "\n  ],");
  console.print("  \"steps\": " + (cost.steps == 0 ? "null" : std::to_string(cost.steps)) +
                ", \"frames\": " + std::to_string(cost.frames) + ", \"dt_s\": " + number(cost.dt) +
                ", \"stable_dt_s\": " + number(cost.stable_dt) +
                ",\n  \"seconds_per_step\": " + number(cost.seconds_per_step) +
                ", \"seconds\": " + (cost.steps == 0 ? "null" : number(cost.seconds)) +
                ", \"bytes\": " + number(cost.bytes) + "\n}");
}

}  // namespace

int explain(const ExplainCommand& command, Console& console) {
  PluginHost host(&console.diagnostics());
  const Scene scene = read_scene(command.scene, command.sets, host, console.diagnostics());
  Simulation simulation(scene, host, console.diagnostics());
  const Estimate cost = simulation.estimate();
  (command.json ? print_json : print_text)(scene, simulation, cost, console);
  return 0;
}

}  // namespace suture
