// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/build/embedded_parts.hpp"
#include "kernel/geometry/moving_blade.hpp"
#include "kernel/geometry/surface_blade.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/operations/cut_along.hpp"

namespace suture::bench {
namespace {

struct BladeOptions {
  Index cells = 100;     ///< along each axis of the block that the blade of triangles cuts
  Index rows = 50;       ///< of 100 squares that make the blade, 200 triangles each
  Index moving = 50000;  ///< elements of the scene with the moving blade
  Index framed = 20000;  ///< elements of the body whose surface is made for a frame
  unsigned threads = 1;
  int rounds = 5;  ///< of dividing planes
  double seconds = 0.5;
};

/// A sheet with waves through the middle of the unit cube, larger than it; 2 x 100 triangles
/// per row of squares.
TriangleSurface sheet(const Vec3& normal, Index rows) {
  const double size = std::hypot(normal[0], normal[1], normal[2]);
  Vec3 n, u, v;
  for (int a = 0; a < 3; ++a) n[a] = normal[a] / size;
  const Vec3 axis = std::abs(n[0]) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  u = {n[1] * axis[2] - n[2] * axis[1], n[2] * axis[0] - n[0] * axis[2],
       n[0] * axis[1] - n[1] * axis[0]};
  v = {n[1] * u[2] - n[2] * u[1], n[2] * u[0] - n[0] * u[2], n[0] * u[1] - n[1] * u[0]};
  const Index columns = 100;
  TriangleSurface surface{"sheet", {}, {}};
  for (Index j = 0; j <= rows; ++j)
    for (Index i = 0; i <= columns; ++i) {
      const double x = 2.0 * i / columns - 1, y = 2.0 * j / rows - 1;
      const double wave = 0.03 * std::sin(9 * x) * std::cos(7 * y);
      Vec3& p = surface.points.emplace_back();
      for (int a = 0; a < 3; ++a) p[a] = 0.5 + x * u[a] + y * v[a] + wave * n[a];
    }
  for (Index j = 0; j < rows; ++j)
    for (Index i = 0; i < columns; ++i) {
      const Index p = i + (columns + 1) * j, q = p + columns + 1;
      surface.triangles.push_back({p, p + 1, q + 1});
      surface.triangles.push_back({p, q + 1, q});
    }
  return surface;
}

struct Block {
  CellComplex complex;
  std::vector<double> rows;
};

Block block_of(Index cells) {
  Mesh mesh = make_box({.cells = {cells, cells, cells}});
  Block block;
  for (const Vec3& p : mesh.points) block.rows.insert(block.rows.end(), {p[0], p[1], p[2], 0});
  block.complex = CellComplex(std::move(mesh.hexahedra), static_cast<Index>(mesh.points.size()));
  block.complex.require_edges();
  block.complex.require_faces();
  return block;
}

void measure_sheets(const BladeOptions& options, Report& report) {
  const Block block = block_of(options.cells);
  const Workers workers(options.threads);
  report.begin("blade triangles",
               "an oblique wavy sheet of triangles through a block, the whole cut: tree and grid "
               "built, faces found, map cut with vertices and edges; once each, " +
                   std::to_string(options.threads) + " thread(s)");
  const Vec3 normals[] = {{1, 0.3, 0.1}, {0.2, 1, 0.4}, {0.3, -0.5, 1}, {1, 1, 1}, {1, -1, 0.5}};
  for (const Vec3& normal : normals) {
    Diagnostics diagnostics;
    CellComplex complex = block.complex;
    const double start = now(options.threads);
    const SurfaceBlade blade(sheet(normal, options.rows), diagnostics);
    const double built = now(options.threads);
    const auto faces = blade.faces_cut(complex, {block.rows.data()}, &workers);
    const double found = now(options.threads);
    complex.cut(faces);
    const double done = now(options.threads);
    report.add(Line()
                   .add("elements", double(complex.element_count()))
                   .add("triangles", double(blade.surface().triangles.size()))
                   .add("normal", std::to_string(normal[0]).substr(0, 4) + " " +
                                      std::to_string(normal[1]).substr(0, 4) + " " +
                                      std::to_string(normal[2]).substr(0, 4))
                   .add("faces", double(faces.size()))
                   .add("blade s", built - start)
                   .add("faces found s", found - built)
                   .add("map cut s", done - found)
                   .add("total s", done - start));
  }
}

/// Steps in which the blade moves along the body, half an element beside it, and in its middle,
/// where it has cut before, so that it examines links and cuts nothing.
void measure_moving(const BladeOptions& options, Report& report) {
  PluginHost host;
  const auto cells = grid_of(options.moving);
  BenchBody body(host, {.model = "tm-faure", .cells = cells, .threads = options.threads});
  const Workers workers(options.threads);
  const double edge = 0.025;
  const Vec3 size{edge * cells[0], edge * cells[1], edge * cells[2]};
  const Places places{body.attributes().position().rows()};
  const double force =
      measure([&] { body.body().models().add_forces(0, 0); }, options.threads, options.seconds)
          .median;
  report.begin("blade moving",
               "a segment that moves 1/1000 of an element per step and cuts nothing, compared with "
               "one evaluation of the forces of tm-faure");
  const auto add = [&](const char* where, double y, double z) {
    const BladeKey from{0, {{-edge, y, z}, {size[0] + edge, y, z}}};
    BladeKey to = from;
    to.time = 1e6;
    for (Vec3& p : to.points) p[1] += 1e6 * edge / 1000;
    MovingBlade blade({from, to});
    double time = 0;
    std::size_t cut = 0;
    blade.advance(body.complex(), places, time, &workers);
    const double step =
        measure(
            [&] { cut += blade.advance(body.complex(), places, time += 1e-3, &workers).size(); },
            options.threads, options.seconds)
            .median;
    report.add(Line()
                   .add("elements", double(body.element_count()))
                   .add("blade", where)
                   .add("faces cut", double(cut))
                   .add("step ms", 1e3 * step)
                   .add("force ms", 1e3 * force)
                   .add("step/force", step / force));
  };
  add("outside the body", -2 * edge, 0.5 * size[2]);
  // Between two rows of centroids: near a layer of links, and the steps are too small to
  // reach them.
  add("in the body", (cells[1] / 2 + 0.1) * edge, (cells[2] / 2) * edge);
}

/// us per element that a plane divides.
struct DivisionTimes {
  double elements, divided, find, change, surface;
};

DivisionTimes time_division(BenchBody& body, EmbeddedParts& parts, const PlaneBlade& blade,
                            unsigned threads) {
  const double start = now(threads);
  const BladeCut cut =
      cut_along(body.complex(), parts.parts(), body.attributes().position().rows(), blade);
  const double found = now(threads);
  body.body().clone_volume(cut.cloning, cut.parts, [] {});
  const double changed = now(threads);
  parts.refine(cut.refined);
  parts.append(cut.parts, cut.cloning.origins);
  (void)parts.embedding(body.complex());
  const double done = now(threads);
  const double us = 1e6 / cut.divided;
  return {static_cast<double>(body.complex().existing(3)), static_cast<double>(cut.divided),
          us * (found - start), us * (changed - found), us * (done - changed)};
}

/// Oblique planes that divide the elements which they cross.
void measure_divisions(const BladeOptions& options, Report& report) {
  PluginHost host;
  const auto cells = grid_of(options.moving);
  report.begin(
      "blade divisions",
      "planes that divide the elements which they cross, one after the other, in a body of "
      "tm-faure; us per divided element: parts and joints found, map and columns changed, "
      "surface made again; medians of " +
          std::to_string(options.rounds));
  const double edge = 0.025;
  const Vec3 centre{edge * cells[0] / 2, edge * cells[1] / 2, edge * cells[2] / 2};
  const std::array<Vec3, 3> normals{{{0.2, 0.3, 1}, {-0.3, 0.4, 1}, {1, 0.5, 0.3}}};
  std::array<std::vector<DivisionTimes>, 3> times;
  for (int round = 0; round < options.rounds; ++round) {
    BenchBody body(
        host,
        {.model = "tm-faure", .cells = cells, .threads = options.threads, .may_divide = true});
    EmbeddedParts parts{Parts{}};
    parts.let_grow(body.complex());
    for (std::size_t i = 0; i < normals.size(); ++i)
      times[i].push_back(
          time_division(body, parts, PlaneBlade({centre, normals[i]}), options.threads));
  }
  for (const auto& plane : times) {
    const auto middle = [&](double DivisionTimes::*member) {
      std::vector<double> values;
      for (const DivisionTimes& t : plane) values.push_back(t.*member);
      return median(values);
    };
    const double find = middle(&DivisionTimes::find), change = middle(&DivisionTimes::change),
                 surface = middle(&DivisionTimes::surface);
    report.add(Line()
                   .add("elements", plane[0].elements)
                   .add("divided", plane[0].divided)
                   .add("find us", find)
                   .add("map and columns us", change)
                   .add("surface us", surface)
                   .add("total us", find + change + surface));
  }
}

/// What a frame needs of the embedded surface: made again after a cut, else its points only.
void measure_surface(const BladeOptions& options, Report& report) {
  PluginHost host;
  const auto cells = grid_of(options.framed);
  BenchBody body(
      host, {.model = "tm-faure", .cells = cells, .threads = options.threads, .may_divide = true});
  EmbeddedParts parts{Parts{}};
  parts.let_grow(body.complex());
  const double edge = 0.025;
  const Vec3 centre{edge * cells[0] / 2, edge * cells[1] / 2, edge * cells[2] / 2};
  const DivisionTimes cut =
      time_division(body, parts, PlaneBlade({centre, {0.2, 0.3, 1}}), options.threads);
  const double* rows = body.attributes().position().rows();
  const Embedding embedding(parts.parts(), body.complex());
  const auto median_ms = [&](const auto& work) {
    return 1e3 * measure(work, options.threads, options.seconds).median;
  };
  double sum = 0;
  report.begin("blade surface", "the embedded surface of a body that an oblique plane has divided");
  report.add(Line()
                 .add("elements", cut.elements)
                 .add("divided", cut.divided)
                 .add("triangles", double(embedding.triangles.size()))
                 .add("made again ms", median_ms([&] {
                        sum += double(Embedding(parts.parts(), body.complex()).points.size());
                      }))
                 .add("points ms", median_ms([&] {
                        for (std::size_t p = 0; p < embedding.points.size(); ++p)
                          for (std::size_t c = 0; c < 3; ++c)
                            sum += embedding.points.value(p, rows, 4, c);
                      }))
                 .add("checksum", sum));
}

void run_blade(const BladeOptions& options, Report& report) {
  measure_sheets(options, report);
  measure_moving(options, report);
  measure_divisions(options, report);
  measure_surface(options, report);
}

}  // namespace

void add_blade(CommandLine& line) {
  auto [command, options] = line.add("blade", "Blades of triangles, and moving ones", run_blade);
  command.option("--cells", &options.cells, "Elements along each axis of the block");
  command.option("--rows", &options.rows, "Blade: hundreds of squares");
  command.option("--moving", &options.moving, "Elements of the scene with a moving blade");
  command.option("--framed", &options.framed, "Elements of the body whose surface is made");
  command.option("--threads", &options.threads, "Threads").positive();
  command.option("--rounds", &options.rounds, "Bodies that planes divide").positive();
  command.option("--seconds", &options.seconds, "Time spent on each figure");
}

}  // namespace suture::bench
