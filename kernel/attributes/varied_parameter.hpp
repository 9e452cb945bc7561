// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include "kernel/attributes/attributes.hpp"

namespace suture {

/// Other values of a parameter of an instance for a while, with the columns and masses that follow
/// from them. When it ends, every bit is as it was, at the same addresses.
class VariedParameter {
 public:
  /// The place of a parameter in its model. Throws InputError if there is none of this name, or if
  /// it is not a number.
  static std::size_t number_of(const Instance& instance, const std::string& name);

  /// Throws InputError if the model has no such parameter, or if it is not a number.
  VariedParameter(Attributes& attributes, Instance& instance, const CellComplex& complex,
                  const std::string& name);
  ~VariedParameter();
  VariedParameter(const VariedParameter&) = delete;
  VariedParameter& operator=(const VariedParameter&) = delete;

  const suture_parameter& parameter() const { return instance_.model().parameters[number_]; }
  /// Its values as they were: of each row of instance.table(3) if they may differ from element to
  /// element, otherwise one.
  std::span<const double> values() const { return values_; }
  bool is_per_element() const { return column_ != nullptr; }

  /// Sets as many values. Throws the errors of Attributes::set_parameters(). O(elements).
  void set(std::span<const double> values);

 private:
  void keep_columns();

  Attributes& attributes_;
  Instance& instance_;
  const CellComplex& complex_;
  std::size_t number_;
  Column* column_ = nullptr;
  std::vector<double> parameters_, values_;
  std::deque<Column> kept_;  ///< the columns of the instance, then the masses; empty: not set
};

}  // namespace suture
