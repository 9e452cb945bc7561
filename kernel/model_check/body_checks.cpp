// SPDX-License-Identifier: GPL-3.0-or-later
//
// Laws of a whole body: rest, stiffness, mass, cuts, and what its parameters change.
#include <algorithm>
#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/model_check/checks.hpp"
#include "kernel/solvers/symmetric_eigen.hpp"

namespace suture::checks {
namespace {

using NodalValues = std::vector<double>;

bool has_functor_of(SampleBody& sample, std::initializer_list<std::uint32_t> dimensions) {
  return std::ranges::any_of(sample.functors(), [&](const suture_functor* f) {
    return std::ranges::find(dimensions, f->dimension) != dimensions.end();
  });
}

/// df/dx, all vertices.
Eigen::MatrixXd tangent_of(SampleBody& sample) {
  const std::size_t n = 3 * sample.body().attributes().vertex_count();
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  for (std::size_t j = 0; j < n; ++j) {
    NodalValues unit(n), df(n);
    unit[j] = 1;
    sample.body().models().add_tangent(unit.data(), 1, 0, TangentTime(0), df.data());
    matrix.col(static_cast<Eigen::Index>(j)) =
        Eigen::Map<const Eigen::VectorXd>(df.data(), static_cast<Eigen::Index>(n));
  }
  return matrix;
}

double total(const NodalValues& values) {
  double sum = 0;
  for (const double x : values) sum += x;
  return sum;
}

Vec3 momentum(SampleBody& sample) {
  Attributes& attributes = sample.body().attributes();
  Vec3 sum{};
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    for (std::size_t c = 0; c < 3; ++c)
      sum[c] += attributes.mass().get(v, 0) * attributes.velocity().get(v, static_cast<int>(c));
  return sum;
}

double worst_of(double a, double b, const char* text_a, const char* text_b, const char*& text) {
  text = a >= b || std::isnan(a) ? text_a : text_b;
  return a >= b || std::isnan(a) ? a : b;
}

/// Everything that a parameter may change.
NodalValues observed(SampleBody& sample) {
  NodalValues all = sample.forces();
  const auto append = [&](const NodalValues& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  append(sample.at_vertices(sample.body().attributes().mass(), 1));
  append({sample.body().models().energy(sample.options().time)});
  for (const VertexField& field : sample.body().attributes().fields())
    if (field.capacity) append(sample.at_vertices(*field.capacity, 1));
  for (const suture_functor* functor : sample.functors())
    for (CellBatch& batch : sample.batches(*functor, 1)) {
      batch.time = sample.options().time;
      const CellForces out = BatchCaller(sample.instance()).force(batch);
      append({out.force.begin(), out.force.end()});
      for (const auto& trial : out.trial) append({trial.begin(), trial.end()});
    }
  return all;
}

/// Whether another value of a number, 10 % larger or smaller, changes anything that a run sees.
/// False if the model refuses these values or this state.
bool changes(const suture_model& model, const SampleOptions& options, std::size_t parameter) {
  const suture_parameter& p = model.parameters[parameter];
  SampleOptions other = options;
  double& value = other.set.values[parameter];
  const double step = value == 0 ? 0.1 : 0.1 * std::abs(value);
  value += value + step < p.maximum ? step : -step;
  try {
    SampleBody before(model, options), after(model, other);
    return observed(before) != observed(after);
  } catch (const InputError&) {
    return false;
  } catch (const NumericalError&) {
    return false;
  }
}

/// The same with other values, states and times: a parameter may act only beyond a threshold, in
/// tension or compression, or from a time on.
bool has_effect(const suture_model& model, const SampleOptions& options, std::size_t parameter) {
  SampleOptions all_on = options;
  all_on.set = with_everything_on(model, options.set);
  for (const double stretch : {1.0, 1.6, 0.6})
    for (const double factor : {1.0, 0.1, 10.0})
      for (SampleOptions tried : {options, all_on}) {
        tried.stretch = stretch;
        double& value = tried.set.values[parameter];
        if (!admits(model.parameters[parameter], value * factor)) continue;
        value *= factor;
        for (const double time : sample_times(model, tried.set)) {
          tried.time = time;
          if (changes(model, tried, parameter)) return true;
        }
      }
  return false;
}

}  // namespace

// All functors together are at rest: springs that pull are held by others that push.
Result rest(const BodyCase& of) {
  if (has_functor_of(of.sample, {0, 2})) return {};
  of.sample.go_to_rest();
  const NodalValues forces = of.sample.forces();
  if (!of.sample.body().models().has_tangent()) return {};
  const double stiffness = tangent_of(of.sample).cwiseAbs().maxCoeff();
  constexpr double edge = 0.05;
  if (stiffness == 0 && largest(forces) == 0) return {};
  return Measured{largest(forces) / (stiffness * edge),
                  "the forces at rest, over those of a displacement by an edge"};
}

// Elements that are far from parallelepipeds may be soft: the correction of mss-baudet, which is
// meant for boxes, has modes of -1e-4 of the largest stiffness there.
// Tensions of faces pull a body together.
Result stiffness(const BodyCase& of) {
  if (is_of_general_hexahedra(of.sample.options().shape)) return {};
  if (has_functor_of(of.sample, {2})) return {};
  if (!of.sample.body().models().has_tangent()) return {};
  of.sample.go_to_rest();
  const Eigen::MatrixXd tangent = tangent_of(of.sample);
  const Eigen::VectorXd values = symmetric_eigenvalues(-(tangent + tangent.transpose()) / 2);
  const double scale = values.cwiseAbs().maxCoeff();
  if (scale == 0) return {};
  return Measured{-values.minCoeff() / scale,
                  "a motion from rest lowers the energy: the smallest eigenvalue of the stiffness "
                  "is negative, over the largest one"};
}

// The mass of an element follows its volume, and is shared among its nodes.
Result mass(const BodyCase& of) {
  if (!of.sample.gives_mass()) return {};
  const NodalValues masses = of.sample.at_vertices(of.sample.body().attributes().mass(), 1);
  if (!(*std::ranges::min_element(masses) > 0))
    throw BrokenLaw("the mass of a node is not positive");
  if (of.sample.options().set.differs) return {};
  SampleOptions larger = of.sample.options();
  larger.scale = 2;
  SampleBody twice(of.sample.model(), larger);
  const double ratio =
      total(twice.at_vertices(twice.body().attributes().mass(), 1)) / total(masses);
  return Measured{std::abs(ratio / 8 - 1),
                  "in a body of twice the size the mass should be 8 times as large"};
}

// Every face inside is opened, while nothing moves.
Result cut(const BodyCase& of) {
  if (has_functor_of(of.sample, {0, 2})) return {};
  SampleBody& sample = of.sample;
  Body& body = sample.body();
  const double mass = total(sample.at_vertices(body.attributes().mass(), 1));
  const double energy = body.models().energy(sample.options().time);
  const Vec3 before = momentum(sample);
  body.cut(of.sample.inner_faces());
  const double lost_mass =
      std::abs(total(sample.at_vertices(body.attributes().mass(), 1)) / mass - 1);
  const double gained = energy > 0 ? body.models().energy(sample.options().time) / energy - 1 : 0;
  double lost_momentum = 0;
  for (std::size_t c = 0; c < 3 && sample.gives_mass(); ++c)
    lost_momentum =
        std::max(lost_momentum, std::abs(momentum(sample)[c] - before[c]) / (mass * 0.05));
  const char* text = "";
  const double matter =
      worst_of(sample.gives_mass() ? lost_mass : 0, lost_momentum,
               "a cut changes the mass by this part", "a cut changes the momentum", text);
  const double worst = worst_of(matter, gained, text, "a cut adds this part of the energy", text);
  return Measured{worst, text};
}

// Numbers only: a choice may matter in special cases.
Result parameters(const BodyCase& of) {
  const suture_model& model = of.sample.model();
  const SampleOptions& options = of.sample.options();
  if (options.set.is_first && options.shape == SampleShape::boxes) {
    for (std::size_t p = 0; p < model.parameter_count; ++p) {
      if (model.parameters[p].type != SUTURE_NUMBER) continue;
      if (!has_effect(model, options, p))
        throw BrokenLaw(std::string("parameter '") + model.parameters[p].name +
                        "' changes neither forces nor energies, masses or states at any time that "
                        "the parameters name");
    }
  }
  return Measured{};
}

}  // namespace suture::checks
