// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/own_rest.hpp"

#include "kernel/base/archive.hpp"

namespace suture {

void OwnRest::set(Index element, const HexahedronNodes& x, Index element_count) {
  if (slot_of_.size() < element_count) slot_of_.resize(element_count, none);
  Index& slot = slot_of_[element];
  if (slot == none && !free_.empty()) {
    slot = free_.back();
    free_.pop_back();
  } else if (slot == none) {
    slot = static_cast<Index>(rows_.size() / 32);
    rows_.resize(rows_.size() + 32);
  }
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) rows_[(std::size_t{slot} * 8 + i) * 4 + c] = x[i][c];
}

void OwnRest::copy(Index from, Index to, Index element_count) {
  if (empty()) return;
  slot_of_.resize(element_count, none);
  if (slot(from) == none) return;
  HexahedronNodes x;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double* p = rows_.data() + (std::size_t{slot(from)} * 8 + i) * 4;
    x[i] = {p[0], p[1], p[2]};
  }
  set(to, x, element_count);
}

void OwnRest::state(Archive& archive) {
  archive("slot_of", slot_of_);
  archive("free", free_);
  archive("rows", rows_);
}

void OwnRest::remove(Index element) {
  if (slot(element) == none) return;
  free_.push_back(slot_of_[element]);
  slot_of_[element] = none;
}

}  // namespace suture
