// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "kernel/live/live_run.hpp"
#include "kernel/run/simulation.hpp"

namespace suture::python {

namespace py = pybind11;

class Session;

/// Python functions that are called between steps of a run.
class Callbacks {
 public:
  /// After every `steps` steps.
  void add_every(std::uint64_t steps, py::function call);
  /// Once, before the first step that begins at or after `time`.
  void add_at(double time, py::function call);
  bool is_due(std::uint64_t step, double time) const;
  /// Calls those that are due, each once per step, with the simulation. Stops at the first
  /// exception.
  void call_due(std::uint64_t step, double time, const py::object& simulation);
  /// The run is at an earlier or later state: those that were due by then count as called.
  void rewind(std::uint64_t step, double time);
  int traverse(visitproc visit, void* argument) const;
  void clear() { entries_.clear(); }

 private:
  struct Entry {
    std::uint64_t every = 0;  ///< steps; 0: once, at
    double at = 0;            ///< s
    py::function call{};
    std::uint64_t last = 0;  ///< step of the last call
    bool done = false;
    bool is_due(std::uint64_t step, double time) const;
  };
  std::vector<Entry> entries_;
};

/// Observes a run for Python: calls callbacks and the handlers of signals, so that Ctrl-C works
/// while the GIL is released. An exception of either stops the run between two steps and is kept.
class Observing final : public Observer {
 public:
  Callbacks callbacks;
  std::vector<std::string> messages;
  std::exception_ptr failure;  ///< of a callback or a signal handler, until it is rethrown
  bool in_callback = false;

  explicit Observing(Session& session) : session_(session) {}
  /// A function (step, time, end), or None; set with the GIL held.
  py::object progress;

  LiveRun* live = nullptr;  ///< shows the steps of the script

  void on_message(const std::string& text) override;
  void on_progress(const Progress& now) override;
  bool stop_requested() override;
  bool gives_up_step() override;

 private:
  using Clock = std::chrono::steady_clock;
  /// Calls f with the GIL held; keeps its exception.
  template <class F>
  void call(F&& f);
  void look_for_signals();

  Session& session_;
  Clock::time_point signals_due_{};
};

}  // namespace suture::python
