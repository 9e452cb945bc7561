// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "kernel/operations/event_runner.hpp"
#include "kernel/output/frame_sink.hpp"
#include "kernel/results/fields.hpp"

namespace suture {

/// A series of files beside the frames of a run, with one file per frame: NAME_0000.vtu, ...,
/// listed in NAME.pvd.
struct SideSeries {
  const char* name = "";
  /// Sets the points, cells and fields of a frame.
  std::function<void(Frame& frame, double time, const Vec3& gravity)> fill;
  std::unique_ptr<FrameSink> sink;
};

/// The series that a scene requests:
///  - springs, faces: the cells of dimension 1 or 2 of all instances, with their fields;
///  - obstacles: their surfaces, with the field "obstacle" (its index in the scene);
///  - surface: that of a body with partial elements (part_frames.hpp);
///  - cuts: both sides of every face that a cut or tear opened and that is still open, with the
///    fields "event" (its index in the scene) and "opened" (s); and the blades that are present
///    ("blade" is 1), moving ones as lines, surfaces as triangles.
/// Keeps references to `fields`, `built` and `events`.
std::vector<SideSeries> side_series(const OutputOptions& options,
                                    const std::vector<FieldChoice>& fields, BuiltScene& built,
                                    const EventRunner& events);

}  // namespace suture
