// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "kernel/attributes/contributions.hpp"
#include "kernel/attributes/instance.hpp"
#include "kernel/attributes/merging.hpp"
#include "kernel/attributes/own_rest.hpp"
#include "kernel/attributes/partial_rows.hpp"
#include "kernel/attributes/policies.hpp"
#include "kernel/attributes/table.hpp"
#include "kernel/attributes/touched.hpp"
#include "kernel/attributes/vertex_field.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

class Archive;

/// All attributes of a simulation: the kernel's own columns and those of every
/// instance. apply() is the one place where values follow an operation.
///
/// Memory of the kernel's columns per vertex: 4 x 32 B (rest, position, velocity,
/// force) + 8 B mass + 8 B fixed = 144 B, and 16 B per field; a bit per vertex, edge and face for
/// the sums after an operation; 4 B per element once a region or a SHARE column needs it; 8 B per
/// row of a table with a SHARE column; after the first removal or merge, a bit per row.
class Attributes {
 public:
  /// Kernel columns from the imported mesh: rest position = position, velocity,
  /// force (rows of 4), mass, fixed (bits 1 x, 2 y, 4 z as a double).
  /// Throws InputError unless there is one rest position per vertex.
  Attributes(const CellComplex& complex, std::span<const Vec3> rest);

  /// Adds an instance on `elements` (ascending; empty = all elements), and builds its
  /// columns, its cell sets for the dimensions that its model uses and, in `complex`,
  /// the ids that these need. Throws InputError for a field that another model declares otherwise.
  Instance& add(std::unique_ptr<Instance> instance, CellComplex& complex,
                std::vector<Index> elements);

  /// Sums every from_volumes column (and the mass) over all elements in ascending
  /// order (the mass instance by instance), stores constant columns once and runs
  /// the models' inspections. Throws InputError for errors that a model reports,
  /// PluginError for a contribution that is not finite.
  void initialise(const CellComplex& complex, Diagnostics& diagnostics);

  /// Changes the parameters of an instance (Instance::set_parameters()) and sums again all that is
  /// computed from them, over the elements that there are now. Throws the errors of initialise();
  /// the caller then sets the earlier parameters again. O(elements). Pointers into the columns of
  /// the instance and into mass() are no longer valid.
  void set_parameters(Instance& instance, std::vector<double> parameters,
                      const CellComplex& complex, Diagnostics& diagnostics);
  /// The same with Instance::set_field().
  void set_field(Instance& instance, std::size_t parameter, std::span<const double> values,
                 const CellComplex& complex, Diagnostics& diagnostics);
  /// Sums again what is computed from the parameters of an instance: its columns, and all masses.
  /// O(elements).
  void sum_again(Instance& instance, const CellComplex& complex);
  /// Saves the parameters of all instances, or sets those that are loaded: into a body as it was
  /// built, before its cells are loaded.
  void parameters(Archive& archive, const CellComplex& complex);

  /// Applies the declared policies to the kernel's tables and to those of every
  /// instance: splits, then merges, then removals. Rows of removed cells remain as dead rows; for
  /// removed vertices, the kernel's columns are zero. New cells join the sets of the instances of
  /// their elements. If all elements of an instance move from a cell to a new one, its row is
  /// reassigned to the new cell; therefore row(c) must be read again for every cell c of
  /// change.stars. from_volumes sums of touched cells are bitwise identical to those of
  /// initialise() on the cut complex (but see decision 018). O(cells in the change).
  void apply(const CellComplex& complex, const TopologyChange& change);

  /// Makes room in all columns for the cells that cuts of `faces` faces add, the largest of them of
  /// `largest`. O(faces).
  void make_room(Index faces, Index largest);

  /// To be called after an accepted step: swaps in the trial copies of all columns.
  void accept_trials();

  /// Load it into attributes that were built and initialised in the same way and to which no
  /// operation was applied. Covers what steps change: positions, velocities (48 B per vertex) and
  /// the accepted states of models; with cells also forces and trial copies, and everything else if
  /// apply() was called. Refuses columns that do not match those of the models.
  void state(Archive& archive);

  /// The kernel's columns on cells of a dimension; rows = cells.
  Table& kernel(int dimension) { return kernel_[static_cast<std::size_t>(dimension)]; }
  const Table& kernel(int dimension) const { return kernel_[static_cast<std::size_t>(dimension)]; }

  std::vector<std::unique_ptr<Instance>>& instances() { return instances_; }
  const std::vector<std::unique_ptr<Instance>>& instances() const { return instances_; }

  // The kernel's vertex columns, rows of 4 doubles (x, y, z, unused).
  Column& rest() { return *rest_; }
  Column& position() { return partial_rows_.whole(PartialRows::position, *position_); }
  Column& velocity() { return partial_rows_.whole(PartialRows::velocity, *velocity_); }
  Column& force() { return partial_rows_.whole(PartialRows::force, *force_); }
  PartialRows& partial_rows() { return partial_rows_; }
  /// Process 0 of several gets all positions and velocities, for files that it writes. Not forces:
  /// those at vertices of others have to be cleared before the next are added.
  void gather_motion();
  Column& mass() { return *mass_; }                     ///< kg, rows of 1
  Column& fixed() { return *fixed_; }                   ///< rows of 1
  Index vertex_count() const { return mass_->size(); }  ///< rows, dead ones included

  /// The unknowns on vertices that models declare, in the order of their first declaration.
  std::deque<VertexField>& fields() { return fields_; }
  const std::deque<VertexField>& fields() const { return fields_; }
  /// That of a functor whose `force` is its rate; nullptr for one that computes forces.
  VertexField* field_of(const suture_model& model, const suture_functor& functor);

  /// The rest positions of elements; the column rest() alone ignores elements that have
  /// separate rest positions. The accessor refers to both and to `complex`.
  RestPlaces rest_places(const CellComplex& complex) const {
    return {complex, *rest_, own_rest_, parts_};
  }

  /// Elements of which only a part is material. Masses, and all that elements contribute to their
  /// vertices, edges and faces, are multiplied by their fractions; models that are not made for
  /// such elements are refused by add(). To be called before it. Throws InputError for an element
  /// that is not a parallelepiped at rest if they are not described as general ones.
  void set_parts(const CellComplex& complex, ElementParts parts);
  const ElementParts& parts() const { return parts_; }
  /// Cuts along blades may make more of them; models that are not made for them are refused from
  /// now on. To be called before add().
  void let_parts_grow(const CellComplex& complex);
  /// Call around an operation that copies elements, with the parts of the copies. `origins`: of the
  /// copies, in the same order; they must still exist.
  void begin_copies(const CellComplex& complex, const Parts& copies,
                    std::span<const Index> origins);
  void end_copies() { parts_.end_copies(); }
  /// Vertices that are declared equal get the mean position and velocity, by mass, and the mean of
  /// each field, by capacity. Prescribed components have the last word.
  void bring_together(const std::vector<std::pair<Index, Index>>& equal);

  /// The numbers of elements as users see them, for messages and suture_batch.cell_ids; set
  /// before initialise() and owned by the caller. Empty: the numbers of the complex.
  std::span<const Index> user_element;

 private:
  void share_columns(Instance& instance);
  VertexField& declare(const suture_attribute& attribute, const Instance& instance);
  void clear_sums();
  void have_changed(Instance& instance, const CellComplex& complex, Diagnostics& diagnostics);
  void sum(Instance& instance, std::uint32_t number, const CellComplex& complex, RestBatch& rest,
           std::span<const double> uniform);
  void add_copies(const CellComplex& complex, std::span<const Split> copies);
  void follow(std::span<Table, 4> tables, const CellComplex& complex, const TopologyChange& change,
              std::size_t first_column = 0);
  void merge_vertices(const CellComplex& complex, const TopologyChange& change);
  void clear_vertices(const TopologyChange& change);
  void clear_vertex(Index vertex);
  void complete_rows();
  void kernel_tables(Archive& archive);
  void motion(Archive& archive);
  void forces(Archive& archive);

  std::array<Table, 4> kernel_;
  std::vector<std::unique_ptr<Instance>> instances_;
  Column *rest_, *position_, *velocity_, *force_, *mass_, *fixed_;
  PartialRows partial_rows_;
  std::deque<VertexField> fields_;
  TouchedElements touched_;
  OwnRest own_rest_;
  ElementParts parts_;
  SplitPolicies policies_;
  MergePolicies merging_;
  std::vector<MergeWeight> vertex_weights_;
  TouchedSums sums_;
  std::uint64_t operations_ = 0;  ///< applied
};

}  // namespace suture
