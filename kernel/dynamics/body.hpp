// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/dynamics/constraints.hpp"
#include "kernel/fields/field_equation.hpp"
#include "kernel/forces/body_share.hpp"
#include "kernel/forces/force_loop.hpp"
#include "kernel/geometry/element_blocks.hpp"
#include "kernel/topology/import.hpp"
#include "kernel/topology/islands.hpp"

namespace suture {

class Contact;
class ContactLaw;
struct Embedding;
struct Obstacle;

/// A soft body: its cells, their attributes, its force terms and its constraints, and the only list
/// of objects that follow an operation on it. Independent of scenes.
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
  ~Body();

  /// Call once all instances have been added: sums their columns and compiles their functors.
  /// `threads`: 0 = as many as are useful. Throws InputError and PluginError.
  void compile(Diagnostics& diagnostics, unsigned threads = 0);

  CellComplex& complex() { return imported_.complex; }
  const CellComplex& complex() const { return imported_.complex; }
  Attributes& attributes() { return attributes_; }
  const Attributes& attributes() const { return attributes_; }
  Constraints& constraints() { return constraints_; }
  /// The numbering of the mesh, except for the members that were moved elsewhere: rest positions
  /// and user_vertex().
  const Imported& imported() const { return imported_; }
  /// The number by which messages name an element.
  Index user_element(Index element) const {
    const auto numbers = attributes_.user_element;
    return numbers.empty() ? element : numbers[element];
  }
  /// Numbers for messages instead of those of the mesh, by element.
  void name_elements(std::vector<Index> names);
  /// The mesh point of every vertex, including those created by cuts.
  const std::vector<Index>& user_vertex() const { return user_vertex_; }

  // ---- terms ----

  /// Adds a term, whose forces act from now on.
  template <class Term>
  Term& add(std::unique_ptr<Term> term) {
    Term& added = *term;
    terms_.push_back(std::move(term));
    if (share_) share_with(added);
    return added;
  }
  /// The term of the models; after compile().
  ForceLoop& models() { return *models_; }
  const ForceLoop& models() const { return *models_; }
  /// All terms, the models first; the list lives as long as the body.
  const std::vector<std::unique_ptr<ForceTerm>>& terms() const { return terms_; }
  /// All terms other than the models.
  std::span<const std::unique_ptr<ForceTerm>> loads() const { return std::span(terms_).subspan(1); }

  /// From now on several processes hold this body, and this one computes a share of it.
  void share(std::unique_ptr<BodyShare> share);
  BodyShare* share() { return share_.get(); }  ///< null if this process is alone
  const BodyShare* share() const { return share_.get(); }
  /// Whether loads and contact read and change marked vertices only (ForceTerm::marks_vertices()):
  /// each process then has these, and computes all loads and contact.
  bool marks_vertices() const;

  /// The equations of the fields that models declare; after compile().
  std::deque<FieldEquation>& fields() { return fields_; }
  const std::deque<FieldEquation>& fields() const { return fields_; }
  FieldEquation& field(std::string_view name);

  // ForceLoop has these for the forces of models and for the rates of each field:
  void check_plugins();
  void measure();
  std::vector<FunctorCost> costs() const;

  /// Adds contact with obstacles, which the body does not enter from now on; call it once.
  /// `embedding`: see Contact.
  Contact& add_contact(std::vector<Obstacle> obstacles, double thickness,
                       std::function<const Embedding&()> embedding = {});
  /// Null without contact.
  ContactLaw* contact() { return contact_.get(); }
  const ContactLaw* contact() const { return contact_.get(); }

  Vec3 acceleration(double time) const;  ///< sum over all terms, m/s^2
  double energy(double time) const;      ///< stored by all terms, J
  double potential(double time) const;   ///< of all terms, J
  // For the loads:
  bool has_loads() const;                          ///< some term adds to rows
  bool is_conservative(double time) const;         ///< TangentTerm::is_conservative() of all terms
  bool has_conservative_loads(double time) const;  ///< the same of all loads
  bool has_transpose(double time) const;           ///< TangentTerm::has_transpose() of all terms
  double last_change() const;                      ///< when the last ramp and motion ends, s
  /// Some component of some vertex with mass is not prescribed. O(vertices).
  bool has_free_vertices();
  /// out += K d with K = df/dx of all terms that have a tangent; 3 numbers per vertex.
  void add_tangent(const double* d, double dx, double dv, const TangentTime& at, double* out) const;
  /// The forces of all terms at these vertices, each given once, excluding acceleration(). O(cells
  /// there).
  std::vector<Vec3> forces_at(std::span<const Index> vertices, double time);

  /// Leaves out cells whose vertices are all permanently fixed from now on (ForceLoop::skip_fixed);
  /// returns their number. Call after the constraints have been added.
  Index skip_fixed_cells() {
    return models_->skip_fixed(constraints_.always_fixed(attributes_.vertex_count()));
  }

  // ---- operations ----

  /// Registers a follower, which is notified of every operation after the attributes, the terms and
  /// the constraints, in the order of registration. It must outlive the last operation.
  void add_follower(Follower& follower) { followers_.push_back(&follower); }

  /// Makes room everywhere, before the run needs it, for what cuts of `faces` faces add, the
  /// largest of them of `largest`. O(faces).
  void make_room(Index faces, Index largest);

  // Operations of CellComplex, after which everything is updated. They throw the errors of the
  // complex; nothing has changed then.
  TopologyChange cut(const std::vector<Dart>& faces);
  /// Removes exactly the elements' shares of momentum and mass with them.
  TopologyChange pierce(const std::vector<Index>& elements);
  /// Velocities are averaged by mass, so momentum is conserved. Joined vertices jump to their
  /// common centre of mass: bring them close together first.
  TopologyChange sew(const std::vector<Seam>& seams);
  /// Replaces elements by copies, whose material is given in their numbers. The energy that
  /// this adds is work of the operation; momentum, mass and kinetic energy do not change.
  /// Where copies absorb other elements, their vertices first move to the mean places of both,
  /// which conserves momentum. `is_cloned`: called when the map has the copies, before anything
  /// follows that may ask for their material.
  TopologyChange clone_volume(const Cloning& cloning, const Parts& parts,
                              const std::function<void()>& is_cloned);
  /// The connected pieces, kept up to date through all operations after the first call.
  const Islands& islands();
  /// The element of the mesh from which each element comes, in the numbers of the complex.
  std::vector<Index> origins() const;
  /// Where blocks of elements are at rest; O(elements) at first and after copies were made.
  const ElementBlocks& blocks_at_rest();

  /// Columns, terms and constraints; in a checkpoint, also the cells.
  void state(Archive& archive);

 private:
  template <class Operate>
  TopologyChange change(const ComingOperation& operation, Operate operate);
  void follow(const TopologyChange& change);
  void share_with(ForceTerm& added);
  void mark_vertices(std::vector<bool>& marks) const;
  void name_copies(std::span<const Index> imported);
  std::vector<Index> around(std::vector<Index> vertices) const;
  void follow_copies(const TopologyChange& change);
  /// The number of elements of the mesh; copies follow.
  Index imported_elements() const {
    return imported_.complex.element_count() - static_cast<Index>(copied_element_.size());
  }

  Imported imported_;
  Attributes attributes_;
  std::vector<Index> user_vertex_;
  std::vector<Index> element_names_;   ///< empty: the numbers of the mesh
  std::vector<Index> copied_element_;  ///< of the mesh, for each copy so far
  std::vector<std::unique_ptr<ForceTerm>> terms_;
  ForceLoop* models_ = nullptr;
  std::unique_ptr<BodyShare> share_;
  std::deque<FieldEquation> fields_;
  Constraints constraints_;
  std::unique_ptr<ContactLaw> contact_;
  std::optional<Islands> islands_;
  std::optional<ElementBlocks> blocks_at_rest_;
  std::vector<Follower*> followers_;
  VertexSelection selection_;
};

}  // namespace suture
