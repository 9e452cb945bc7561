// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>

#include "kernel/dynamics/integrators.hpp"
#include "kernel/implicit/implicit_integrator.hpp"

namespace suture {
namespace {

/// v' = v + h a(x', v'),   x' = x + h v'. First order; it damps fast modes strongly. With a budget,
/// steps are on time instead of solved (budgeted_step.cpp). In positions,
/// with x* = x + h v:
///   v' = v + (x' - x*) / h,   a = (x' - x*) / h^2
class ImplicitEuler final : public ImplicitIntegrator {
 public:
  ImplicitEuler(Motion& motion, const IntegratorOptions& options)
      : ImplicitIntegrator(motion, options) {
    if (options.budget) clock_.emplace(*options.budget);
  }
  bool is_solved() const override { return !clock_; }
  void prepare(double dt) override {
    if (clock_) newton()->prepare(*equations(dt));
  }
  void accept(double end) override {
    ImplicitIntegrator::accept(end);
    if (clock_) clock_->end();
  }
  void state(Archive& archive) override {
    ImplicitIntegrator::state(archive);
    if (clock_) newton()->budget_state(archive);
  }

 private:
  void find(const StepEquations& equations) override {
    if (clock_)
      newton()->take_step(equations, *clock_);
    else
      ImplicitIntegrator::find(equations);
  }
  void set(StepEquations& equations) override {
    if (clock_) clock_->begin();
    const double h = equations.dt;
    equations.rate = 1 / h;
    equations.acceleration = 1 / (h * h);
    for (std::size_t i = 0; i < equations.position.size(); ++i)
      equations.position[i] += h * equations.velocity[i];
  }

  std::optional<StepClock> clock_;  ///< with a budget
};

}  // namespace

std::unique_ptr<Integrator> make_implicit_euler(Motion& motion, const IntegratorOptions& options) {
  return std::make_unique<ImplicitEuler>(motion, options);
}

}  // namespace suture
