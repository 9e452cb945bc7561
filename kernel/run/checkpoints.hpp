// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

#include "kernel/build/built_scene.hpp"
#include "kernel/dynamics/clock.hpp"
#include "kernel/output/checkpoint_writer.hpp"
#include "kernel/output/output_folder.hpp"
#include "kernel/plugin_host/plugin_host.hpp"

namespace suture {

class Simulation;

/// Hash of the elements of a body as it was built, where they are at rest, and what differs between
/// them.
std::string mesh_hash(Body& body);

/// What the checkpoints of a run say about it. Call before it makes a step. O(elements).
CheckpointHeader checkpoint_header(BuiltScene& built, const PluginHost& host);
/// Throws InputError or PluginError if a checkpoint, read from `file`, belongs to another mesh,
/// version or model than a run with this header.
void require_fit(const CheckpointHeader& checkpoint, const CheckpointHeader& run,
                 const std::filesystem::path& file);
/// Saves a run that writes no results, to a file of its own. `header`: its checkpoint_header().
/// Throws IoError.
void save_checkpoint(Simulation& run, CheckpointHeader header, const std::filesystem::path& file);
/// Calls load(); its errors name the checkpoint's file.
void load_checkpoint(const std::filesystem::path& file, const std::function<void()>& load);

/// Decides when a checkpoint is due and writes it. Costs nothing if the scene requests none.
class Checkpoints {
 public:
  Checkpoints(BuiltScene& built, const PluginHost& host, std::shared_ptr<OutputFolder> folder);

  /// Call between two steps, once per step.
  bool is_due(const Clock& clock) const;
  bool is_enabled() const { return options_.enabled; }
  /// Saves the state now and writes it on another thread. Throws the IoError of the previous
  /// checkpoint, if any. Of several processes, process 0 writes it.
  template <class Run>
  void write(const Clock& clock, Run& run) {
    if (writing_.folder->is_silent()) {
      DroppingWriter dropped;
      run.state(dropped);
    } else {
      StateTree tree;
      save_state(tree, run);
      write(header_at(clock), std::move(tree));
    }
    note_written(clock);
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
    load_checkpoint(file, [&] { load_state(checkpoint.state, run); });
    continue_from(checkpoint.header, file, clock);
  }

 private:
  using Wall = std::chrono::steady_clock;
  const CheckpointHeader& header_at(const Clock& clock);
  void write(const CheckpointHeader& header, StateTree&& state);
  void note_written(const Clock& clock);
  void check(const CheckpointHeader& header, const std::filesystem::path& file);
  void take_folder(const CheckpointHeader& header, const std::filesystem::path& file);
  void continue_from(const CheckpointHeader& header, const std::filesystem::path& file,
                     const Clock& clock);

  BuiltScene& built_;
  const PluginHost& host_;
  CheckpointOptions options_;
  CheckpointHeader header_;
  CheckpointWriterOptions writing_;
  std::unique_ptr<CheckpointWriter> writer_;
  std::uint64_t last_step_ = 0;
  double last_time_ = 0;
  Wall::time_point written_ = Wall::now();
};

}  // namespace suture
