// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/base/diagnostics.hpp"
#include "kernel/base/isa.hpp"
#include "suture/plugin.h"

namespace suture {

/// Finds, checks and loads plugins; never unloads them. For use on one thread.
///
/// A plugin NAME is up to three files in one folder, NAME.so, NAME.avx2.so and
/// NAME.avx512.so; the best that the processor runs stands for all. Which models
/// a file has is read from its note, so nothing is loaded but what is used.
///
/// Search order: files named in the scene in the scene's order, the folders of
/// SUTURE_PLUGIN_PATH, the user's plugin folder, the installed folder, the build
/// tree; within a folder the plugin that is named like the model, then by name.
/// If two plugins have the model, the first is used and a warning names both.
class PluginHost {
 public:
  /// Whose code may run. Loading a plugin runs its code.
  enum class Trust {
    all,         ///< also files that a scene names, wherever they lie
    search_path  ///< files in the folders that are searched
  };

  /// Reads the environment, no file. `diagnostics` gets the warnings, may be null.
  explicit PluginHost(Diagnostics* diagnostics = nullptr, Trust trust = Trust::all);
  ~PluginHost();
  PluginHost(const PluginHost&) = delete;
  PluginHost& operator=(const PluginHost&) = delete;

  /// A plugin file named in a scene, already resolved against the scene's folder.
  /// "NAME.so" (".so" may be left out) means the best of NAME's builds beside it.
  /// Throws PluginError if there is no such file or it is refused by its note.
  void add_file(const std::filesystem::path& file);

  /// The model `id`; loads the one plugin that has it, once. The reference is
  /// valid as long as the program runs. Throws PluginError naming the file, the
  /// loader's text or the tables' faults; for a file that is not trusted; or, if no
  /// plugin has the model, the nearest id, the places searched, the files refused
  /// there and a hint.
  /// Cost: the notes of all files on the search path once (10 us per file).
  const suture_model& model(std::string_view id);

  /// Of a model that model() returned.
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
  /// What `suture models` shows: every plugin file in search order.
  std::vector<Listing> list() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace suture
