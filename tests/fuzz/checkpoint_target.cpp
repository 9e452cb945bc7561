// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/output/checkpoint_file.hpp"
#include "kernel/run/simulation.hpp"
#include "tests/fuzz/input_file.hpp"
#include "tests/fuzz/small_scene.hpp"
#include "tests/fuzz/targets.hpp"

namespace suture::fuzz {
namespace {

// Where the run wrote does not exist here.
Scene scene_of(const CheckpointHeader& header, const std::filesystem::path& output,
               Diagnostics& diagnostics) {
  Scene scene = read_scene_source({header.scene_text, header.scene_file, header.working_folder},
                                  {R"(/output/directory="out")"}, shipped_models(), diagnostics);
  scene.output.directory = output;
  return scene;
}

}  // namespace

void checkpoint(std::string_view bytes) {
  answered([&] {
    const std::filesystem::path file = input_file("c.h5", bytes);
    const Checkpoint checkpoint = read_checkpoint(file);
    Diagnostics diagnostics;
    Scene scene = scene_of(checkpoint.header, file.parent_path() / "out", diagnostics);
    if (!is_small(scene.mesh)) return;
    scene.solver.threads = 1;
    Simulation(scene, shipped_plugins(), diagnostics).resume(checkpoint, file);
  });
}

}  // namespace suture::fuzz
