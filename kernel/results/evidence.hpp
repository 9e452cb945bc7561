// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "kernel/build/built_scene.hpp"
#include "kernel/output/frame.hpp"
#include "kernel/output/output_folder.hpp"

namespace suture {

/// The visual evidence of a failed run: failed.pvd with the last good state and the one that
/// failed, both with displacement, velocity and, on elements, "failure": 0 sound, 1 inverted (a
/// corner Jacobian <= 0), 2 not finite. Nodes that are not finite are drawn at their last finite
/// positions.
class Evidence {
 public:
  /// The current state is the one that failed.
  Evidence(BuiltScene& built, double time);
  void add_last_good(BuiltScene& built, double time);
  /// Returns a sentence that says what was written, or why it could not be written.
  std::string write(std::shared_ptr<OutputFolder> folder);

 private:
  Frame failed_;
  std::optional<Frame> good_;
};

}  // namespace suture
