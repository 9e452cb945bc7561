// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/factored_rows.hpp"

#include <cmath>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

/// Calls visit(row, column, place of the block or `none`, index in the block) for the lower
/// triangle, column by column. Nodes without a row still have their diagonal.
template <class Visit>
void for_each_below(const BlockPattern& pattern, Visit visit) {
  for (Index node = 0; node < pattern.rows(); ++node)
    for (Index c = 0; c < 3; ++c) {
      bool has_diagonal = false;
      for (Index i = pattern.begin[node]; i < pattern.begin[node + 1]; ++i) {
        const Index other = pattern.column[i];
        if (other < node) continue;
        has_diagonal |= other == node;
        // The rows of the block (node, other): the matrix is symmetric.
        for (Index r = other == node ? c : 0; r < 3; ++r)
          visit(other * 3 + r, node * 3 + c, i, 3 * r + c);
      }
      if (!has_diagonal) visit(node * 3 + c, node * 3 + c, none, Index{0});
    }
}

}  // namespace

double FactoredRows::analyse(const BlockPattern& pattern) {
  begin_.assign(std::size_t{pattern.rows()} * 3 + 1, 0);
  row_.clear();
  for_each_below(pattern, [&](Index row, Index column, Index, Index) {
    row_.push_back(static_cast<std::int32_t>(row));
    begin_[column + 1] = static_cast<std::int32_t>(row_.size());
  });
  value_.clear();
  if (!factor_) factor_ = make_sparse_factor();
  return factor_->analyse(view());
}

void FactoredRows::fill(const BlockRows<double>& a, const Held& held,
                        const std::vector<bool>& soft) {
  // A singular matrix must not depend on rounding.
  constexpr double least = 1e-10, softness = 1e-3;
  value_.clear();
  value_.reserve(row_.size());
  for_each_below(a.pattern(), [&](Index row, Index column, Index place, Index in_block) {
    double value = place == none ? 0 : a.block(place)[in_block];
    if (!std::isfinite(value)) throw NumericalError("the tangent is not finite");
    if (row == column) {
      if (held[row] || value == 0) value = 1;
      value *= 1 + least + (!soft.empty() && soft[row / 3] ? softness : 0);
    }
    value_.push_back(value);
  });
}

void FactoredRows::raise_diagonal(double part) {
  double mean = 0;
  const std::size_t size = begin_.size() - 1;
  const auto diagonal = [&](std::size_t i) -> double& {
    return value_[static_cast<std::size_t>(begin_[i])];
  };
  for (std::size_t i = 0; i < size; ++i) mean += std::abs(diagonal(i)) / static_cast<double>(size);
  for (std::size_t i = 0; i < size; ++i)
    diagonal(i) += part * std::max(std::abs(diagonal(i)), 1e-6 * mean);
}

void FactoredRows::factor(const BlockRows<double>& a, const Held& held,
                          const std::vector<bool>& soft) {
  fill(a, held, soft);
  shift_ = 0;
  for (double part = 1e-8; !factor_->factor(view()); part *= 100) {
    if (part > 1e4)
      throw NumericalError(
          "the tangent is too indefinite to be factored, as where a body buckles, snaps through or "
          "slides off what holds it");
    raise_diagonal(part);
    shift_ += part;
  }
}

}  // namespace suture
