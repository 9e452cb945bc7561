// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kernel/base/archive.hpp"
#include "kernel/base/file.hpp"

namespace suture {

/// What a checkpoint holds about the run besides its state.
struct CheckpointHeader {
  struct Plugin {
    std::string id, version, file;
    void state(Archive& archive);
  };
  std::string program;         ///< "suture 0.1.0"
  std::string isa;             ///< instruction set of the loops
  std::string scene_text;      ///< complete, after --set
  std::string scene_file;      ///< absolute; files are relative to its folder
  std::string working_folder;  ///< absolute; the output folder is relative to it
  std::string scene_hash;
  std::string mesh_source, mesh_hash;
  std::vector<Plugin> plugins;
  std::string run;  ///< identity of the run: equal if all bits of the results are equal
  /// Index of the checkpoint in its run, from 1; set by CheckpointWriter. 0: no results belong to
  /// it.
  std::uint64_t number = 0;
  std::uint64_t step = 0;
  double time = 0;  ///< s
  /// What was done to a live run since its scene began, as lines of a recording (docs/live.md).
  /// Other runs do not say it.
  std::optional<std::string> inputs;

  void state(Archive& archive);
};

struct Checkpoint {
  CheckpointHeader header;
  StateTree state;
};

/// Writes one file and returns when it is on disk. The file is HDF5 after a block of 512 bytes
/// that holds its version, length and checksum: the attributes of the root group and the group
/// `plugins` are the header, the group `state` is the state, group by group. Arrays of the state
/// are freed as they are written. Throws IoError.
void write_checkpoint(OutputFile& file, CheckpointHeader header, StateTree&& state);

/// The same for a file of its own, which appears complete or not at all. Throws IoError.
void write_checkpoint(const std::filesystem::path& path, CheckpointHeader header,
                      StateTree&& state);

/// Whether a file begins like a checkpoint; false if it cannot be read.
bool is_checkpoint(const std::filesystem::path& path);
/// Throws an InputError that says why a file cannot be read: it does not exist, is a folder, is of
/// another kind or version of the format, is truncated or damaged.
Checkpoint read_checkpoint(const std::filesystem::path& path);

/// The name of a file, checkpoint_0042.h5: the number has four digits or more.
std::string checkpoint_name(std::uint64_t number);
/// The numbers of the files with such names in a folder, ascending.
std::vector<std::uint64_t> checkpoints_in(const std::filesystem::path& folder);

}  // namespace suture
