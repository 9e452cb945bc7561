// SPDX-License-Identifier: GPL-3.0-or-later
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <memory>
#include <random>

#include "apps/suture-bench/cgal_cut.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/cut_case.hpp"
#include "apps/suture-bench/suture_cut.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/base/error.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/topology/dart.hpp"

namespace suture::bench {
namespace {

struct CutOptions {
  std::vector<Index> sides{200, 400, 600, 800};
  std::vector<std::string> bodies{"frog", "elephant", "mushroom", "giraffe"};
  unsigned rounds = 3;
  bool baselines = true;
  Index large = 800;
};

double resident_bytes() {
  malloc_trim(0);
  std::size_t size = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> size >> resident;
  return static_cast<double>(resident) * 4096;
}

/// What one round of a method on a case gave.
struct Round {
  std::vector<double> seconds;  ///< of each cut
  double bytes = 0;             ///< of the model before the cuts
  double mass_lost = 0;         ///< relative
};

struct Method {
  std::string name;
  std::function<Round(const CutCase&)> run;
};

double lost(double before, double after) { return std::abs(after - before) / before; }

Round cut_suture(PluginHost& host, const std::string& model, const CutCase& c) {
  Round round;
  const double bytes = resident_bytes();
  SutureCut body(host, model, c.mesh, c.cuts);
  round.bytes = resident_bytes() - bytes;
  const double mass = body.mass();
  for (const auto& faces : c.cuts) {
    round.seconds.push_back(body.cut(faces));
  }
  round.mass_lost = lost(mass, body.mass());
  return round;
}

Round run_baseline(std::unique_ptr<CutBaseline> (*make)(const Mesh&), const CutCase& c) {
  Round round;
  const double bytes = resident_bytes();
  const auto map = make(c.mesh);
  round.bytes = resident_bytes() - bytes;
  const double mass = map->mass();
  for (const auto& faces : c.cuts) {
    const double start = now(1);
    map->cut(faces);
    round.seconds.push_back(now(1) - start);
  }
  round.mass_lost = lost(mass, map->mass());
  return round;
}

std::vector<Method> methods(PluginHost& host, const CutOptions& options) {
  std::vector<Method> all;
  for (const char* model : {"mss-baudet", "tm-faure"})
    all.push_back({std::string("Suture, ") + model,
                   [&host, model](const CutCase& c) { return cut_suture(host, model, c); }});
  if (!options.baselines) return all;
  all.push_back({"CGAL unsew<3>", [](const CutCase& c) { return run_baseline(make_cgal_cut, c); }});
  all.push_back(
      {"Flechon 2013", [](const CutCase& c) { return run_baseline(make_flechon_cut, c); }});
  return all;
}

/// All rounds of a method on a case.
struct Sample {
  std::vector<Round> rounds;

  double seconds(std::size_t cut) const {
    std::vector<double> of_cut;
    for (const Round& r : rounds) of_cut.push_back(r.seconds[cut]);
    return median(of_cut);
  }
  double all_seconds() const {
    std::vector<double> sums;
    for (const Round& r : rounds) {
      sums.push_back(0);
      for (const double s : r.seconds) sums.back() += s;
    }
    return median(sums);
  }
};

/// Rounds of the methods alternate, so that a slow moment of the machine hits all.
std::vector<Sample> measure_cuts(const CutCase& c, const std::vector<Method>& all,
                                 unsigned rounds) {
  std::vector<Sample> samples(all.size());
  for (unsigned round = 0; round < rounds; ++round)
    for (std::size_t m = 0; m < all.size(); ++m) {
      samples[m].rounds.push_back(all[m].run(c));
      if (samples[m].rounds.back().mass_lost > 1e-9)
        throw InputError("the benchmark's " + all[m].name + " loses mass in a cut of " + c.name);
    }
  return samples;
}

void add_lines(Report& report, const CutCase& c, const std::vector<Method>& all,
               const std::vector<Sample>& samples) {
  const auto faces = static_cast<double>(c.faces());
  const auto elements = static_cast<double>(c.mesh.hexahedra.size());
  for (std::size_t m = 0; m < all.size(); ++m) {
    const Sample& sample = samples[m];
    Line line;
    line.add("mesh", c.name)
        .add("elements", elements)
        .add("faces", faces)
        .add("method", all[m].name)
        .add("ms", 1e3 * sample.all_seconds())
        .add("median_us_per_face", 1e6 * sample.all_seconds() / faces)
        .add("bytes_per_element", sample.rounds[0].bytes / elements);
    const auto slower = [&](std::size_t baseline) -> Line::Value {
      if (samples.size() <= baseline || baseline <= m) return "";
      return samples[baseline].all_seconds() / sample.all_seconds();
    };
    line.add("CGAL / this", slower(2)).add("Flechon / this", slower(3));
    report.add(std::move(line));
  }
}

void compare_grids(const CutOptions& options, const std::vector<Method>& all, Report& report) {
  report.begin("cut",
               "the paper's Fig. 5: all faces between two layers of cubes; vertices, edges and "
               "faces split, masses and stiffnesses recomputed, columns grown, rows of the force "
               "loops updated; median over fresh bodies, CPU time");
  for (const Index side : options.sides) {
    const CutCase c = two_layers(side);
    add_lines(report, c, all, measure_cuts(c, all, options.rounds));
  }
}

void compare_bodies(const CutOptions& options, const std::vector<Method>& all, Report& report) {
  report.begin("cut bodies",
               "the paper's Table 1 on generated bodies with the same numbers of elements, one "
               "plane each, and its Fig. 11: ten cuts of the giraffe together");
  for (const std::string& name : options.bodies) {
    const CutCase c = body_case(name);
    add_lines(report, c, all, measure_cuts(c, all, options.rounds));
  }
  if (std::ranges::find(options.bodies, "giraffe") == options.bodies.end()) return;
  const CutCase ten = ten_cuts();
  const std::vector<Sample> samples = measure_cuts(ten, all, options.rounds);
  add_lines(report, ten, all, samples);
  report.begin("ten cuts", "Fig. 11, cut by cut, us per face");
  for (std::size_t i = 0; i < ten.cuts.size(); ++i) {
    Line line;
    line.add("cut", static_cast<double>(i + 1));
    line.add("faces", static_cast<double>(ten.cuts[i].size()));
    for (std::size_t m = 0; m < all.size(); ++m)
      line.add(all[m].name, 1e6 * samples[m].seconds(i) / static_cast<double>(ten.cuts[i].size()));
    report.add(std::move(line));
  }
}

/// The same thousand faces in a small and in a large mesh.
void compare_sizes(const CutOptions& options, const std::vector<Method>& all, Report& report) {
  report.begin("cut sizes", "1,000 faces in a row of a small and of a large mesh");
  for (const Index side : {Index{71}, options.large}) {
    const CutCase c = two_layers(side, 1000);
    const std::vector<Method> ours(all.begin(), all.begin() + 2);
    add_lines(report, c, ours, measure_cuts(c, ours, 3 * options.rounds));
  }
}

/// One operation after the other, of one face or element each, chosen at random.
void single_operations(PluginHost& host, const CutOptions& options, Report& report) {
  report.begin("single cuts",
               "one face or element at a time: 1,000 random cuts in 20x20x20 and in large cubes of "
               "cells; us per operation");
  for (const char* model : {"mss-baudet", "tm-faure"})
    for (const Index n :
         {Index{20}, static_cast<Index>(std::cbrt(2.0 * options.large * options.large))}) {
      const auto length = static_cast<double>(n);
      SutureCut body(host, model, make_box({.size = {length, length, length}, .cells = {n, n, n}}));
      std::mt19937 random(1);
      std::vector<double> cuts, pierces;
      for (int i = 0; i < 1000; ++i) {
        Dart face = none;
        do face = face_of(random() % (hexahedron::darts * body.element_count()));
        while (!body.can_cut(face));
        cuts.push_back(body.cut({&face, 1}));
      }
      for (int i = 0; i < 1000; ++i) {
        Index element = none;
        do element = random() % body.element_count();
        while (!body.can_pierce(element));
        pierces.push_back(body.pierce({&element, 1}));
      }
      report.add(Line()
                     .add("model", model)
                     .add("elements", static_cast<double>(n) * n * n)
                     .add("cut us", 1e6 * median(cuts))
                     .add("pierce us", 1e6 * median(pierces)));
    }
}

/// A cavity.
void pierce_many(PluginHost& host, const CutOptions& options, Report& report) {
  report.begin("pierce", "every element of a slab of an eighth of a block, removed at once");
  for (const char* model : {"mss-baudet", "tm-faure"})
    for (const Index n : {Index{24}, Index{80}}) {
      std::vector<double> seconds;
      std::vector<Index> slab(n * n * n / 8);
      for (Index i = 0; i < slab.size(); ++i) slab[i] = n * n * (n / 2) + i;
      for (unsigned round = 0; round < options.rounds; ++round) {
        const auto length = static_cast<double>(n);
        SutureCut body(host, model,
                       make_box({.size = {length, length, length}, .cells = {n, n, n}}));
        seconds.push_back(body.pierce(slab));
      }
      report.add(Line()
                     .add("model", model)
                     .add("elements", static_cast<double>(n) * n * n)
                     .add("removed", static_cast<double>(slab.size()))
                     .add("us per removed element",
                          1e6 * median(seconds) / static_cast<double>(slab.size())));
    }
}

void run_cut(const CutOptions& options, Report& report) {
  PluginHost host;
  const std::vector<Method> all = methods(host, options);
  compare_grids(options, all, report);
  compare_bodies(options, all, report);
  compare_sizes(options, all, report);
  single_operations(host, options, report);
  pierce_many(host, options, report);
}

}  // namespace

void add_cut(CommandLine& line) {
  auto [command, options] = line.add(
      "cut",
      "Time per cut face, compared with CGAL's unsew<3> and the predecessor of the paper's model",
      run_cut);
  command.option("--sides", &options.sides, "n of the grids n x n x 2");
  command.option("--bodies", &options.bodies, "Bodies of the paper's Table 1");
  command.option("--large", &options.large, "n of the large grid n x n x 2");
  command.option("--rounds", &options.rounds, "Fresh bodies for each figure").positive();
  command.flag("!--no-baselines", &options.baselines, "Suture only");
}

}  // namespace suture::bench
