// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "kernel/forces/nonsmooth_term.hpp"
#include "kernel/geometry/obstacle.hpp"

namespace suture {

/// What touches in the iterations of Newton's method, and how: finds what alternates, for messages.
/// Each iteration is a begin(), a note() for each contact with a pressure, and an end().
class ContactRegimes {
 public:
  void begin(unsigned iteration);
  void note(std::size_t obstacle, Index vertex, bool slides);
  void end();
  /// The contact that has alternated most often, if any does. `obstacles`: for their names.
  std::optional<NonsmoothTerm::Alternation> alternation(std::span<const Obstacle> obstacles) const;

 private:
  enum class Kind { apart, holds, slides };
  struct Regime {
    Kind now = Kind::apart, next = Kind::apart;
    unsigned changes = 0, last_change = 0;  ///< the number of the iteration
    bool lets_go = false;                   ///< some changes are from or to apart
  };
  using Entry = std::pair<const std::pair<std::size_t, Index>, Regime>;
  bool alternates(const Entry& entry) const;

  std::map<std::pair<std::size_t, Index>, Regime> regimes_;  ///< by obstacle and vertex
  unsigned iteration_ = 0;
};

}  // namespace suture
