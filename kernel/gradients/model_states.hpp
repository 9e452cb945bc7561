// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"

namespace suture {

/// The states of all models with a memory (SUTURE_TRIAL), as one row of numbers. A step leads from
/// the accepted ones, z, to the trial ones, z'.
class ModelStates {
 public:
  explicit ModelStates(Attributes& attributes);

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  std::vector<double> accepted() const;
  std::vector<double> trial() const;
  void set_accepted(std::span<const double> values) const;

  /// weights . z'
  double work(std::span<const double> weights) const;
  /// The same for each cell of the instance with this dimension: out[row] += its part.
  void add_work(const Instance& instance, int dimension, std::span<const double> weights,
                std::span<double> out) const;

  /// The numbers of one component of a state, one per row of its table.
  struct Component {
    Instance* instance;
    Column* column;
    int number;          ///< in the column
    std::size_t begin;   ///< of the numbers of the column
    std::size_t stride;  ///< components of the column
    std::size_t place(Index row) const {
      return begin + row * stride + static_cast<std::size_t>(number);
    }
  };
  const std::vector<Component>& components() const { return components_; }

 private:
  template <class Visit>
  void for_each(Visit visit) const;
  std::vector<Component> components_;
  std::size_t size_ = 0;
};

}  // namespace suture
