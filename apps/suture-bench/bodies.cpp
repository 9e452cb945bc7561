// SPDX-License-Identifier: GPL-3.0-or-later
//
// A body of the paper's Table 1 as a surface, to be looked at or filled by hand.
#include <cstdio>
#include <filesystem>

#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/paper_body.hpp"
#include "kernel/geometry/surface_file.hpp"

namespace suture::bench {
namespace {

struct SurfaceOptions {
  std::string name;
  std::filesystem::path to;
  double size = 0;
};

void run_bodies(const SurfaceOptions& options, Report&) {
  const BodyPreset& preset = body_preset(options.name);
  const TriangleSurface surface = generate_body(preset.parameters, options.size);
  write_surface(options.to, surface);
  const Vec3 &p = preset.cut_point, &n = preset.cut_normal;
  std::printf(
      "%s: %zu triangles; the paper's mesh: suture mesh voxelize --cells %zu, its cut: point "
      "[%g, %g, %g], normal [%g, %g, %g]\n",
      options.to.c_str(), surface.triangles.size(), preset.cells, p[0], p[1], p[2], n[0], n[1],
      n[2]);
}

}  // namespace

void add_bodies(CommandLine& line) {
  auto [command, options] =
      line.add("body", "The surface of a body of the paper's Table 1", run_bodies);
  command.option("name", &options.name, "frog, elephant, mushroom or giraffe").required();
  command.option("-o,--output", &options.to, "Output file (.stl .obj .off .ply)").required();
  command.option("--size", &options.size, "Approximate edge length of its triangles in m")
      .positive();
  command.only_by_name();
}

}  // namespace suture::bench
