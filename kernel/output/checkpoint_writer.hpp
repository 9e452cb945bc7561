// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>

#include "kernel/output/checkpoint_file.hpp"
#include "kernel/output/output_folder.hpp"

namespace suture {

struct CheckpointWriterOptions {
  std::shared_ptr<OutputFolder> folder;
  unsigned keep = 2;                     ///< files that stay, at least 1
  std::filesystem::path resumed_from{};  ///< the checkpoint that the run goes on from; empty: none
  std::uint64_t resumed_number = 0;      ///< of its header
};

/// Writes checkpoint_0001.h5, ... on a thread of its own while the simulation goes on. A file
/// appears complete or not at all; the oldest beyond `keep` goes only when the new one is on
/// the disk.
///
/// A run that was resumed goes on behind the number that it was resumed from, whose file and
/// those before it, in the same folder, count as its own from the constructor on. Those behind it
/// are what this run did before, and stale (OutputFolder).
///
/// Errors of the writing thread are thrown, once, as IoError by the next submit() or by
/// finish(); a checkpoint that waits then is dropped, those written stay.
class CheckpointWriter {
 public:
  explicit CheckpointWriter(CheckpointWriterOptions options);
  /// Writes what waits; errors are lost, therefore call finish() before.
  ~CheckpointWriter();
  CheckpointWriter(const CheckpointWriter&) = delete;
  CheckpointWriter& operator=(const CheckpointWriter&) = delete;

  /// Hands a checkpoint over, which gets its number here; returns at once unless one waits
  /// already while another is written.
  void submit(CheckpointHeader header, StateTree&& state);
  /// Returns when everything is on disk.
  void finish();

  /// The newest file that is whole: of this run, else the one it was resumed from, else empty.
  std::filesystem::path newest() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace suture
