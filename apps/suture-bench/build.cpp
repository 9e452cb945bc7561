// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <numeric>
#include <random>

#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/topology/import.hpp"

namespace suture::bench {
namespace {

struct BuildOptions {
  std::vector<Index> sides{20, 50, 100};
  unsigned rounds = 5;
};

/// Elements and points in random order: connectivity as foreign meshers may write it.
void shuffle(Mesh& mesh) {
  std::mt19937 random(1);
  std::vector<Index> place(mesh.points.size());
  std::iota(place.begin(), place.end(), Index{0});
  std::shuffle(place.begin(), place.end(), random);
  std::vector<Vec3> points(mesh.points.size());
  for (std::size_t p = 0; p < place.size(); ++p) points[place[p]] = mesh.points[p];
  mesh.points = std::move(points);
  for (Hexahedron& h : mesh.hexahedra)
    for (Index& v : h) v = place[v];
  std::shuffle(mesh.hexahedra.begin(), mesh.hexahedra.end(), random);
}

void measure_grid(Index side, bool shuffled, unsigned rounds, Report& report) {
  std::vector<double> import, edges, faces, all;
  std::size_t bytes = 0;
  double elements = 0;
  for (unsigned round = 0; round < rounds; ++round) {
    const auto n = static_cast<double>(side);
    Mesh mesh = make_box({.size = {n, n, n}, .cells = {side, side, side}});
    mesh.point_sets.clear();
    if (shuffled) shuffle(mesh);
    elements = static_cast<double>(mesh.hexahedra.size());
    Diagnostics diagnostics;
    const double start = now(1);
    Imported in = import_mesh(std::move(mesh), {}, diagnostics);
    const double imported = now(1);
    in.complex.require_edges();
    const double with_edges = now(1);
    in.complex.require_faces();
    const double end = now(1);
    import.push_back(imported - start);
    edges.push_back(with_edges - imported);
    faces.push_back(end - with_edges);
    all.push_back(end - start);
    bytes = in.complex.memory();
  }
  const double us = 1e6 / elements;
  report.add(Line()
                 .add("elements", elements)
                 .add("order", shuffled ? "random" : "natural")
                 .add("import us/hex", us * median(import))
                 .add("edges us/hex", us * median(edges))
                 .add("faces us/hex", us * median(faces))
                 .add("all us/hex", us * median(all))
                 .add("map B/hex", static_cast<double>(bytes) / elements));
}

void run_build(const BuildOptions& options, Report& report) {
  report.begin("build",
               "checks, renumbering, matching, vertex, edge and face ids of a cube of cubes; "
               "medians, processor time");
  for (const Index side : options.sides)
    for (const bool shuffled : {false, true}) measure_grid(side, shuffled, options.rounds, report);
}

}  // namespace

void add_build(CommandLine& line) {
  auto [command, options] = line.add("build", "Time and memory of the map, from a mesh", run_build);
  command.option("--sides", &options.sides, "n of the grids n x n x n (171: 5 million)");
  command.option("--rounds", &options.rounds, "Repetitions of each figure").positive();
}

}  // namespace suture::bench
