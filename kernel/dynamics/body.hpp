// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/dynamics/constraints.hpp"
#include "kernel/forces/force_loop.hpp"
#include "kernel/topology/import.hpp"
#include "kernel/topology/islands.hpp"

namespace suture {

/// A soft body: its cells, their attributes, the terms of its forces and its constraints; and the
/// one list of all that follows an operation on it. Knows no scene.
///
///   Body body(import_mesh(...));
///   body.attributes().add(instance, body.complex(), {});     for each model
///   body.compile(diagnostics);
///   body.add(std::make_unique<Gravity>(body.attributes(), g, ramp));
///   Dynamics dynamics(body, options);
///
/// Neither copied nor moved: terms and followers refer to it.
class Body {
 public:
  explicit Body(Imported imported);
  Body(const Body&) = delete;
  Body& operator=(const Body&) = delete;

  /// The instances are complete: sums their columns and compiles their functors. `threads`:
  /// 0 = as many as pay. Throws InputError and PluginError.
  void compile(Diagnostics& diagnostics, unsigned threads = 0);

  CellComplex& complex() { return imported_.complex; }
  const CellComplex& complex() const { return imported_.complex; }
  Attributes& attributes() { return attributes_; }
  const Attributes& attributes() const { return attributes_; }
  Constraints& constraints() { return constraints_; }
  /// The numbers of the mesh; but for what moved on, rest positions and user_vertex().
  const Imported& imported() const { return imported_; }
  /// The number by which messages name an element.
  Index user_element(Index element) const {
    const auto numbers = attributes_.user_element;
    return numbers.empty() ? element : numbers[element];
  }
  /// The mesh's point at every vertex, also at those that cuts made.
  const std::vector<Index>& user_vertex() const { return user_vertex_; }

  // ---- terms ----

  /// From now on its forces act.
  template <class Term>
  Term& add(std::unique_ptr<Term> term) {
    Term& added = *term;
    terms_.push_back(std::move(term));
    return added;
  }
  /// The term of the models; after compile().
  ForceLoop& models() { return *models_; }
  const ForceLoop& models() const { return *models_; }
  /// All terms, the models first.
  std::span<const std::unique_ptr<ForceTerm>> terms() const { return terms_; }

  Vec3 acceleration(double time) const;  ///< of all terms, m/s^2
  double energy(double time) const;      ///< stored by all, J
  double potential(double time) const;   ///< of all, J
  // Of the terms besides the models:
  bool has_loads() const;           ///< some adds to rows
  bool loads_have_tangent() const;  ///< all have; not pressures
  double settled_after() const;     ///< when the last ramp and motion ends, s
  /// Some component of some vertex with mass is not prescribed. O(vertices).
  bool has_free_vertices();
  /// out += K d with K = df/dx of all terms that have a tangent; 3 numbers per vertex.
  void add_tangent(const double* d, double dx, double dv, double time, double* out) const;
  /// Of all terms at these vertices, each given once, but for acceleration(). O(what is there).
  std::vector<Vec3> forces_at(std::span<const Index> vertices, double time);

  /// Cells between vertices that are held at rest for good are left out from now
  /// on (ForceLoop::skip_still); returns how many. After the constraints are added.
  Index skip_still_cells() {
    return models_->skip_still(constraints_.still(attributes_.vertex_count()));
  }

  // ---- operations ----

  /// Told of every operation after the attributes, the terms and the constraints, in order of
  /// these calls. Outlives the body, or the last operation.
  void add_follower(Follower& follower) { followers_.push_back(&follower); }

  // Operations of CellComplex, after which everything follows. They throw what the complex
  // throws, and then nothing has happened.
  TopologyChange cut(const std::vector<Dart>& faces);
  /// Momentum and mass go with the elements, exactly those of their shares.
  TopologyChange pierce(const std::vector<Index>& elements);
  /// Velocities merge by mass, so momentum stays. Vertices that join meet at once in
  /// their common centre of mass: bring them near before.
  TopologyChange sew(const std::vector<Seam>& seams);
  /// The pieces, known through all operations from the first call on.
  const Islands& islands();

  /// Columns, terms, constraints; of a checkpoint the cells too.
  void state(Archive& archive);

 private:
  template <class Operate>
  TopologyChange change(const ComingOperation& operation, Operate operate);
  void follow(const TopologyChange& change);

  Imported imported_;
  Attributes attributes_;
  std::vector<Index> user_vertex_;
  std::vector<std::unique_ptr<ForceTerm>> terms_;
  ForceLoop* models_ = nullptr;
  Constraints constraints_;
  std::optional<Islands> islands_;
  std::vector<Follower*> followers_;
  VertexSelection selection_;
};

}  // namespace suture
