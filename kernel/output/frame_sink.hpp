// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

#include "kernel/base/archive.hpp"
#include "kernel/output/frame.hpp"

namespace suture {

/// Where the frames of a series go: files (FrameWriter), or whatever shows them while the run goes
/// on. Frames arrive in order, and only when their step can no longer be rejected.
class FrameSink {
 public:
  virtual ~FrameSink() = default;

  /// A frame to fill: one that the sink no longer needs, with stale contents, or an empty one.
  /// Assigning to its vectors avoids the page faults of fresh memory: 216,000 hexahedra with
  /// displacement and velocity take 3.5 ms instead of 14.
  virtual Frame take_frame() = 0;
  /// Submits a frame; returns at once unless many are already waiting. Throws
  /// std::invalid_argument for a field of the wrong length, and earlier errors of the sink.
  virtual void submit(Frame frame) = 0;
  /// Returns when every frame has arrived; throws the errors of the sink.
  virtual void finish() = 0;

  /// Where its frames can be found: for files, the list to open in ParaView.
  virtual std::string collection() const = 0;
  /// The number of frames of the part before a resumption that are gone.
  virtual std::size_t missing() const = 0;
  /// What a resumed run needs to continue the series.
  virtual void state(Archive& archive) = 0;
};

}  // namespace suture
