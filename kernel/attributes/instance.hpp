// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "kernel/attributes/table.hpp"
#include "kernel/base/diagnostics.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// One use of a model in a scene: its parameters, its region, its own columns.
/// The same model twice is two instances; an edge between them has a row in
/// each, summed from the elements of each.
class Instance {
 public:
  /// `elements`: of the region, ascending; empty = all. Runs the model's
  /// prepare(); throws PluginError / InputError with what it reported.
  Instance(const suture_model& model, std::string name, std::vector<double> parameters,
           Diagnostics& diagnostics);

  const suture_model& model() const { return model_; }
  const std::string& name() const { return name_; }
  std::span<const double> parameters() const { return parameters_; }

  Table& table(int dimension) { return tables_[dimension]; }
  const Table& table(int dimension) const { return tables_[dimension]; }

  /// Context for worker `worker` (0 .. workers-1); error record of its own.
  suture_context& context(unsigned worker);
  void set_workers(unsigned count);

  /// First row of table(3) whose element is no parallelepiped at rest: rows are
  /// ordered parallelepipeds first.
  Index general_begin = 0;

 private:
  const suture_model& model_;
  std::string name_;
  std::vector<double> parameters_;
  std::array<Table, 4> tables_;
  AlignedVector<double> prepared_;
  std::vector<std::unique_ptr<suture_error>> errors_;
  std::vector<suture_context> contexts_;
};

}  // namespace suture
