// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

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

/// The plugin call of this thread. Signal handlers read it, only on the same thread.
struct PluginThread {
  const PluginCall* present = nullptr;  ///< null outside plugins
  std::uint64_t calls = 0;              ///< number of scopes entered
  bool guarded = false;                 ///< whether enter_plugin_thread was called for the thread
};
inline constinit thread_local PluginThread plugin_thread;

/// Called when a thread first calls a plugin (plugin_faults.hpp); null without guards.
inline void (*enter_plugin_thread)() = nullptr;

/// `call` is in progress as long as the scope lives. Costs a nanosecond: used once per chunk of
/// batches, not once per batch.
class PluginScope {
 public:
  explicit PluginScope(const PluginCall& call) : outer_(plugin_thread.present) {
    if (!plugin_thread.guarded && enter_plugin_thread != nullptr) enter_plugin_thread();
    ++plugin_thread.calls;
    plugin_thread.present = &call;
  }
  ~PluginScope() { plugin_thread.present = outer_; }
  PluginScope(const PluginScope&) = delete;
  PluginScope& operator=(const PluginScope&) = delete;

 private:
  const PluginCall* outer_;
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
