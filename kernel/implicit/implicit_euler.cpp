// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/integrators.hpp"
#include "kernel/implicit/implicit_integrator.hpp"

namespace suture {
namespace {

/// v' = v + h a(x', v'),   x' = x + h v'. First order; it damps fast modes strongly. In positions,
/// with x* = x + h v:
///   v' = v + (x' - x*) / h,   a = (x' - x*) / h^2
class ImplicitEuler final : public ImplicitIntegrator {
 public:
  using ImplicitIntegrator::ImplicitIntegrator;

 private:
  void set(StepEquations& equations) override {
    const double h = equations.dt;
    equations.rate = 1 / h;
    equations.acceleration = 1 / (h * h);
    for (std::size_t i = 0; i < equations.position.size(); ++i)
      equations.position[i] += h * equations.velocity[i];
  }
};

}  // namespace

std::unique_ptr<Integrator> make_implicit_euler(Motion& motion, const IntegratorOptions& options) {
  return std::make_unique<ImplicitEuler>(motion, options);
}

}  // namespace suture
