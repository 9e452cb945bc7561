// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "kernel/output/frame.hpp"
#include "kernel/scene/built_scene.hpp"

namespace suture {

/// What a run that fails leaves behind for the eye: failed.pvd with the last good state and the
/// one that failed, both with displacement, velocity and, on elements, "failure": 0 sound,
/// 1 inverted (a corner Jacobian <= 0), 2 not finite. Nodes that are not finite are shown where
/// they were last.
class Evidence {
 public:
  /// The state that failed is the present one.
  Evidence(BuiltScene& built, double time);
  void add_last_good(BuiltScene& built, double time);
  /// A sentence on what was written, or on why it could not be.
  std::string write(const std::filesystem::path& directory);

 private:
  Frame failed_;
  std::optional<Frame> good_;
};

}  // namespace suture
