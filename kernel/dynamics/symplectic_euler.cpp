// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/integrators.hpp"

namespace suture {
namespace {

/// With a = f/m + g, h = dt, and damping integrated exactly (stable for any alpha h):
///   v' = e v + (1 - e)/alpha a(x, v),   x' = x + h v',   e = exp(-alpha h)
/// The velocities live in the middle of the steps, so that a kick goes from the middle of one to
/// the middle of the next.
class SymplecticEuler final : public Integrator {
 public:
  using Integrator::Integrator;

  void begin(double dt) override {
    dt_ = dt;
    motion_.evaluate(dt);
  }

  void accept(double end) override {
    const Kick kick = explicit_step(dt_).kick;
    motion_.kick_and_drift({&kick, 1}, dt_, end, motion_.last_step());
  }

  ExplicitStep explicit_step(double dt) const override {
    const double last = motion_.last_step();
    return {{motion_.damping(), last != 0 ? (last + dt) / 2 : dt}, dt};
  }

  void reject() override { motion_.discard_forces(); }

  bool is_lagging() const override { return motion_.last_step() != 0; }
  Kick lacking() const override {
    return is_lagging() ? Kick(motion_.damping(), motion_.last_step() / 2) : Kick();
  }
  /// But for the first step, whose kick is whole.
  bool is_other_step(double dt) const override {
    return motion_.last_step() != 0 && Integrator::is_other_step(dt);
  }

 private:
  double dt_ = 0;
};

}  // namespace

std::unique_ptr<Integrator> make_symplectic_euler(Motion& motion, const IntegratorOptions&) {
  return std::make_unique<SymplecticEuler>(motion);
}

}  // namespace suture
