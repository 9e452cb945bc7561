// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/base/types.hpp"

namespace suture {

/// What the calls of one function of a functor cost.
struct FunctorCost {
  std::string functor;   ///< "tissue/inner springs"
  std::string function;  ///< "force"
  std::uint64_t calls = 0;
  std::uint64_t cells = 0;  ///< of all calls
  double seconds = 0;       ///< wall clock, with gathering and adding
};

/// Sums what the loops of a run take, by functor and function.
class FunctorTimes {
  using Clock = std::chrono::steady_clock;

 public:
  struct Entry {
    Index functor = 0;
    std::string_view function;
    std::uint64_t calls = 0, cells = 0;
    Clock::duration time{};
  };

  /// From its construction to its end. Does nothing without `times`.
  class Scope {
   public:
    Scope(FunctorTimes* times, Index functor, std::string_view function, Index cells)
        : entry_(times ? &times->entry(functor, function) : nullptr) {
      if (entry_ == nullptr) return;
      ++entry_->calls;
      entry_->cells += cells;
      begin_ = Clock::now();
    }
    ~Scope() {
      if (entry_ != nullptr) entry_->time += Clock::now() - begin_;
    }
    Scope(const Scope&) = delete;

   private:
    Entry* entry_;
    Clock::time_point begin_;
  };

  const std::vector<Entry>& entries() const { return entries_; }

 private:
  /// `function` is a string literal.
  Entry& entry(Index functor, std::string_view function) {
    for (Entry& entry : entries_)
      if (entry.functor == functor && entry.function == function) return entry;
    return entries_.emplace_back(Entry{functor, function});
  }

  std::vector<Entry> entries_;
};

}  // namespace suture
