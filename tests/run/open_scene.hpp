// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include "kernel/geometry/surface_file.hpp"
#include "kernel/operations/event_runner.hpp"
#include "kernel/output/frame_file.hpp"
#include "kernel/results/frame_parts.hpp"
#include "kernel/results/side_series.hpp"
#include "tests/geometry/surfaces.hpp"

namespace suture::test {

/// Makes a closed surface the body of a scene, filled with cubes.
inline void fill(Scene& scene, const TriangleSurface& surface, double edge) {
  const auto file = file_with("body.off", "");
  write_surface(file, surface);
  scene.mesh.box.reset();
  scene.mesh.filled = FilledBody{.file = file, .size = {.edge = edge}};
}

/// A scene that has been built, with what it shows.
struct OpenScene {
  explicit OpenScene(const Scene& of) : scene(of) {}

  Frame frame() {
    Frame frame;
    set_geometry(frame, built);
    fill_fields(fields, FieldChoice::On::points, {built, {}, 0}, frame.point_fields);
    fill_fields(fields, FieldChoice::On::cells, {built, {}, 0}, frame.cell_fields);
    leave_out(frame, built);
    check_frame(frame);
    return frame;
  }
  /// The first series beside the frames.
  Frame side(double time = 0) {
    Frame frame;
    side_series(scene.output, fields, built, events).at(0).fill(frame, time, {});
    check_frame(frame);
    return frame;
  }

  Scene scene;
  Diagnostics diagnostics;
  BuiltScene built{scene, diagnostics};
  EventRunner events{built.scene(), built, diagnostics};
  std::vector<FieldChoice> fields = choose_fields(built, scene.output);
};

}  // namespace suture::test
