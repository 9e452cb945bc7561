// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "kernel/attributes/instance.hpp"
#include "kernel/attributes/table.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// All attributes of a simulation: the kernel's own columns and those of every
/// instance. apply() is the one place where values follow an operation.
class Attributes {
 public:
  /// Kernel columns from the imported mesh: rest position = position, velocity,
  /// force (rows of 4), mass, fixed (bits 1 x, 2 y, 4 z as a double).
  Attributes(const CellComplex& complex, std::span<const Vec3> rest);

  /// Adds an instance on `elements` (ascending; empty = all elements), builds its
  /// cell sets for the dimensions its model uses, and its columns.
  Instance& add(std::unique_ptr<Instance> instance, const CellComplex& complex,
                std::vector<Index> elements);
  /// Sums every from_volumes column (and the mass) over all elements; stores
  /// constant columns once; runs the models' inspections.
  void initialise(const CellComplex& complex, Diagnostics& diagnostics);

  /// Applies the declared policies. O(cells in the change).
  void apply(const CellComplex& complex, const TopologyChange& change);

  Table& kernel(int dimension) { return kernel_[dimension]; }
  const Table& kernel(int dimension) const { return kernel_[dimension]; }
  std::vector<std::unique_ptr<Instance>>& instances() { return instances_; }

  // The kernel's vertex columns, rows of 4 doubles (x, y, z, unused).
  Column& rest() { return *rest_; }
  Column& position() { return *position_; }
  Column& velocity() { return *velocity_; }
  Column& force() { return *force_; }
  Column& mass() { return *mass_; }
  Column& fixed() { return *fixed_; }
  Index vertex_count() const { return mass_->size(); }

 private:
  std::array<Table, 4> kernel_;
  std::vector<std::unique_ptr<Instance>> instances_;
  Column *rest_, *position_, *velocity_, *force_, *mass_, *fixed_;
};

}  // namespace suture
