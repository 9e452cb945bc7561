// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/dynamics/dynamics.hpp"
#include "kernel/run/select.hpp"
#include "kernel/scene/scene.hpp"
#include "kernel/scene/translate.hpp"
#include "kernel/topology/islands.hpp"

namespace suture {

/// What a scene builds before the first step, in the order of the flow: mesh,
/// complex, attributes, dynamics with its constraints and loads. Positions count from the
/// lower corner of the body at rest (BodyFrame). Members refer to each other: neither
/// copied nor moved.
class World {
 public:
  /// `skip`: leave out what the scene does not need; false builds and computes it
  /// all the same. Throws whatever the stages throw: InputError, TopologyError,
  /// PluginError.
  World(const Scene& given, Diagnostics& diagnostics, bool skip = true);
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  CellComplex& complex() { return imported.complex; }
  // Operations of CellComplex, after which everything that depends on cells follows.
  // They throw what the complex throws, and then nothing has happened.
  TopologyChange cut(const std::vector<Dart>& faces);
  /// Momentum and mass go with the elements, exactly those of their shares.
  TopologyChange pierce(const std::vector<Index>& elements);
  /// Velocities merge by mass, so momentum stays. Vertices that join meet at once in
  /// their common centre of mass: bring them near before.
  TopologyChange sew(const std::vector<Seam>& seams);
  /// The pieces, known through all operations from the first call on.
  const Islands& islands();
  /// The number by which users know an element.
  std::uint64_t element_name(Index e) const { return names.element_id(imported.user_element[e]); }
  /// "(0.1, 0.2, 0.3) m" in the scene: a point of the body; the middle of an element at rest.
  std::string place_text(const Vec3& local) const;
  std::string place_of(Index e);

  const bool skips;       ///< leaves out what the scene does not need
  const BodyFrame frame;  ///< all positions here are those of the body in it
  const Scene scene;      ///< with its coordinates in that frame
  std::string mesh_source;
  MeshNames names;
  Imported imported;  ///< but for what moved on: rest positions, user_vertex
  Attributes attributes;
  Selector selector;
  std::unique_ptr<Dynamics> dynamics;
  std::vector<Index> user_vertex;  ///< of every vertex, also of those that cuts made

 private:
  World(const Scene& given, Mesh mesh, Diagnostics& diagnostics, bool skip);
  void add_models(Diagnostics& diagnostics);
  void add_constraints();
  double shortest_edge(const std::vector<Index>& vertices);
  void add_loads();
  void follow(const TopologyChange& change);

  std::vector<Index> element_ids_;  ///< by element, if the file has numbers of its own
  std::optional<Islands> islands_;
};

}  // namespace suture
