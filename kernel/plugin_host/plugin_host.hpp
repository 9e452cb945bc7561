// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/base/diagnostics.hpp"
#include "kernel/base/isa.hpp"
#include "kernel/plugin_host/plugin_search.hpp"
#include "suture/plugin.h"

namespace suture {

/// Finds, checks and loads plugins; never unloads them. For use on one thread.
///
/// A plugin NAME is up to three files in one folder, NAME.so, NAME.avx2.so and
/// NAME.avx512.so, of which the best that the processor supports is used. The models
/// in a file are read from its note, so only plugins that are used are loaded.
///
/// Search order: the files named in the scene, in the scene's order; the folders of
/// SUTURE_PLUGIN_PATH; the user's plugin folder; the installation folder; the build
/// tree. Within a folder: first the plugin that has the name of the model, then by
/// name. If two plugins have the model, the first is used and a warning names both.
class PluginHost {
 public:
  /// Which plugins may be loaded. Loading a plugin runs its code.
  enum class Trust {
    all,         ///< also files that a scene names, wherever they are
    search_path  ///< only files in the folders that are searched
  };

  /// Reads the environment but no files. `diagnostics` receives warnings; may be null.
  explicit PluginHost(Diagnostics* diagnostics = nullptr, Trust trust = Trust::all);
  ~PluginHost();
  PluginHost(const PluginHost&) = delete;
  PluginHost& operator=(const PluginHost&) = delete;

  /// Adds a plugin file named in a scene, already resolved against the scene's folder.
  /// "NAME.so" (".so" may be left out) means the best of NAME's builds beside it.
  /// Throws PluginError if the file does not exist or is refused by its note.
  void add_file(const std::filesystem::path& file);

  /// The ids of the models in these files, by their notes.
  std::vector<std::string> models_of_files() const;

  /// The model `id`; loads the one plugin that has it, once. The reference is
  /// valid as long as the program runs. Throws PluginError with the file and the
  /// loader's text or the problems of the tables; for a file that is not trusted; or,
  /// if no plugin has the model, with the nearest id, the folders searched, the files
  /// refused there and a hint.
  /// Cost: reads the notes of all files on the search path once (10 us per file).
  const suture_model& model(std::string_view id);

  /// The builds that this processor runs of the plugin that model(id) would load, the best first;
  /// loads none of them. Throws the same errors.
  std::vector<PluginFile> builds(std::string_view id);

  /// The plugin of a model that model() returned.
  const suture_plugin& plugin_of(const suture_model& model) const;
  std::filesystem::path file_of(const suture_model& model) const;

  /// One plugin file on the search path, as its note describes it; not loaded.
  struct Listing {
    std::filesystem::path file;
    std::string plugin;               ///< empty if the file has no note
    std::vector<std::string> models;  ///< ids
    std::string isa;                  ///< "avx512", "avx2", "base"
    std::string problem;              ///< why it would be refused or not used, else empty
  };
  /// Every plugin file in search order, for `suture models`.
  std::vector<Listing> list() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace suture
