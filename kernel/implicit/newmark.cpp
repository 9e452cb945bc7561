// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/integrators.hpp"
#include "kernel/implicit/implicit_integrator.hpp"

namespace suture {
namespace {

/// The average acceleration method (Newmark, J. Eng. Mech. Div. ASCE 85 (1959) 67; beta = 1/4,
/// gamma = 1/2): second order, and without damping for linear forces.
///   x' = x + h v + h^2 (a + a') / 4,   v' = v + h (a + a') / 2
/// In positions, with x* = x + h v + h^2 a / 4:
///   a' = 4 (x' - x*) / h^2,   v' = v + h a / 2 + 2 (x' - x*) / h
/// a is that of the forces at the start of the step, so that nothing beside x and v is kept.
class Newmark final : public ImplicitIntegrator {
 public:
  using ImplicitIntegrator::ImplicitIntegrator;

 private:
  void set(StepEquations& equations) override {
    const double h = equations.dt;
    equations.rate = 2 / h;
    equations.acceleration = 4 / (h * h);
    equations.start_position = h * h / 4;
    equations.start_velocity = h / 2;
    Attributes& attributes = motion_.body().attributes();
    const Residual now(motion_);
    for (Index vertex = 0; vertex < attributes.vertex_count(); ++vertex) {
      if (!(attributes.mass().get(vertex, 0) > 0)) continue;
      const Vec3 a = now.acceleration(vertex);
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t i = std::size_t{vertex} * 4 + c;
        equations.position[i] += h * equations.velocity[i] + equations.start_position * a[c];
        equations.velocity[i] += equations.start_velocity * a[c];
      }
    }
  }
};

}  // namespace

std::unique_ptr<Integrator> make_newmark(Motion& motion, const IntegratorOptions& options) {
  return std::make_unique<Newmark>(motion, options);
}

}  // namespace suture
