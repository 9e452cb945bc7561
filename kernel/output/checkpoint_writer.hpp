// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>

#include "kernel/output/checkpoint_file.hpp"
#include "kernel/output/output_folder.hpp"

namespace suture {

struct CheckpointWriterOptions {
  std::shared_ptr<OutputFolder> folder;
  unsigned keep = 2;                     ///< number of files kept, at least 1
  std::filesystem::path resumed_from{};  ///< the checkpoint from which the run resumes; or empty
  std::uint64_t resumed_number = 0;      ///< from its header
};

/// Writes checkpoint_0001.h5, ... on a separate thread while the simulation continues. A file
/// appears complete or not at all; the oldest beyond `keep` is removed only when the new one is
/// on disk.
///
/// A resumed run continues after the number from which it was resumed. That file and those with
/// lower numbers in the same folder belong to the run from the constructor on; those with higher
/// numbers were written before it was resumed and are stale (OutputFolder).
///
/// Errors of the writing thread are thrown, once, as IoError by the next submit() or by
/// finish(); a checkpoint that is waiting then is dropped, those already written stay.
class CheckpointWriter {
 public:
  explicit CheckpointWriter(CheckpointWriterOptions options);
  /// Writes what is waiting; its errors are lost, so call finish() first.
  ~CheckpointWriter();
  CheckpointWriter(const CheckpointWriter&) = delete;
  CheckpointWriter& operator=(const CheckpointWriter&) = delete;

  /// Submits a checkpoint and assigns its number; returns at once unless one is already
  /// waiting while another is being written.
  void submit(CheckpointHeader header, StateTree&& state);
  /// Returns when everything is on disk.
  void finish();

  /// The newest complete file of this run; else the one it was resumed from; else empty.
  std::filesystem::path newest() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace suture
