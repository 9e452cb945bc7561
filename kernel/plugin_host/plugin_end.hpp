// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "kernel/plugin_host/plugin_call.hpp"

namespace suture {

inline constexpr int exit_plugin = 4, exit_interrupted = 130;

/// A call in progress with its batch, copied without trusting a pointer: the plugin may have
/// overwritten them, or another thread may be about to replace them. Safe in signal handlers.
class CallSnapshot {
 public:
  /// `call`: in progress on any thread.
  explicit CallSnapshot(const PluginCall* call);
  CallSnapshot(const CallSnapshot&) = delete;
  CallSnapshot& operator=(const CallSnapshot&) = delete;

  /// Without a batch if there is none that can be read.
  const PluginCall& call() const { return call_; }
  /// The first cell of the batch, or UINT32_MAX.
  std::uint32_t first_cell() const { return call_.batch != nullptr ? ids_[0] : UINT32_MAX; }

 private:
  void copy_batch();

  PluginCall call_;
  suture_batch batch_{};
  std::array<std::uint32_t, SUTURE_LANES> ids_{};
};
/// Call it once before the first snapshot. Throws IoError.
void prepare_snapshots();

/// Says what happened in a call, and ends the program. Safe in signal handlers. If several threads
/// call it, the first speaks.
[[noreturn]] void end_program(const PluginCall* call, const char* what, const char* cure,
                              int code = exit_plugin);

}  // namespace suture
