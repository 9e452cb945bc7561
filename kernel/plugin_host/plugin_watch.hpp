// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/plugin_host/plugin_call.hpp"

namespace suture {

/// The watch on calls of plugins that do not return. A thread looks at all others that call
/// plugins, ten times a second. It ends the program if one call
///   has used `limit` seconds of its thread's CPU time,
///   has waited for `limit` seconds, in all of which its thread used no CPU time (it sleeps, waits
///   for a lock, or for input), or
///   is still in progress almost a second after interrupt_plugin_calls().
/// Time is counted in looks, so time during which a debugger or a signal has stopped the program
/// does not count. A thread of its own is needed because signals would interrupt calls that sleep,
/// and because a plugin can block signals.
void limit_plugin_calls(double seconds);  ///< 0: no limit, but interruptions take effect

/// The call in progress on this thread, or else on another one that is watched; null if there is
/// none. For signal handlers that end the program: the other call may return meanwhile.
const PluginCall* call_in_progress();

/// The calling thread is watched as long as the object lives. The first one starts the watch.
class WatchedThread {
 public:
  WatchedThread();
  ~WatchedThread();
  WatchedThread(const WatchedThread&) = delete;
  WatchedThread& operator=(const WatchedThread&) = delete;

  struct Record;

 private:
  Record* record_;
};

}  // namespace suture
