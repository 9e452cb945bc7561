// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/processes/process_share.hpp"

#include <algorithm>
#include <numeric>

namespace suture {

ProcessShare::ProcessShare(Communicator& processes)
    : processes_(processes), added_(processes.size()), counts_(processes.size()) {}

loops::Rows ProcessShare::part_of(unsigned process, Index count) const {
  const auto border = [&](std::uint64_t i) {
    return static_cast<Index>(i * count / processes_.size());
  };
  return {border(process), border(process + 1)};
}

/// The borders stay where they are at first, whatever operations do.
std::vector<bool> ProcessShare::others(const CellComplex& complex) {
  const Index elements = complex.element_count(), vertices = complex.count(0);
  std::vector<unsigned> owner(elements);
  for (unsigned p = 0; p < processes_.size(); ++p) {
    const auto [begin, end] = part_of(p, elements);
    std::fill(owner.begin() + begin, owner.begin() + end, p);
  }
  const auto owner_of = [&](Index v) { return owner[element_of(complex.dart_of(0, v))]; };
  if (borders_.empty()) {
    borders_.resize(processes_.size() + 1);
    for (Index v = 0; v < vertices; ++v)
      ++borders_[complex.exists(0, v) ? owner_of(v) + 1 : processes_.size()];
    std::inclusive_scan(borders_.begin(), borders_.end(), borders_.begin());
  }
  std::vector<bool> others(vertices, true);
  const unsigned me = processes_.rank();
  std::fill(others.begin() + borders_[me], others.begin() + borders_[me + 1], false);
  for (auto& list : added_) list.clear();
  for (Index v = borders_.back(); v < vertices; ++v) {
    if (!complex.exists(0, v)) continue;
    added_[owner_of(v)].push_back(v);
    others[v] = owner_of(v) != me;
  }
  return others;
}

/// Failures are rare: their texts follow only where there is one.
void ProcessShare::exchange(Failure& failure) {
  mine_.push_back(failure.any() ? 1 : 0);
  all_.resize(std::reduce(counts_.begin(), counts_.end(), std::size_t{0}));
  processes_.gather(mine_, counts_, all_.data());
  mine_.clear();
  bool any = false;
  std::size_t end = 0;
  for (const int count : counts_) any |= all_[(end += static_cast<std::size_t>(count)) - 1] != 0;
  if (!any) return;
  for (const std::string& text : processes_.gather(failure.packed()))
    failure.merge(Failure::unpacked(text));
}

void ProcessShare::join(double* rows, Failure& failure) {
  for (unsigned p = 0; p < processes_.size(); ++p)
    counts_[p] = static_cast<int>(4 * (borders_[p + 1] - borders_[p]));
  processes_.complete(rows, counts_);
  for (const Index v : added_[processes_.rank()]) {
    const double* row = rows + std::size_t{v} * 4;
    mine_.insert(mine_.end(), row, row + 3);
  }
  for (unsigned p = 0; p < processes_.size(); ++p)
    counts_[p] = static_cast<int>(3 * added_[p].size() + 1);
  exchange(failure);
  const double* next = all_.data();
  for (const auto& list : added_) {
    for (const Index v : list) {
      std::copy_n(next, 3, rows + std::size_t{v} * 4);
      next += 3;
    }
    ++next;  // whether it has failed
  }
}

void ProcessShare::join_sums(std::span<double> sums, Failure& failure) {
  const auto count = static_cast<Index>(sums.size());
  const auto [begin, end] = part(count);
  mine_.assign(sums.begin() + begin, sums.begin() + end);
  for (unsigned p = 0; p < processes_.size(); ++p) {
    const auto [first, last] = part_of(p, count);
    counts_[p] = static_cast<int>(last - first + 1);
  }
  exchange(failure);
  const double* next = all_.data();
  for (unsigned p = 0; p < processes_.size(); ++p) {
    const auto [first, last] = part_of(p, count);
    std::copy_n(next, last - first, sums.begin() + first);
    next += last - first + 1;
  }
}

}  // namespace suture
