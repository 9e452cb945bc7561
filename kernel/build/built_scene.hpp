// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "kernel/build/embedded_parts.hpp"
#include "kernel/build/select.hpp"
#include "kernel/build/translate.hpp"
#include "kernel/dynamics/dynamics.hpp"
#include "kernel/scene/scene.hpp"
#include "kernel/spectrum/step_limits.hpp"

namespace suture {

class Gravity;

/// Everything that is built from a scene before the first step, in the order of the data flow:
/// mesh, body (cells, attributes, forces, constraints) and dynamics, with the user's names for its
/// cells. Positions are relative to the lower corner of the body at rest (BodyFrame). Neither
/// copied nor moved.
class BuiltScene {
 public:
  /// `skip`: leave out what the scene does not need; false builds and computes it regardless.
  /// Throws the errors of the stages: InputError, TopologyError, PluginError.
  BuiltScene(const Scene& given, Diagnostics& diagnostics, bool skip = true);
  BuiltScene(const BuiltScene&) = delete;
  BuiltScene& operator=(const BuiltScene&) = delete;

  bool skips() const { return skips_; }              ///< whether unneeded work is left out
  const BodyFrame& frame() const { return frame_; }  ///< the frame of all positions here
  const Scene& scene() const { return scene_; }      ///< the scene, with coordinates in that frame
  const std::string& mesh_source() const { return mesh_source_; }
  const MeshNames& names() const { return names_; }
  Body& body() { return body_; }
  const Body& body() const { return body_; }
  /// The elements of which only a part is material, and the surface inside them; empty if all are
  /// full.
  const Parts& parts() const { return parts_.parts(); }
  EmbeddedParts& embedded_parts() { return parts_; }
  /// Whether some are, or may become so by a cut: what it shows and touches is embedding().
  bool is_embedded() const { return !parts().empty() || body_.attributes().parts().may_grow(); }
  /// The same on the vertices of the body as it is now.
  const Embedding& embedding() { return parts_.embedding(body_.complex()); }
  const Selector& selector() const { return selector_; }
  Dynamics& dynamics() { return *dynamics_; }
  StepLimits& limits() { return *limits_; }
  Gravity& gravity() { return *gravity_; }

  /// By model of the scene: whether a run ends where one of its elements becomes inverted.
  std::vector<bool> stops_on_inversion() const;

  /// Holds the nodes that a grasp selects now, and moves them from `time` on; returns their number.
  /// Throws InputError, with `path` in front, if there are none; nothing has changed then.
  Index grasp(const Grasp& grasp, double time, const std::string& path);
  /// Call when an obstacle has another path: what it holds moves along.
  void redirect(std::size_t obstacle);
  /// Moves what a grasp holds from where it is now by a translation (m), from `time` on for so long
  /// (s). Throws InputError if nothing with this name holds any.
  void move_grasp(const std::string& name, const Vec3& translation, double time, double duration);
  /// Frees the nodes of a grasp or a constraint with a name; returns their number. Throws
  /// InputError, with `path` in front, if nothing with this name holds any.
  Index release(const std::string& name, const std::string& path);

  /// The user's number of an element.
  std::uint64_t element_name(Index e) const { return selector_.element_id(e); }
  /// "(0.1, 0.2, 0.3) m" in coordinates of the scene: a point of the body, or the centre of an
  /// element at rest.
  std::string place_text(const Vec3& local) const;
  std::string place_of(Index e);

 private:
  BuiltScene(const Scene& given, Mesh mesh, Diagnostics& diagnostics, bool skip);
  void let_parts_grow();
  void name_elements();
  void add_models(Diagnostics& diagnostics);
  std::vector<Index> add_lips(Instance& instance, const ModelUse& use);
  void open_lips();
  std::vector<std::vector<GivenColumn>> read_values();
  void add_constraints();
  std::vector<Index> graspable(const Grasp& grasp, double time);
  double shortest_edge(const std::vector<Index>& vertices);
  void add_terms();
  void add_volumes();
  void add_foundations();
  std::string node_text(Index v);
  void add_contact(Diagnostics& diagnostics);
  void add_edges(Contact& contact);
  std::vector<double> element_values(const CellValues& table) const;

  bool skips_;
  BodyFrame frame_;
  Scene scene_;
  std::string mesh_source_;
  MeshNames names_;
  EmbeddedParts parts_;
  Body body_;
  Selector selector_;
  std::unique_ptr<Dynamics> dynamics_;
  std::unique_ptr<StepLimits> limits_;
  Gravity* gravity_ = nullptr;  ///< a term of the body
};

/// Reads the mesh of a scene from its files, with which load_mesh() begins; null if the scene has
/// no such files. As MeshSource::given of scenes that have the same /mesh, it need not be read
/// again. Throws InputError.
std::shared_ptr<const Mesh> read_mesh_of(const Scene& scene, Diagnostics& diagnostics);
/// Reads or makes the mesh of a scene, with the arrays that the scene's values name. Its points are
/// relative to frame_of() it. Throws InputError.
Mesh load_mesh(const Scene& scene, Diagnostics& diagnostics);
BodyFrame frame_of(const Mesh& mesh);

/// What a constraint or a grasp prescribes, without `reach`.
PrescribedMotion motion_of(const Constraint& constraint);

}  // namespace suture
