// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "kernel/build/built_scene.hpp"
#include "kernel/plugin_host/plugin_host.hpp"

namespace suture {

/// How results were made.
struct Provenance {
  /// For each file: versions, hash of the scene, mesh, plugins.
  std::string line;
  /// provenance.json, what it takes to repeat the run: the program, the machine, the scene with all
  /// changes, and the files and plugins that it uses, with their sizes and hashes (XXH64). Times,
  /// folders and threads are left out: on one machine, equal runs write equal texts. Only several
  /// processes name themselves, with their machines, threads and shares of the body.
  /// Reads all files of the scene once, at the speed of the disk.
  std::function<std::string()> json;
};

std::string provenance_line(const Scene& scene, PluginHost& host, const BuiltScene& built);

/// Both arguments must outlive it.
Provenance provenance_of(PluginHost& host, const BuiltScene& built);

}  // namespace suture
