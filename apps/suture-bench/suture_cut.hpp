// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/dynamics/dynamics.hpp"
#include "kernel/plugin_host/plugin_host.hpp"
#include "kernel/topology/import.hpp"

namespace suture::bench {

/// Seconds that parts of an operation took.
struct OperationTimes {
  double topology = 0, attributes = 0, dynamics = 0;
  double release = 0;  ///< of the TopologyChange
  double all() const { return topology + attributes + dynamics + release; }
};

/// A mesh of one model with everything that follows an operation, ids of edges and
/// faces too, and the loops over cells ready to run.
class SutureCut {
 public:
  SutureCut(PluginHost& host, const std::string& model, Mesh mesh);

  /// As World::cut(). Darts in the numbers of the mesh; translating them is not timed.
  OperationTimes cut(std::span<const Dart> faces);
  OperationTimes pierce(std::span<const Index> elements);

  /// In the numbers of the mesh.
  bool can_cut(Dart face) const {
    return mesh_.complex.can_cut(24 * mesh_.element_of[face / 24] + face % 24);
  }
  bool can_pierce(Index element) const {
    return mesh_.complex.can_pierce(mesh_.element_of[element]);
  }

  Index element_count() const { return mesh_.complex.element_count(); }
  double mass();

 private:
  OperationTimes follow(const TopologyChange& change, double start);

  Diagnostics diagnostics_;
  Imported mesh_;
  std::unique_ptr<Attributes> attributes_;
  std::unique_ptr<Dynamics> dynamics_;
};

}  // namespace suture::bench
