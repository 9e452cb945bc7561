// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kernel/dynamics/dynamics.hpp"
#include "kernel/plugin_host/plugin_host.hpp"
#include "kernel/spectrum/step_limits.hpp"
#include "kernel/topology/dart.hpp"

namespace suture::bench {

/// A mesh of one model with everything that follows an operation, ids of edges and
/// faces too, and the loops over cells ready to run.
class SutureCut {
 public:
  /// `cuts`: faces of those to come, for which room is made as in a run whose scene has them.
  SutureCut(PluginHost& host, const std::string& model, Mesh mesh,
            std::span<const std::vector<Dart>> cuts = {});

  /// Seconds that the operation took. Darts in the numbers of the mesh; translating them is not
  /// timed.
  double cut(std::span<const Dart> faces);
  double pierce(std::span<const Index> elements);

  /// In the numbers of the mesh.
  bool can_cut(Dart face) const { return body_.complex().can_cut(in_body(face)); }
  bool can_pierce(Index element) const {
    return body_.complex().can_pierce(body_.imported().element_of[element]);
  }

  Index element_count() const { return body_.complex().element_count(); }
  double mass();

 private:
  /// The dart of the body that is `dart` in the mesh.
  Dart in_body(Dart dart) const {
    return corresponding_dart(body_.imported().element_of[suture::element_of(dart)], dart);
  }

  Diagnostics diagnostics_;
  Body body_;
  std::unique_ptr<Dynamics> dynamics_;
  std::unique_ptr<StepLimits> limits_;
};

}  // namespace suture::bench
