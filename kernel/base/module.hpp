// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace suture {

/// The folder with lib/suture to which this code belongs: for a program in PREFIX/bin, PREFIX; for
/// a library (the Python module), the nearest folder above it that contains lib/suture.
std::filesystem::path own_prefix();

/// Loads one of Suture's own shared modules (NOW, LOCAL, never unloaded) and returns its `symbol`.
/// `file` is a file name without a folder, such as "libsuture-vtk.so". It is searched for in
/// SUTURE_MODULE_PATH (one folder), then in lib/suture and lib/<arch>/suture of own_prefix() (the
/// build tree or an installation), then in the installation folder
/// given at build time. Throws IoError with the message of the loader and the paths tried.
void* module_symbol(const std::string& file, const char* symbol);

}  // namespace suture
