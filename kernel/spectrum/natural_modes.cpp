// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/spectrum/natural_modes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/dynamics/free_motions.hpp"
#include "kernel/solvers/choice.hpp"
#include "kernel/solvers/lobpcg.hpp"
#include "kernel/spectrum/scaled_tangent.hpp"

namespace suture {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;
using EigenIndex = Eigen::Index;

/// The shift of a body with free pieces, over a quotient that is typical of its lowest modes: above
/// the effect of single precision in the multigrid on rigid motions, below most of what is wanted.
constexpr double free_shift = 0.1;
/// A mode below this part of that quotient is zero; a rod of that quotient bends at 1e-10 of it if
/// it is 1e5 times as long as thick.
constexpr double zero_part = 1e-10;

/// M^-1/2 K M^-1/2, and the preconditioner of K in the same scaling.
class ModalProblem final : public EigenProblem {
 public:
  ModalProblem(Body& body, double time)
      : body_(body),
        time_(time),
        tangent_(body, time),
        shifted_(body.attributes(), body.terms(), body.models().workers()),
        scaled_(static_cast<std::size_t>(tangent_.size())),
        solved_(scaled_.size()) {}

  ScaledTangent& tangent() { return tangent_; }
  std::string preconditioner() const { return choice_.preconditioner->name(); }

  /// The preconditioner of K + shift M from now on.
  void set_shift(double shift) {
    shift_ = shift;
    shifted_.set(time_, shift);
    choice_ = choose_preconditioner(body_.complex(), body_.attributes(), shifted_);
    choice_.preconditioner->build(shifted_);
  }

  void multiply(const Vector& x, Result y) override { tangent_.multiply(x, y); }

  void precondition(const Vector& r, Result z) override {
    const std::vector<double>& scale = tangent_.scale();
    for (std::size_t i = 0; i < scaled_.size(); ++i)
      scaled_[i] = scale[i] > 0 ? r[static_cast<EigenIndex>(i)] / scale[i] : 0;
    choice_.preconditioner->apply(scaled_.data(), solved_.data());
    for (std::size_t i = 0; i < scaled_.size(); ++i)
      z[static_cast<EigenIndex>(i)] = scale[i] > 0 ? solved_[i] / scale[i] : 0;
  }

  void adapt(double lowest) override {
    if (lowest < -shift_ / 2 && lowest < -least_shift_) set_shift(-2 * lowest);
  }
  /// Negative values above -shift are rounding.
  void set_least_shift(double shift) { least_shift_ = shift; }

 private:
  Body& body_;
  double time_;
  ScaledTangent tangent_;
  TangentMatrix shifted_;
  PreconditionerChoice choice_;
  double shift_ = 0, least_shift_ = 0;
  std::vector<double> scaled_, solved_;
};

/// The smallest Rayleigh quotient of uniform strain along an axis: that of the first axial
/// vibrations, unless what is held resists it.
double typical_eigenvalue(ScaledTangent& tangent, Attributes& attributes) {
  double typical = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < 3; ++c) {
    VectorXd y = VectorXd::Zero(tangent.size());
    for (std::size_t i = c; i < tangent.scale().size(); i += 3)
      if (const double scale = tangent.scale()[i]; scale > 0)
        y[static_cast<EigenIndex>(i)] =
            attributes.rest().get(static_cast<Index>(i / 3), static_cast<int>(c)) / scale;
    if (!(y.squaredNorm() > 0)) continue;
    const double quotient = std::abs(y.dot(tangent(y))) / y.squaredNorm();
    if (quotient > 0) typical = std::min(typical, quotient);
  }
  return std::isfinite(typical) ? typical : 0;
}

bool has_free_pieces(Body& body) {
  const std::vector<double> no_forces(4 * std::size_t{body.attributes().vertex_count()});
  return !find_free_pieces(body.complex(), body.attributes(), no_forces).empty();
}

/// Random vectors, mostly smoothed: the rest keeps them independent. The guards make the last modes
/// converge.
MatrixXd start_vectors(ModalProblem& problem, EigenIndex count, Random& numbers) {
  const EigenIndex guards = std::max<EigenIndex>(4, count / 4);
  MatrixXd start(problem.tangent().size(), std::min(count + guards, problem.tangent().unknowns()));
  for (EigenIndex i = 0; i < start.cols(); ++i) {
    const VectorXd random = problem.tangent().random(numbers);
    problem.precondition(random, start.col(i));
    start.col(i).normalize();
    start.col(i) += 0.1 * random;
  }
  return start;
}

[[noreturn]] void refuse(const EigenPairs& pairs, const EigenOptions& options) {
  const VectorXd& residuals = pairs.residuals;
  EigenIndex worst = 0;
  residuals.maxCoeff(&worst);
  std::ostringstream text;
  text << "mode " << worst + 1 << " did not converge in " << pairs.iterations
       << " iterations: its residual is " << residuals[worst] << ", the tolerance "
       << options.tolerance
       << "; request a few modes more, which separates this one from the next, or look for thin or "
          "nearly incompressible elements";
  throw NumericalError(text.str());
}

/// Scaled so that the component with the largest magnitude is 1.
void normalise(std::vector<Vec3>& shape) {
  double largest = 0;
  for (const Vec3& u : shape)
    for (const double component : u)
      if (std::abs(component) > std::abs(largest)) largest = component;
  for (Vec3& u : shape)
    for (double& component : u) component = component / largest + 0.0;  // no -0
}

NaturalMode mode_of(const EigenPairs& pairs, EigenIndex i, double zero,
                    const ScaledTangent& tangent) {
  NaturalMode mode;
  mode.eigenvalue = pairs.values[i];
  mode.residual = pairs.residuals[i];
  if (std::abs(mode.eigenvalue) <= zero)
    mode.kind = NaturalMode::Kind::zero;
  else if (mode.eigenvalue < 0)
    mode.kind = NaturalMode::Kind::unstable;
  mode.shape = tangent.shape(pairs.vectors.col(i));
  normalise(mode.shape);
  return mode;
}

}  // namespace

double NaturalMode::frequency() const { return std::sqrt(eigenvalue) / (2 * std::numbers::pi); }

double NaturalMode::growth() const { return std::sqrt(-eigenvalue); }

void require_modes(Body& body, unsigned count) {
  const EigenIndex unknowns = ScaledTangent(body, 0).unknowns();
  if (unknowns >= static_cast<EigenIndex>(count)) return;
  if (unknowns == 0) throw InputError("the body has no modes because every node is prescribed");
  throw InputError("the body has " + std::to_string(unknowns) +
                   (unknowns == 1 ? " free component" : " free components") +
                   " and thus as many modes, but " + std::to_string(count) +
                   " were requested; reduce --count");
}

NaturalModes find_natural_modes(Body& body, double time, unsigned count,
                                const std::function<void(const ModalIteration&)>& on_iteration) {
  ModalProblem problem(body, time);
  ScaledTangent& tangent = problem.tangent();
  Random numbers;
  const double typical = typical_eigenvalue(tangent, body.attributes());
  EigenOptions options;
  options.count = static_cast<EigenIndex>(count);
  options.zero = std::max(tangent.noise(tangent.largest(numbers)), zero_part * typical);
  problem.set_least_shift(options.zero);
  problem.set_shift(has_free_pieces(body) ? free_shift * typical : 0);
  Lobpcg solver(problem, options, start_vectors(problem, options.count, numbers));
  if (on_iteration)
    solver.on_iteration = [&](const Lobpcg::Iteration& i) {
      on_iteration({i.number, static_cast<unsigned>(i.converged), i.lowest, i.residual});
    };
  const EigenPairs pairs = solver.solve();
  if (!pairs.converged) refuse(pairs, options);
  NaturalModes result;
  for (EigenIndex i = 0; i < pairs.values.size(); ++i)
    result.modes.push_back(mode_of(pairs, i, options.zero, tangent));
  result.iterations = pairs.iterations;
  result.products = tangent.products();
  result.preconditioner = problem.preconditioner();
  return result;
}

}  // namespace suture
