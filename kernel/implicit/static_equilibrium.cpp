// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <optional>

#include "kernel/dynamics/integrators.hpp"
#include "kernel/implicit/arc_length.hpp"
#include "kernel/implicit/implicit_integrator.hpp"
#include "kernel/implicit/load_steps.hpp"

namespace suture {
namespace {

/// Equilibria, one after the other: f(x, time) + m g = 0 at the end of each step. Time is only the
/// parameter of ramps, motions and events; nothing has a velocity.
class StaticEquilibrium final : public ImplicitIntegrator {
 public:
  StaticEquilibrium(Motion& motion, const IntegratorOptions& options)
      : ImplicitIntegrator(motion, options), path_(motion, *newton(), options.forbids_inversion) {
    if (options.follows_path) arc_length_.emplace(path_);
  }
  bool is_static() const override { return true; }

 private:
  void set(StepEquations& equations) override { std::ranges::fill(equations.velocity, 0.0); }
  void solve(const StepEquations& equations) override {
    if (arc_length_)
      arc_length_->solve(equations);
    else
      LoadSteps(path_).solve(equations);
  }

  LoadPath path_;
  std::optional<ArcLength> arc_length_;
};

}  // namespace

std::unique_ptr<Integrator> make_static_equilibrium(Motion& motion,
                                                    const IntegratorOptions& options) {
  return std::make_unique<StaticEquilibrium>(motion, options);
}

}  // namespace suture
