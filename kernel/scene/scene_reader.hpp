// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/base/diagnostics.hpp"
#include "kernel/scene/scene.hpp"

namespace suture {

class PluginHost;

/// What the reader needs from plugins.
struct ModelLookup {
  /// The table of a model; throws PluginError.
  std::function<const suture_model&(std::string_view id)> model;
  /// Registers a plugin file named in the scene, before any model is requested.
  std::function<void(const std::filesystem::path&)> add_plugin;
};

/// Reads and checks a scene; nothing is built. `sets` are the texts of --set. Throws IoError if the
/// file cannot be read, SceneError at the first syntax error or with all other mistakes
/// ("FILE:LINE:COLUMN: PATH: ..." each), PluginError if all mistakes are in plugins, UsageError for
/// a --set with an invalid pointer. Warns of values that are legal but unusual.
Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& sets,
                 PluginHost& host, Diagnostics& diagnostics);

/// The same from a text; `file` is the name for messages, and mesh and plugin files are relative to
/// its folder. `mesh`: the mesh, if the program has it; the scene then contains no source of one.
/// `output_folder`: if not empty, it replaces /output/directory of a scene that has an output.
Scene read_scene_text(std::string_view text, const std::filesystem::path& file,
                      const std::vector<std::string>& sets, const ModelLookup& lookup,
                      Diagnostics& diagnostics, std::shared_ptr<const Mesh> mesh = {},
                      const std::filesystem::path& output_folder = {});
/// The same from a file.
Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& sets,
                 const ModelLookup& lookup, Diagnostics& diagnostics,
                 std::shared_ptr<const Mesh> mesh, const std::filesystem::path& output_folder = {});
ModelLookup lookup_of(PluginHost& host);

/// Reads the scene again from Scene::source, in any working folder and even if its file has
/// changed: without `sets` it has the same hash. Mesh, blade and plugin files are read from their
/// original locations.
Scene read_scene_source(const SceneSource& source, const std::vector<std::string>& sets,
                        PluginHost& host, Diagnostics& diagnostics);
Scene read_scene_source(const SceneSource& source, const std::vector<std::string>& sets,
                        const ModelLookup& lookup, Diagnostics& diagnostics);

/// Reads an event without a time, such as {"cut": {"faces": [[4, 5]]}}, to apply to a run of
/// `scene` at once. `name` is the name of the text in messages. Throws SceneError with all
/// mistakes.
Event read_event(std::string_view text, const std::string& name, const Scene& scene,
                 Diagnostics& diagnostics);

/// Reads parameters of a model of a scene during its run, such as {"E": 2e4}; the others keep their
/// values `now` (Instance::parameters()). `name` is the name of the text in messages. Throws
/// SceneError with all mistakes.
std::vector<double> read_parameters(std::string_view text, const std::string& name,
                                    const suture_model& model, std::span<const double> now);

/// Names of the output fields available to every scene, independent of its models.
const std::vector<std::string>& standard_fields();
/// Names of those available if a model provides the element field "stress" (6 components).
const std::vector<std::string>& stress_fields();
/// Names of those available if the scene has obstacles.
const std::vector<std::string>& contact_fields();

}  // namespace suture
