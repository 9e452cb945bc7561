// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "kernel/base/types.hpp"

namespace suture {

/// A force term whose forces have kinks, as those of contact, derives from this class besides
/// ForceTerm: Newton's method may find no way through them.
class NonsmoothTerm {
 public:
  /// A vertex whose force changes from one side of a kink to the other and back.
  struct Alternation {
    std::string text;  ///< "contact with the obstacle 'floor' alternates between sliding and ..."
    Index vertex;
  };

  virtual ~NonsmoothTerm() = default;
  /// Iteration `number` of Newton's method is about to use the tangent at `time`.
  virtual void begin_iteration(unsigned number, double time) = 0;
  /// Newton's method has failed. Makes the forces easier to balance until the step ends: they
  /// converge to the same limit, but with more calls of ConstraintTerm::update(). False if they
  /// already are, or if there are no easier ones.
  virtual bool simplify() = 0;
  /// What has alternated most often since the first iteration, if anything has.
  virtual std::optional<Alternation> alternation() const = 0;
  /// For the summary of a run: how far solutions were off; empty if there is nothing to say.
  virtual std::string note() const = 0;
};

}  // namespace suture
