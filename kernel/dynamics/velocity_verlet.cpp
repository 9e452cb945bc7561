// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/integrators.hpp"

namespace suture {
namespace {

/// Half a kick, x' = x + h v, half a kick with a(x'); kicks as in symplectic Euler. The second
/// half kick is left to the next step, where both are made in one pass over the vertices;
/// synchronise() makes it at once, with the same rounding. So there is one evaluation of forces
/// per step. Viscous forces see the velocity half a step before the positions: first order in dt.
class VelocityVerlet final : public Integrator {
 public:
  using Integrator::Integrator;

  /// The forces are those at the end of the step before, so its dt is theirs: they
  /// must not be computed again when the velocities have had their half kick.
  void begin(double dt) override {
    dt_ = dt;
    motion_.evaluate(explicit_step(dt).forces_dt);
  }

  void accept(double end) override {
    const Kick half(motion_.damping(), dt_ / 2);
    const Kick kicks[2] = {pending_, half};
    if (is_pending_)
      motion_.kick_and_drift(kicks, dt_, end, motion_.last_step());
    else
      motion_.kick_and_drift({&half, 1}, dt_, end, 0);
    pending_ = half;
    is_pending_ = true;
  }

  ExplicitStep explicit_step(double dt) const override {
    const Kick half(motion_.damping(), dt / 2);
    Kick whole;
    whole.decay = pending_.decay * half.decay;
    whole.gain = half.decay * pending_.gain + half.gain;
    return {is_pending_ ? whole : half, motion_.last_step() != 0 ? motion_.last_step() : dt};
  }

  void reject() override { motion_.discard_forces(); }

  bool is_lagging() const override { return is_pending_; }
  Kick lacking() const override { return is_pending_ ? pending_ : Kick(); }

  void synchronise() override {
    if (!is_pending_) return;
    motion_.kick(pending_);
    is_pending_ = false;
  }
  bool waits() const override { return is_pending_; }

  void state(Archive& archive) override {
    archive("decay", pending_.decay);
    archive("gain", pending_.gain);
    archive("is pending", is_pending_);
  }

 private:
  double dt_ = 0;
  Kick pending_;  ///< the half kick that the velocities lack
  bool is_pending_ = false;
};

}  // namespace

std::unique_ptr<Integrator> make_velocity_verlet(Motion& motion, const IntegratorOptions&) {
  return std::make_unique<VelocityVerlet>(motion);
}

}  // namespace suture
