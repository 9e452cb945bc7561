// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/processes/process_share.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace suture {
namespace {

/// Own vertices are whole ranges of every sum over vertices (Motion).
constexpr Index aligned = 4 * BodyShare::block;

}  // namespace

ProcessShare::ProcessShare(Communicator& processes)
    : processes_(processes), common_(processes.size()), counts_(processes.size()) {}

loops::Rows ProcessShare::part_of(unsigned process, Index count) const {
  const auto border = [&](std::uint64_t i) {
    return static_cast<Index>(i * count / processes_.size());
  };
  return {border(process), border(process + 1)};
}

/// The process whose part has the first element of the vertex.
unsigned ProcessShare::owner_of(const CellComplex& complex, Index vertex) const {
  const std::uint64_t element = element_of(complex.dart_of(0, vertex));
  return static_cast<unsigned>(((element + 1) * processes_.size() - 1) / complex.element_count());
}

void ProcessShare::divide(const CellComplex& complex) {
  begins_.resize(processes_.size() + 1);
  for (Index v = 0; v < complex.count(0); ++v)
    ++begins_[complex.exists(0, v) ? owner_of(complex, v) + 1 : processes_.size()];
  std::inclusive_scan(begins_.begin(), begins_.end(), begins_.begin());
  for (Index& begin : begins_) begin -= begin % aligned;
}

/// The borders stay where they are at first, whatever operations do.
std::vector<bool> ProcessShare::others(const CellComplex& complex) {
  if (begins_.empty()) divide(complex);
  std::vector<bool> others(complex.count(0), true);
  const auto [begin, end] = own();
  std::fill(others.begin() + begin, others.begin() + end, false);
  for (auto& list : common_) list.clear();
  for (Index v = common_begin(); v < others.size(); ++v) {
    if (!complex.exists(0, v)) continue;
    const unsigned owner = owner_of(complex, v);
    common_[owner].push_back(v);
    others[v] = owner != processes_.rank();
  }
  return others;
}

void ProcessShare::read(const std::vector<bool>& vertices) {
  borders_.clear();
  taken_.assign(processes_.size(), {});
  for (unsigned p = 0; p < processes_.size(); ++p) {
    if (p == processes_.rank()) continue;
    const auto [begin, end] = own_of(p);
    for (Index v = begin; v < end; ++v)
      if (vertices[v]) taken_[p].push_back(v);
    borders_.insert(borders_.end(), taken_[p].begin(), taken_[p].end());
  }
  given_ = processes_.swap(taken_);
  in_.clear();
  out_.clear();
  for (unsigned p = 0; p < processes_.size(); ++p) {
    if (!taken_[p].empty()) in_.push_back({p, {}});
    if (!given_[p].empty()) out_.push_back({p, {}});
  }
}

// ---------------------------------------------------------------- exchanges --

/// Gathers mine_ of all. Whether any process has met a fault.
bool ProcessShare::exchange(bool fault) {
  mine_.push_back(fault ? 1 : 0);
  all_.resize(std::reduce(counts_.begin(), counts_.end(), std::size_t{0}));
  processes_.gather(mine_, counts_, all_.data());
  mine_.clear();
  bool any = false;
  std::size_t end = 0;
  for (const int count : counts_) any |= all_[(end += static_cast<std::size_t>(count)) - 1] != 0;
  return any;
}

/// Failures are rare: their texts follow only where there is one.
void ProcessShare::exchange(Failure& failure) {
  if (!exchange(failure.any())) return;
  for (const std::string& text : processes_.gather(failure.packed()))
    failure.merge(Failure::unpacked(text));
}

void ProcessShare::complete(VertexRows rows) {
  const std::size_t width = rows.bytes / sizeof(double);
  for (unsigned p = 0; p < processes_.size(); ++p)
    counts_[p] = static_cast<int>(width * (own_of(p).end - own_of(p).begin));
  processes_.complete(reinterpret_cast<double*>(rows.data), counts_);
}

void ProcessShare::join_common(VertexRows rows, Failure& failure) {
  const std::size_t width = rows.bytes / sizeof(double);
  const auto& own = common_[processes_.rank()];
  mine_.resize(width * own.size());
  for (std::size_t i = 0; i < own.size(); ++i)
    std::memcpy(mine_.data() + i * width, rows.data + own[i] * rows.bytes, rows.bytes);
  for (unsigned p = 0; p < processes_.size(); ++p)
    counts_[p] = static_cast<int>(width * common_[p].size() + 1);
  exchange(failure);
  const double* next = all_.data();
  for (const auto& list : common_) {
    for (const Index v : list) {
      std::memcpy(rows.data + v * rows.bytes, next, rows.bytes);
      next += width;
    }
    ++next;  // whether it has failed
  }
}

void ProcessShare::join_borders(std::span<double* const> columns) {
  const auto prepare = [&](std::vector<Communicator::Parcel>& parcels, const auto& lists) {
    for (auto& [process, numbers] : parcels)
      numbers.resize(3 * columns.size() * lists[process].size());
  };
  prepare(out_, given_);
  prepare(in_, taken_);
  for (auto& [process, numbers] : out_) {
    double* next = numbers.data();
    for (const double* column : columns)
      for (const Index v : given_[process])
        next = std::copy_n(column + std::size_t{v} * 4, 3, next);
  }
  processes_.swap(out_, in_);
  for (const auto& [process, numbers] : in_) {
    const double* next = numbers.data();
    for (double* column : columns)
      for (const Index v : taken_[process]) {
        std::copy_n(next, 3, column + std::size_t{v} * 4);
        next += 3;
      }
  }
}

bool ProcessShare::join_blocks(std::span<double> rows, std::size_t width, bool good) {
  const auto of = [&](unsigned process) {
    const auto [begin, end] = own_of(process);
    return rows.subspan(begin / block * width, (end - begin) / block * width);
  };
  const auto own = of(processes_.rank());
  mine_.assign(own.begin(), own.end());
  for (unsigned p = 0; p < processes_.size(); ++p) counts_[p] = static_cast<int>(of(p).size() + 1);
  const bool any_is_bad = exchange(!good);
  const double* next = all_.data();
  for (unsigned p = 0; p < processes_.size(); ++p) {
    std::copy_n(next, of(p).size(), of(p).begin());
    next += counts_[p];
  }
  return !any_is_bad;
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
