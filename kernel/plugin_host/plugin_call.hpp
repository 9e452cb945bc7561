// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include "kernel/base/diagnostics.hpp"
#include "kernel/plugin_host/float_modes.hpp"
#include "suture/plugin.h"

namespace suture {

/// A call of a plugin's function, as a message describes it when the call fails. Everything except
/// `function` may be null. Lives on the caller's stack while the call is in progress.
struct PluginCall {
  const char* function = "";  ///< "force", "prepare"
  const suture_model* model = nullptr;
  const char* instance = nullptr;  ///< name of the model's use in the scene
  const suture_functor* functor = nullptr;
  const suture_attribute* attribute = nullptr;
  const char* file = nullptr;           ///< of the plugin, if no model is known yet
  const suture_batch* batch = nullptr;  ///< the current batch, whose cells a message names
};

/// The plugin call of this thread. Signal handlers read it on the same thread, and the watch on
/// calls that do not return (plugin_watch.hpp) on its own.
struct PluginThread {
  std::atomic<const PluginCall*> present = nullptr;  ///< null outside plugins
  std::atomic<std::uint64_t> calls = 0;              ///< number of scopes entered
  bool guarded = false;  ///< whether enter_plugin_thread was called for the thread
};
inline constinit thread_local PluginThread plugin_thread;
/// The call in progress on this thread, or null.
inline const PluginCall* present_call() {
  return plugin_thread.present.load(std::memory_order_relaxed);
}

/// Called when a thread first calls a plugin (plugin_faults.hpp); null without guards.
inline void (*enter_plugin_thread)() = nullptr;

/// Restores the floating-point modes that `call` has left changed, and has a warning issued once
/// per function.
void restore_modes(const PluginCall& call, const FloatModes& before);
/// Issues the warnings about calls that have ended since the last time. An atomic read if there are
/// none. Any thread.
void deliver_plugin_warnings(Diagnostics& diagnostics);

/// `call` is in progress as long as the scope lives. Costs a few nanoseconds: used once per chunk
/// of batches, not once per batch.
///
/// The floating-point modes are the same after the scope as before it. Otherwise a rounding mode
/// that a plugin has left behind would round all that this thread computes later, and which part of
/// a step that is differs from run to run.
class PluginScope {
 public:
  explicit PluginScope(const PluginCall& call)
      : call_(call), outer_(present_call()), modes_(FloatModes::now()) {
    if (!plugin_thread.guarded && enter_plugin_thread != nullptr) enter_plugin_thread();
    plugin_thread.calls.store(plugin_thread.calls.load(std::memory_order_relaxed) + 1,
                              std::memory_order_relaxed);
    plugin_thread.present.store(&call, std::memory_order_release);
  }
  ~PluginScope() {
    if (FloatModes::now() != modes_) [[unlikely]]
      restore_modes(call_, modes_);
    plugin_thread.present.store(outer_, std::memory_order_release);
  }
  PluginScope(const PluginScope&) = delete;
  PluginScope& operator=(const PluginScope&) = delete;

 private:
  const PluginCall& call_;
  const PluginCall* outer_;
  FloatModes modes_;
};

/// Registers the id and file of a loaded plugin for messages. The tables stay valid because
/// plugins are never unloaded.
void register_plugin(const suture_plugin& plugin, const std::filesystem::path& file);

/// Writes "plugin 'p' (p.so), model 'tissue' (m), functor 'edge springs', force of edges 8 to 15"
/// to `out`, terminated, at most `size` bytes; returns the length. Safe in signal handlers.
std::size_t describe(const PluginCall& call, char* out, std::size_t size);
std::string describe(const PluginCall& call);

/// The text that a plugin wrote to its error record, terminated or not.
std::string text_of(const suture_error& error);

inline constexpr const char* exception_cure =
    "exceptions must not leave a plugin's functions: catch them, and return SUTURE_STOP with a "
    "message from functions that return a status";
/// In a catch block: what was thrown, such as "an exception of type int". Never rethrows it.
std::string text_of_exception();
/// In a catch block around a call: the call, what was thrown, and what the author should do.
std::string text_of_fault(const PluginCall& call);
/// True for SUTURE_FAULT and for a value that is not a status.
bool is_fault(suture_status status);
/// The same text for a status that is a fault.
std::string text_of_fault(const PluginCall& call, suture_status status, const suture_error& error);
/// Throws text_of_fault() as a PluginError.
[[noreturn]] void raise_exception_of(const PluginCall& call);
[[noreturn]] void raise_fault(const PluginCall& call, suture_status status,
                              const suture_error& error);

/// Runs f() as a call of a plugin; an exception of any type becomes a PluginError.
template <class F>
decltype(auto) call_plugin(const PluginCall& call, F&& f) {
  const PluginScope scope(call);
  try {
    return std::forward<F>(f)();
  } catch (...) {
    raise_exception_of(call);
  }
}

/// The same for a function that returns a status; a fault becomes a PluginError, too.
template <class F>
suture_status call_plugin(const PluginCall& call, const suture_error& error, F&& f) {
  const suture_status status = call_plugin(call, std::forward<F>(f));
  if (is_fault(status)) raise_fault(call, status, error);
  return status;
}

/// The extension `id` of a functor; null if it has none.
template <class Extension>
const Extension* extension_of(const suture_functor& functor, const char* id) {
  if (functor.extension == nullptr) return nullptr;
  const PluginCall call{.function = "extension", .functor = &functor};
  return static_cast<const Extension*>(call_plugin(call, [&] { return functor.extension(id); }));
}

}  // namespace suture
