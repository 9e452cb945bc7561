// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "suture/plugin.h"

namespace suture {

/// Finds, checks and loads plugins; never unloads them.
class PluginHost {
 public:
  /// Where plugins are looked for, in this order: SUTURE_PLUGIN_PATH, the user's
  /// plugin folder, the installed folder, the build tree.
  PluginHost();
  ~PluginHost();

  /// Plugin files named in a scene, relative to the scene's folder; searched first.
  void add_file(const std::filesystem::path& file);

  /// The model `id`; loads the one plugin that has it. By convention a plugin
  /// "NAME" (NAME.avx512.so, NAME.avx2.so, NAME.so: the best the processor runs)
  /// holds model NAME; notes of the other files are read (not loaded) to find an
  /// id elsewhere. Throws PluginError naming the file, the loader's text, the
  /// paths tried, the nearest id and a hint.
  const suture_model& model(std::string_view id);
  const suture_plugin& plugin_of(const suture_model& model) const;
  std::filesystem::path file_of(const suture_model& model) const;

  /// What `suture models` lists: every plugin file on the search path, read from
  /// its note without loading it; `problem` says why it would be refused.
  struct Listing {
    std::filesystem::path file;
    std::string plugin;
    std::vector<std::string> models;
    std::string isa;
    std::string problem;
  };
  std::vector<Listing> list() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Parameters by name as the scene gives them -> doubles in declared order, with
/// defaults filled in, is the business of scene/: it has the positions.

/// The best instruction set this processor runs: "avx512", "avx2" or "".
/// SUTURE_ISA=avx2|base in the environment lowers it (for tests).
std::string_view best_isa();

}  // namespace suture
