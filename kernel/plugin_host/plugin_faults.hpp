// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace suture {

/// From now on a plugin that crashes (SIGSEGV, SIGFPE, SIGBUS, SIGILL, SIGABRT, a stack
/// overflow), calls exit() or does not return (plugin_watch.hpp) ends the program with exit code 4
/// and a message that names plugin, model, functor and cells. Outside plugins, signals keep their
/// actions; a handler that is already installed (a sanitizer's) is left alone.
///
/// "Does not return": one call has used 20 s of its thread's CPU time, or has waited for 20 s
/// without using any; or the value of SUTURE_PLUGIN_TIMEOUT (seconds; 0: no limit). Throws
/// UsageError if the variable is not a number.
void guard_plugin_calls();

/// `leave`, which must be safe in signal handlers, is called before a fault of a plugin ends the
/// program.
void at_plugin_fault(void (*leave)());

/// Declares that the user wants the program to end: if a plugin's call does not return within a
/// second, the program ends with exit code 130. Safe in signal handlers.
void interrupt_plugin_calls();

/// If the caller is a plugin, or a thread that a plugin started, ends the program with a message
/// that `function` must not be called. Returns in a process that a plugin has forked.
void refuse_in_plugin(const char* function);

/// Ends the process at once, as _exit() does, which is not taken for a call of a plugin.
[[noreturn]] void leave_process(int code);

}  // namespace suture
