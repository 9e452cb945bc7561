// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// What a run reports to its caller: decisions before it, progress during it, a summary after it.

#include <cstdint>
#include <optional>
#include <string>

#include "kernel/operations/removed_matter.hpp"

namespace suture {

/// One decision made when the scene was compiled into a run.
struct Decision {
  std::string subject;  ///< "edge ids", "functor tissue/inner springs", "writer"
  bool skipped = false;
  std::string reason;  ///< "no model and no event works on 1-cells"
};

/// The progress of a run, passed to the observer a few times a second.
struct Progress {
  std::uint64_t step = 0;
  double time = 0;      ///< s simulated
  double end = 0;       ///< s; 0 if the run ends at rest
  double residual = 0;  ///< |f| / |f_ext|, for runs until rest; else 0
  double tolerance = 0;
  unsigned iteration = 0;  ///< of Newton's method in the next step, which left `residual`; else 0
  double elements_per_second = 0;
  double seconds_left = -1;  ///< ETA; < 0: unknown
};

/// Observes a run and can stop it. Called on the thread of the run, and between steps unless said
/// otherwise.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void on_progress(const Progress&) {}    ///< also within a step that solves equations
  virtual void on_message(const std::string&) {}  ///< "t = 0.5 s: cut 25 faces, 2 islands"
  virtual void on_detail(const std::string&) {}  ///< convergence of implicit steps, errors of steps
  virtual bool stop_requested() { return false; }
  /// Asked within steps that solve equations: true gives the step up, and the run is as it was
  /// before it. stop_requested() is asked next, and has to be true, too.
  virtual bool gives_up_step() { return false; }
};

struct RunSummary {
  enum class Outcome { finished, at_rest, interrupted, unstable_equilibrium };
  Outcome outcome = Outcome::finished;
  std::uint64_t steps = 0, frames = 0, inverted_elements = 0;
  std::uint64_t faces_cut = 0, faces_torn = 0, faces_sewn = 0, elements_removed = 0;
  std::uint64_t elements_cut = 0;    ///< along the blade
  std::uint64_t events_skipped = 0;  ///< could not be carried out
  RemovedMatter debris;
  double volume_at_start = 0;   ///< m^3; Debris::volume_at_start()
  std::uint64_t rollbacks = 0;  ///< number of rollbacks
  /// J: the unexplained remainder without its recoverable part, and its scale; 0: rounding.
  double balance = 0, exchanged = 0;
  double time = 0, dt = 0;  ///< s; dt of the last step
  // Steps that follow their error:
  std::uint64_t rejected_steps = 0;
  double shortest_dt = 0, longest_dt = 0;  ///< s, accepted; 0: dt does not follow the error
  double seconds = 0;                      ///< wall clock of the loop
  double elements_per_second = 0;
  /// The lowest eigenvalue of the tangent at rest, 1/s^2; none if it was not computed.
  std::optional<double> lowest_eigenvalue;
  unsigned threads = 1;
  std::string pvd;  ///< file to open in ParaView, or ""
};

/// Where Simulation::advance() pauses; neither: at the end of the run.
struct Pause {
  std::optional<double> time{};          ///< s: before the first step that begins at or after it
  std::optional<std::uint64_t> steps{};  ///< after this number of steps
};

/// The estimated cost of a run, from the compiled scene and a few timed steps.
struct Estimate {
  std::uint64_t steps = 0;  ///< 0: unknown (until rest)
  std::uint64_t frames = 0;
  double dt = 0, stable_dt = 0;   ///< s
  bool dt_follows_error = false;  ///< dt is a mean
  double seconds_per_step = 0, seconds = 0;
  double bytes = 0;  ///< peak of the process
};

}  // namespace suture
