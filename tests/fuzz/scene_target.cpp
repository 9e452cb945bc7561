// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/build/built_scene.hpp"
#include "tests/fuzz/input_file.hpp"
#include "tests/fuzz/small_scene.hpp"
#include "tests/fuzz/targets.hpp"

namespace suture::fuzz {
namespace {

constexpr double max_elements = 200;

}  // namespace

bool is_small(const MeshSource& mesh) {
  if (mesh.voxels) {
    std::size_t cubes = 0;
    for (const std::string& row : mesh.voxels->rows) cubes += row.size();
    return static_cast<double>(cubes) * mesh.voxels->layers <= max_elements;
  }
  if (!mesh.box) return false;
  const auto& cells = mesh.box->cells;
  return double(cells[0]) * double(cells[1]) * double(cells[2]) <= max_elements;
}

PluginHost& shipped_plugins() {
  static PluginHost host;
  return host;
}

ModelLookup shipped_models() {
  return {[](std::string_view id) -> const suture_model& { return shipped_plugins().model(id); },
          [](const std::filesystem::path&) {}};
}

void scene(std::string_view bytes) {
  answered([&] {
    Diagnostics diagnostics;
    Scene scene =
        read_scene_text(bytes, input_file("s.json", bytes), {}, shipped_models(), diagnostics);
    if (!is_small(scene.mesh)) return;
    scene.solver.threads = 1;
    try {
      BuiltScene(scene, diagnostics);
    } catch (const InputError& error) {
      scene.places.rethrow(error);
    }
  });
}

}  // namespace suture::fuzz
