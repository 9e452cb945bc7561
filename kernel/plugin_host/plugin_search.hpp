// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kernel/plugin_host/note_reader.hpp"

namespace suture {

/// A plugin file with what its note says.
struct PluginFile {
  std::filesystem::path file;  ///< absolute
  std::string name;            ///< "NAME" of NAME.so, NAME.avx2.so, NAME.avx512.so
  PluginNote note;
};

/// A folder in which plugins are looked for, and why.
struct PluginFolder {
  std::filesystem::path path;
  std::string origin;  ///< "SUTURE_PLUGIN_PATH", for messages
};

/// SUTURE_PLUGIN_PATH (':' between folders), the user's folder
/// ($XDG_DATA_HOME/suture/plugins, else ~/.local/share/suture/plugins), then
/// relative to the program: ../<libdir>/suture/plugins (installed) and
/// ../lib/suture/plugins (build tree). Each folder once, whether it exists or not.
std::vector<PluginFolder> plugin_folders();

/// The name that the builds of one plugin share: file name without ".so" and
/// without ".avx512" or ".avx2".
std::string plugin_name(const std::filesystem::path& file);

/// All files *.so of a folder with their notes, ordered by name, then the best
/// instruction set first. None if there is no such folder.
std::vector<PluginFile> plugin_files(const std::filesystem::path& folder);

/// Of the builds of one plugin (same folder, same name) the best one that this
/// processor runs; the first if none does. `builds` is not empty.
const PluginFile& best_build(const std::vector<PluginFile>& builds);

/// The builds beside `file` that share its name, itself included: a scene names
/// NAME.so and gets NAME.avx512.so where the processor runs it. A file that
/// names an instruction set means that build only. Empty if there is none.
std::vector<PluginFile> builds_of(const std::filesystem::path& file);

}  // namespace suture
