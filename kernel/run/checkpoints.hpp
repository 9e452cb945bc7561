// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

#include "kernel/build/built_scene.hpp"
#include "kernel/dynamics/clock.hpp"
#include "kernel/output/checkpoint_writer.hpp"
#include "kernel/plugin_host/plugin_host.hpp"

namespace suture {

/// Hash of the elements of a body as it was built, where they are at rest, and what differs between
/// them.
std::string mesh_hash(Body& body);

/// Decides when a checkpoint is due and writes it. Costs nothing if the scene requests none.
class Checkpoints {
 public:
  Checkpoints(BuiltScene& built, const PluginHost& host, std::shared_ptr<OutputFolder> folder);

  /// Call between two steps, once per step.
  bool is_due(const Clock& clock) const;
  bool is_enabled() const { return options_.enabled; }
  /// Saves the state now and writes it on another thread. Throws the IoError of the previous
  /// checkpoint, if any.
  template <class Run>
  void write(const Clock& clock, Run& run) {
    StateTree tree;
    save_state(tree, run);
    write(clock, std::move(tree));
  }
  void finish();
  /// The newest complete checkpoint, or "".
  std::string newest() const;

  /// Resumes from a checkpoint: loads its state into `run`, which must be as built from the scene.
  /// Throws InputError for a checkpoint of a different mesh, model or format, and IoError if the
  /// output folder has the results of another run.
  template <class Run>
  void resume(const Checkpoint& checkpoint, const std::filesystem::path& file, const Clock& clock,
              Run& run) {
    check(checkpoint.header, file);
    take_folder(checkpoint.header, file);
    load(file, [&] { load_state(checkpoint.state, run); });
    continue_from(checkpoint.header, file, clock);
  }

 private:
  using Wall = std::chrono::steady_clock;
  void write(const Clock& clock, StateTree&& state);
  void check(const CheckpointHeader& header, const std::filesystem::path& file) const;
  void take_folder(const CheckpointHeader& header, const std::filesystem::path& file);
  static void load(const std::filesystem::path& file, const std::function<void()>& load);
  void continue_from(const CheckpointHeader& header, const std::filesystem::path& file,
                     const Clock& clock);

  BuiltScene& built_;
  CheckpointOptions options_;
  CheckpointHeader header_;
  CheckpointWriterOptions writing_;
  std::unique_ptr<CheckpointWriter> writer_;
  std::uint64_t last_step_ = 0;
  double last_time_ = 0;
  Wall::time_point written_ = Wall::now();
};

}  // namespace suture
