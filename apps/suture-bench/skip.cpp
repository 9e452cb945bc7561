// SPDX-License-Identifier: GPL-3.0-or-later
//
// What each thing that a run skips would cost, on a scene where it matters: the same
// body or scene with and without it.

#include <algorithm>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/frames.hpp"
#include "apps/suture-bench/timer.hpp"

namespace suture::bench {
namespace {

struct SkipOptions {
  Index size = 32000;
  int rounds = 5;
  double seconds = 0.1;
};

class Skips {
 public:
  Skips(const SkipOptions& options, PluginHost& host, Report& report)
      : options_(options), host_(host), report_(report) {}

  /// A step with and without, in turn.
  void of_step(const char* what, const char* scene, BenchBody& with, BenchBody& without) {
    double skipped = 1e9, done = 1e9;
    for (int round = 0; round < options_.rounds; ++round) {
      skipped = std::min(skipped, measure([&] { with.step(); }, 2, options_.seconds).median);
      done = std::min(done, measure([&] { without.step(); }, 2, options_.seconds).median);
    }
    add(what, scene, "step", skipped, done);
  }

  BenchBody body(BodyOptions options, bool skip) {
    options.skip = skip;
    if (options.cells == std::array<Index, 3>{}) options.cells = grid_of(options_.size);
    return {host_, options};
  }

  void add(const char* what, const char* scene, const char* of, double skipped, double done) {
    report_.add(Line()
                    .add("skipped", std::string(what))
                    .add("scene", std::string(scene))
                    .add("time of", std::string(of))
                    .add("ms", 1e3 * skipped)
                    .add("not skipped ms", 1e3 * done)
                    .add("saves %", 100 * (1 - skipped / done)));
  }

  void functors() {
    const BodyOptions springs{.model = "mss-baudet", .cells = {}};
    BenchBody with = body(springs, true), without = body(springs, false);
    of_step("damping and correction, with their inputs", "springs without either", with, without);
    const BodyOptions corrected{
        .model = "mss-baudet", .parameters = {{"correction", 1}}, .cells = {}};
    BenchBody undamped = body(corrected, true), damped = body(corrected, false);
    of_step("damping, velocities, masses", "springs with correction", undamped, damped);
  }

  void constant_columns() {
    const BodyOptions boxes{.model = "tm-faure", .cells = grid_of(432000)};  // beyond the caches
    BenchBody with = body(boxes, true), without = body(boxes, false);
    of_step("copies of equal columns", "TM, 432,000 congruent boxes", with, without);
  }

  void still_cells() {
    BodyOptions bone{.model = "tm-faure", .cells = {}};
    bone.held = bone.cell * 2 * grid_of(options_.size)[0];  // half of a beam 1:1:4
    BenchBody with = body(bone, true), without = body(bone, true);
    with.body().skip_fixed_cells();
    of_step("cells between fixed vertices", "TM, half of it fixed", with, without);
  }

  void threads() {
    BodyOptions small{.model = "tm-faure", .cells = {5, 5, 20}, .threads = 2};
    BenchBody with = body(small, true), without = body(small, false);
    of_step("threads that do not help", "TM, 500 elements", with, without);
  }

  /// From a mesh to attributes.
  void ids_and_columns() {
    struct Case {
      const char *what, *scene;
      BodyOptions options;
    };
    const Case cases[] = {{"edge and face ids", "TM, no cuts", {.model = "tm-faure", .cells = {}}},
                          {"columns that no functor reads",
                           "springs without correction, general hexahedra",
                           {.model = "mss-baudet", .cells = {}, .distorted = true}}};
    for (const Case& c : cases) {
      double skipped = 1e9, done = 1e9;
      for (int round = 0; round < options_.rounds; ++round) {
        const bool ids = c.options.model == "tm-faure";
        const auto time = [&](bool skip) {
          // Ids are built by the run, columns by the instance.
          BenchBody made = body(c.options, ids ? true : skip);
          const BodyTimes& t = made.times();
          const double start = now(1);
          if (ids && !skip) made.require_all_ids();
          return t.map + t.attributes + t.loops + now(1) - start;
        };
        skipped = std::min(skipped, time(true));
        done = std::min(done, time(false));
      }
      add(c.what, c.scene, "map and attributes", skipped, done);
    }
  }

  /// A frame as the simulation thread sees it; the writer works behind it.
  void fields() {
    double seconds[2] = {1e9, 1e9};
    for (const bool skip : {true, false}) {
      Frames frames(host_, grid_of(options_.size), {"displacement", "velocity"}, skip);
      for (int round = 0; round < options_.rounds; ++round) {
        frames.wait();
        const double start = now(1);
        frames.write();
        seconds[skip] = std::min(seconds[skip], now(1) - start);
      }
    }
    add("fields that are not requested", "TM, displacement and velocity", "a frame", seconds[1],
        seconds[0]);
  }

 private:
  const SkipOptions& options_;
  PluginHost& host_;
  Report& report_;
};

void run_skip(const SkipOptions& options, Report& report) {
  PluginHost host;
  report.begin(
      "skip",
      "work that is skipped if a scene does not need it, measured on a scene where it matters; " +
          std::to_string(options.size) + " elements, best of " + std::to_string(options.rounds) +
          ", in turn");
  Skips skips(options, host, report);
  skips.functors();
  skips.constant_columns();
  skips.still_cells();
  skips.threads();
  skips.ids_and_columns();
  skips.fields();
}

}  // namespace

void add_skip(CommandLine& line) {
  auto [command, options] = line.add("skip", "The cost of each skipped piece of work", run_skip);
  command.option("--size", &options.size, "Elements");
  command.option("--rounds", &options.rounds, "Turns").positive();
  command.option("--seconds", &options.seconds, "Time spent on each figure and round");
}

}  // namespace suture::bench
