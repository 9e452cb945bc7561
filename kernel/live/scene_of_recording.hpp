// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kernel/live/recording.hpp"

namespace suture {

/// A scene that does by itself what was done to a run.
struct RecordedScene {
  std::string text;                   ///< JSON; files are relative to the folder of the first scene
  std::vector<std::string> left_out;  ///< inputs that a scene cannot say, one text for each
};

/// Makes events of inputs to a run of a scene (JSON text), at their times: motions of grasps and
/// obstacles become paths, swept surfaces become triangles. It ends at `end` (s). With an automatic
/// dt, steps end at these times, so states agree approximately. Throws InputError for an input that
/// is not understood.
RecordedScene scene_of(const std::string& scene, std::span<const RecordedInput> inputs, double end);

}  // namespace suture
