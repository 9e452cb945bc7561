// SPDX-License-Identifier: GPL-3.0-or-later
//
// How fast a haptic device gets its force: a hand leads a compliant knife through a block of liver,
// by the exchange of `suture live` after every millisecond.
#include <algorithm>
#include <cmath>
#include <optional>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/live/device_hand.hpp"
#include "kernel/live/inputs.hpp"

namespace suture::bench {
namespace {

struct HapticOptions {
  std::array<Index, 3> cells{20, 10, 10};
  double edge = 0.005, tick = 1e-3, seconds = 5,
         dt = 4e-4;  // below the bound, so that nothing is searched for
};

/// A block of liver on a plate.
Scene haptic_block(PluginHost& host, const HapticOptions& options) {
  const auto& n = options.cells;
  Scene scene;
  scene.mesh.box = BoxOptions{
      {0, 0, 0}, {options.edge * n[0], options.edge * n[1], options.edge * n[2]}, n, {1, 1, 1}};
  ModelUse use;
  use.name = "tm-faure";
  use.model = &host.model(use.name);
  use.parameters = parameters_of(*use.model, {{"E", 10e3}, {"nu", 0.45}, {"rho", 1000}});
  scene.models.push_back(use);
  Constraint plate;
  plate.where.what = Selection::Named{"z0"};
  scene.constraints.push_back(plate);
  scene.solver.damping = 5;
  scene.solver.end = options.seconds;
  scene.solver.threads = 1;
  scene.output.enabled = false;
  return scene;
}

/// A rod of half an element in front of the upper half, behind a blade. The hand moves it along x.
void add_knife(Scene& scene, const HapticOptions& options) {
  const auto& n = options.cells;
  const double e = options.edge, middle = e * (n[1] / 2 + 0.05);
  const double low = e * (n[2] / 2 + 0.05), high = e * (n[2] + 2);
  const Capsule rod{{-2 * e, middle, low + e}, {-2 * e, middle, high}, e / 4};
  Obstacle knife{"knife", "/contact/obstacles/0", rod, {}, 0.2};
  knife.motion.centre = {-2 * e, middle, (low + high) / 2};
  const double inertia = 1e-5;
  knife.coupling = Coupling{0.05, 500, 10, inertia, 0.1, 2e-3};
  scene.contact.obstacles.push_back(knife);
  Event cut;
  cut.path = "/events/0";
  CutBlade blade;
  blade.carried =
      CutBlade::Carried{0, "knife", {{-1.2 * e, middle, low - 0.1 * e}, {-1.2 * e, middle, high}}};
  cut.what = blade;
  scene.events.push_back(cut);
}

/// What a part of the values does not exceed.
double percentile(std::vector<double>& values, double part) {
  std::ranges::sort(values);
  const auto last = static_cast<double>(values.size() - 1);
  return values[static_cast<std::size_t>(std::lround(part * last))];
}

void measure_ticks(bool lips, std::optional<double> dt, const HapticOptions& options,
                   PluginHost& host, Report& report) {
  Scene scene = haptic_block(host, options);
  add_knife(scene, options);
  scene.contact.pieces = lips;
  scene.solver.dt = dt;
  Diagnostics diagnostics;
  Simulation simulation(scene, host, diagnostics);
  DeviceHand hand(simulation, "knife", options.edge);
  const double speed = options.edge * options.cells[0] / options.seconds;
  Observer nobody;
  std::vector<double> walls, processor;
  double largest = 0;
  const auto ticks = static_cast<std::uint64_t>(options.seconds / options.tick);
  for (std::uint64_t i = 1; i < ticks; ++i) {
    const double start = wall(), own = now(1), time = static_cast<double>(i) * options.tick;
    const double step = simulation.next_dt();
    const std::string input =
        hand.input({{speed * time, 0, 0}, {}, 0, 0}, options.tick / step, step);
    if (!input.empty()) apply_input(input, scene, simulation, nobody, diagnostics);
    simulation.run_to(time, nobody);
    const Vec3 force = hand.force().force;
    walls.push_back(wall() - start);
    processor.push_back(now(1) - own);
    largest = std::max(largest, std::sqrt(dot(force, force)));
  }
  const auto on_time = [&](const std::vector<double>& times) {
    return 100 *
           static_cast<double>(
               std::ranges::count_if(times, [&](double t) { return t <= options.tick; })) /
           static_cast<double>(times.size());
  };
  double busy = 0;
  for (const double t : walls) busy += t;
  const RunSummary end = simulation.run(nobody);
  report.add(Line()
                 .add("lips touch", lips ? "yes" : "no")
                 .add("elements", static_cast<double>(simulation.complex().element_count()))
                 .add("faces cut", static_cast<double>(end.faces_cut))
                 .add("dt", dt ? "fixed" : "auto")
                 .add("dt s", end.dt)
                 .add("largest force N", largest)
                 .add("forces per s", static_cast<double>(walls.size()) / busy)
                 .add("on time %", on_time(walls))
                 .add("of processor time %", on_time(processor))
                 .add("median ms", 1e3 * percentile(processor, 0.5))
                 .add("99 % ms", 1e3 * percentile(processor, 0.99))
                 .add("99.9 % ms", 1e3 * percentile(processor, 0.999))
                 .add("worst ms", 1e3 * percentile(processor, 1)));
}

void run_haptic(const HapticOptions& options, Report& report) {
  PluginHost host;
  report.begin("haptic",
               "liver (tm-faure, E 10 kPa, nu 0.45, elements of 5 mm) cut by a compliant knife "
               "(0.05 kg, 500 N/m, friction 0.2) that goes through it in " +
                   std::to_string(static_cast<int>(options.seconds)) +
                   " s; one thread; a force on the hand after every 1 ms; percentiles of "
                   "processor time");
  for (const bool lips : {false, true})
    for (const std::optional<double> dt : {std::optional<double>(), std::optional(options.dt)})
      measure_ticks(lips, dt, options, host, report);
}

}  // namespace

void add_haptic(CommandLine& line) {
  auto [command, options] =
      line.add("haptic", "How fast a haptic device gets its force", run_haptic);
  command.option("--cells", &options.cells, "Elements along each axis");
  command.option("--dt", &options.dt, "The fixed step, s").positive();
  command.option("--seconds", &options.seconds, "Of the cut").positive();
}

}  // namespace suture::bench
