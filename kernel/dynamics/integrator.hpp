// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kernel/dynamics/motion.hpp"

namespace suture {

/// A scheme that makes the steps of a motion. One file each; integrators.cpp lists them.
///
/// A step begins, and is then either accepted or rejected; only then may another begin.
class Integrator {
 public:
  explicit Integrator(Motion& motion) : motion_(motion) {}
  virtual ~Integrator() = default;

  /// Does everything of a step of dt that a term may refuse. Throws what terms throw
  /// (StepRejected: a smaller step may help); the state before is whole then.
  virtual void begin(double dt) = 0;
  /// Makes the step that began: positions and velocities are those of `end` (= time() + dt, but
  /// for rounding). Throws NotFinite.
  virtual void accept(double end) = 0;
  /// Drops the step that began, as if it had not.
  virtual void reject() = 0;

  /// The velocities are those of half a step before the positions.
  virtual bool is_lagging() const { return false; }
  /// The kick that they lack to be those of the positions' time.
  virtual Kick lacking() const { return {}; }
  /// A step of this length changes where the velocities are in time.
  virtual bool is_other_step(double dt) const;
  /// Gives the velocities what they lack, if that leaves the steps to come as they are. The
  /// forces are evaluated.
  virtual void synchronise() {}
  /// synchronise() has something to do.
  virtual bool waits() const { return false; }
  /// Besides the motion's.
  virtual void state(Archive&) {}

 protected:
  Motion& motion_;
};

/// By its name in scenes: "symplectic-euler". Throws InputError for another.
std::unique_ptr<Integrator> make_integrator(const std::string& name, Motion& motion);
/// All names, the default first.
std::span<const char* const> integrator_names();

}  // namespace suture
