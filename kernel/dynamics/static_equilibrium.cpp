// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "kernel/dynamics/implicit_integrator.hpp"
#include "kernel/dynamics/integrators.hpp"

namespace suture {
namespace {

/// Equilibria, one after the other: f(x, time) + m g = 0 at the end of each step. Time is only the
/// parameter of ramps, motions and events; nothing has a velocity.
class StaticEquilibrium final : public ImplicitIntegrator {
 public:
  using ImplicitIntegrator::ImplicitIntegrator;
  bool is_static() const override { return true; }

 private:
  void set(StepEquations& equations) override { std::ranges::fill(equations.velocity, 0.0); }
};

}  // namespace

std::unique_ptr<Integrator> make_static_equilibrium(Motion& motion,
                                                    const IntegratorOptions& options) {
  return std::make_unique<StaticEquilibrium>(motion, options);
}

}  // namespace suture
