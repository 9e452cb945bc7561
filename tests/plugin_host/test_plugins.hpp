// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace suture {

/// The folder of the plugins that the build makes of test_plugin.c and throwing_plugin.cpp.
inline const std::filesystem::path plugins = TEST_PLUGINS;

}  // namespace suture
