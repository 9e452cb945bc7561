// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kernel/attributes/instance.hpp"
#include "kernel/attributes/own_rest.hpp"

namespace suture {

/// Number of cells of a dimension to which a contribution of one 3-cell gives values:
/// 8 vertices, 12 edges, 6 faces or the cell itself.
inline constexpr std::array<int, 4> contribution_cells = {8, 12, 6, 1};

/// The batch that a contribution functor reads: rest positions of up to eight
/// elements and their parameters, lane-fastest; lanes after the last element repeat it.
class RestBatch {
 public:
  /// `user_element`: numbers as messages show them, or empty.
  RestBatch(const RestPlaces& rest, std::span<const Index> user_element);

  /// 1..8 elements of the instance's region.
  const suture_batch& gather(const Instance& instance, std::span<const Index> elements);
  const suture_batch& batch() const { return batch_; }  ///< that of gather()
  /// Multiplies what the elements last gathered contribute to their vertices, edges or faces
  /// (contribute()) by the fractions of them that are material.
  void scale(const suture_attribute& attribute, double* out) const;
  const ElementParts& parts() const { return rest_.parts(); }

 private:
  void gather_parameters(const Instance& instance, std::span<const Index> elements);

  RestPlaces rest_;
  std::span<const Index> user_element_;
  alignas(SUTURE_ALIGNMENT) std::array<double, 8 * 3 * SUTURE_LANES> positions_, zeros_{};
  std::array<std::uint32_t, SUTURE_LANES> ids_;
  std::array<double, SUTURE_LANES> fractions_;
  bool has_parts_ = false;
  AlignedVector<double> parameters_;
  std::vector<const double*> parameter_columns_;
  suture_batch batch_{};
};

/// Calls an attribute's contribution functor. Throws InputError with the model's
/// text if it fails: the rest shape of an element does not suit the model. Throws PluginError
/// for values that are not finite, and for a negative mass.
/// out: contribution_cells x components x 8 doubles.
void contribute(Instance& instance, const suture_attribute& attribute, const suture_batch& batch,
                double* out);

/// What the first element of the region contributes to a from_volumes attribute of dimension 0..2
/// (contribution_cells x components) if the contributions of all elements are equal to within
/// `relative` times their largest value; otherwise empty. O(elements), less if they differ.
std::vector<double> uniform_contribution(Instance& instance, const suture_attribute& attribute,
                                         const CellComplex& complex, RestBatch& rest,
                                         double relative);

/// A from_volumes attribute summed over all elements of the region, in ascending
/// order, into `column`; its rows are those of `cells`. Sums are added to what
/// `column` holds. `uniform`: the contribution of every element (uniform_contribution()), or
/// empty: the functor is called. O(elements).
void sum_contributions(Instance& instance, const suture_attribute& attribute,
                       const CellComplex& complex, RestBatch& rest, const CellSet& cells,
                       Column& column, std::span<const double> uniform);

/// The same for an attribute of elements that depends only on parameters (SUTURE_FROM_PARAMETERS)
/// if these are uniform: asks for one element, and the column is constant. Otherwise returns false.
bool fill_from_parameters(Instance& instance, const suture_attribute& attribute,
                          const CellComplex& complex, RestBatch& rest, Column& column);

/// Repeats these sums at the cells that an operation touched. Its work space, a bit per
/// vertex, edge and face, is kept between operations.
class TouchedSums {
 public:
  /// Allocates the marks; otherwise the first operation does.
  void reserve(const CellComplex& complex);

  /// From now on sum() uses `values` as the contribution of every element, unless they are empty.
  /// Returns the stored values.
  std::span<const double> keep_uniform(const Instance& instance, const suture_attribute& attribute,
                                       std::vector<double> values);

  /// The stored values, or none.
  std::span<const double> uniform(const Instance& instance,
                                  const suture_attribute& attribute) const;

  /// Sums all from_volumes attributes of the instance at the touched cells; its shares
  /// are added to shared columns, whose touched rows the caller has set to zero. Each sum
  /// adds the same values in the same order as sum_contributions() on the complex
  /// after the operation: the same bits. O(cells and elements in the change).
  void sum(Instance& instance, const CellComplex& complex, RestBatch& rest,
           const TopologyChange& change);
  /// To be called after the last sum() for a change.
  void clear(const TopologyChange& change);

 private:
  struct Target {
    const suture_attribute* attribute;
    Column* column;
    const CellSet* cells;  ///< nullptr: of a shared column, row = cell
    double* values;
    std::size_t components;
    const double* uniform = nullptr;  ///< the contribution of every element

    /// Sets the rows of cells to the sums over their elements in the region. `parts`: null if all
    /// of these are full.
    template <int Dimension>
    void sum_uniform(const Stars& stars, const CellSet& region, const ElementParts* parts) const;
  };
  /// A value in the batch of contributions that belongs to a touched cell.
  struct Hit {
    Index cell;
    std::uint16_t k, lane;  ///< local number of the cell in the element of the lane
  };
  struct Uniform {
    const Instance* instance;
    const suture_attribute* attribute;
    std::vector<double> values;
  };
  void mark(const CellComplex& complex, const TopologyChange& change);
  template <int Dimension>
  void sum_uniform(const Instance& instance, const TopologyChange& change,
                   const ElementParts& parts);
  void find_targets(Instance& instance, const TopologyChange& change);
  static void start(const Target& target, const TopologyChange& change);
  void add_batch(Instance& instance, const CellComplex& complex, const RestBatch& rest,
                 std::span<const Index> elements);
  void find_hits(const CellComplex& complex, std::uint32_t dimension,
                 std::span<const Index> elements);
  void add_hits(Instance& instance, const RestBatch& rest, Target& target);

  std::array<std::vector<std::uint64_t>, 3> marks_;  ///< all zero between operations
  std::array<Hit, std::size_t{12} * SUTURE_LANES + 1> hits_;
  std::size_t hit_count_ = 0;
  std::array<std::vector<Target>, 3> targets_, uniform_targets_;
  std::vector<Uniform> uniform_;
  bool marked_ = false;
};

}  // namespace suture
