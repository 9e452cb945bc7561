// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "apps/suture-bench/cgal_cut.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/topology/import.hpp"

namespace suture::bench {
namespace {

struct Options {
  std::vector<Index> sides{100, 200, 400, 800};
  unsigned rounds = 7;
  bool cgal = true;
};

/// Unit cubes in two layers, whole numbers as coordinates: CGAL compares points exactly.
Mesh two_layers(Index side) {
  const auto n = static_cast<double>(side);
  return make_box({.size = {n, n, 2}, .cells = {side, side, 2}});
}

/// The faces between the layers, counted by the user's element numbers.
std::vector<Dart> between_layers(const Imported& in, Index side) {
  std::vector<Dart> faces;
  for (Index e = 0; e < in.complex.element_count(); ++e)
    for (int f = 0; f < 6; ++f) {
      const Index other = in.complex.neighbour(e, f);
      if (other != none && in.user_element[other] == in.user_element[e] + side * side)
        faces.push_back(24 * e + 4 * f);
    }
  std::ranges::sort(faces);
  return faces;
}

struct Sample {
  std::vector<double> seconds;
  double median() {
    std::ranges::sort(seconds);
    return seconds[seconds.size() / 2];
  }
};

Imported import_quietly(Mesh mesh) {
  Diagnostics diagnostics;
  Imported in = import_mesh(std::move(mesh), {}, diagnostics);
  in.complex.require_edges();
  in.complex.require_faces();
  return in;
}

void add_line(Report& report, Index side, std::size_t faces, const char* method, Sample& sample,
              double base_line) {
  const double us = 1e6 * sample.median() / static_cast<double>(faces);
  report.add(Line()
                 .add("mesh", std::to_string(side) + "x" + std::to_string(side) + "x2")
                 .add("elements", 2.0 * side * side)
                 .add("faces", static_cast<double>(faces))
                 .add("method", method)
                 .add("us/face", us)
                 .add("best us/face", 1e6 * sample.seconds.front() / static_cast<double>(faces))
                 .add("times faster", base_line / us));
}

/// Rounds of both methods alternate, so that a slow moment of the machine hits both;
/// a round is a fresh map and all faces between its layers.
void measure_grid(Index side, const Options& options, Report& report) {
  Sample ours, cgal;
  std::size_t count = 0;
  for (unsigned round = 0; round < options.rounds; ++round) {
    Imported in = import_quietly(two_layers(side));
    const std::vector<Dart> faces = between_layers(in, side);
    count = faces.size();
    const double start = now(1);
    const TopologyChange change = in.complex.cut(faces);
    ours.seconds.push_back(now(1) - start);
    if (!options.cgal || round >= std::max(1u, options.rounds / 2)) continue;
    CgalCut base(two_layers(side));
    std::vector<Dart> same(faces);  // in the numbers of the mesh
    for (Dart& d : same) d = 24 * in.user_element[d / 24] + d % 24;
    const double begin = now(1);
    base.cut(same);
    cgal.seconds.push_back(now(1) - begin);
  }
  double base_line = 0;
  if (options.cgal) {
    base_line = 1e6 * cgal.median() / static_cast<double>(count);
    add_line(report, side, count, "CGAL unsew<3>", cgal, base_line);
  }
  add_line(report, side, count, "Suture", ours, base_line);
}

void run(const Options& options, Report& report) {
  report.begin("cut",
               "all faces between two layers, vertices, edges and faces split and their stars "
               "reported, median of fresh maps, processor time");
  for (const Index side : options.sides) measure_grid(side, options, report);
}

}  // namespace

void add_cut(CLI::App& app, std::vector<Command>& commands) {
  auto* command = app.add_subcommand("cut", "Time per cut face, beside CGAL's linear cell complex");
  auto options = std::make_shared<Options>();
  command->add_option("--sides", options->sides, "n of the grids n x n x 2");
  command->add_option("--rounds", options->rounds, "Fresh maps for each figure")
      ->check(CLI::PositiveNumber);
  command->add_flag("!--no-cgal", options->cgal, "Without the base line");
  commands.push_back({command, [options](Report& report) { run(*options, report); }});
}

}  // namespace suture::bench
