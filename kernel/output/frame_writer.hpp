// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "kernel/output/frame_sink.hpp"
#include "kernel/output/output_folder.hpp"

namespace suture {

struct FrameWriterOptions {
  enum class Compression { raw, lz4, zlib };
  std::shared_ptr<OutputFolder> folder;
  std::string prefix = "frame";    ///< frame_0042.vtu
  std::string collection = "run";  ///< run.pvd
  Compression compression = Compression::lz4;
  /// Each process that makes the run writes a piece of each frame (frame_pieces.hpp),
  /// frame_0042_1.vtu, and then process 0 frame_0042.pvtu.
  bool in_pieces = false;
  bool background = true;   ///< write on a separate thread, unless processes wait for each other
  std::size_t waiting = 2;  ///< frames that may wait before submit() blocks
};

/// Writes frames as `.vtu`, surfaces as `.vtp` (appended raw data), or pieces of them, and lists
/// them in a `.pvd`, on a separate thread while the simulation continues. A frame appears complete
/// or not at all, and then the list is replaced: ParaView can read the files at any time, and every
/// listed frame is complete whenever the program ends.
///
/// For what happens to the results of an earlier run in the folder, see OutputFolder.
///
/// Errors of the writing thread are thrown, once, as IoError (with the path and the
/// text of the system's error) by the next submit() or by finish(); frames that are
/// waiting then are dropped, those already written stay.
class FrameWriter final : public FrameSink {
 public:
  explicit FrameWriter(FrameWriterOptions options);
  /// Writes what is waiting; its errors are lost, so call finish() first.
  ~FrameWriter() override;
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;

  Frame take_frame() override;
  void submit(Frame frame) override;
  /// Returns when everything is on disk; throws IoError if files are missing.
  void finish() override;

  /// Saving stores the list of frames, all of which are on disk then; after loading, the list is
  /// continued. Later frames are stale from the next write to the folder on, at the latest from
  /// finish(). Frames of the list whose files are missing are removed from it.
  void state(Archive& archive) override;
  /// The number of frames whose files were missing when the state was loaded.
  std::size_t missing() const override;

  std::size_t written() const;  ///< frames so far
  std::string collection() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace suture
