// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>
#include <utility>

#include "kernel/attributes/held.hpp"
#include "kernel/base/error.hpp"
#include "kernel/dynamics/integrators.hpp"
#include "kernel/dynamics/residual.hpp"
#include "kernel/forces/contact_law.hpp"

namespace suture {
namespace {

/// Position based dynamics with compliance, one iteration per step (a "substep" of Macklin et al.,
/// Small steps in physics simulation, SCA 2019):
///   v* = v + h (f_ext / m + g),   x* = x + h v*
///   x' = x*, and then moved cell by cell (force_loop_project.cpp)
///   v' = (x' - x) / h,   contact moves x' and v',   v' = exp(-alpha h) v'
/// f_ext: of all terms but the models, at the end of the step. Any step is bounded, but soft: it
/// leaves out a part h^2 w / 2 of the stiffness, unless cells compensate. What the kinetic energy
/// lacks after a step is booked as dissipated.
class Xpbd final : public Integrator {
 public:
  Xpbd(Motion& motion, bool compensates) : Integrator(motion), compensates_(compensates) {
    const std::string without = body().models().without_projection();
    if (!without.empty())
      throw InputError("the integrator 'xpbd' moves nodes by the energies of models, and " +
                       without + "; use another integrator or model");
  }

  bool is_implicit() const override { return true; }
  bool is_solved() const override { return false; }
  bool is_other_step(double) const override { return false; }

  void begin(double dt) override {
    start_.begin(motion_);
    dt_ = dt;
    const double end = motion_.time() + dt;
    predict(end);
    const ForceLoop::Softness step =
        body().models().project({end, dt, inverse_mass().data(),
                                 body().attributes().velocity().rows(), true, compensates_});
    softness_.energy += step.energy;
    softness_.missing += step.missing;
  }

  void accept(double end) override {
    find_velocities();
    const double contact = touch(end);
    damp();
    body().constraints().apply(body().attributes(), end);
    reach_states(end);
    motion_.arrive(dt_, end);
    withhold();
    StepSums sums = start_.sums(motion_, StepWork::Losses::all);
    sums.damped += contact;
    motion_.sums().add_step(sums);
  }

  void reject() override {
    start_.restore(motion_);
    motion_.discard_forces();
  }

  void forget_cells() override { inverse_mass_.clear(); }

  double softness() const override {
    return softness_.energy > 0 ? softness_.missing / softness_.energy : 0;
  }

  bool compensates() const override { return compensates_; }

  /// By w in a uniform deformation: at rest there is no energy, and at random all is stiff.
  double step_of_softness(double softness) override {
    constexpr double instant = 1e-9;  // s, in which what is missing grows with the square
    constexpr double gradient[3][3] = {
        {3e-4, 2e-4, 1e-4}, {-1e-4, 2e-4, 3e-4}, {2e-4, 1e-4, -3e-4}};
    Column& position = body().attributes().position();
    const std::vector<double> before(position.rows(), position.rows() + inverse_mass().size());
    for (std::size_t i = 0; i < before.size(); ++i)
      for (std::size_t c = 0; i % 4 != 3 && c < 3; ++c)
        position.rows()[i] += gradient[i % 4][c] * before[i / 4 * 4 + c];
    ForceLoop::Softness unit;
    try {
      unit =
          body().models().project({motion_.time(), instant, inverse_mass().data(), nullptr, false});
    } catch (...) {
      std::ranges::copy(before, position.rows());
      throw;
    }
    std::ranges::copy(before, position.rows());
    return unit.missing > 0
               ? instant * std::sqrt(softness / (1 - softness) * unit.energy / unit.missing)
               : std::numeric_limits<double>::infinity();
  }

  void state(Archive& archive) override {
    archive("energy", softness_.energy);
    archive("missing", softness_.missing);
    if (archive.loads()) inverse_mass_.clear();
  }

 private:
  Body& body() const { return motion_.body(); }

  void predict(double end) {
    Attributes& attributes = body().attributes();
    load_.assign(inverse_mass().size(), 0);
    for (const auto& term : body().loads()) term->add_forces(end, motion_.moving(), load_.data());
    const Vec3 gravity = body().acceleration(end);
    double *x = attributes.position().rows(), *v = attributes.velocity().rows();
    for_each_free([&](std::size_t i, double mass) {
      v[i] += dt_ * (load_[i] / mass + gravity[i % 4]);
      x[i] += dt_ * v[i];
    });
    body().constraints().apply(attributes, end);
  }

  /// visit(i, m): places in rows of 4 that move, and their masses.
  template <class Visit>
  void for_each_free(Visit visit) {
    const double* mass = body().attributes().mass().rows();
    const LiveMask& moving = motion_.moving();
    for (std::size_t i = 0; i < load_.size(); ++i)
      if (inverse_mass_[i] != 0 && moving[static_cast<Index>(i / 4)]) visit(i, mass[i / 4]);
  }

  void find_velocities() {
    const double* x = body().attributes().position().rows();
    double* v = body().attributes().velocity().rows();
    exerted_.assign(load_.size(), 0);
    for_each_free([&](std::size_t i, double mass) {
      v[i] = (x[i] - start_.position()[i]) / dt_;
      exerted_[i] = mass * (v[i] - start_.velocity()[i]) / dt_;
    });
  }

  /// Pushes out what has entered obstacles or other pieces, after all that cells have moved.
  /// Returns the work of contact, J. Its impulses act on the motion that the other forces have
  /// made.
  double touch(double end) {
    ContactLaw* contact = body().contact();
    if (!contact) return 0;
    double* force = body().attributes().force().rows();
    for_each_free([&](std::size_t i, double) { force[i] = exerted_[i]; });
    ContactStep step;
    step.time = motion_.time();
    step.end = end;
    step.dt = step.whole_gain = dt_;
    step.moving = &motion_.moving();
    contact->prepare(step);
    contact->resolve(step);
    return contact->step_work();
  }

  void damp() {
    double* v = body().attributes().velocity().rows();
    const double decay = std::exp(-motion_.damping() * dt_);
    for_each_free([&](std::size_t i, double) { v[i] *= decay; });
  }

  /// The states of models at the end: the pass has evaluated cells where others moved them on.
  void reach_states(double end) {
    if (!body().models().keeps_states()) return;
    load_.assign(load_.size(), 0);
    body().models().add_forces(end, dt_, ForceLoop::Part::all, load_.data());
  }

  /// At rest the step exerts nothing, though the forces there are not in balance.
  void withhold() {
    const double* force = body().attributes().force().rows();
    const Vec3 gravity = body().acceleration(motion_.time());
    std::vector<double> rows(load_.size());
    for_each_free([&](std::size_t i, double mass) {
      rows[i] = exerted_[i] - force[i] - mass * gravity[i % 4];
    });
    motion_.withhold(std::move(rows));
  }

  /// Rows of 4, 1/kg; 0 where components are held.
  const AlignedVector<double>& inverse_mass() {
    if (!inverse_mass_.empty()) return inverse_mass_;
    Attributes& attributes = body().attributes();
    inverse_mass_.assign(std::size_t{attributes.vertex_count()} * 4, 0);
    for (Index v = 0; v < attributes.vertex_count(); ++v)
      for (std::size_t c = 0; c < 3; ++c)
        if (!is_held(held_components(attributes, v), c))
          inverse_mass_[std::size_t{v} * 4 + c] = 1 / attributes.mass().get(v, 0);
    return inverse_mass_;
  }

  bool compensates_;
  double dt_ = 0;
  StepWork start_;
  ForceLoop::Softness softness_;        ///< of all steps
  AlignedVector<double> inverse_mass_;  ///< rows of 4; empty while unknown
  AlignedVector<double> load_;          ///< rows of 4, N
  /// m (v' - v) / h of the last step, without contact and damping: rows of 4, N.
  std::vector<double> exerted_;
};

}  // namespace

std::unique_ptr<Integrator> make_xpbd(Motion& motion, const IntegratorOptions& options) {
  return std::make_unique<Xpbd>(motion, options.compensates);
}

}  // namespace suture
