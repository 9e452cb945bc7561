// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/column.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "kernel/base/archive.hpp"
#include "kernel/base/bulk.hpp"
#include "kernel/base/out_of_memory.hpp"

namespace suture {

ColumnSpec spec_of(const suture_attribute& attribute) {
  ColumnSpec spec;
  spec.name = attribute.name;
  spec.unit = attribute.unit;
  spec.doc = attribute.doc;
  spec.components = static_cast<int>(attribute.components);
  spec.policy = static_cast<suture_policy>(attribute.policy);
  spec.initial = attribute.initial;
  spec.flags = attribute.flags;
  return spec;
}

Column::Column(ColumnSpec spec, int dimension)
    : spec_(std::move(spec)),
      dimension_(dimension),
      stride_(spec_.components == 3 ? 4 : spec_.components),
      constant_(dimension != 0 && !has_trial()) {
  if (constant_) data_.assign(storage(1), spec_.initial);
}

std::size_t Column::storage(Index rows) const {
  if (dimension_ == 0) return offset(rows);
  return block_offset(rows / lanes + (rows % lanes != 0 ? 1 : 0));
}

namespace {

void reserve(Column::Values& data, std::size_t numbers, const std::string& name) {
  try {
    data.reserve(numbers);
  } catch (const std::bad_alloc&) {
    throw OutOfMemory(("column '" + name + "'").c_str(), double(numbers) * sizeof(double));
  }
}

}  // namespace

void Column::grow(Values& data, Index rows) const {
  const std::size_t needed = storage(rows);
  // A cut adds rows a few at a time; copying a column of a million rows for the
  // first of them would cost more than the cut.
  if (needed > data.capacity()) {
    reserve(data, 2 * needed, spec_.name);
    // But for the page between, which would hold little for as long as nothing is cut.
    prefer_large_pages(data.data(), needed * sizeof(double));
    prefer_large_pages(data.data() + needed, needed * sizeof(double));
  }
  if (needed < data.size()) std::fill(data.begin() + std::ptrdiff_t(needed), data.end(), 0.0);
  // Rows of zeros take no memory until they are written.
  if (std::bit_cast<std::uint64_t>(spec_.initial) == 0)
    data.resize(needed);
  else
    data.resize(needed, spec_.initial);
  if (dimension_ == 0) {
    const bool has_unused = spec_.components == 3 && spec_.initial != 0;
    for (std::size_t i = offset(size_) + 3; has_unused && i < needed; i += 4) data[i] = 0;
    return;
  }
  // Lanes that held copies of the last row become rows.
  const Index end = std::min(rows, (size_ + lanes - 1) / lanes * lanes);
  for (Index row = size_; row < end; ++row)
    for (int c = 0; c < spec_.components; ++c) data[stored(row, c)] = spec_.initial;
}

void Column::resize(Index rows) {
  if (!constant_) {
    grow(data_, rows);
    if (has_trial()) grow(trial_, rows);
  }
  size_ = rows;
  pad();
}

void Column::make_room(Index rows) {
  if (constant_) return;
  const std::size_t more = storage(size_ + rows) - storage(size_);
  suture::make_room(data_, more);
  if (has_trial()) suture::make_room(trial_, more);
}

void Column::set(Index row, int component, double value) {
  if (constant_ && data_[stored(row, component)] == value) return;
  expand();
  data_[stored(row, component)] = value;
  if (row + 1 == size_) pad();
}

void Column::append_copies(std::span<const RowSplit> splits) {
  if (constant_) return resize(size_ + static_cast<Index>(splits.size()));
  // A few at a time, so that what resize() writes is still in the cache.
  constexpr std::size_t max_splits = 128;
  for (; !splits.empty(); splits = splits.subspan(std::min(max_splits, splits.size()))) {
    const std::span<const RowSplit> some = splits.first(std::min(max_splits, splits.size()));
    resize(size_ + static_cast<Index>(some.size()));
    copy_rows(data_, some);
    if (has_trial()) copy_rows(trial_, some);
  }
  pad();
}

void Column::copy_rows(Values& data, std::span<const RowSplit> splits) const {
  double* values = data.data();
  if (dimension_ == 0 && stride_ == 4) {
    for (const auto& [from, to] : splits) {
      // std::copy_n calls memmove: a third of the time of following a cut.
      const double* source = values + std::size_t{from} * 4;
      double* target = values + std::size_t{to} * 4;
      const double x = source[0], y = source[1], z = source[2], w = source[3];
      target[0] = x, target[1] = y, target[2] = z, target[3] = w;
    }
    return;
  }
  const std::size_t step = component_step();
  const std::size_t end = static_cast<std::size_t>(spec_.components) * step;
  for (const auto& [from, to] : splits)
    for (std::size_t at = 0; at < end; at += step)
      values[offset(to) + at] = values[offset(from) + at];
}

void Column::scale_row(Index row, double factor) {
  if (factor == 1) return;
  expand();
  for (int c = 0; c < spec_.components; ++c) {
    data_[stored(row, c)] *= factor;
    if (has_trial()) trial_[stored(row, c)] *= factor;
  }
  if (row + 1 == size_) pad();
}

void Column::mix_row(Index to, Index from, double weight) {
  if (constant_) return;
  for (int c = 0; c < spec_.components; ++c) {
    const std::size_t a = stored(to, c), b = stored(from, c);
    data_[a] = std::lerp(data_[a], data_[b], weight);
    if (has_trial()) trial_[a] = std::lerp(trial_[a], trial_[b], weight);
  }
  if (to + 1 == size_) pad();
}

void Column::add_row(Index to, Index from) {
  expand();
  for (int c = 0; c < spec_.components; ++c) {
    data_[stored(to, c)] += data_[stored(from, c)];
    if (has_trial()) trial_[stored(to, c)] += trial_[stored(from, c)];
  }
  if (to + 1 == size_) pad();
}

Column::Values Column::hand_over() {
  Values copy;
  copy.reserve(data_.capacity());  // what is reserved for cuts
  copy = data_;
  return std::exchange(data_, std::move(copy));
}

void Column::hold_row(Index row) {
  for (int c = 0; c < spec_.components; ++c) trial_[stored(row, c)] = data_[stored(row, c)];
  if (row + 1 == size_) pad();
}

void Column::fill(double value) {
  constant_ = dimension_ != 0 && !has_trial();
  if (constant_) {
    Values(storage(1), value).swap(data_);
    return;
  }
  for (Index row = 0; row < size_; ++row)
    for (int c = 0; c < spec_.components; ++c) data_[stored(row, c)] = value;
  pad();
}

void Column::fill(std::span<const double> block) {
  Values(block.begin(), block.end()).swap(data_);
  constant_ = true;
}

double* Column::block(Index b) {
  expand();
  return data_.data() + block_offset(b);
}

void Column::expand() {
  if (!constant_) return;
  const Values one = data_;
  reserve(data_, 2 * storage(size_), spec_.name);
  data_.resize(storage(size_));
  for (std::size_t at = 0; at < data_.size(); at += one.size())
    std::copy(one.begin(), one.end(), data_.begin() + static_cast<std::ptrdiff_t>(at));
  constant_ = false;
}

void Column::pad() {
  if (dimension_ == 0 || constant_ || size_ % lanes == 0) return;
  pad(data_);
  if (has_trial()) pad(trial_);
}

void Column::pad(Values& data) const {
  for (int c = 0; c < spec_.components; ++c) {
    double* lane = data.data() + block_offset(size_ / lanes) + c * static_cast<int>(lanes);
    std::fill(lane + size_ % lanes, lane + lanes, lane[size_ % lanes - 1]);
  }
}

bool Column::compress(double relative) {
  if (constant_ || dimension_ == 0 || has_trial() || size_ == 0) return constant_;
  double largest = 0;
  for (const double value : data_) largest = std::max(largest, std::abs(value));
  const std::size_t length = storage(1);
  for (std::size_t at = 0; at < data_.size(); at += length)
    for (std::size_t i = 0; i < length; ++i) {
      const double first = data_[i / lanes * lanes];
      if (!(std::abs(data_[at + i] - first) <= relative * largest)) return false;
    }
  Values one(length);
  for (std::size_t i = 0; i < length; ++i) one[i] = data_[i / lanes * lanes];
  data_.swap(one);
  constant_ = true;
  return true;
}

void Column::state(Archive& archive) {
  if (archive.has_cells()) {
    Index rows = size_;
    bool constant = constant_;
    archive("rows", rows);
    archive("constant", constant);
    if (!constant) expand();
    if (archive.loads()) {
      archive.require(constant == constant_, "only one of the two columns is constant");
      // Room for `rows` only if there are values for all of them: a damaged number may be anything.
      Values values;
      archive("values", values);
      archive.require(values.size() == storage(constant ? 1 : rows),
                      "the column has a different number of rows");
      resize(rows);  // with the room that it has for more
    }
  }
  const std::size_t size = data_.size();
  archive("values", data_);
  if (archive.has_cells() && has_trial()) archive("trial", trial_);
  archive.require(data_.size() == size && (!has_trial() || trial_.size() == size),
                  "the column has a different number of rows");
}

}  // namespace suture
