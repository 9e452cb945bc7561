// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/base/bulk.hpp"
#include "kernel/forces/batch_list.hpp"
#include "kernel/forces/checked_force.hpp"
#include "kernel/plugin_host/plugin_call.hpp"

namespace suture {

/// The vertices of the rows of an instance's vertices, edges, faces or lips, kept up to date
/// through all operations, and their rest positions where they differ from those of the vertices.
/// Elements do not need this: they use the list of the complex and OwnRest. Rows of faces that are
/// no lips have no vertices where a functor acts on lips.
class RowNodes {
 public:
  /// For all functors of the instance on the same cells as `functor`.
  RowNodes(const Instance& instance, const suture_functor& functor, const RestPlaces& rest);
  /// O(cells in the change); of lips O(n log n) for all n pairs.
  void update(const RestPlaces& rest, const TopologyChange& change);
  /// Makes room for so many new rows. O(rows).
  void make_room(Index rows) { suture::make_room(nodes_, rows * node_count_); }
  int dimension() const { return dimension_; }
  /// To be called after state() of the attributes.
  void state(Archive& archive);
  const Index* data() const { return nodes_.data(); }
  /// As in loops::Job; null while no element has separate rest positions.
  const Index* rest_slots() const { return rest_slot_.empty() ? nullptr : rest_slot_.data(); }
  const double* own_rest() const { return own_rest_.data(); }

 private:
  void read_nodes(const CellComplex& complex, const TopologyChange& change);
  void read_rest(const RestPlaces& rest, std::span<const Index> elements);
  void read_rest_of(const RestPlaces& rest, Index cell);
  void read_row(const CellComplex& complex, Index row);
  void read_cell(const CellComplex& complex, Index cell);
  void read_elements(const CellComplex& complex, std::span<const Index> elements);
  void read_lips(const CellComplex& complex);
  template <int Dimension>
  void follow_vertices(const CellComplex& complex, const TopologyChange& change, Index rows);

  const Instance& instance_;
  const CellSet& cells_;
  int dimension_;
  bool on_lips_;
  std::size_t node_count_;
  std::vector<Index> nodes_;
  std::vector<Index> rest_slot_;    ///< by row
  AlignedVector<double> own_rest_;  ///< node_count_ rows of 4 per slot
};

/// One functor of one instance, ready to run: which rows, which arrays.
class CompiledFunctor {
 public:
  /// `nodes`: of the functor's cells, dimension 0 to 2; else null. `on_parts`: not the functor
  /// itself, but what replaces it on elements of which only a part is material.
  CompiledFunctor(Instance& instance, const suture_functor& functor, const RowNodes* nodes,
                  const suture_functor* on_parts = nullptr);

  /// Rebuilds rows, chunks and colours. O(rows).
  void build(const CellComplex& complex);
  /// Leaves out rows between `fixed` vertices, now and after every change.
  void leave_out(const std::vector<bool>* fixed, const CellComplex& complex);
  /// Follows a change; `nodes` must already be up to date.
  void update(const CellComplex& complex, const TopologyChange& change);

  /// To be called after state() of the attributes. `fixed`: as for leave_out(), from now on.
  void state(Archive& archive, const std::vector<bool>* fixed);

  /// The job with the current addresses of all columns, for the live rows, adding to `force`.
  /// O(columns).
  const loops::Job& job(Attributes& attributes, const CellComplex& complex, const LiveMask& live,
                        double time, double dt, double* force);
  const CellSet& cells() const { return instance_.table(dimension_).cells; }
  int dimension() const { return dimension_; }
  /// The vertices of the rows of cells().
  Connectivity connectivity(const CellComplex& complex) const;
  /// True if the loop visits the row, or leaves it out because its vertices never move.
  bool visits(const CellComplex& complex, Index row) const;

  Instance& instance() const { return instance_; }
  const suture_functor& functor() const { return functor_; }
  std::uint32_t reads() const { return reads_; }
  /// Whether it reads columns that steps change (SUTURE_TRIAL).
  bool has_states() const;
  /// Per node, of what it computes: 3 of a force, or those of its field.
  Index components() const;
  bool reads_field() const;  ///< whether it reads one (SUTURE_FIELD)
  bool skipped() const { return !reason_.empty(); }
  const std::string& reason() const { return reason_; }
  const BatchList& list() const { return list_; }
  /// Without the blocks whose vertices are all among `others`; of the first call since a change.
  const BatchList& list_without(const std::vector<bool>& others, const CellComplex& complex);
  void forget_list_without() { list_without_.reset(); }
  std::string title() const;  ///< "model 'tissue' (mss-baudet), functor 'edge springs'"

  /// From now on every call of the force is checked (checked_force.hpp).
  void check_calls() { function_ = &checked_force; }
  PluginCall call(const char* function) const {
    PluginCall call = instance_.call(function);
    call.functor = &functor_;
    return call;
  }

  template <class Extension>
  const Extension* extension(const char* id) const {
    return extension_of<Extension>(functor_, id);
  }

 private:
  void read_columns(Attributes& attributes);
  bool visits_some_faces() const;
  std::vector<loops::Rows> wanted_rows(const CellComplex& complex) const;
  std::vector<loops::Rows> element_rows() const;
  std::vector<loops::Rows> rows_from(Index first) const;
  bool append(const CellComplex& complex, Index first);
  std::vector<loops::Rows> wanted_faces(const CellComplex& complex) const;
  bool follow_merges(const CellComplex& complex, const TopologyChange& change);
  std::vector<Index> rows_at(const CellComplex& complex, Dart dart) const;

  Instance& instance_;
  const suture_functor& functor_;
  bool on_parts_;
  suture_force_fn function_;
  const RowNodes* nodes_;
  int dimension_;
  std::uint32_t reads_;
  std::string reason_;  ///< why the functor is skipped
  BatchList list_;
  std::optional<BatchList> list_without_;
  const std::vector<bool>* fixed_ = nullptr;
  Index rows_ = 0;  ///< of the table when the list was built or last appended to
  loops::Job job_{};
  std::vector<loops::CellColumn> cell_columns_;
  std::vector<std::uint32_t> varying_columns_;
  std::vector<loops::VertexColumn> vertex_columns_;
};

}  // namespace suture
