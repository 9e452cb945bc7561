// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace suture {

/// The folder of the program's executable.
std::filesystem::path executable_folder();

/// Loads one of Suture's own shared modules (NOW, LOCAL, never unloaded) and returns its `symbol`.
/// `file` is a file name without a folder, such as "libsuture-vtk.so". It is searched for in
/// SUTURE_MODULE_PATH (one folder), then in ../lib/suture and ../lib/<arch>/suture relative to the
/// executable's folder (in the build tree and in an installation), then in the installation folder
/// given at build time. Throws IoError with the message of the loader and the paths tried.
void* module_symbol(const std::string& file, const char* symbol);

}  // namespace suture
