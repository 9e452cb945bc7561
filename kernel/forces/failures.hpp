// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "kernel/base/types.hpp"
#include "suture/plugin.h"

namespace suture {

/// The failure that is reported of those that one worker met: the one that stops
/// before those that ask for a smaller step, then the first functor, then the
/// lowest cell. Merging those of all workers gives the same for any number.
class Failure {
 public:
  /// A call of functor number `functor` returned `status` for `batch`.
  void note(suture_status status, Index functor, const suture_error& error,
            const suture_batch& batch);
  void merge(const Failure& other);
  void clear() { *this = {}; }

  bool any() const { return status_ != SUTURE_OK; }
  Index functor() const { return functor_; }
  /// Throws NumericalError or StepRejected; `title` names model and functor,
  /// `cell_word` what its cells are called.
  [[noreturn]] void raise(const std::string& title, const char* cell_word, double time) const;

 private:
  bool comes_before(const Failure& other) const;

  suture_status status_ = SUTURE_OK;
  Index functor_ = none, cell_ = none;
  bool cell_known_ = false;
  std::int32_t code_ = 0;
  double step_factor_ = 1;  // the smallest asked for
  std::string text_;
};

}  // namespace suture
