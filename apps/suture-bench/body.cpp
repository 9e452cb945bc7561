// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/body.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <span>

#include "apps/suture-bench/timer.hpp"
#include "kernel/forces/gravity.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/topology/dart.hpp"

namespace suture::bench {
namespace {

Mesh block_mesh(const BodyOptions& options) {
  BoxOptions box;
  box.cells = options.cells;
  const double cell = options.cell;
  for (std::size_t c = 0; c < 3; ++c) box.size[c] = cell * options.cells[c];
  Mesh mesh = make_box(box);
  if (!options.distorted) return mesh;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> shift(-0.1 * cell, 0.1 * cell);
  for (Vec3& point : mesh.points)
    for (double& x : point) x += shift(random);
  return mesh;
}

/// Seconds since the last call.
class Stopwatch {
 public:
  double lap() {
    const double before = last_;
    last_ = now(2);
    return last_ - before;
  }

 private:
  double last_ = now(2);
};

Imported timed_import(const BodyOptions& options, Diagnostics& diagnostics, BodyTimes& times) {
  Stopwatch watch;
  Mesh mesh = block_mesh(options);
  times.mesh = watch.lap();
  Imported imported = import_mesh(std::move(mesh), {}, diagnostics);
  times.map = watch.lap();
  return imported;
}

}  // namespace

std::vector<double> parameters_of(const suture_model& model,
                                  const std::map<std::string, double>& wanted) {
  std::map<std::string, double> known{{"E", 400e3}, {"nu", 0.3}, {"rho", 1000}};
  for (const auto& [name, value] : wanted) known[name] = value;
  std::vector<double> values;
  for (const suture_parameter& p : std::span(model.parameters, model.parameter_count)) {
    const auto found = known.find(p.name);
    values.push_back(found == known.end() ? p.default_value : found->second);
  }
  return values;
}

BenchBody::BenchBody(PluginHost& host, const BodyOptions& options)
    : body_(std::make_unique<Body>(timed_import(options, diagnostics_, times_))) {
  for (std::size_t c = 0; c < 3; ++c) length_[c] = options.cell * options.cells[c];
  const suture_model& model = host.model(options.model);
  Stopwatch watch;
  if (options.may_divide) attributes().let_parts_grow(body_->complex());
  attributes().add(
      std::make_unique<Instance>(model, options.model, parameters_of(model, options.parameters),
                                 diagnostics_, options.skip),
      body_->complex(), {});
  times_.attributes = watch.lap();
  body_->compile(diagnostics_, options.threads);
  TimeRamp ramp;
  ramp.to = options.ramp;
  body_->add(std::make_unique<Gravity>(attributes(), options.gravity, ramp));
  dynamics_ = std::make_unique<Dynamics>(
      *body_, DynamicsOptions{options.integrator, options.damping, options.solver});
  limits_ = std::make_unique<StepLimits>(*body_);
  std::vector<Index> held;
  for (Index v = 0; v < attributes().vertex_count(); ++v)
    if (attributes().rest().get(v, 2) < options.held + 1e-9 * options.cell) held.push_back(v);
  body_->constraints().add(held, 7, {}, attributes());
  dynamics_->start();
  times_.loops = watch.lap();
  dt_ = options.dt;
  if (dt_ == 0)
    dt_ = options.safety * (options.search ? limits_->stable_step(0) : limits_->bounds(0).dt);
  times_.stable_step = watch.lap();
}

void BenchBody::step() {
  dynamics_->step(dt_, time_ + dt_);
  time_ += dt_;
}

void BenchBody::require_all_ids() {
  body_->complex().require_edges();
  body_->complex().require_faces();
}

void BenchBody::cut(std::span<const Dart> faces) { body_->cut({faces.begin(), faces.end()}); }

std::vector<Dart> BenchBody::strip(int part, int parts) const {
  const double* rest = body_->attributes().rest().rows();
  const auto low = [&](Index e, int axis) {
    return rest[std::size_t{body_->complex().vertices_of(e)[0]} * 4 +
                static_cast<std::size_t>(axis)];
  };
  const double middle = length_[0] / 2, slack = 1e-6 * length_[0];
  const double from = length_[1] * part / parts, to = length_[1] * (part + 1) / parts;
  std::vector<Dart> faces;
  for (Index e = 0; e < element_count(); ++e) {
    if (low(e, 1) < from - slack || low(e, 1) > to - slack || low(e, 0) > middle - slack) continue;
    for (int f = 0; f < hexahedron::faces; ++f) {
      const Index other = body_->complex().neighbour(e, f);
      if (other != none && low(other, 0) > middle - slack) faces.push_back(face_dart(e, f));
    }
  }
  return faces;
}

double BenchBody::cut_random(unsigned count, unsigned seed) {
  std::mt19937 random(seed);
  double seconds = 0;
  for (unsigned i = 0; i < count; ++i) {
    Dart face = none;
    do {
      face = face_of(random() % (hexahedron::darts * element_count()));
    } while (!body_->complex().can_cut(face));
    const double start = now(1);
    cut({&face, 1});
    seconds += now(1) - start;
  }
  dt_ = 0.5 * limits_->bounds(time_).dt;
  return seconds;
}

std::array<Index, 3> grid_of(Index elements) {
  if (elements == 432000) return {60, 60, 120};
  const auto n = static_cast<Index>(std::max(1.0, std::round(std::cbrt(elements / 4.0))));
  return {n, n, 4 * n};
}

}  // namespace suture::bench
