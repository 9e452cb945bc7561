// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/base/diagnostics.hpp"
#include "kernel/scene/scene.hpp"

namespace suture {

class PluginHost;

/// What the reader needs to know of plugins.
struct ModelLookup {
  /// The table of a model; throws PluginError.
  std::function<const suture_model&(std::string_view id)> model;
  /// Makes a plugin file named in the scene known, before any model is asked for.
  std::function<void(const std::filesystem::path&)> add_plugin;
};

/// Reads and checks a scene; nothing is built. `sets` are the texts of --set.
/// Throws IoError if the file cannot be read, InputError at the first error of
/// syntax or with all errors of meaning ("FILE:LINE:COLUMN: PATH: ..." each),
/// PluginError if all that is wrong are plugins, UsageError for a --set that
/// leads nowhere. What is legal but odd is warned of.
Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& sets,
                 PluginHost& host, Diagnostics& diagnostics);

/// The same from a text; `file` gives the name for messages and the folder that
/// mesh and plugin files are relative to.
Scene read_scene_text(std::string_view text, const std::filesystem::path& file,
                      const std::vector<std::string>& sets, const ModelLookup& lookup,
                      Diagnostics& diagnostics);

/// The scene that Scene::source was read from, whatever became of its file and in any working
/// folder: without `sets` it has the same hash. Mesh, blade and plugin files are read where
/// they were.
Scene read_scene_source(const SceneSource& source, const std::vector<std::string>& sets,
                        PluginHost& host, Diagnostics& diagnostics);
Scene read_scene_source(const SceneSource& source, const std::vector<std::string>& sets,
                        const ModelLookup& lookup, Diagnostics& diagnostics);

/// Names of output fields that every scene may ask for, whatever its models.
const std::vector<std::string>& standard_fields();

}  // namespace suture
