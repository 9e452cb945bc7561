// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kernel/plugin_host/note_reader.hpp"

namespace suture {

/// A plugin file and its note.
struct PluginFile {
  std::filesystem::path file;  ///< absolute
  std::string name;            ///< "NAME" of NAME.so, NAME.avx2.so, NAME.avx512.so
  PluginNote note;
};

/// A folder that is searched for plugins, and the reason.
struct PluginFolder {
  std::filesystem::path path;
  std::string origin;  ///< "SUTURE_PLUGIN_PATH", for messages
};

/// SUTURE_PLUGIN_PATH (':' between folders), the user's folder
/// ($XDG_DATA_HOME/suture/plugins, else ~/.local/share/suture/plugins), then
/// relative to the program, ../<libdir>/suture/plugins (installed) and
/// ../lib/suture/plugins (build tree). Each folder once, whether or not it exists.
std::vector<PluginFolder> plugin_folders();

/// The common name of the builds of one plugin: file name without ".so" and
/// without ".avx512" or ".avx2".
std::string plugin_name(const std::filesystem::path& file);

/// All files *.so of a folder with their notes, ordered by name, then the best
/// instruction set first. Empty if the folder does not exist.
std::vector<PluginFile> plugin_files(const std::filesystem::path& folder);

/// The best of the builds of one plugin (same folder, same name) that this processor
/// supports; the first if it supports none. `builds` is not empty.
const PluginFile& best_build(const std::vector<PluginFile>& builds);

/// The builds in the folder of `file` that share its name, including itself: a scene
/// names NAME.so and gets NAME.avx512.so if the processor supports it. A file name with
/// an instruction set means that build only. Empty if there is none.
std::vector<PluginFile> builds_of(const std::filesystem::path& file);

}  // namespace suture
