// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kernel/attributes/findings.hpp"
#include "kernel/attributes/own_rest.hpp"
#include "kernel/attributes/part_column.hpp"
#include "kernel/attributes/table.hpp"
#include "kernel/base/diagnostics.hpp"
#include "kernel/plugin_host/guarded_array.hpp"
#include "kernel/plugin_host/plugin_call.hpp"
#include "kernel/topology/cell_complex.hpp"
#include "suture/parts.h"

namespace suture {

/// All existing cells of a dimension; row = cell, removed cells are dead rows. O(1)
/// if no cell was removed.
CellSet all_cells(const CellComplex& complex, int dimension);

/// Whether the values of an attribute are a column of the kernel, not of an instance.
inline bool is_of_kernel(const suture_attribute& attribute) {
  return (attribute.flags & (SUTURE_SHARED_MASS | SUTURE_FIELD | SUTURE_CAPACITY |
                             SUTURE_RELAXATION | SUTURE_FIELD_RATE)) != 0;
}

/// Values that a scene gives to a column of a model.
struct GivenColumn {
  std::uint32_t attribute = 0;  ///< its place in the model's list
  bool by_cell = false;
  /// All components of cell 0 of the complex, then those of cell 1, ... (dimension 0 and 3); of
  /// one that stands for all unless given by cell.
  std::vector<double> values;
};

/// One use of a model in a scene, with its parameters, region and columns. A model
/// that is used twice has two instances; an edge between them has a row in each,
/// summed from the elements of each. Neither copied nor moved: contexts point into
/// it.
class Instance {
 public:
  /// Runs the model's prepare(). Throws InputError with the errors that it reported,
  /// PluginError if it failed or takes another number of parameters. The tables are
  /// trusted: the plugin host checks them when it loads them. With `skip` false,
  /// functors that add nothing are computed, too (suture run --no-skip). A parameter that differs
  /// from element to element is NaN in `parameters`, and its column is `given`.
  Instance(const suture_model& model, std::string name, std::vector<double> parameters,
           Diagnostics& diagnostics, bool skip = true, std::vector<GivenColumn> given = {});
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  const suture_model& model() const { return model_; }
  const std::string& name() const { return name_; }
  std::span<const double> parameters() const { return parameters_; }
  /// Changes the parameters after build(): calls prepare() and enabled() again, and fills the
  /// columns of uniform parameters. Throws InputError if the model refuses them, or if it enabled
  /// other functors or inputs than those that are built; nothing has changed then.
  void set_parameters(std::vector<double> parameters, Diagnostics& diagnostics);
  /// The same with one parameter that may differ from element to element: its values, by row of
  /// table(3).
  void set_field(std::size_t parameter, std::span<const double> values, Diagnostics& diagnostics);
  /// The parameters that set_field() has set and that still differ between elements, ascending.
  std::vector<std::uint32_t> changed_fields() const;
  /// Rows of table(3) after build(); those of copies of elements follow.
  Index built_rows() const { return built_rows_; }
  /// "model 'tissue' (mss-baudet)", the beginning of messages.
  std::string title() const;
  /// Describes a call of a function of the model.
  PluginCall call(const char* function) const {
    return {.function = function, .model = &model_, .instance = name_.c_str()};
  }

  /// What enabled() returned for a functor with these parameters; it is called once.
  struct Enabled {
    bool runs = true;
    std::uint32_t reads = 0;  ///< those of the declared suture_read bits that it needs
    bool operator==(const Enabled&) const = default;
  };
  const Enabled& functor(std::size_t number) const { return enabled_[number]; }
  bool skips() const { return skip_; }

  /// False for an attribute that is read only by functors that do not run: it gets no
  /// column. Attributes for output, and those that no functor names, are needed.
  bool needs(std::uint32_t attribute) const { return needed_[attribute]; }
  /// True if a needed attribute or an enabled functor is on cells of `dimension`.
  bool uses(int dimension) const;

  /// Tables of the dimensions that uses(), and always table(3), whose cells are
  /// the region. A row exists for a cell if and only if it has an incident
  /// element of the region.
  Table& table(int dimension) { return tables_[static_cast<std::size_t>(dimension)]; }
  const Table& table(int dimension) const { return tables_[static_cast<std::size_t>(dimension)]; }

  std::span<Table, 4> tables() { return tables_; }

  /// Column of an attribute by its position in model().attributes; nullptr for one that
  /// instances share (is_of_kernel()), and if it is not needed.
  Column* column(std::uint32_t attribute) const { return columns_[attribute]; }
  /// The kernel's column of an attribute that instances share, with a row per vertex: its mass, a
  /// field or the capacity of one; nullptr for others.
  Column* shared_column(std::uint32_t attribute) const { return shared_columns_[attribute]; }
  /// To be called after build().
  void share(std::uint32_t attribute, Column& column) { shared_columns_[attribute] = &column; }

  /// The columns of parameters that may differ from element to element (SUTURE_PARAMETER), in the
  /// order of the model's attributes.
  std::span<const Column* const> parameter_columns() const { return parameter_columns_; }

  /// That of a parameter by its place in model().parameters; nullptr if it is the same in all
  /// elements.
  Column* parameter_column(std::size_t parameter) const;

  /// The columns that were given cell by cell.
  std::span<const Column* const> columns_given_by_cell() const { return by_cell_; }

  /// Builds cell sets and columns for `elements` (ascending; empty = all existing
  /// ones), and ids of edges and faces if the model uses them. Called by
  /// Attributes::add. O(elements of the complex).
  void build(CellComplex& complex, const RestPlaces& rest, std::vector<Index> elements);

  /// Context for worker `worker` (0 .. workers-1), with a separate error record, to be
  /// reset() before a call. There is one worker until set_workers().
  suture_context& context(unsigned worker) { return workers_[worker]->context; }
  void set_workers(unsigned count);

  /// The pairs of faces between which functors on lips act (attributes/lips.hpp): the first lies on
  /// an element of the region. By ascending faces; set before build().
  std::vector<Seam> lips;

  /// Passes on what the model has reported; throws InputError for its errors.
  void deliver_findings(Diagnostics& diagnostics) { findings_.deliver(title(), diagnostics); }

  /// First row of table(3) whose element is not a parallelepiped at rest: the rows of
  /// parallelepipeds come first. table(3).cells.size() if no functor of the
  /// model asks for the shape (nothing is classified then).
  Index general_begin = 0;
  /// First row of a parallelepiped that is no box: boxes come first of all. No batch of a functor
  /// on parallelepipeds holds both.
  Index skewed_begin = 0;
  /// First row of table(3) whose element is only in part material; these come last, whatever their
  /// shape. table(3).cells.size() if there are none.
  Index part_begin = 0;
  bool has_parts() const { return part_begin < table(3).cells.size(); }
  /// Whether copies of elements may become parts (ElementParts::may_grow()).
  bool may_get_parts() const { return may_get_parts_; }
  /// Adds rows for the copies of its elements, with their values; shares (SUTURE_SHARE) go by
  /// fractions. O(copies).
  void add_copies(std::span<const Split> copies, const ElementParts& parts);
  /// Whether rows of elements were added: then their columns are no longer those of build().
  bool has_copies() const { return table(3).cells.size() > built_rows_; }
  /// Saves the shapes of added rows; call after their cells, if has_copies().
  void state_of_copies(Archive& archive, const ElementParts& parts);
  /// What functor `number` of the model does on such elements; null if nothing.
  const suture_functor* part_functor(std::size_t number) const {
    return part_functors_.empty() ? nullptr : part_functors_[number];
  }
  /// Which functors compute a row. Copies of elements are parts, unless sewing has made them whole
  /// again: then they have the shape that the element had.
  enum class RowShape : std::uint8_t { box, skewed, general, part };
  RowShape shape(Index row) const {
    if (row >= part_begin)
      return is_part_[row - part_begin] != 0 ? RowShape::part : whole_shape(row);
    return row < skewed_begin    ? RowShape::box
           : row < general_begin ? RowShape::skewed
                                 : RowShape::general;
  }
  /// Whether functors of SUTURE_GENERAL shape compute the row.
  bool is_general(Index row) const {
    const RowShape of = shape(row);
    return of == RowShape::part ? parts_are_general_ : of == RowShape::general;
  }
  /// SUTURE_PART_COLUMN or SUTURE_GENERAL_PART_COLUMN, from part_begin on.
  const PartColumn& part_column(std::uint32_t place) const {
    return place == SUTURE_PART_COLUMN ? moments_ : general_parts_;
  }

 private:
  struct Worker {
    suture_error error;
    suture_context context;
  };
  void prepare(Diagnostics& diagnostics);
  void ask_functors();
  void choose_alternative(std::size_t number);
  void find_needed();
  bool is_read(std::uint32_t attribute) const;
  bool has_cells(const suture_functor& functor) const;
  bool asks_for_shape() const;
  CellSet region(const RestPlaces& rest, std::vector<Index> elements);

  void find_part_functors();
  [[noreturn]] void refuse_parts(const suture_functor& functor) const;
  void fill_parts(const ElementParts& parts, Index first_row);
  /// The shape of the row's element if it is, or became, whole.
  RowShape whole_shape(Index row) const {
    return row < part_begin ? shape(row) : static_cast<RowShape>(shapes_[row - part_begin]);
  }
  void fill_parameter_columns();
  void fill_columns();
  void fill(const GivenColumn& given);

  const suture_model& model_;
  std::string name_;
  std::vector<double> parameters_;
  std::vector<GivenColumn> given_;  ///< until build()
  std::vector<const Column*> parameter_columns_, by_cell_;
  std::vector<std::uint32_t> changed_fields_;
  std::array<Table, 4> tables_;
  std::vector<Column*> columns_, shared_columns_;
  std::vector<std::uint8_t> shapes_, is_part_;  ///< by row, from part_begin on
  PartColumn moments_{SUTURE_PART_COMPONENTS};
  PartColumn general_parts_{SUTURE_GENERAL_PART_COMPONENTS};  ///< if parts_are_general_
  std::vector<const suture_functor*> part_functors_;          ///< empty if there are no parts
  std::vector<Enabled> enabled_;                              ///< by position in model().functors
  std::vector<bool> needed_;                                  ///< by position in model().attributes
  bool skip_;
  bool may_get_parts_ = false;
  bool parts_are_general_ = false;
  Index built_rows_ = 0;  ///< of table(3)
  void* own_memory() const { return prepared_ ? prepared_->data() : nullptr; }
  std::span<double> behind_own_memory() const;
  std::optional<GuardedArray> prepared_;  ///< the model's own memory, then values that must stay
  std::vector<std::unique_ptr<Worker>> workers_;
  Findings findings_;
};

}  // namespace suture
