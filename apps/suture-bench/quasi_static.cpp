// SPDX-License-Identifier: GPL-3.0-or-later
//
// Equilibria at frame rate: a beam that is pulled and cut, one equilibrium per frame.
#include <algorithm>
#include <cmath>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/run/simulation.hpp"

namespace suture::bench {
namespace {

/// A beam, and the rate of frames that is asked of it.
struct Beam {
  std::array<Index, 3> cells;  ///< x along it
  int frames_per_second;
};
constexpr Beam beams[] = {{{40, 5, 5}, 100}, {{40, 10, 10}, 30}};

struct QuasiStaticOptions {
  std::vector<std::string> elements{"trilinear", "mean-gradient"};
  double seconds = 1, tolerance = 1e-4, cut_every = 0.1;
  unsigned threads = 1;
};

constexpr double beam_length = 1, beam_side = 0.25;  // m

/// Held at one end; the other is pulled away by a tenth of the length and aside, in a second.
Scene pulled(PluginHost& host, const Beam& beam, const std::string& element,
             const QuasiStaticOptions& options) {
  Scene scene;
  scene.mesh.box =
      BoxOptions{{0, 0, 0}, {beam_length, beam_side, beam_side}, beam.cells, {1, 1, 1}};
  ModelUse use;
  use.name = "tm-faure";
  use.model = &host.model(use.name);
  use.parameters = parameters_of(*use.model, {{"element", element == "trilinear" ? 0 : 1}});
  scene.models.push_back(use);
  scene.gravity = {0, -2.45, 0};
  Constraint end;
  end.where.what = Selection::Named{"x0"};
  scene.constraints.push_back(end);
  end.where.what = Selection::Named{"x1"};
  end.translation = {0.1 * beam_length, 0.1 * beam_length, 0};
  end.moves = true;
  end.ramp = {0, 1, false};
  scene.constraints.push_back(end);
  scene.solver.integrator = "static";
  scene.solver.dt = 1.0 / beam.frames_per_second;
  // Beyond the last frame: what a run examines at its end is part of none.
  scene.solver.end = options.seconds + 1.0 / beam.frames_per_second;
  scene.solver.step_tolerance = options.tolerance;
  scene.solver.threads = options.threads;
  scene.output.enabled = false;
  return scene;
}

/// A notch from above over half of the height, the `number`-th along the beam.
Event notch(int number) {
  const double x = beam_length * (0.1 + 0.1 * (number % 9)) + 1e-3, low = beam_side / 2 + 1e-3;
  CutPlane cut{{x, 0.75 * beam_side, beam_side / 2}, {1, 0, 0}};
  cut.polygon = {{x, low, -beam_side},
                 {x, 2 * beam_side, -beam_side},
                 {x, 2 * beam_side, 2 * beam_side},
                 {x, low, 2 * beam_side}};
  Event event;
  event.path = "/events/" + std::to_string(number);
  event.what = cut;
  return event;
}

struct ShownFrames {
  double total = 0, slowest = 0;  ///< s
  int count = 0, late = 0, cuts = 0, newton = 0;
};

/// Counts the iterations of Newton's method.
struct Counter : Observer {
  void on_detail(const std::string&) override { ++iterations; }
  int iterations = 0;
};

ShownFrames show(Simulation& simulation, const Beam& beam, const QuasiStaticOptions& options) {
  ShownFrames result;
  Counter counter;
  const double frame = 1.0 / beam.frames_per_second;
  const int frames = static_cast<int>(std::lround(options.seconds / frame));
  for (int i = 1; i <= frames; ++i) {
    const double begin = now(options.threads);
    if (i * frame > options.cut_every * (result.cuts + 1))
      simulation.apply(notch(result.cuts++), counter);
    simulation.run_to(i * frame, counter);
    const double spent = now(options.threads) - begin;
    result.total += spent;
    result.slowest = std::max(result.slowest, spent);
    result.late += spent > frame;
    ++result.count;
  }
  result.newton = counter.iterations;
  return result;
}

void run_quasi_static(const QuasiStaticOptions& options, Report& report) {
  PluginHost host;
  report.begin(
      "quasi-static",
      "cantilever of 1 m whose free end is pulled by 0.1 m along and aside in a second, "
      "notched to half of its height every 0.1 s: one equilibrium to 1e-4 per frame; a "
      "frame is late that takes longer than the asked rate allows; CPU s of one thread, or "
      "wall clock");
  for (const std::string& element : options.elements)
    for (const Beam& beam : beams) {
      Diagnostics diagnostics;
      Simulation simulation(pulled(host, beam, element, options), host, diagnostics);
      const ShownFrames frames = show(simulation, beam, options);
      report.add(Line()
                     .add("element", element)
                     .add("threads", static_cast<double>(options.threads))
                     .add("elements", static_cast<double>(simulation.complex().existing(3)))
                     .add("cuts", static_cast<double>(frames.cuts))
                     .add("frames", static_cast<double>(frames.count))
                     .add("frames_per_s", frames.count / frames.total)
                     .add("asked_frames_per_s", static_cast<double>(beam.frames_per_second))
                     .add("slowest_ms", 1e3 * frames.slowest)
                     .add("asked_ms", 1e3 / beam.frames_per_second)
                     .add("newton_steps", static_cast<double>(frames.newton) / frames.count)
                     .add("late", static_cast<double>(frames.late)));
    }
}

}  // namespace

void add_quasi_static(CommandLine& line) {
  auto [command, options] =
      line.add("quasi-static", "Equilibria at frame rate, with cuts", run_quasi_static);
  command.option("--elements", &options.elements, "Element types of tm-faure")
      .one_of({"trilinear", "mean-gradient"});
  command.option("--seconds", &options.seconds, "Simulated time").positive();
  command.option("--tolerance", &options.tolerance, "Residual relative to the load").positive();
  command.option("--threads", &options.threads, "Threads").positive();
  command.option("--cut-every", &options.cut_every, "s").positive();
}

}  // namespace suture::bench
