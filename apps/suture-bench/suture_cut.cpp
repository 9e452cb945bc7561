// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/suture_cut.hpp"

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/timer.hpp"

namespace suture::bench {
SutureCut::SutureCut(PluginHost& host, const std::string& name, Mesh mesh)
    : mesh_(import_mesh(std::move(mesh), {}, diagnostics_)) {
  const suture_model& model = host.model(name);
  mesh_.complex.require_edges();
  mesh_.complex.require_faces();
  attributes_ = std::make_unique<Attributes>(mesh_.complex, mesh_.rest);
  attributes_->user_element = mesh_.user_element.list();
  attributes_->add(std::make_unique<Instance>(model, name, parameters_of(model, {}), diagnostics_),
                   mesh_.complex, {});
  attributes_->initialise(mesh_.complex, diagnostics_);
  dynamics_ = std::make_unique<Dynamics>(*attributes_, mesh_.complex, DynamicsOptions{});
}

OperationTimes SutureCut::cut(std::span<const Dart> faces) {
  std::vector<Dart> ours(faces.begin(), faces.end());
  for (Dart& d : ours) d = 24 * mesh_.element_of[d / 24] + d % 24;
  const double start = now(1);
  dynamics_->prepare_change({}, true);
  OperationTimes times = follow(mesh_.complex.cut(ours), start);
  times.release = now(1) - start - times.all();
  return times;
}

OperationTimes SutureCut::pierce(std::span<const Index> elements) {
  std::vector<Index> ours(elements.begin(), elements.end());
  for (Index& e : ours) e = mesh_.element_of[e];
  const double start = now(1);
  dynamics_->prepare_change({}, false);
  OperationTimes times = follow(mesh_.complex.pierce(ours), start);
  times.release = now(1) - start - times.all();
  return times;
}

OperationTimes SutureCut::follow(const TopologyChange& change, double start) {
  const double cut = now(1);
  attributes_->apply(mesh_.complex, change);
  const double applied = now(1);
  dynamics_->update(mesh_.complex, change);
  return {cut - start, applied - cut, now(1) - applied};
}

double SutureCut::mass() {
  double sum = 0;
  for (Index v = 0; v < attributes_->vertex_count(); ++v) sum += attributes_->mass().get(v, 0);
  return sum;
}

}  // namespace suture::bench
