// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "kernel/dynamics/clock.hpp"
#include "kernel/results/recorder.hpp"

namespace suture {

/// Decides when frames and rows are due, and records each once.
class Records {
 public:
  Records(BuiltScene& built, Recorder& recorder, const Clock& clock)
      : built_(built), recorder_(recorder), clock_(clock) {}

  /// The current value, m/s^2.
  Vec3 gravity() const { return built_.body().acceleration(clock_.time()); }
  /// Records what is due at the current step, unless that has been done. `last_dt`: dt of the
  /// previous step.
  bool are_done() const { return recorded_ == clock_.step(); }
  void record(double last_dt);
  /// Records the last frame and rows of a run, if its state is one to record; waits until
  /// everything is on disk.
  void finish(double last_dt, bool records_state);
  /// Call after a rollback to an earlier step, which was recorded before it was kept.
  void roll_back();
  /// For a run whose first results are those after now: frames have the numbers that they would
  /// have had with those before.
  void begin_here();
  void state(Archive& archive);

 private:
  bool frame_is_due() const;
  bool is_reached(std::size_t frame) const;
  void write_frame();
  void record_tables(double last_dt, bool last);

  BuiltScene& built_;
  Recorder& recorder_;
  const Clock& clock_;
  static constexpr std::uint64_t never = ~std::uint64_t{0};
  std::uint64_t recorded_ = never, last_frame_ = never, last_energies_ = never,
                last_probes_ = never, last_tools_ = never;  ///< steps
};

}  // namespace suture
