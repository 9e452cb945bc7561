// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/suture_cut.hpp"

#include <algorithm>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/timer.hpp"

namespace suture::bench {

SutureCut::SutureCut(PluginHost& host, const std::string& name, Mesh mesh,
                     std::span<const std::vector<Dart>> cuts)
    : body_(import_mesh(std::move(mesh), {}, diagnostics_)) {
  const suture_model& model = host.model(name);
  body_.complex().require_edges();
  body_.complex().require_faces();
  body_.attributes().add(
      std::make_unique<Instance>(model, name, parameters_of(model, {}), diagnostics_),
      body_.complex(), {});
  body_.compile(diagnostics_);
  dynamics_ = std::make_unique<Dynamics>(body_, DynamicsOptions{});
  limits_ = std::make_unique<StepLimits>(body_);
  Index faces = 0, largest = 0;
  for (const auto& cut : cuts) {
    faces += static_cast<Index>(cut.size());
    largest = std::max(largest, static_cast<Index>(cut.size()));
  }
  body_.make_room(faces, largest);
}

double SutureCut::cut(std::span<const Dart> faces) {
  std::vector<Dart> ours(faces.begin(), faces.end());
  for (Dart& d : ours) d = in_body(d);
  const double start = now(1);
  body_.cut(ours);
  return now(1) - start;
}

double SutureCut::pierce(std::span<const Index> elements) {
  std::vector<Index> ours(elements.begin(), elements.end());
  for (Index& e : ours) e = body_.imported().element_of[e];
  const double start = now(1);
  body_.pierce(ours);
  return now(1) - start;
}

double SutureCut::mass() {
  double sum = 0;
  Attributes& attributes = body_.attributes();
  for (Index v = 0; v < attributes.vertex_count(); ++v) sum += attributes.mass().get(v, 0);
  return sum;
}

}  // namespace suture::bench
