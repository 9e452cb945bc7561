// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace suture {

/// Folder of the running program's executable.
std::filesystem::path executable_folder();

/// Loads one of Suture's own shared modules (NOW, LOCAL, never unloaded) and
/// returns its `symbol`. `file` is a bare name, "libsuture-vtk.so"; looked for
/// in SUTURE_MODULE_PATH (one folder), then ../lib/suture and
/// ../lib/<arch>/suture beside the executable's folder (build tree and
/// installation alike), then the folder given at build time for installation.
/// Throws IoError naming the loader's text and the paths tried.
void* module_symbol(const std::string& file, const char* symbol);

}  // namespace suture
