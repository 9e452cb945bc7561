// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/body.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <span>

#include "apps/suture-bench/timer.hpp"
#include "kernel/mesh/box.hpp"

namespace suture::bench {
namespace {

Mesh block(const BodyOptions& options) {
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

/// In declared order; the paper's material (E = 400 kPa, nu = 0.3, rho = 1000).
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

}  // namespace

Body::Body(PluginHost& host, const BodyOptions& options)
    : mesh_(import_mesh(block(options), {}, diagnostics_)) {
  const suture_model& model = host.model(options.model);
  attributes_ = std::make_unique<Attributes>(mesh_.complex, mesh_.rest);
  attributes_->user_element = mesh_.user_element;
  attributes_->add(
      std::make_unique<Instance>(model, options.model, parameters_of(model, options.parameters),
                                 diagnostics_),
      mesh_.complex, {});
  attributes_->initialise(mesh_.complex, diagnostics_);
  DynamicsOptions motion;
  motion.gravity = {0, -9.8, 0};
  motion.gravity_ramp.to = options.ramp;
  motion.threads = options.threads;
  dynamics_ = std::make_unique<Dynamics>(*attributes_, mesh_.complex, motion);
  std::vector<Index> held;
  for (Index v = 0; v < attributes_->vertex_count(); ++v)
    if (attributes_->rest().get(v, 2) < 1e-9 * options.cell) held.push_back(v);
  dynamics_->constraints().add(held, 7, {}, *attributes_);
  dynamics_->start();
  dt_ = options.safety * dynamics_->stable_step();
}

void Body::step() {
  dynamics_->step(dt_, time_ + dt_);
  time_ += dt_;
}

double Body::cut_random(unsigned count, unsigned seed) {
  std::mt19937 random(seed);
  double seconds = 0;
  for (unsigned i = 0; i < count; ++i) {
    Dart face = none;
    do {
      face = random() % (24 * element_count()) / 4 * 4;
    } while (!mesh_.complex.can_cut(face));
    const double start = now(1);
    dynamics_->synchronise_velocities();
    const TopologyChange change = mesh_.complex.cut({&face, 1});
    attributes_->apply(mesh_.complex, change);
    dynamics_->update(mesh_.complex, change);
    seconds += now(1) - start;
  }
  dt_ = 0.5 * dynamics_->stable_step();
  return seconds;
}

std::array<Index, 3> grid_of(Index elements) {
  if (elements == 432000) return {60, 60, 120};
  const auto n = static_cast<Index>(std::max(1.0, std::round(std::cbrt(elements / 4.0))));
  return {n, n, 4 * n};
}

}  // namespace suture::bench
