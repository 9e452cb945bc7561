// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/plugin_host/plugin_host.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture::fuzz {

/// The plugins of the build.
PluginHost& shipped_plugins();
/// Plugins that a scene names are code, not input.
ModelLookup shipped_models();
/// True if the scene has a mesh of its own that takes little time to build.
bool is_small(const MeshSource& mesh);

}  // namespace suture::fuzz
