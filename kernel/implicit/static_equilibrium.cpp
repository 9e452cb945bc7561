// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <optional>
#include <utility>

#include "kernel/dynamics/integrators.hpp"
#include "kernel/implicit/arc_length.hpp"
#include "kernel/implicit/implicit_integrator.hpp"
#include "kernel/implicit/load_steps.hpp"

namespace suture {
namespace {

/// Equilibria, one after the other: f(x, time) + m g = 0 at the end of each step. Time is only the
/// parameter of ramps, motions and events; nothing has a velocity. Where loads and motions go on as
/// before, the next equilibrium is near  x + dt (x - x_before) / dt_before. What a cut releases in
/// a step does not go on: the change before it does.
class StaticEquilibrium final : public ImplicitIntegrator {
 public:
  StaticEquilibrium(Motion& motion, const IntegratorOptions& options)
      : ImplicitIntegrator(motion, options), path_(motion, *newton(), options.forbids_inversion) {
    if (options.follows_path) arc_length_.emplace(path_);
  }
  bool is_static() const override { return true; }

  void accept(double end) override {
    ImplicitIntegrator::accept(end);
    const bool was_cut = std::exchange(is_cut_, false);
    if (dt() == 0) return;  // the equilibrium after an event
    if (was_cut && !change_.empty()) return;
    const double* x = motion_.body().attributes().position().rows();
    change_.resize(start().size());
    for (std::size_t i = 0; i < change_.size(); ++i) change_[i] = (x[i] - start()[i]) / dt();
  }

  /// Copies of vertices go on like these.
  void follow(const TopologyChange& change) override {
    ImplicitIntegrator::follow(change);
    is_cut_ = true;
    if (change_.empty()) return;
    change_.resize(std::size_t{motion_.body().attributes().vertex_count()} * 4);
    for (const Split& split : change.splits[0])
      std::copy_n(change_.begin() + std::ptrdiff_t{split.old_cell} * 4, 4,
                  change_.begin() + std::ptrdiff_t{split.new_cell} * 4);
  }

  void state(Archive& archive) override {
    ImplicitIntegrator::state(archive);
    archive("change", change_);
    archive("is_cut", is_cut_);
    if (!archive.loads()) return;
    const std::size_t size = std::size_t{motion_.body().attributes().vertex_count()} * 4;
    archive.require(change_.empty() || change_.size() == size,
                    "the change of the positions belongs to a different body");
  }

 private:
  /// Contact is not predicted.
  void set(StepEquations& equations) override {
    std::ranges::fill(equations.velocity, 0.0);
    equations.is_predicted =
        !change_.empty() && equations.dt > 0 && motion_.body().contact() == nullptr;
    if (!equations.is_predicted) return;
    for (std::size_t i = 0; i < change_.size(); ++i)
      equations.position[i] += equations.dt * change_[i];
  }
  void solve(const StepEquations& equations) override {
    if (arc_length_)
      arc_length_->solve(equations);
    else
      LoadSteps(path_).solve(equations);
  }

  std::vector<double> change_;  ///< of the positions with the time, rows of 4, m/s; empty: unknown
  bool is_cut_ = false;         ///< since the last equilibrium
  LoadPath path_;
  std::optional<ArcLength> arc_length_;
};

}  // namespace

std::unique_ptr<Integrator> make_static_equilibrium(Motion& motion,
                                                    const IntegratorOptions& options) {
  return std::make_unique<StaticEquilibrium>(motion, options);
}

}  // namespace suture
